"""The numbers that sum up a run: one table for a single run, for a table of many, and for the limits that name them."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from orchestrator.evaluation.verdict.comfort import DrySteering, PeakJerk
from orchestrator.evaluation.verdict.contact import VEHICLE, contact_facts, has_scene
from orchestrator.evaluation.verdict.geometry import vehicle_parameters
from orchestrator.evaluation.verdict.measures import Measure, measure_recording
from orchestrator.evaluation.verdict.standing import in_frames, kerb_distances, outline_margin
from orchestrator.evaluation.verdict.truth import GroundTruth, truth_of
from orchestrator.inputs.scenario import end_condition
from orchestrator.inputs.scenario.scenario import PENETRATION, Scenario
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording


class Metric(NamedTuple):
    """One number of a summary."""

    unit: str
    text: str
    measure: Measure | None = None
    """What it is made from; None: from the end of the run, or from its last pose and what is true."""
    unsigned: bool = False


POSE = tuple(Measure("last", f"vehicle.pose.{axis}") for axis in ("x", "y", "heading"))
SPEED = Measure("last", end_condition.SPEED)
CLEARANCE = Measure("smallest", "vehicle.clearance")
NUMBERS: dict[str, Metric] = {
    "duration": Metric("s", "from start to the end of the run"),
    "manoeuvres": Metric(
        "1", "number of manoeuvres; the first reverse motion counts as one", Measure("last", "controller.manoeuvres")
    ),
    "max_speed": Metric("m/s", "largest absolute speed", Measure("largest", end_condition.SPEED), True),
    "final.x": Metric("m", "x of the rear-axle midpoint at the end", POSE[0]),
    "final.y": Metric("m", "y of the rear-axle midpoint at the end", POSE[1]),
    "final.heading": Metric("rad", "heading at the end", POSE[2]),
    "final.longitudinal_error": Metric("m", "in the target's frame, along its heading"),
    "final.lateral_error": Metric("m", "in the target's frame, to its left"),
    "final.heading_error": Metric("rad", "heading minus the target's, wrapped"),
    "final.steering_wheel_angle": Metric(
        "rad", "steering-wheel angle at the end, left positive", Measure("last", "vehicle.steering_wheel_angle")
    ),
    "final.speed": Metric("m/s", "speed at the end, reverse negative", SPEED),
    "final.outline_margin": Metric("m", "signed distance of the outline to the slot boundary, negative beyond it"),
    "final.kerb_nearest": Metric("m", "distance to the slot's kerb of the nearest tyre beside it"),
    "final.kerb_farthest": Metric("m", "distance to the slot's kerb of the farthest tyre beside it"),
    "steering_travel": Metric(
        "rad",
        "steering travel: sum of the absolute changes of the steering-wheel angle",
        Measure("travel", "vehicle.steering_wheel_angle"),
    ),
    "min_clearance": Metric(
        "m", "smallest clearance of the outline to boxes and kerbs; in contact minus the penetration depth", CLEARANCE
    ),
    "polygon_clearance": Metric(
        "m", "smallest clearance of the outline to the scenario's polygons; in contact minus the penetration depth"
    ),
    PENETRATION: Metric("m", "largest penetration depth of the outline into an obstacle; 0: no contact"),
    "peak_jerk": Metric("m/s3", "largest absolute jerk, averaged over a second"),
    "dry_steering_count": Metric("1", "dry-steering events: standstills with more than 5 deg of steering-wheel travel"),
}
ERRORS = ("final.longitudinal_error", "final.lateral_error", "final.heading_error")
STANDING = (*ERRORS, "final.outline_margin", "final.kerb_nearest", "final.kerb_farthest")
"""Made from the last pose and from what is true; NaN where a scenario has no target, slot or kerb."""
OF_WHOLE_RUNS = {
    "polygon_clearance": tuple(measure.signal for measure in POSE),
    "peak_jerk": (end_condition.SPEED,),
    "dry_steering_count": (end_condition.SPEED, "vehicle.steering_wheel_angle"),
}
"""Numbers that take the whole run -> signals; tables of many runs do not have them."""
MEASURES = tuple(item.measure for item in NUMBERS.values() if item.measure is not None)


def signals_of(name: str) -> list[str]:
    """Return the signals that a number is made from."""
    if name in OF_WHOLE_RUNS:
        return list(OF_WHOLE_RUNS[name])
    measure = NUMBERS[name].measure
    measures = POSE if name in STANDING else () if measure is None else (measure,)
    return [item.signal for item in measures]


class RunFacts(NamedTuple):
    """What one run is judged by beside its signals."""

    numbers: dict[str, float]
    """By the names of ``NUMBERS``; NaN for what was not measured, or what the scenario does not have."""
    has: frozenset[str]
    """What the scenario has: ``target``, ``slot``, ``kerb``, ``obstacles``, ``scene``."""


def facts_of(recording: Recording, scenario: Scenario) -> RunFacts:
    """Return the numbers of one recorded run of ``scenario``."""
    found = {
        measure: np.array([measure_recording(measure, recording)])
        for measure in MEASURES
        if recording.count and measure.signal in recording.signals
    }
    duration = np.array([recording.duration])
    truth = truth_of(scenario, vehicle_parameters(scenario, recording.parameters_of(VEHICLE)))
    made = {name: float(values[0]) for name, values in numbers(duration, found, truth).items()}
    has = {name for name, rows in truth.has().items() if rows[0]}
    has |= quantities_of(scenario, recording.parameters_of(VEHICLE))
    return RunFacts(made | of_whole_run(recording, scenario), frozenset(has))


def quantities_of(scenario: Scenario, vehicle: Mapping[str, float]) -> set[str]:
    """Return which of ``obstacles`` and ``scene`` (anything at all) a run has; ``vehicle``: its own parameters."""
    polygons = {"obstacles"} if scenario.obstacles else set[str]()
    return polygons | ({"scene"} if polygons or has_scene(vehicle_parameters(scenario, vehicle)) else set())


def of_whole_run(recording: Recording, scenario: Scenario) -> dict[str, float]:
    """Return the duration, and the numbers ``OF_WHOLE_RUNS``, which nothing that is kept of a run tells."""
    near = contact_facts(recording, scenario)
    jerk, turns = _comfort(recording)
    return {
        "duration": recording.duration,
        "min_clearance": near.scene,
        "polygon_clearance": near.polygons if scenario.obstacles else math.nan,
        PENETRATION: near.depth,
        "peak_jerk": jerk,
        "dry_steering_count": turns,
    }


def _comfort(recording: Recording) -> tuple[float, float]:
    """Return peak jerk [m/s3] and how often the wheel is turned at standstill; NaN where that is not known."""
    jerk, turns = PeakJerk(), DrySteering()
    names = OF_WHOLE_RUNS["dry_steering_count"]
    has_speed, has_wheel = (recording.count > 0 and name in recording.signals for name in names)
    for part, _, _ in recording.parts() if has_speed else ():
        speed = part.signals[names[0]]
        jerk.add(part.t, speed)
        if has_wheel:
            turns.add(speed, part.signals[names[1]])
    return jerk.value, turns.value if has_speed and has_wheel else math.nan


def numbers(durations: Array, found: Mapping[Measure, Array], truth: GroundTruth) -> dict[str, Array]:
    """Return the numbers of many runs by name, one value for each.

    ``durations`` [s], ``found``: their measures, of which signals that do not exist may lack; ``truth``: where each
    was to stand.
    """
    made: dict[str, Array] = {"duration": durations}
    made |= {name: np.full(len(durations), np.nan) for name in OF_WHOLE_RUNS}
    for name, item in NUMBERS.items():
        if item.measure is not None:
            values = found.get(item.measure, np.full(len(durations), np.nan))
            made[name] = np.abs(values) if item.unsigned else values
    made[PENETRATION] = np.maximum(0.0, -made["min_clearance"])
    poses = np.column_stack([made[f"final.{axis}"] for axis in ("x", "y", "heading")])
    made |= dict(zip(STANDING, _standing(np.where(np.isfinite(poses), poses, np.nan), truth), strict=True))
    return {name: made[name] for name in NUMBERS}


def _standing(poses: Array, truth: GroundTruth) -> tuple[Array, ...]:
    """Return the numbers ``STANDING`` of cars at ``poses`` (n, 3)."""
    with np.errstate(over="ignore", invalid="ignore"):
        errors = in_frames(poses, truth.targets).T
        margin = outline_margin(poses, truth.slots, truth.cars)
        return (*errors, margin, *kerb_distances(poses, truth.kerbs, truth.cars))
