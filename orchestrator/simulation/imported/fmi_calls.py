"""The calls of FMI 2.0 and FMI 3.0 for co-simulation, as few as a master needs, through ctypes alone.

Runs in the process of the FMU and imports nothing but the standard library.
"""

import ctypes
import struct
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

OK, WARNING, DISCARD, ERROR, FATAL = 0, 1, 2, 3, 4
WORDS = {DISCARD: "fmiDiscard", ERROR: "fmiError", FATAL: "fmiFatal"}


def is_failure(status: int) -> bool:
    """Return whether a call did not do what it should; a status that FMI does not define counts as a failure."""
    return not OK <= status <= WARNING


Say = Callable[[int, str], None]
"""Called with an FMI status and a message of the FMU."""
Group = Mapping[str, Any]
"""Variables of one type: ``type``, ``references``, and ``count``, the number of their values."""
C_TYPES: dict[str, Any] = {
    "Real": ctypes.c_double,
    "Integer": ctypes.c_int32,
    "Boolean": ctypes.c_int32,
    "Float64": ctypes.c_double,
    "Float32": ctypes.c_float,
    **{f"Int{bits}": getattr(ctypes, f"c_int{bits}") for bits in (8, 16, 32, 64)},
    **{f"UInt{bits}": getattr(ctypes, f"c_uint{bits}") for bits in (8, 16, 32, 64)},
    "Boolean3": ctypes.c_bool,
}
"""Type of a group -> how C has it; a Boolean of FMI 3.0 is another one than that of FMI 2.0."""
Pointer, Text, Size, Int, Double, Bool = (
    ctypes.c_void_p,
    ctypes.c_char_p,
    ctypes.c_size_t,
    ctypes.c_int,
    ctypes.c_double,
    ctypes.c_bool,
)


class RefusedError(Exception):
    """A call that did not do what it should."""

    def __init__(self, what: str, status: int) -> None:
        super().__init__(what)
        self.what = what
        self.status = status


class NumbersAt(NamedTuple):
    """Where the numbers of a call are, as doubles."""

    memory: Any
    """A writable buffer."""
    begin: int
    """The first of them in it [bytes]."""


class ValueCall:
    """One direction of one type: the call, and the memory that its values go through.

    Doubles are handed to the FMU where they lie; other types are converted, by ``take`` or ``give``.
    """

    def __init__(self, call: Callable[..., int], component: Any, group: Group, counts: bool, place: NumbersAt) -> None:
        self.count = int(group["count"])
        kind = C_TYPES[group["type"]]
        self.is_double, self._is_real = kind is Double, kind in (Double, ctypes.c_float)
        self._memory, self._begin = place
        inside = self.is_double and self.count
        self._array = (kind * self.count).from_buffer(*place) if inside else (kind * max(self.count, 1))()
        self._packed = struct.Struct(f"={self.count}d")
        references = [int(item) for item in group["references"]]
        self._references = (ctypes.c_uint32 * max(len(references), 1))(*references)
        more = (Size(self.count),) if counts else ()
        self._arguments = (component, self._references, Size(len(references)), self._array, *more)
        self._call = call

    def __call__(self) -> int:
        """Make the call and return its FMI status."""
        return self._call(*self._arguments) if self.count else OK

    def take(self) -> None:
        """Lay the numbers into the memory of the call."""
        if not self.is_double:
            values = self._packed.unpack_from(self._memory, self._begin)
            self._array[: self.count] = values if self._is_real else [int(value) for value in values]

    def give(self) -> None:
        """Lay what the call has brought where the numbers are."""
        if not self.is_double:
            self._packed.pack_into(self._memory, self._begin, *self._array[: self.count])


class _Callbacks(ctypes.Structure):
    """fmi2CallbackFunctions."""

    _fields_ = (
        ("logger", Pointer),
        ("allocate_memory", Pointer),
        ("free_memory", Pointer),
        ("step_finished", Pointer),
        ("environment", Pointer),
    )


class Fmi2:
    """One instance of an FMI 2.0 FMU."""

    prefix, counts = "fmi2", False

    def __init__(self, library: Any, name: str, guid: str, resources: str, say: Say) -> None:
        self._library = library
        self._logger = ctypes.CFUNCTYPE(None, Pointer, Text, Int, Text, Text)(
            lambda _, __, status, ___, message: say(status, _words(message))
        )
        memory = ctypes.CDLL("msvcrt" if sys.platform == "win32" else None)
        calloc, free = (ctypes.cast(getattr(memory, called), Pointer) for called in ("calloc", "free"))
        self._callbacks = _Callbacks(ctypes.cast(self._logger, Pointer), calloc, free, None, None)
        make = library.fmi2Instantiate
        make.restype, make.argtypes = Pointer, (Text, Int, Text, Text, Pointer, Int, Int)
        texts = name.encode(), guid.encode(), resources.encode()
        made = make(texts[0], 1, texts[1], texts[2], ctypes.byref(self._callbacks), 0, 1)
        if not made:
            raise RefusedError("cannot be instantiated", FATAL)
        self.component = Pointer(made)
        self._step = library.fmi2DoStep
        self._step.argtypes = (Pointer, Double, Double, Int)

    def initialize(self, stop: float) -> int:
        """Set the experiment up and enter Initialization Mode."""
        setup = self._library.fmi2SetupExperiment
        setup.argtypes = (Pointer, Int, Double, Double, Int, Double)
        status = int(setup(self.component, 0, 0.0, 0.0, 1, stop))
        return status if is_failure(status) else self.plain("EnterInitializationMode")

    def start(self) -> int:
        """Exit Initialization Mode."""
        return self.plain("ExitInitializationMode")

    def step(self, t: float, dt: float) -> int:
        """Call fmi2DoStep."""
        return int(self._step(self.component, t, dt, 1))

    @property
    def requests_end(self) -> bool:
        """Whether the last step asked for the end of the simulation: FMI 2.0 has no ``terminateSimulation``."""
        return False

    def terminate(self) -> int:
        """Call fmi2Terminate."""
        return self.plain("Terminate")

    def free(self) -> None:
        """Free the instance."""
        free = getattr(self._library, f"{self.prefix}FreeInstance")
        free.restype, free.argtypes = None, (Pointer,)
        free(self.component)

    def transfer(self, verb: str, group: Group, place: NumbersAt) -> ValueCall:
        """Return the call that gets, or sets, a group of variables whose numbers are at a place."""
        call = getattr(
            self._library, f"{self.prefix}{verb}{group['type'].rstrip('3') if self.counts else group['type']}"
        )
        return ValueCall(call, self.component, group, self.counts, place)

    def set_texts(self, references: Sequence[int], texts: Sequence[str]) -> int:
        """Set text parameters: one value for each reference, or for each element of an array."""
        given = (Text * len(texts))(*[text.encode() for text in texts])
        numbers = (ctypes.c_uint32 * len(references))(*references)
        more = (Size(len(texts)),) if self.counts else ()
        call = getattr(self._library, f"{self.prefix}SetString")
        return int(call(self.component, numbers, Size(len(references)), given, *more))

    def plain(self, verb: str) -> int:
        """Return the status of a call that takes the instance alone."""
        call = getattr(self._library, self.prefix + verb)
        call.argtypes = (Pointer,)
        return int(call(self.component))


class Fmi3(Fmi2):
    """One instance of an FMI 3.0 FMU."""

    prefix, counts = "fmi3", True

    def __init__(self, library: Any, name: str, guid: str, resources: str, say: Say) -> None:
        self._library = library
        kind = ctypes.CFUNCTYPE(None, Pointer, Int, Text, Text)
        self._logger = kind(lambda _, status, __, message: say(status, _words(message)))
        make = library.fmi3InstantiateCoSimulation
        make.restype = Pointer
        make.argtypes = (Text, Text, Text, Bool, Bool, Bool, Bool, Pointer, Size, Pointer, kind, Pointer)
        texts = name.encode(), guid.encode(), resources.encode()
        made = make(*texts, False, True, False, False, None, 0, None, self._logger, None)
        if not made:
            raise RefusedError("cannot be instantiated", FATAL)
        self.component = Pointer(made)
        self._step = library.fmi3DoStep
        self._step.argtypes = (Pointer, Double, Double, Bool, Pointer, Pointer, Pointer, Pointer)
        self._flags = [Bool(False) for _ in range(3)]
        self._reached = Double(0.0)
        self._told = [*(ctypes.byref(flag) for flag in self._flags), ctypes.byref(self._reached)]

    def initialize(self, stop: float) -> int:
        """Enter Initialization Mode."""
        enter = self._library.fmi3EnterInitializationMode
        enter.argtypes = (Pointer, Bool, Double, Double, Bool, Double)
        return int(enter(self.component, False, 0.0, 0.0, True, stop))

    def step(self, t: float, dt: float) -> int:
        """Call fmi3DoStep; afterwards ``requests_end`` says whether the FMU set ``terminateSimulation``."""
        return int(self._step(self.component, t, dt, True, *self._told))

    @property
    def requests_end(self) -> bool:
        """Whether the last step asked for the end of the simulation."""
        return bool(self._flags[1].value)


def _words(message: bytes | None) -> str:
    return (message or b"").decode(errors="replace").replace("%%", "%").strip()
