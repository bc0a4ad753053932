"""summary.json: the documented result of a run, computed from its recording alone.

SI units and radians. ``final`` errors are measured in the target's frame: longitudinal along its
heading, lateral to its left, heading wrapped to (-pi, pi].
"""

import math
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from orchestrator.evaluation.verdict.contact import VEHICLE, contact_facts
from orchestrator.evaluation.verdict.frame import in_frame, pose_of
from orchestrator.evaluation.verdict.geometry import vehicle_parameters
from orchestrator.evaluation.verdict.judge import Check, judge
from orchestrator.evaluation.verdict.measures import Measure, measure_recording
from orchestrator.evaluation.verdict.numbers import RunFacts, facts_of
from orchestrator.evaluation.verdict.outcome import Ends, RequiredCheck, outcomes, state_name
from orchestrator.evaluation.verdict.standing import beyond_ends
from orchestrator.evaluation.verdict.truth import truth_of
from orchestrator.inputs.scenario.end_condition import SPEED
from orchestrator.inputs.scenario.scenario import DONE, PENETRATION, Outcome, Scenario
from orchestrator.inputs.text.quantities import RAD_PER_DEGREE
from orchestrator.simulation.cosim.recording import Recording


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", ser_json_inf_nan="constants")


class Final(_Part):
    """Final state of the vehicle, the metrics ``final.*``; NaN where the scenario has no target, slot or kerb."""

    x: float
    """x of the rear-axle midpoint [m]."""
    y: float
    """y of the rear-axle midpoint [m]."""
    heading: float
    """Heading [rad]."""
    lateral_error: float
    """Position relative to the target, in its frame: to the left [m]."""
    longitudinal_error: float
    """Position relative to the target, in its frame: along its heading [m]."""
    heading_error: float
    """Heading relative to the target, in (-pi, pi] [rad]."""
    steering_wheel_angle: float
    """Steering-wheel angle, left positive [rad]."""
    speed: float
    """Speed, reverse negative [m/s]."""
    outline_margin: float
    """Smallest distance of the outline to the slot boundary, negative outside the slot [m]."""
    kerb_nearest: float
    """Distance from the slot's kerb to the nearest tyre beside it [m]."""
    kerb_farthest: float
    """Distance from the slot's kerb to the farthest tyre beside it [m]."""


class Event(_Part):
    """One transition of the controller's state (``controller.phase``)."""

    t: float
    """Time of the transition [s]."""
    from_: str
    """State before the transition."""
    to: str
    """State after the transition."""
    x: float
    """x of the rear-axle midpoint at that time [m]."""
    y: float
    """y of the rear-axle midpoint at that time [m]."""
    heading: float
    """Heading at that time [rad]."""


class FmuUsed(_Part):
    """One component of the run."""

    name: str
    """Name of the component in the system."""
    kind: str
    """``python``, ``native``, ``none`` (in process) or ``foreign`` (third-party FMU)."""
    guid: str
    """GUID of the FMU; of a model in process, its name."""
    path: str = ""
    """Path of the FMU; of a model in process, the folder of its sources."""
    sha256: str = ""
    """SHA-256 of that file, or of all sources of the models."""


class StartRecord(_Part):
    """Time and command of the run."""

    time: str = ""
    """UTC, ISO 8601."""
    command: str = ""
    """Command line."""
    folder: str = ""
    """Working folder of the command."""
    git: str = ""
    """Commit of the repository in that folder, with ``-modified`` if a tracked file differs."""


class ParameterTuning(_Part):
    """A parameter that a viewer changed during the run."""

    t: float
    """Time of the change [s]."""
    name: str
    """Component and parameter."""
    value: float
    """New value."""
    by: str = ""
    """Client that changed it."""


class Lateness(_Part):
    """Lateness of a real-time run against the wall clock."""

    exchanges: int
    """Number of exchanges."""
    late: int
    """Number of exchanges that were more than 1 ms late."""
    median: float
    """Median lateness [s]."""
    percentile_99: float
    """99th percentile of the lateness [s]."""
    largest: float
    """Largest lateness [s]."""
    at_end: float
    """Lateness of the last exchange [s]; large if the run was slower than real time."""
    tuned: list[ParameterTuning] = []
    """Parameters changed during the run."""


class Summary(_Part):
    """The content of summary.json."""

    scenario: str
    """Name of the scenario."""
    overrides: dict[str, str]
    """Changes of the scenario by ``--set``."""
    outcome: Outcome
    """Outcome of the run."""
    reason: str
    """Reason of the outcome."""
    duration: float
    """Simulated time [s]."""
    manoeuvres: int | None
    """Manoeuvres; null if the controller does not count them."""
    max_speed: float
    """Largest absolute speed [m/s]."""
    peak_jerk: float
    """Largest absolute jerk, averaged over a second [m/s3]."""
    penetration: float
    """Largest penetration depth of the outline in an obstacle [m]; 0: no contact."""
    dry_steering_count: int | None
    """Standstills with more than 5 deg of steering; null if the steering-wheel angle is unknown."""
    final: Final
    """Final state of the vehicle."""
    events: list[Event]
    """Transitions of the controller's state."""
    checks: list[Check]
    """Results of the requirements."""
    fmus: list[FmuUsed]
    """Components of the run."""
    wall_time: float
    """Wall-clock time of the run [s]."""
    real_time_factor: float
    """Simulated time over wall-clock time."""
    seed: int
    """Random seed of the scenario."""
    versions: dict[str, str]
    """Versions of Python, of this project and of the packages it uses."""
    started: StartRecord = StartRecord()
    """Time and command of the run."""
    standing: list[str] = []
    """Remarks on the final pose: an outline beyond the slot boundary, a large distance from the target."""
    notes: list[str] = []
    """Remarks on the evaluation: contact, a controller with another target, data missing in the log."""
    realtime: Lateness | None = None
    """Lateness of a real-time run; null otherwise."""

    @property
    def headline(self) -> str:
        """Return why the run came out so, and where the car stands if that is not where it should."""
        return "; ".join([self.reason, *self.standing])

    @property
    def is_done(self) -> bool:
        """Return whether the run has done its task: parked, or finished."""
        return self.outcome in DONE

    def as_json(self) -> dict[str, Any]:
        """Return the summary as plain data; numbers that are not finite become null."""
        data: dict[str, Any] = _finite(self.model_dump())
        for event in data["events"]:
            event["from"] = event.pop("from_")
        data["events"] = [
            {key: event[key] for key in ("t", "from", "to", "x", "y", "heading")} for event in data["events"]
        ]
        return data


def summarize(recording: Recording, scenario: Scenario, wall_time: float, facts: RunFacts | None = None) -> Summary:
    """Return the summary of a run. Raises ``BadInput`` if a limit names a signal that does not exist.

    ``facts``: those of :func:`orchestrator.evaluation.verdict.numbers.facts_of`, if they are known already.
    """
    facts = facts_of(recording, scenario) if facts is None else facts
    numbers, checks = facts.numbers, judge(scenario.requirements, recording, facts, scenario.file)
    outcome, reason = _outcome(recording, scenario, checks)
    events = _events(recording)
    many = f"only the first {MOST_EVENTS} changes of phase are listed" if len(events) == MOST_EVENTS else ""
    said = (*_contact(recording, scenario, numbers), _target_difference(recording, scenario), many)
    return Summary(
        scenario=scenario.name,
        overrides=scenario.overrides,
        outcome=outcome,
        reason=reason,
        duration=numbers["duration"],
        manoeuvres=_count(numbers["manoeuvres"]),
        max_speed=numbers["max_speed"],
        peak_jerk=numbers["peak_jerk"],
        penetration=numbers[PENETRATION],
        dry_steering_count=_count(numbers["dry_steering_count"]),
        final=Final(**{name: numbers[f"final.{name}"] for name in Final.model_fields}),
        events=events,
        checks=checks,
        fmus=[FmuUsed(**item) for item in recording.info.get("fmus", [])],
        wall_time=wall_time,
        real_time_factor=numbers["duration"] / wall_time if wall_time > 0.0 else 0.0,
        seed=scenario.seed,
        versions=recording.info.get("versions", {}),
        started=StartRecord(**recording.info.get("started", {})),
        realtime=recording.info.get("realtime"),
        standing=standing_of(recording, scenario, numbers),
        notes=[text for text in said if text],
    )


def phase_changes(recording: Recording) -> list[tuple[int, str, str]]:
    """Return (row, from, to) of the changes of phase, at most ``MOST_EVENTS`` of them."""
    if CHART not in recording.signals:
        return []
    names = recording.states(CHART)
    found: list[tuple[int, str, str]] = []
    before: list[float] = []
    for part, first_row, _ in recording.parts():
        phases = np.concatenate((before, part.signals[CHART]))
        rows = np.flatnonzero(np.diff(phases)) + 1
        shift = first_row - len(before)
        found += [
            (int(row) + shift, state_name(names, phases[row - 1]), state_name(names, phases[row]))
            for row in rows[: MOST_EVENTS - len(found)]
        ]
        before = phases[-1:].tolist()
    return found


def _events(recording: Recording) -> list[Event]:
    changes = phase_changes(recording)
    there = recording.rows([row for row, _, _ in changes]) if changes else recording
    empty = np.zeros(len(changes))
    x, y, heading = (there.signals.get(f"vehicle.pose.{axis}", empty) for axis in ("x", "y", "heading"))
    return [
        Event(t=float(t), from_=before, to=after, x=float(x[place]), y=float(y[place]), heading=float(heading[place]))
        for place, (t, (_, before, after)) in enumerate(zip(there.t, changes, strict=False))
    ]


def _target_difference(recording: Recording, scenario: Scenario) -> str:
    """Return how the target given to the controller differs from the scenario's; empty if it does not."""
    reported = pose_of(recording.parameters_of("controller"), "target")
    if scenario.target is None or reported is None or reported == scenario.target.pose:
        return ""
    along, across, turn = in_frame(*reported, scenario.target.pose)
    return (
        f"the controller has another target, {along:+.3f} m along and {across:+.3f} m across the true one, "
        f"turned by {turn / RAD_PER_DEGREE:+.2f} deg; the run is judged by the true one"
    )


def _outcome(recording: Recording, scenario: Scenario, checks: list[Check]) -> tuple[Outcome, str]:
    end = str(recording.info.get("end", {}).get("reason", ""))
    broken = end if end == "interrupted" or end.startswith("error") else ""
    signals = (scenario.stop_condition.signal, scenario.stop_condition.reason)
    last = (np.array([measure_recording(Measure("last", name), recording)]) for name in (*signals, SPEED))
    asked = [
        RequiredCheck(check.id, np.array([not check.passed]), np.array([math.isnan(check.value)]))
        for check in checks
        if check.required
    ]
    (found,) = outcomes(scenario, Ends([broken], *last), asked, *(recording.variables.get(name) for name in signals))
    return found


CHART = "controller.phase"
MOST_EVENTS = 10_000
"""Changes of phase in a summary; a chart that changes more often is out of order."""
FAR_FROM_TARGET = 0.5
"""A car further than this [m] from its target: the headline states it."""
ALLOWED_CONTACT = "in contact, which the scenario allows (contact_allowed)"
VISIBLE_DISTANCE = 5e-4
"""An outline beyond a boundary by less than this [m] is at it."""


def standing_of(recording: Recording, scenario: Scenario, numbers: dict[str, float]) -> list[str]:
    """Return what is said of a car that stands beyond an end of its slot, or far from its target."""
    touched = [ALLOWED_CONTACT] if scenario.contact_allowed and numbers[PENETRATION] > 0.0 else []
    if scenario.task != "park":
        return touched
    pose = np.array([[numbers[f"final.{axis}"] for axis in ("x", "y", "heading")]])
    said = touched
    if scenario.slot is not None and np.isfinite(pose).all():
        truth = truth_of(scenario, vehicle_parameters(scenario, recording.parameters_of(VEHICLE)))
        ends = zip(("front", "rear"), beyond_ends(pose, truth.slots, truth.cars), strict=True)
        said += [
            f"outline {100.0 * float(over[0]):.1f} cm beyond the slot's {end} boundary"
            for end, over in ends
            if over[0] >= VISIBLE_DISTANCE
        ]
    off = math.hypot(numbers["final.longitudinal_error"], numbers["final.lateral_error"])
    return [*said, f"{off:.2f} m from the target"] if off > FAR_FROM_TARGET else said


def _contact(recording: Recording, scenario: Scenario, numbers: dict[str, float]) -> list[str]:
    """Return when the car touches something first, how fast and how deep; and a wheel at a low kerb."""
    if not numbers[PENETRATION] > 0.0 and numbers["min_clearance"] != 0.0:
        return []
    found = contact_facts(recording, scenario)
    touched, low = found.first, found.low_kerb_time
    said = []
    if touched is not None:
        speed = "" if math.isnan(touched.speed) else f" at {touched.speed:.2f} m/s"
        said.append(
            f"contact from {touched.t:.2f} s on{speed}, up to {_depth_text(touched.depth)} deep, "
            f"in {touched.samples} samples"
        )
    if math.isfinite(low):
        said.append(f"a wheel is at a kerb or box lower than vehicle.ultrasonic.kerb_height, first at {low:.2f} s")
    return said


def _depth_text(depth: float) -> str:
    return f"{100.0 * depth:.1f} cm" if depth >= 5e-4 else "0 cm"


def _count(number: float) -> int | None:
    return int(number) if math.isfinite(number) else None


def _finite(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list):
        return [_finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data
