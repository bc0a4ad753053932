"""summary.json: the promised result of a run, computed from its recording alone.

SI units and radians. ``final`` errors are measured in the target's frame: longitudinal along its
heading, lateral to its left, heading wrapped to (-pi, pi].
"""

import math
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from orchestrator.cosim.endings import FINAL_PHASES
from orchestrator.cosim.recording import Recording
from orchestrator.scenario.scenario import Outcome, Scenario
from orchestrator.verdict.judge import Check, judge
from orchestrator.verdict.numbers import numbers_of


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", ser_json_inf_nan="constants")


class Final(_Part):
    """Where and how the car stands at the end."""

    x: float
    y: float
    heading: float
    lateral_error: float
    longitudinal_error: float
    heading_error: float
    steering_wheel_angle: float


class Event(_Part):
    """One change of the manoeuvre chart; ``from`` and ``to`` are names of phases."""

    t: float
    from_: str
    to: str
    x: float
    y: float
    heading: float


class FmuUsed(_Part):
    """One slave of the run."""

    name: str
    kind: str
    """``python``, ``native``, ``none`` (in process) or ``foreign``: somebody else's."""
    guid: str
    path: str = ""
    """File of a foreign one, and its hash."""
    sha256: str = ""


class Summary(_Part):
    """The whole of summary.json."""

    scenario: str
    changed: dict[str, str]
    """What ``--set`` changed of the scenario."""
    outcome: Outcome
    reason: str
    duration: float
    shifts: int | None
    """Manoeuvres; null if the controller does not count them."""
    max_speed: float
    final: Final
    events: list[Event]
    checks: list[Check]
    fmus: list[FmuUsed]
    wall_time: float
    real_time_factor: float
    seed: int
    versions: dict[str, str]

    def as_json(self) -> dict[str, Any]:
        """Return the summary as plain data; numbers that are not finite become null."""
        data: dict[str, Any] = _finite(self.model_dump())
        for event in data["events"]:
            event["from"] = event.pop("from_")
        data["events"] = [
            {key: event[key] for key in ("t", "from", "to", "x", "y", "heading")} for event in data["events"]
        ]
        return data


def summarize(recording: Recording, scenario: Scenario, wall_time: float) -> Summary:
    """Return the summary of a run. Raises ``BadInput`` if a limit names a signal that does not exist."""
    numbers = numbers_of(recording)
    checks = judge(scenario.limits, recording, numbers, scenario.file)
    outcome, reason = _outcome(recording, checks)
    return Summary(
        scenario=scenario.name,
        changed=scenario.changed,
        outcome=outcome,
        reason=reason,
        duration=numbers["duration"],
        shifts=int(numbers["shifts"]) if math.isfinite(numbers["shifts"]) else None,
        max_speed=numbers["max_speed"],
        final=Final(**{name: numbers[f"final.{name}"] for name in Final.model_fields}),
        events=_events(recording),
        checks=checks,
        fmus=[FmuUsed(**item) for item in recording.info.get("fmus", [])],
        wall_time=wall_time,
        real_time_factor=numbers["duration"] / wall_time if wall_time > 0.0 else 0.0,
        seed=scenario.seed,
        versions=recording.info.get("versions", {}),
    )


def phase_changes(recording: Recording) -> list[tuple[int, str, str]]:
    """Return (row, from, to) of every change of phase."""
    phases = recording.signals.get("controller.phase")
    if phases is None or not len(phases):
        return []
    names = recording.states("controller.phase")
    rows = np.flatnonzero(np.diff(phases)) + 1
    return [(int(row), _state(names, phases[row - 1]), _state(names, phases[row])) for row in rows]


def _state(names: dict[int, str], value: float) -> str:
    return names.get(int(value), f"{value:g}") if math.isfinite(value) else "nan"


def _events(recording: Recording) -> list[Event]:
    t = recording.t
    empty = np.zeros(len(t))
    x, y, heading = (recording.signals.get(f"vehicle.pose.{axis}", empty) for axis in ("x", "y", "heading"))
    return [
        Event(t=float(t[row]), from_=before, to=after, x=float(x[row]), y=float(y[row]), heading=float(heading[row]))
        for row, before, after in phase_changes(recording)
    ]


def _outcome(recording: Recording, checks: list[Check]) -> tuple[Outcome, str]:
    end = str(recording.info.get("end", {}).get("reason", ""))
    if end == "interrupted" or end.startswith("error"):
        return "aborted", end
    if "controller.phase" not in recording.signals:
        return "not_parked", "the controller has no output phase, of which PARKED (9) says that the car is parked"
    phase = _state(recording.states("controller.phase"), _last(recording, "controller.phase", math.nan))
    if phase == "FAILED":
        why = _state(recording.states("controller.reason"), _last(recording, "controller.reason", math.nan))
        return "failed", why.lower()
    missed = [check.id for check in checks if check.required and check.judged and not check.passed]
    unknown = [check.id for check in checks if check.required and not check.judged]
    if phase == "PARKED":
        lacks = [f"beyond its limit: {', '.join(missed)}"] if missed else []
        lacks += [f"not measured: {', '.join(unknown)}"] if unknown else []
        return ("not_parked", "; ".join(lacks)) if lacks else ("parked", "all checks passed")
    if phase in FINAL_PHASES:
        return "not_parked", phase.lower()
    return "not_parked", f"stop time reached in {phase.lower()}"


def _last(recording: Recording, name: str, default: float) -> float:
    values = recording.signals.get(name)
    return float(values[-1]) if values is not None and len(values) else default


def _finite(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list):
        return [_finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data
