"""The result of an identification: as data, and as sentences."""

import math
from typing import Any, NamedTuple

from orchestrator.studies.identification.estimate import Estimate
from orchestrator.studies.identification.identifiability import HIGH_CORRELATION, Identifiability, Undetermined
from orchestrator.studies.identification.parameter import FitParameter
from orchestrator.studies.identification.problem import Problem
from orchestrator.studies.identification.signals import unit_of

MAX_WHITE_TIME = 1.5
"""Integrated autocorrelation time [samples] up to which residuals count as white."""
LARGE_DIRECTION_PART = 0.1


class ParameterEstimate(NamedTuple):
    """One parameter of the result."""

    candidate: FitParameter
    value: float
    half_width: float
    identified: bool

    @property
    def unit(self) -> str:
        """Return its unit."""
        return self.candidate.variable.signal.unit

    @property
    def interval(self) -> tuple[float, float]:
        """Return the 95 % interval, within what the model allows."""
        low, high = self.candidate.bounds
        return max(self.value - self.half_width, low), min(self.value + self.half_width, high)


class Identification(NamedTuple):
    """The result."""

    problem: Problem
    estimate: Estimate
    identifiability: Identifiability

    @property
    def parameters(self) -> list[ParameterEstimate]:
        """Return all parameters in their order."""
        rows = zip(
            self.problem.candidates,
            self.estimate.theta.tolist(),
            self.estimate.half_widths.tolist(),
            self.identifiability.identified,
            strict=True,
        )
        return [ParameterEstimate(*row) for row in rows]

    @property
    def values(self) -> dict[str, float]:
        """Return the parameters that are identified."""
        return {item.candidate.name: item.value for item in self.parameters if item.identified}


def as_json(found: Identification) -> dict[str, Any]:
    """Return the result as plain data; a parameter that is not identified has no value."""
    return {
        "duration": found.problem.drive.duration,
        "parameters": [_parameter(item) for item in found.parameters],
        "undetermined": [
            {**item._asdict(), "names": list(item.names), "text": sentence(item)}
            for item in found.identifiability.undetermined
        ],
        "singular_values": [round(value, 6) for value in found.identifiability.singular_values.tolist()],
        "directions": [_direction(found.problem, row) for row in found.identifiability.directions.tolist()],
        "correlations": found.identifiability.correlations.tolist(),
        "signals": _signals(found),
        "runs": found.problem.vehicle.runs,
    }


def _parameter(item: ParameterEstimate) -> dict[str, Any]:
    known: dict[str, Any] = {"name": item.candidate.name, "unit": item.unit, "identified": item.identified}
    low, high = item.interval
    known |= (
        {"value": item.value, "low": low, "high": high} if item.identified else dict.fromkeys(("value", "low", "high"))
    )
    return {**known, "start": item.candidate.start, "accuracy": item.candidate.accuracy}


def _direction(problem: Problem, row: list[float]) -> dict[str, float]:
    parts = {item.name: value for item, value in zip(problem.candidates, row, strict=True)}
    return {name: round(value, 4) for name, value in parts.items() if abs(value) >= LARGE_DIRECTION_PART}


def _signals(found: Identification) -> dict[str, Any]:
    drive = found.problem.drive
    uses = (("input", drive.inputs), ("followed", drive.followed), ("compared", drive.compared))
    rows: dict[str, Any] = {
        name: {"column": item.column, "use": use, "unit": unit_of(name), "samples": len(item.t)}
        for use, group in uses
        for name, item in group.items()
    }
    for name in drive.compared:
        rows[name] |= {"noise": found.estimate.noise[name], "correlation_time": found.estimate.correlation_times[name]}
    return rows


def sentence(item: Undetermined) -> str:
    """Return what is not identified, and what would change that."""
    names = " and ".join(item.names)
    if item.is_without_effect:
        return f"{names}: no effect on any signal of this vehicle (vehicle.body, or what the log has no request for)"
    several = len(item.names) > 1
    what = "only a combination is determined" if several else "the log responds too little"
    remedies = [f"give one by --set {item.names[0]}=VALUE"] if several else []
    drive = item.manoeuvre or item.further_signals
    if drive:
        more = ", with pose, speed, steering-wheel angle and odometry in the log" if not item.manoeuvre else ""
        widths = ", ".join(f"{name} ± {width:.2g}" for name, width in item.half_widths.items())
        remedies.append(f"drive {drive}{more} (expected: {widths})")
    return f"{names}: {what}" + (f"; {', or '.join(remedies)}" if remedies else "; no known manoeuvre identifies it")


def notes(found: Identification) -> list[str]:
    """Return notes on the quality of the result: correlated estimates, residuals that are not white."""
    lines = []
    names = [item.name for item in found.problem.candidates]
    for row, name in enumerate(names):
        for column in range(row):
            value = float(found.identifiability.correlations[row, column])
            both = found.identifiability.identified[row] and found.identifiability.identified[column]
            if both and abs(value) >= HIGH_CORRELATION:
                lines.append(f"{names[column]} and {name} are correlated: {value:+.3f}")
    coloured = [name for name, time in found.estimate.correlation_times.items() if time > MAX_WHITE_TIME]
    if coloured:
        lines.append(
            f"residuals are not white ({', '.join(coloured)}): the model lacks something; intervals are widened"
        )
    return lines


def value_text(item: ParameterEstimate) -> str:
    """Return a value with as many digits as its interval supports."""
    return _round_text(item.value, _decimals(item.half_width))


def interval_text(item: ParameterEstimate) -> str:
    """Return the 95 % interval."""
    digits = _decimals(item.half_width)
    low, high = item.interval
    return f"{_round_text(low, digits)} to {_round_text(high, digits)}"


def _round_text(value: float, digits: int) -> str:
    return f"{round(value, digits) + 0.0:.{digits}f}"


def _decimals(half_width: float) -> int:
    return int(min(max(1 - math.floor(math.log10(max(half_width, 1e-12))), 0), 9))
