"""Runs as machine code that go on by a period at a time, with inputs from outside: the episodes of a learner.

Models, exchange, faults, stop condition and what is kept are those of :mod:`fmus.compiled_batch`.
"""

import ctypes
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fmus.compiled_batch import (
    FAULT_NUMBERS,
    FIRST_KEPT,
    BatchTables,
    Doubles,
    FaultInputs,
    RecordedSignal,
    SampleTime,
    SignalC,
    StopCondition,
    bits,
    signals_to_read,
)
from fmus.native.library_cache import batch_library
from fmus.native.structures import Long, Pointer, structure
from fmus.study_slices import StudyCode
from modelkit.model import Model

RUNNING, AT_STOP_TIME, AT_STANDSTILL, BROKEN_OFF = 0, 1, 2, 3
"""Progress of an episode."""
AccessC = structure(
    "AccessC",
    batch=Pointer,
    given=Pointer,
    seen=Pointer,
    given_count=Long,
    seen_count=Long,
    broken=SignalC,
    values=ctypes.c_uint64,
)


class Access(NamedTuple):
    """What the caller has to do with a run."""

    given: tuple[str, ...]
    """Inputs that it sets at the beginning of each period; nothing else may be connected to them."""
    seen: tuple[str, ...]
    """Signals that it sees at the end of each period."""
    broken: SampleTime
    """A run is broken off at the first exchange at which a mode has one of these values."""


class EpisodeModels(NamedTuple):
    """What is run, until when, what is kept of it, and what the caller has to do with it."""

    models: Mapping[str, Model]
    ending: StopCondition
    kept: Sequence[RecordedSignal]
    access: Access
    faults: Sequence[FaultInputs] = ()
    code: StudyCode | None = None
    """Slices of the models, which must have :meth:`signals`; None: the complete models."""

    def signals(self) -> frozenset[str]:
        """Return the signals that the episodes use of their models."""
        own: frozenset[str] = frozenset((*self.access.given, *self.access.seen, self.access.broken.signal))
        return own | signals_to_read(self.ending, self.kept)


class CompiledEpisodes:
    """A fixed number of runs side by side. ``rows``, ``seen`` and ``progress`` are written by the calls.

    Raises as :func:`fmus.compiled_batch.compile_rows`; ``MemoryError`` where there is none.
    """

    def __init__(self, count: int, task: EpisodeModels) -> None:
        models, ending, kept, access, faults, code = task
        self._tables = tables = BatchTables(models, ending, kept, faults, code)
        self._access = AccessC(
            tables.address,
            tables.array(SignalC, [tables.signal(name) for name in access.given]),
            tables.array(SignalC, [tables.signal(name) for name in access.seen]),
            len(access.given),
            len(access.seen),
            tables.signal(access.broken.signal),
            bits(access.broken.values),
        )
        self._library = _library()
        self.count = count
        self.rows: Doubles = np.zeros((count, FIRST_KEPT + len(kept)))
        """As those of a batch: the end (0 also where a run is broken off), its time [ns], what is kept."""
        self.seen: Doubles = np.zeros((count, len(access.seen)))
        self.progress: NDArray[np.int64] = np.full(count, AT_STOP_TIME)
        self._shapes = (tables.width, 2 + len(models), FAULT_NUMBERS * len(faults))
        self._given = len(access.given)
        self._out = [array.ctypes.data for array in (self.rows, self.seen, self.progress)]
        self._episodes = self._library.episodes_open(ctypes.addressof(self._access), count)
        if not self._episodes:
            raise MemoryError

    def begin(
        self, which: NDArray[np.int64], parameters: Doubles, times: NDArray[np.int64], disturbed: Doubles
    ) -> None:
        """Begin the episodes ``which`` anew: a line of numbers for each, as for ``compile_rows``.

        They are taken on by one communication step, so that every model has seen the outputs of the others.
        """
        lines: list[NDArray[Any]] = [np.ascontiguousarray(which, dtype=np.int64)]
        for array, width, kind in zip(
            (parameters, times, disturbed), self._shapes, (np.float64, np.int64, np.float64), strict=True
        ):
            line = np.ascontiguousarray(array, dtype=kind)
            if line.shape != (len(which), width):
                raise ValueError(f"{line.shape}: expected {len(which)} lines of {width}")
            lines.append(line)
        if any(not 0 <= number < self.count for number in which.tolist()):
            raise IndexError(f"{which}: expected numbers from 0 to {self.count - 1}")
        if self._library.episodes_begin(self._episodes, len(which), *(line.ctypes.data for line in lines), *self._out):
            raise MemoryError

    def advance(self, given: Doubles, period_ns: int, first: int = 0, end: int | None = None) -> None:
        """Take the episodes from ``first`` up to ``end`` on by ``period_ns`` with ``given``, (count, inputs).

        Those that are over, as ``progress`` has it, stay as they are. No lock is held: disjoint ranges may go on at
        once, on threads.
        """
        if given.shape != (self.count, self._given) or given.dtype != np.float64 or not given.flags.c_contiguous:
            raise ValueError(f"{given.dtype} {given.shape}: expected {self.count} lines of {self._given} in C order")
        self._library.episodes_advance(
            self._episodes, first, self.count if end is None else end, period_ns, given.ctypes.data, *self._out
        )

    def close(self) -> None:
        """Free the memory of the runs; may be called twice."""
        self._library.episodes_close(self._episodes)
        self._episodes = None

    def __del__(self) -> None:
        if getattr(self, "_episodes", None):
            self.close()


def _library() -> Any:
    library = ctypes.CDLL(str(batch_library()))
    library.episodes_open.restype = Pointer
    library.episodes_open.argtypes = [Pointer, Long]
    library.episodes_close.restype = None
    library.episodes_close.argtypes = [Pointer]
    library.episodes_begin.restype = Long
    library.episodes_begin.argtypes = [Pointer, Long, *[Pointer] * 7]
    library.episodes_advance.restype = None
    library.episodes_advance.argtypes = [Pointer, Long, Long, Long, *[Pointer] * 4]
    return library
