"""Two runs side by side: which signals agree within tolerance, and where the first does not."""

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from orchestrator.evaluation.comparison.tolerance import Tolerance, Tolerances
from orchestrator.evaluation.comparison.traces import TracePair, traces
from orchestrator.evaluation.comparison.tube import Distance, distance
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.patterns import fits, matching
from orchestrator.simulation.cosim.recording import Recording

DURATION = "duration"


class Difference(BaseModel):
    """One signal of both runs."""

    model_config = ConfigDict(extra="forbid")

    signal: str
    unit: str
    passed: bool
    largest: float | None
    """Largest distance [unit]; None if one of the runs does not have the signal or has not-a-number there."""
    t_largest: float | None
    """When [s]."""
    allowed: float
    """Tolerance in value at that moment [unit]."""
    time_tolerance: float
    """Half-width of the tube [s]."""
    absolute: float
    """Tolerance in value [unit], and as a share of A: the larger one counts."""
    relative: float
    first: float | None
    """First moment outside the tube [s]; None if there is none."""
    note: str = ""


class ParameterChange(BaseModel):
    """A parameter that differs between the runs."""

    name: str
    unit: str
    a: float | None
    b: float | None


class Comparison(BaseModel):
    """The verdict of ``apa compare``; ``a`` is the reference."""

    model_config = ConfigDict(extra="forbid")

    a: str
    b: str
    passed: bool
    compared: int
    differing: int
    signals: list[Difference]
    """Worst first."""
    parameters: list[ParameterChange]
    only_in_a: list[str]
    only_in_b: list[str]


def compare(a: Recording, b: Recording, tolerances: Tolerances, patterns: Iterable[str] | None = None) -> Comparison:
    """Return how run ``b`` differs from the reference ``a`` in the signals that match one of ``patterns``.

    A signal that only the reference has counts as differing; one that only ``b`` has is listed.
    Raises ``BadInput`` if nothing is left to compare.
    """
    chosen = ["*"] if patterns is None else list(patterns)
    names = matching(a.signals, chosen)
    new = [name for name in b.signals if name not in a.signals and any(fits(name, item) for item in chosen)]
    if not a.count or not b.count:
        raise BadInput("nothing to compare: a run is empty")
    rows = [_duration(a, b, tolerances), *(_signal(name, a, b, tolerances) for name in names)]
    rows.sort(key=_severity, reverse=True)
    missed = sum(not row.passed for row in rows)
    return Comparison(
        a=_name(a, "A"),
        b=_name(b, "B"),
        passed=missed == 0,
        compared=len(rows),
        differing=missed,
        signals=rows,
        parameters=_changes(a, b),
        only_in_a=[name for name in names if name not in b.signals],
        only_in_b=new,
    )


def _signal(name: str, a: Recording, b: Recording, tolerances: Tolerances) -> Difference:
    variable = a.variables[name]
    unit = variable.signal.unit
    tolerance = tolerances.of(name, unit)
    if name not in b.signals:
        return _row(name, unit, tolerance, note="only in A")
    if b.variables[name].signal.unit != unit:
        return _row(name, unit, tolerance, note=f"in {unit} in A, in {b.variables[name].signal.unit} in B")
    held = variable.kind is not float
    turns = unit == "rad" and name.endswith("heading")
    worst = _LargestDistances()
    names = states_named(a.states(name))
    for pair in traces(name, a, b, held, tolerance.time, turns):
        worst.add(distance(pair.a, pair.b, tolerance, pair.span), pair, names)
    return _difference(name, unit, tolerance, worst)


def states_named(states: dict[int, str]) -> Callable[[TracePair, float], str]:
    """Return what says in words which states the runs have at a time [s]; nothing for a signal without states."""

    def words(pair: TracePair, t: float) -> str:
        values = (float(trace.at(np.array([t]))[0]) for trace in (pair.a, pair.b))
        return " / ".join(states.get(int(value), str(value)) for value in values) if states else ""

    return words


class _LargestDistances:
    """The instants that decide about a signal, of distances that come in parts."""

    def __init__(self) -> None:
        self.outside: tuple[float, ...] | None = None
        """Excess, distance, tolerance and time where it is furthest outside of the tube."""
        self.apart: tuple[float, ...] | None = None
        """Where the distance is largest."""
        self.first: float | None = None
        self.words = ""

    def add(self, found: Distance, pair: TracePair, words: Callable[[TracePair, float], str]) -> None:
        """Take the distances of the next part."""
        if not len(found.t):
            return
        for rank, where in ((found.excess, "outside"), (found.raw, "apart")):
            row = int(np.argmax(rank))
            values = tuple(float(item[row]) for item in (rank, found.raw, found.allowed, found.t))
            known = getattr(self, where)
            if known is None or values[0] > known[0]:
                setattr(self, where, values)
        beyond = found.excess > 0.0
        if self.first is None and beyond.any():
            self.first = float(found.t[beyond.argmax()])
            self.words = words(pair, self.first)


def _difference(name: str, unit: str, tolerance: Tolerance, worst: _LargestDistances) -> Difference:
    deciding = worst.apart if worst.first is None else worst.outside
    if deciding is None:
        return _row(name, unit, tolerance, note="no common time")
    _, largest, allowed, t = deciding
    return Difference(
        signal=name,
        unit=unit,
        passed=worst.first is None,
        largest=largest if math.isfinite(largest) else None,
        t_largest=t,
        allowed=allowed if math.isfinite(allowed) else 0.0,
        time_tolerance=tolerance.time,
        absolute=tolerance.absolute,
        relative=tolerance.relative,
        first=worst.first,
        note=worst.words or ("" if math.isfinite(largest) else "not a number"),
    )


def _duration(a: Recording, b: Recording, tolerances: Tolerances) -> Difference:
    """Return the difference of the lengths; the time tolerance counts as well."""
    tolerance = tolerances.of(DURATION, "s")
    ends = a.duration, b.duration
    allowed = max(tolerance.absolute, tolerance.relative * ends[0], tolerance.time)
    apart = abs(ends[1] - ends[0])
    row = _row(DURATION, "s", tolerance, note=f"{ends[0]:.2f} s and {ends[1]:.2f} s" if apart > 0.0 else "")
    passed, end = apart <= allowed, min(ends)
    update = {
        "passed": passed,
        "largest": apart,
        "t_largest": end,
        "allowed": allowed,
        "first": None if passed else end,
    }
    return row.model_copy(update=update)


def _row(name: str, unit: str, tolerance: Tolerance, note: str) -> Difference:
    known = {
        "signal": name,
        "unit": unit,
        "allowed": tolerance.absolute,
        "time_tolerance": tolerance.time,
        "absolute": tolerance.absolute,
        "relative": tolerance.relative,
        "note": note,
    }
    return Difference.model_validate({**known, "passed": False, "largest": None, "t_largest": None, "first": None})


def _severity(row: Difference) -> tuple[bool, float]:
    if row.largest is None:
        return not row.passed, math.inf
    return not row.passed, row.largest / row.allowed if row.allowed > 0.0 else row.largest * 1e12


def _changes(a: Recording, b: Recording) -> list[ParameterChange]:
    names = list(dict.fromkeys([*a.parameters, *b.parameters]))
    rows = []
    for name in names:
        one, two = a.parameters.get(name), b.parameters.get(name)
        if one != two:
            variables: dict[str, Any] = a.variables if name in a.variables else b.variables
            rows.append(ParameterChange(name=name, unit=variables[name].signal.unit, a=one, b=two))
    return rows


def _name(recording: Recording, default: str) -> str:
    return str(recording.info.get("scenario", {}).get("name", default))
