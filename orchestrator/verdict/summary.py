"""summary.json: the promised result of a run, computed from its recording alone.

SI units and radians. ``final`` errors are measured in the target's frame: longitudinal along its
heading, lateral to its left, heading wrapped to (-pi, pi].
"""

import math
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from orchestrator.cosim.recording import Recording
from orchestrator.scenario.end_condition import SPEED
from orchestrator.scenario.scenario import DONE, PENETRATION, Outcome, Scenario
from orchestrator.text.quantities import RAD_PER_DEGREE
from orchestrator.verdict.contact import VEHICLE, contact_facts
from orchestrator.verdict.frame import in_frame, pose_of
from orchestrator.verdict.geometry import described
from orchestrator.verdict.judge import Check, judge
from orchestrator.verdict.measures import Measure, measured
from orchestrator.verdict.numbers import facts_of
from orchestrator.verdict.outcome import Asked, Ends, outcomes, state_name
from orchestrator.verdict.standing import beyond_ends
from orchestrator.verdict.truth import truth_of


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", ser_json_inf_nan="constants")


class Final(_Part):
    """Where and how the car stands at the end: the numbers ``final.*`` of a run, NaN for what it does not have."""

    x: float
    """Of the rear-axle midpoint [m]."""
    y: float
    """Of the rear-axle midpoint [m]."""
    heading: float
    """[rad]"""
    lateral_error: float
    """In the target's frame, to its left [m]."""
    longitudinal_error: float
    """In the target's frame, along its heading [m]."""
    heading_error: float
    """Heading minus the target's, wrapped [rad]."""
    steering_wheel_angle: float
    """Left positive [rad]."""
    speed: float
    """Reverse negative [m/s]."""
    outline_margin: float
    """Least distance of the outline to the slot's edges, negative where it stands out [m]."""
    kerb_nearest: float
    """Distance to the slot's kerb of the nearest tyre beside it [m]."""
    kerb_farthest: float
    """Distance to the slot's kerb of the farthest tyre beside it [m]."""


class Event(_Part):
    """One change of the manoeuvre chart; ``from`` and ``to`` are names of phases."""

    t: float
    """When [s]."""
    from_: str
    """Phase it leaves."""
    to: str
    """Phase it enters."""
    x: float
    """Where the car is then [m]."""
    y: float
    """Where the car is then [m]."""
    heading: float
    """How the car stands then [rad]."""


class FmuUsed(_Part):
    """One slave of the run."""

    name: str
    """Its place in the system."""
    kind: str
    """``python``, ``native``, ``none`` (in process) or ``foreign``: somebody else's."""
    guid: str
    """Of the FMU; for a model in process, which it is."""
    path: str = ""
    """Its file; the folder of the sources for a model in process."""
    sha256: str = ""
    """Hash of that file, or of all sources of the models."""


class Started(_Part):
    """When and how a run was started."""

    time: str = ""
    """UTC, ISO 8601."""
    command: str = ""
    """Command line."""
    folder: str = ""
    """Where the command was given."""
    git: str = ""
    """Commit of the repository there, ``-modified`` behind it if a tracked file differs."""


class Tuned(_Part):
    """A parameter changed from outside during the run."""

    t: float
    """From when on [s]."""
    name: str
    """Of slave and parameter."""
    value: float
    """What it was set to."""
    by: str = ""
    """By whom."""


class Lateness(_Part):
    """How a run kept to the clock on the wall."""

    exchanges: int
    """How many there were."""
    late: int
    """How many of them were over 1 ms late."""
    median: float
    """Half were later than this [s]."""
    percentile_99: float
    """One in a hundred was later than this [s]."""
    largest: float
    """The latest of all [s]."""
    at_end: float
    """The last one [s]: large, if the run could not keep the pace."""
    tuned: list[Tuned] = []
    """What was changed meanwhile."""


class Summary(_Part):
    """The whole of summary.json."""

    scenario: str
    """Its name."""
    overrides: dict[str, str]
    """What ``--set`` changed of the scenario."""
    outcome: Outcome
    """How the run came out."""
    reason: str
    """Why."""
    duration: float
    """Simulated time [s]."""
    manoeuvres: int | None
    """Manoeuvres; null if the controller does not count them."""
    max_speed: float
    """Largest absolute speed [m/s]."""
    peak_jerk: float
    """Largest absolute jerk, averaged over a second [m/s3]."""
    penetration: float
    """Greatest penetration depth of the outline in anything of the scene [m]; 0: no contact."""
    dry_steering_count: int | None
    """Standstills in which the steering wheel is turned by more than 5 deg; null if the wheel is not known."""
    final: Final
    """Where and how the car stands at the end."""
    events: list[Event]
    """Changes of the manoeuvre chart."""
    checks: list[Check]
    """Requirements and how the run stands against them."""
    fmus: list[FmuUsed]
    """What was run."""
    wall_time: float
    """Time it took [s]."""
    real_time_factor: float
    """Simulated time over the time it took."""
    seed: int
    """Of the scenario."""
    versions: dict[str, str]
    """Of Python, of this project and of what it stands on."""
    started: Started = Started()
    """When and how it was started."""
    standing: list[str] = []
    """What the headline adds: an outline beyond the slot's front or rear boundary, a car far from its target."""
    notes: list[str] = []
    """What is worth knowing of the verdict: contact, a target that was told wrong, or is not in the log."""
    realtime: Lateness | None = None
    """How late it was, if it was held to the clock on the wall."""

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


def summarize(recording: Recording, scenario: Scenario, wall_time: float, note: str = "") -> Summary:
    """Return the summary of a run. Raises ``BadInput`` if a limit names a signal that does not exist.

    ``note``: what its log does not tell, see :func:`orchestrator.verdict.logged.logged`.
    """
    facts = facts_of(recording, scenario)
    numbers, checks = facts.numbers, judge(scenario.requirements, recording, facts, scenario.file)
    outcome, reason = _outcome(recording, scenario, checks)
    events = _events(recording)
    many = f"only the first {MOST_EVENTS} changes of phase are listed" if len(events) == MOST_EVENTS else ""
    said = (note, *_contact(recording, scenario, numbers), _target_difference(recording, scenario), many)
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
        started=Started(**recording.info.get("started", {})),
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
    """Return how the target that the controller is told differs from the scenario's; empty if it does not."""
    told = pose_of(recording.parameters_of("controller"), "target")
    if scenario.target is None or told is None or told == scenario.target.pose:
        return ""
    along, across, turn = in_frame(*told, scenario.target.pose)
    return (
        f"the controller is told another target, {along:+.3f} m along and {across:+.3f} m across the true one, "
        f"turned by {turn / RAD_PER_DEGREE:+.2f} deg; the run is judged by the true one"
    )


def _outcome(recording: Recording, scenario: Scenario, checks: list[Check]) -> tuple[Outcome, str]:
    end = str(recording.info.get("end", {}).get("reason", ""))
    broken = end if end == "interrupted" or end.startswith("error") else ""
    signals = (scenario.stop_condition.signal, scenario.stop_condition.reason)
    last = (np.array([measured(Measure("last", name), recording)]) for name in (*signals, SPEED))
    asked = [
        Asked(check.id, np.array([not check.passed]), np.array([math.isnan(check.value)]))
        for check in checks
        if check.required
    ]
    (found,) = outcomes(scenario, Ends([broken], *last), asked, *(recording.variables.get(name) for name in signals))
    return found


CHART = "controller.phase"
MOST_EVENTS = 10_000
"""Changes of phase in a summary; a chart that changes more often is out of order."""
FAR_FROM_TARGET = 0.5
"""A car further than this [m] from its target: the headline says so."""
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
        truth = truth_of(scenario, described(scenario, recording.parameters_of(VEHICLE)))
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
        said.append(f"a wheel is at a kerb lower than vehicle.ultrasonic.kerb_height, first at {low:.2f} s")
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
