"""Whole runs as machine code: many at once, without Python in between and without the interpreter's lock.

The models' code is the native FMU's, from the same C; the exchange is ``native/c/batch.c``, which follows
tables of connections. The tables are made from the types: an output and an input of the same name are connected. Only
:class:`StopCondition` and :class:`RecordedSignal` name signals.
"""

import ctypes
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from fmus.native.library_cache import batch_library
from fmus.native.structures import Long, Pointer, structure
from fmus.study_slices import StudyCode
from modelkit.connections import connections, live_connections, part_of
from modelkit.model import Model
from modelkit.variables import variables

How = Literal["last", "largest", "greatest", "smallest", "travel", "first", "time"]
HOW: tuple[How, ...] = get_args(How)
FIRST_KEPT = 2
"""A row begins with the end (0 stop time, 1 standstill) and its time [ns]."""
Doubles = NDArray[np.float64]
Rows = Callable[[Doubles, NDArray[np.int64], Doubles, Doubles], None]
"""``rows(parameters, times, faults, out)``: one run for each line of the arrays; see :func:`compile_rows`."""
FAULTS = ("override", "stuck_at_last", "dropout", "delay", "noise")
FAULT_NUMBERS = 4
"""Of each fault of a run: start [ns], stop [ns], amount, seed. The amount is what its kind needs: the value, nothing,
the probability, the age [ns], the standard deviation."""


class SampleTime(NamedTuple):
    """The instants at which a mode has one of some values."""

    signal: str
    values: tuple[int, ...]
    """From 0 to 63."""


class RecordedSignal(NamedTuple):
    """One number kept of a run; NaN if there is no instant to take it from."""

    how: How
    """``last``; ``largest`` absolute value, signed; ``greatest``; ``smallest``; ``travel``: sum of absolute changes;
    ``first``; ``time``: of the first instant [s]."""
    signal: str
    """An output, ``vehicle.speed``; or an input as its model saw it."""
    when: SampleTime | None = None
    """The instants that count; None: all."""


class FaultInputs(NamedTuple):
    """Inputs of one model that a fault disturbs."""

    kind: str
    """One of ``FAULTS``."""
    model: int
    """Its number."""
    places: tuple[int, ...]
    """Of its inputs."""


class StopCondition(NamedTuple):
    """A run is over when a mode has a final value and a speed has been small for a time."""

    mode: str
    final: tuple[int, ...]
    speed: str
    still: float
    """Largest absolute speed that counts as standing."""
    time_ns: int


LinkC = structure("LinkC", source=Long, source_place=Long, target=Long, target_place=Long)
SignalC = structure("SignalC", model=Long, place=Long, input=Long)
KeptC = structure("KeptC", how=Long, signal=SignalC, when=SignalC, values=ctypes.c_uint64)
BatchC = structure(
    "BatchC",
    models=Pointer,
    links=Pointer,
    kept=Pointer,
    model_count=Long,
    link_count=Long,
    kept_count=Long,
    mode=SignalC,
    speed=SignalC,
    final=ctypes.c_uint64,
    still=ctypes.c_double,
    still_ns=Long,
    faults=Pointer,
    places=Pointer,
    fault_count=Long,
)
FaultC = structure("FaultC", kind=Long, model=Long, first=Long, count=Long)


def signals_to_read(ending: StopCondition | None, kept: Sequence[RecordedSignal]) -> frozenset[str]:
    """Return the signals that decide when runs are over, and those that are kept of them."""
    found = {item.signal for item in kept} | {item.when.signal for item in kept if item.when is not None}
    return frozenset(found if ending is None else found | {ending.mode, ending.speed})


def in_smallest_forms(
    models: Mapping[str, Model], ending: StopCondition | None, kept: Sequence[RecordedSignal]
) -> tuple[dict[str, Model], list[RecordedSignal]]:
    """Return models and what to keep of their runs so that the same numbers take less to work out.

    A model has its form for smallest values where nothing else is kept of the outputs concerned, and nothing reads
    them. Their last value is then the smallest.
    """
    made, wanted = dict(models), list(kept)
    names = list(models)
    wires = connections([part_of(name, model) for name, model in models.items()])
    read = {f"{names[wire.source]}.{variables(models[names[wire.source]].outputs)[wire.output].name}" for wire in wires}
    for name, model in models.items():
        if model.smallest is None:
            continue
        of_form = {f"{name}.{output}" for output in model.smallest.outputs}
        others = [
            item for item in kept if item.signal not in of_form or item.how != "smallest" or item.when is not None
        ]
        concerned = of_form | {f"{name}.{output}" for output in model.smallest.made_of_them}
        if len(others) == len(kept) or concerned & (read | signals_to_read(ending, others)):
            continue
        made[name] = model.in_smallest_form()
        wanted = [item._replace(how="last") if item.signal in of_form else item for item in wanted]
    return made, wanted


def compile_rows(
    models: Mapping[str, Model],
    ending: StopCondition | None,
    kept: Sequence[RecordedSignal],
    faults: Sequence[FaultInputs] = (),
    code: StudyCode | None = None,
) -> Rows:
    """Return the compiled runs; of ``code``, made for this study (slices with :func:`signals_to_read`), or None.

    ``parameters``: for each run those of all models, one after the other, as doubles. ``times``: step
    [ns], stop [ns], then the decimation of each model. The ``faults`` of a run: ``FAULT_NUMBERS`` for each of those
    given here, which act in their order. ``out`` receives the end, its time [ns] and ``kept``.
    Raises ``KeyError`` for a signal that does not exist, ``TypeError`` if connected types differ or a model
    cannot be compiled, ``RuntimeError`` where there is no compiler.
    """
    tables = BatchTables(models, ending, kept, faults, code)
    library = ctypes.CDLL(str(batch_library()))
    library.batch_rows.restype = Long
    library.batch_rows.argtypes = [Pointer, Long, Pointer, Pointer, Pointer, Pointer]

    def rows(parameters: Doubles, times: NDArray[np.int64], disturbed: Doubles, out: Doubles) -> None:
        """Run all; no lock is held meanwhile."""
        tables.check(parameters, times, disturbed, out)
        pointers = (array.ctypes.data for array in (parameters, times, disturbed, out))
        if library.batch_rows(tables.address, len(parameters), *pointers):
            raise MemoryError

    return rows


class BatchTables:
    """The C structures of a batch, and all memory they point to."""

    def __init__(
        self,
        models: Mapping[str, Model],
        ending: StopCondition | None,
        kept: Sequence[RecordedSignal],
        faults: Sequence[FaultInputs],
        code: StudyCode | None,
    ) -> None:
        self._held: list[Any] = []
        self._places: dict[str, Any] = {}
        for number, (owner, model) in enumerate(models.items()):
            for is_input, cls in ((1, model.inputs), (0, model.outputs)):
                for place, variable in enumerate(variables(cls)):
                    self._places[f"{owner}.{variable.name}"] = (number, place, is_input)
        links = live_connections(models, None if code is None else code.slices)
        notes = [self._note(item) for item in kept]
        libraries = [_load_library(name, model, code) for name, model in models.items()]
        end = ending or StopCondition("", (), "", 0.0, 0)
        found = [self.signal(name) if ending else SignalC(0, 0, 0) for name in (end.mode, end.speed)]
        self._batch = BatchC(
            self.array(Pointer, [library.model_library() for library in libraries]),
            self.array(LinkC, [LinkC(*link) for link in links]),
            self.array(KeptC, notes),
            len(libraries),
            len(links),
            len(notes),
            *found,
            bits(end.final),
            end.still,
            end.time_ns,
            self.array(FaultC, [_plan(faults, number) for number in range(len(faults))]),
            self.array(Long, [place for fault in faults for place in fault.places]),
            len(faults),
        )
        self.address = ctypes.addressof(self._batch)
        self.width = sum(len(variables(model.params)) for model in models.values())
        self._held += libraries

    def check(self, parameters: Doubles, times: NDArray[np.int64], disturbed: Doubles, out: Doubles) -> None:
        """Raise ``ValueError`` unless the arrays have the sizes and kinds of those of runs."""
        batch, count = self._batch, len(parameters)
        shapes = (
            (parameters, self.width, np.float64),
            (times, 2 + batch.model_count, np.int64),
            (disturbed, FAULT_NUMBERS * batch.fault_count, np.float64),
            (out, FIRST_KEPT + batch.kept_count, np.float64),
        )
        for array, width, kind in shapes:
            if array.shape != (count, width) or array.dtype != kind or not array.flags.c_contiguous:
                raise ValueError(f"{array.dtype} {array.shape}: expected {count} lines of {width} in C order")

    def _note(self, item: RecordedSignal) -> Any:
        when, values = SignalC(0, 0, 0), 0
        if item.when is not None:
            when, values = self.signal(item.when.signal), bits(item.when.values)
        return KeptC(HOW.index(item.how), self.signal(item.signal), when, values)

    def signal(self, name: str) -> Any:
        """Return where an output, or an input, is. Raises ``KeyError`` for a name that does not exist."""
        return SignalC(*self._places[name])

    def array(self, kind: Any, items: list[Any]) -> int:
        """Return the address of ``items``, which live as long as the tables."""
        held = (kind * max(len(items), 1))(*items)
        self._held.append(held)
        return ctypes.addressof(held)


def _load_library(name: str, model: Model, code: StudyCode | None) -> Any:
    from fmus.native.libraries import load_model  # the translator takes a tenth of a second to import

    return load_model(model) if code is None else load_model(model, code.slices[name], code.options)


def _plan(faults: Sequence[FaultInputs], number: int) -> Any:
    first = sum(len(fault.places) for fault in faults[:number])
    fault = faults[number]
    return FaultC(FAULTS.index(fault.kind), fault.model, first, len(fault.places))


def bits(values: Sequence[int]) -> int:
    """Return a number in which bit n is set for each n of ``values``."""
    return sum(1 << value for value in set(values))
