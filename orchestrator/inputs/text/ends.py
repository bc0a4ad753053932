"""Ctrl-C and SIGTERM: the first ends what is done in order, the second, or two seconds, end the program at once.

A handler in Python waits until the C code in hand returns, which a hanging FMU never does. So a thread watches too:
the system writes each signal into its pipe at once.
"""

import os
import select
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

from fmus.children import end_all
from fmus.files import remove_all_folders
from orchestrator.inputs.text.errors import INTERRUPTED

SHUTDOWN_TIMEOUT = 1.5
"""Time for an end in order [s]."""
SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM") if hasattr(signal, name))


@contextmanager
def stop_on_signal(act: Callable[[], None]) -> Iterator[None]:
    """Call ``act`` on the first SIGINT or SIGTERM, so that no exception lands inside an FMU's code; end at the second.

    Elsewhere than on the main thread, to which signals come, nothing is changed.
    """
    asked = False

    def handler(_number: int, _frame: FrameType | None) -> None:
        nonlocal asked
        if asked:
            end_now()
        asked = True
        act()

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = [(number, signal.signal(number, handler)) for number in SIGNALS]
    try:
        yield
    finally:
        for number, old in before:
            signal.signal(number, old)


@contextmanager
def interrupt_within_limit() -> Iterator[threading.Event]:
    """Let signals raise ``KeyboardInterrupt``, and end the program at once if that takes too long.

    Gives what is set by a signal: code in C may make another exception of the interrupt.
    """
    interrupted = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield interrupted
        return

    def interrupt() -> None:
        interrupted.set()
        raise KeyboardInterrupt

    here, there = _pipe()
    watch = threading.Thread(target=_watch, args=(here,), daemon=True)
    before = signal.set_wakeup_fd(there.fileno(), warn_on_full_buffer=False)
    watch.start()
    try:
        with stop_on_signal(interrupt):
            yield interrupted
    finally:
        signal.set_wakeup_fd(before)
        there.close()
        watch.join()
        here.close()
        # CPython remembers an interrupt that came out of an exec and ends ``python -m`` for it by SIGINT, without code.
        exec("")


def _pipe() -> tuple[Any, Any]:
    """Return two ends: what the system writes into the second comes out of the first."""
    if os.name == "posix":
        here, there = os.pipe()
        os.set_blocking(there, False)
        return open(here, "rb", buffering=0), open(there, "wb", buffering=0)
    import socket

    first, second = socket.socketpair()
    second.setblocking(False)
    return first, second


def end_now() -> None:
    """End the program with all that it has started, and take away what it has for a while."""
    with suppress(Exception):
        end_all()
        remove_all_folders()
        os.write(2, b"apa: interrupted\n")
    os._exit(INTERRUPTED)


def _watch(pipe: Any) -> None:
    """End the program at a second signal, or some time after the first; return when the pipe is closed."""
    wait: float | None = None
    while True:
        if not select.select([pipe], [], [], wait)[0]:
            end_now()
        data = os.read(pipe.fileno(), 64) if os.name == "posix" else pipe.recv(64)
        if not data:
            return
        ends = sum(number in SIGNALS for number in data)
        if ends and (wait is not None or ends > 1):
            end_now()
        wait = SHUTDOWN_TIMEOUT if ends else wait
