"""The process of one FMU: takes orders on its standard input, answers on what was its standard output.

A message is one letter, the number of the order, the length of what follows, and that: JSON, or nothing. An answer
has the number of its order, which begins anywhere and which no FMU knows, so what an FMU writes into the pipe is no
answer. Numbers lie in a file that both have in their memory: time and step, the inputs, the outputs, as doubles.
Imports nothing but the standard library and ``fmi_calls``, so that a process is there in 30 ms.

Orders: ``L`` load, ``P`` parameters, ``I`` enter Initialization Mode, ``R`` exit it, ``O`` give outputs, ``N`` take
inputs, ``S`` take inputs, step, give outputs, ``s`` the same with the inputs as they were, ``C`` close. Answers: ``=``
done, ``!`` refused, and before either ``M``, a message of the FMU.
"""

import ctypes
import json
import mmap
import os
import struct
import sys
from _thread import allocate_lock
from collections.abc import Callable
from typing import Any

from orchestrator.simulation.imported import fmi_calls

HEAD = struct.Struct("=cQI")
TIMES = struct.Struct("=dd")
DONE, REFUSED, MESSAGE = b"=", b"!", b"M"
LOAD, PARAMETERS, INITIALIZE, START, OUTPUTS, INPUTS, STEP, HELD_STEP, CLOSE = (
    letter.encode() for letter in ("L", "P", "I", "R", "O", "N", "S", "s", "C")
)
READ_BLOCK_BYTES = 1 << 16
"""Bytes that are read at once."""
MAX_ORDER, MAX_ANSWER = 1 << 26, 1 << 16
"""Bytes that follow in one message."""
MAX_TEXT = 2_000
"""Letters of a message of an FMU; the rest is left out."""
MAX_MESSAGES = 10_000
"""Of one FMU in a run; the rest is left out."""
PRIVATE = range(200, 1000)
"""Descriptors of the pipes, where the system allows so many: an FMU that writes to a low one does not meet them."""


class ForeignAnswerError(Exception):
    """There is something in the pipe that no worker has written."""


class Stream:
    """Messages from a pipe; what was read too much is kept for the next."""

    def __init__(self, handle: int, most: int, wait: Callable[[], None] = lambda: None) -> None:
        self._handle, self._most, self._wait = handle, most, wait
        self._kept = b""

    def message(self) -> tuple[bytes, int, bytes]:
        """Return (letter, number of the order, what follows).

        Raises ``EOFError`` if there is nobody any more, ``ForeignAnswerError`` if the length cannot be.
        """
        while True:
            kept = self._kept
            if len(kept) >= HEAD.size:
                letter, number, size = HEAD.unpack_from(kept)
                whole = HEAD.size + size
                if size > self._most:
                    raise ForeignAnswerError
                if len(kept) >= whole:
                    self._kept = kept[whole:]
                    return letter, number, kept[HEAD.size : whole]
            self._wait()
            part = os.read(self._handle, READ_BLOCK_BYTES)
            if not part:
                raise EOFError
            self._kept = kept + part if kept else part


def send(handle: int, letter: bytes, number: int, data: bytes) -> None:
    """Write one message."""
    rest = HEAD.pack(letter, number, len(data)) + data
    while rest:
        rest = rest[os.write(handle, rest) :]


class Worker:
    """One FMU and what it was asked."""

    def __init__(self, reading: int, writing: int) -> None:
        self._orders, self._writing = Stream(reading, MAX_ORDER), writing
        self._number = self._messages = 0
        self._lock = allocate_lock()
        self._is_answering = False
        self._early: list[bytes] = []
        """Messages from threads of the FMU between two orders: they go with the next one."""
        self._fmu: Any = None
        self._worst = 0
        self._last = ""
        self._gets: list[Any] = []
        self._sets: list[Any] = []
        self._shared: Any = None

    def serve(self) -> None:
        """Carry out orders until the pipe is closed."""
        orders: dict[bytes, Callable[[bytes], None]] = {
            LOAD: self._load,
            PARAMETERS: self._parameters,
            INITIALIZE: lambda data: self._check_status(
                self._fmu.initialize(*json.loads(data)), "refuses to initialize"
            ),
            START: lambda data: self._check_status(self._fmu.start(), "refuses to start"),
            OUTPUTS: lambda data: self._outputs(),
            INPUTS: lambda data: self._inputs(),
            STEP: self._step_with_inputs,
            HELD_STEP: self._step,
            CLOSE: self._close,
        }
        while True:
            try:
                letter, number, data = self._orders.message()
            except EOFError:
                return
            self._begin(number)
            try:
                orders[letter](data)
                self._answer(DONE, b"")
            except fmi_calls.RefusedError as error:
                self._worst = max(self._worst, error.status)
                word = fmi_calls.WORDS.get(error.status, "")
                self._answer(REFUSED, json.dumps([error.what, error.status, self._last or word]).encode())
            if letter == CLOSE:
                return

    def _begin(self, number: int) -> None:
        """Send the messages that came before this order: the other side reads none between two orders."""
        with self._lock:
            self._number, self._is_answering = number, True
            for message in self._early:
                send(self._writing, MESSAGE, number, message)
            self._early.clear()

    def _answer(self, letter: bytes, data: bytes) -> None:
        with self._lock:
            self._is_answering = False
            send(self._writing, letter, self._number, data)

    def _load(self, data: bytes) -> None:
        asked = json.loads(data)
        _limit_memory(int(asked["memory"]))
        made = fmi_calls.Fmi3 if asked["version"] == 3 else fmi_calls.Fmi2
        try:
            if hasattr(os, "add_dll_directory"):
                os.add_dll_directory(os.path.dirname(asked["library"]))
            library = ctypes.CDLL(asked["library"])
            self._fmu = made(library, asked["name"], asked["guid"], asked["resources"], self._say)
            self._share(asked)
        except (OSError, AttributeError) as error:
            self._last = self._last or str(error)
            raise fmi_calls.RefusedError("cannot be loaded here", fmi_calls.ERROR) from error

    def _share(self, asked: Any) -> None:
        """Have the numbers' file, a path or a descriptor, in memory, and a call for each type of them, inputs first."""
        with open(asked["shared"], "r+b", buffering=0) as file:
            self._shared = mmap.mmap(file.fileno(), 0)
        at = TIMES.size
        for verb, groups, transfers in (("Set", asked["inputs"], self._sets), ("Get", asked["outputs"], self._gets)):
            for group in groups:
                transfers.append(self._fmu.transfer(verb, group, fmi_calls.NumbersAt(self._shared, at)))
                at += 8 * transfers[-1].count

    def _parameters(self, data: bytes) -> None:
        for group in json.loads(data):
            if group["type"] == "String":
                self._check_status(self._fmu.set_texts(group["references"], group["values"]), "refuses its parameters")
                continue
            values = bytearray(struct.pack(f"={len(group['values'])}d", *group["values"]))
            transfer = self._fmu.transfer("Set", group, fmi_calls.NumbersAt(values, 0))
            transfer.take()
            self._check_status(transfer(), "refuses its parameters")

    def _step_with_inputs(self, data: bytes) -> None:
        self._inputs()
        self._step(data)

    def _step(self, data: bytes) -> None:
        t, dt = TIMES.unpack_from(self._shared)
        status = self._fmu.step(t, dt)
        if fmi_calls.is_failure(status):
            raise fmi_calls.RefusedError(f"failed at {t:g} s", status)
        if self._fmu.requests_end:
            text = f"requests the end of the simulation at {t + dt:g} s (terminateSimulation)"
            raise fmi_calls.RefusedError(text, fmi_calls.WARNING)
        self._outputs()

    def _inputs(self) -> None:
        for transfer in self._sets:
            transfer.take()
            self._check_status(transfer(), "refuses its inputs")

    def _outputs(self) -> None:
        for transfer in self._gets:
            self._check_status(transfer(), "gives no outputs")
            transfer.give()

    def _close(self, data: bytes) -> None:
        """Terminate and free, as far as FMI allows: after an error free alone, after fmiFatal nothing."""
        if self._fmu is not None:
            status = self._fmu.terminate() if self._worst < fmi_calls.ERROR else fmi_calls.OK
            if max(status, self._worst) < fmi_calls.FATAL:
                self._fmu.free()

    def _check_status(self, status: int, what: str) -> None:
        if fmi_calls.is_failure(status):
            raise fmi_calls.RefusedError(what, status)

    def _say(self, status: int, text: str) -> None:
        """Pass a message on, as far as there is a sense in it: so many in a run, of so many letters."""
        text = text if len(text) <= MAX_TEXT else f"{text[:MAX_TEXT]}... ({len(text)} letters)"
        if status > fmi_calls.WARNING:
            self._last = text
        with self._lock:
            self._messages += 1
            if self._messages > MAX_MESSAGES:
                return
            if self._messages == MAX_MESSAGES:
                status, text = fmi_calls.WARNING, f"further messages are left out, as there are {MAX_MESSAGES} already"
            message = json.dumps([int(status), text]).encode()
            if self._is_answering:
                send(self._writing, MESSAGE, self._number, message)
            else:
                self._early.append(message)


def _limit_memory(size: int) -> None:
    """Let this process have so many bytes of addresses, where the system can limit that."""
    if sys.platform != "win32":
        import resource

        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        most = size if hard == resource.RLIM_INFINITY else min(size, hard)
        resource.setrlimit(resource.RLIMIT_AS, (most, hard))


def _private(handle: int) -> int:
    """Return a descriptor of the same pipe that is hard to meet by chance, and closed in children."""
    if sys.platform == "win32":
        return os.dup(handle)
    import fcntl
    import random

    try:
        return fcntl.fcntl(handle, fcntl.F_DUPFD_CLOEXEC, random.SystemRandom().choice(PRIVATE))
    except OSError:  # there are not so many
        return os.dup(handle)


def main() -> None:
    """Keep the pipes to oneself, so that what the FMU prints is no answer; leave no core; end with the parent."""
    reading, writing = _private(0), _private(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    if sys.platform != "win32":
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, 9)
    Worker(reading, writing).serve()
    os._exit(0)
