"""Ctrl-C ends a run after the exchange in hand; a second one ends the program at once."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from orchestrator.cosim.master import Interrupt


@contextmanager
def on_interrupt(interrupt: Interrupt) -> Iterator[None]:
    """Set ``interrupt.requested`` on the first SIGINT, so that no exception lands inside an FMU's code."""

    def handler(_number: int, _frame: FrameType | None) -> None:
        if interrupt.requested:
            raise KeyboardInterrupt
        interrupt.requested = True

    before = signal.signal(signal.SIGINT, handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
