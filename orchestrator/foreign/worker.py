"""The process of one FMU: takes orders on its standard input, answers on what was its standard output.

A message is one letter, the length of what follows as four bytes, and that: JSON, or numbers as doubles. Imports
nothing but the standard library and ``fmi_calls``, so that a process is there in 30 ms.

Orders: ``L`` load, ``P`` parameters, ``I`` enter Initialization Mode, ``R`` exit it, ``O`` give outputs, ``N`` take
inputs, ``S`` step (time, step, inputs; answers with the outputs), ``C`` close. Answers: ``=`` done (with the numbers
asked for), ``!`` refused, and before either ``M``, a message of the FMU.
"""

import ctypes
import json
import os
import struct
import sys
from collections.abc import Callable
from typing import Any

from orchestrator.foreign import fmi_calls

HEAD = struct.Struct("=ci")
TIMES = struct.Struct("=dd")
DONE, REFUSED, MESSAGE = b"=", b"!", b"M"
LOAD, PARAMETERS, INITIALIZE, START, OUTPUTS, INPUTS, STEP, CLOSE = (
    letter.encode() for letter in ("L", "P", "I", "R", "O", "N", "S", "C")
)


class Stream:
    """Messages from a pipe; what was read too much is kept for the next."""

    def __init__(self, handle: int) -> None:
        self._handle = handle
        self._kept = b""

    def message(self) -> tuple[bytes, bytes]:
        """Return (letter, what follows). Raises ``EOFError`` if there is nobody any more."""
        while len(self._kept) < HEAD.size:
            self._more()
        letter, size = HEAD.unpack_from(self._kept)
        whole = HEAD.size + size
        while len(self._kept) < whole:
            self._more()
        data, self._kept = self._kept[HEAD.size : whole], self._kept[whole:]
        return letter, data

    def _more(self) -> None:
        part = os.read(self._handle, 1 << 16)
        if not part:
            raise EOFError
        self._kept += part


def send(handle: int, letter: bytes, data: bytes) -> None:
    """Write one message."""
    rest = HEAD.pack(letter, len(data)) + data
    while rest:
        rest = rest[os.write(handle, rest) :]


class Worker:
    """One FMU and what it was asked."""

    def __init__(self, reading: int, writing: int) -> None:
        self._orders, self._writing = Stream(reading), writing
        self._fmu: Any = None
        self._worst = 0
        self._last = ""
        self._gets: list[Any] = []
        self._sets: list[Any] = []
        self._seen = b""

    def serve(self) -> None:
        """Do what is asked until there is nobody who asks."""
        orders: dict[bytes, Callable[[bytes], bytes]] = {
            LOAD: self._load,
            PARAMETERS: self._parameters,
            INITIALIZE: lambda data: self._checked(self._fmu.initialize(*json.loads(data)), "refuses to initialize"),
            START: lambda data: self._checked(self._fmu.start(), "refuses to start"),
            OUTPUTS: lambda data: self._outputs(),
            INPUTS: self._inputs,
            STEP: self._step,
            CLOSE: self._close,
        }
        while True:
            try:
                letter, data = self._orders.message()
            except EOFError:
                return
            try:
                send(self._writing, DONE, orders[letter](data))
            except fmi_calls.RefusedError as error:
                self._worst = max(self._worst, error.status)
                word = fmi_calls.WORDS.get(error.status, "")
                send(self._writing, REFUSED, json.dumps([error.what, error.status, self._last or word]).encode())
            if letter == CLOSE:
                return

    def _load(self, data: bytes) -> bytes:
        asked = json.loads(data)
        made = fmi_calls.Fmi3 if asked["version"] == 3 else fmi_calls.Fmi2
        try:
            if hasattr(os, "add_dll_directory"):
                os.add_dll_directory(os.path.dirname(asked["library"]))
            library = ctypes.CDLL(asked["library"])
            self._fmu = made(library, asked["name"], asked["guid"], asked["resources"], self._say)
            self._gets = [self._fmu.transfer("Get", group) for group in asked["outputs"]]
            self._sets = [self._fmu.transfer("Set", group) for group in asked["inputs"]]
        except (OSError, AttributeError) as error:
            self._last = self._last or str(error)
            raise fmi_calls.RefusedError("cannot be loaded here", fmi_calls.ERROR) from error
        return b""

    def _parameters(self, data: bytes) -> bytes:
        for group in json.loads(data):
            transfer = self._fmu.transfer("Set", group)
            transfer.take(struct.pack(f"={transfer.count}d", *group["values"]))
            self._checked(transfer(), "refuses its parameters")
        return b""

    def _step(self, data: bytes) -> bytes:
        t, dt = TIMES.unpack_from(data)
        self._inputs(data[TIMES.size :])
        status = self._fmu.step(t, dt)
        if status > fmi_calls.WARNING:
            raise fmi_calls.RefusedError(f"failed at {t:g} s", status)
        return self._outputs()

    def _inputs(self, data: bytes) -> bytes:
        """Set the inputs, if any has changed: an FMU holds its inputs."""
        if data == self._seen:
            return b""
        self._seen = data
        at = 0
        for transfer in self._sets:
            transfer.take(data[at : at + transfer.size])
            at += transfer.size
            self._checked(transfer(), "refuses its inputs")
        return b""

    def _outputs(self) -> bytes:
        for transfer in self._gets:
            self._checked(transfer(), "gives no outputs")
        return b"".join([transfer.give() for transfer in self._gets])

    def _close(self, data: bytes) -> bytes:
        """Terminate and free, as far as FMI allows: after an error free alone, after fmiFatal nothing."""
        if self._fmu is not None:
            status = self._fmu.terminate() if self._worst < fmi_calls.ERROR else fmi_calls.OK
            if max(status, self._worst) < fmi_calls.FATAL:
                self._fmu.free()
        return b""

    def _checked(self, status: int, what: str) -> bytes:
        if status > fmi_calls.WARNING:
            raise fmi_calls.RefusedError(what, status)
        return b""

    def _say(self, status: int, text: str) -> None:
        if status > fmi_calls.WARNING:
            self._last = text
        send(self._writing, MESSAGE, json.dumps([int(status), text]).encode())


def main() -> None:
    """Keep the pipes to oneself, so that what the FMU prints is no answer; leave no core; end with the parent."""
    reading, writing = os.dup(0), os.dup(1)
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
