"""Two runs side by side: which signals agree within tolerance, and where the first does not."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from orchestrator.comparison.tolerance import Tolerance, Tolerances
from orchestrator.comparison.tube import Trace, distance
from orchestrator.cosim.recording import Recording
from orchestrator.text.errors import BadInput
from orchestrator.text.patterns import fits, matching

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
    if not len(a.t) or not len(b.t):
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
    first, second = _curve(a, name, held), _curve(b, name, held)
    if unit == "rad" and name.endswith("heading"):
        first, second = _unwrapped(first, second)
    row = _judged(name, unit, tolerance, first, second)
    states = a.states(name)
    if states and row.first is not None:
        seen = [
            states.get(int(value), str(value)) for curve in (first, second) for value in curve.at(np.array([row.first]))
        ]
        return row.model_copy(update={"note": f"{seen[0]} / {seen[1]}"})
    return row


def _judged(name: str, unit: str, tolerance: Tolerance, first: Trace, second: Trace) -> Difference:
    found = distance(first, second, tolerance)
    if not len(found.t):
        return _row(name, unit, tolerance, note="no common time")
    outside = found.excess > 0.0
    worst = int(np.argmax(found.excess)) if outside.any() else int(np.argmax(found.raw))
    largest = float(found.raw[worst])
    return Difference(
        signal=name,
        unit=unit,
        passed=not outside.any(),
        largest=largest if math.isfinite(largest) else None,
        t_largest=float(found.t[worst]),
        allowed=float(found.allowed[worst]) if math.isfinite(found.allowed[worst]) else 0.0,
        time_tolerance=tolerance.time,
        absolute=tolerance.absolute,
        relative=tolerance.relative,
        first=float(found.t[outside.argmax()]) if outside.any() else None,
        note="" if math.isfinite(largest) else "not a number",
    )


def _duration(a: Recording, b: Recording, tolerances: Tolerances) -> Difference:
    """Return the difference of the lengths; the time tolerance counts as well."""
    tolerance = tolerances.of(DURATION, "s")
    ends = float(a.t[-1]), float(b.t[-1])
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


def _curve(recording: Recording, name: str, held: bool) -> Trace:
    return Trace(recording.t, recording.signals[name], held)


def _unwrapped(first: Trace, second: Trace) -> tuple[Trace, Trace]:
    """Return two headings without jumps, the second moved by whole turns to where the first begins."""
    if np.isnan(first.values).any() or np.isnan(second.values).any():
        return first, second
    one, two = np.unwrap(first.values), np.unwrap(second.values)
    turns = round((one[0] - two[0]) / (2.0 * math.pi))
    return first._replace(values=one), second._replace(values=two + turns * 2.0 * math.pi)


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
