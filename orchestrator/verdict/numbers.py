"""The numbers that sum up a run: one table for a single run, for a table of many, and for the limits that name them."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from orchestrator.cosim.recording import Recording
from orchestrator.cosim.slave import Array
from orchestrator.verdict.frame import in_frame, pose_of
from orchestrator.verdict.measures import Measure, measured

PoseTuple = tuple[float, float, float]


class Number(NamedTuple):
    """One number of a summary."""

    unit: str
    text: str
    measure: Measure | None = None
    """What it is made from; None: from the end of the run, or from its last pose and the target."""
    unsigned: bool = False


POSE = tuple(Measure("last", f"vehicle.pose.{axis}") for axis in ("x", "y", "heading"))
CLEARANCE = Measure("smallest", "vehicle.clearance")
NUMBERS: dict[str, Number] = {
    "duration": Number("s", "from start to the end of the run"),
    "shifts": Number("1", "manoeuvres, the first reverse counts one", Measure("last", "controller.shifts")),
    "max_speed": Number("m/s", "largest absolute speed", Measure("largest", "vehicle.speed"), True),
    "final.x": Number("m", "x of the rear-axle midpoint at the end", POSE[0]),
    "final.y": Number("m", "y of the rear-axle midpoint at the end", POSE[1]),
    "final.heading": Number("rad", "heading at the end", POSE[2]),
    "final.longitudinal_error": Number("m", "in the target's frame, along its heading"),
    "final.lateral_error": Number("m", "in the target's frame, to its left"),
    "final.heading_error": Number("rad", "heading minus the target's, wrapped"),
    "final.steering_wheel_angle": Number(
        "rad", "steering-wheel angle at the end, left positive", Measure("last", "vehicle.steering_wheel_angle")
    ),
    "steering_effort": Number(
        "rad",
        "sum of the absolute changes of the steering-wheel angle",
        Measure("travel", "vehicle.steering_wheel_angle"),
    ),
    "min_clearance": Number("m", "smallest distance of the outline to anything in the scene", CLEARANCE),
}
ERRORS = ("final.longitudinal_error", "final.lateral_error", "final.heading_error")
MEASURES = tuple(item.measure for item in NUMBERS.values() if item.measure is not None)


def signals_of(name: str) -> list[str]:
    """Return the signals that a number is made from."""
    measure = NUMBERS[name].measure
    measures = POSE if name in ERRORS else () if measure is None else (measure,)
    return [item.signal for item in measures]


def numbers(durations: Array, found: Mapping[Measure, Array], targets: Sequence[PoseTuple]) -> dict[str, Array]:
    """Return the numbers of many runs by name, one value for each.

    ``durations`` [s], ``found``: their measures, of which signals that do not exist may lack; ``targets``: the pose
    each was to reach.
    """
    made: dict[str, Array] = {"duration": durations}
    for name, item in NUMBERS.items():
        if item.measure is not None:
            values = found.get(item.measure, np.full(len(durations), np.nan))
            made[name] = np.abs(values) if item.unsigned else values
    axes = (made[name].tolist() for name in ("final.x", "final.y", "final.heading"))
    errors = [in_frame(x, y, heading, target) for x, y, heading, target in zip(*axes, targets, strict=True)]
    columns = np.array(errors).reshape(-1, 3).T
    made |= dict(zip(ERRORS, columns, strict=True))
    return {name: made[name] for name in NUMBERS}


def numbers_of(recording: Recording) -> dict[str, float]:
    """Return the numbers of one recorded run by name."""
    target = pose_of(recording.parameters_of("controller"), "target") or (0.0, 0.0, 0.0)
    found = {
        measure: np.array([measured(measure, recording)])
        for measure in MEASURES
        if len(recording.signals.get(measure.signal, ()))
    }
    duration = np.array([float(recording.t[-1]) if len(recording.t) else 0.0])
    return {name: float(values[0]) for name, values in numbers(duration, found, [target]).items()}
