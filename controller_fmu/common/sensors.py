"""The ultrasonic sensors as controllers use them: where one is, and when and whether it tells something."""

import math
from typing import NamedTuple

from modelkit.car import SensorMount
from modelkit.vocabulary import Pose

LEFT_SENSOR = 8
RIGHT_SENSOR = 10
"""The front ones of the flanks, by which slots are found."""
MAX_SAMPLE_LATENCY = 0.01
"""Longest latency [s] of a new reading."""
VALID_RANGE_FRACTION = 0.99
"""A reading of more than this share of the range tells nothing."""


def is_new_sample(clock_ns: int, dt_ns: int, cycle: float) -> bool:
    """Return whether sensors that measure every ``cycle`` [s] tell something new in a sample of ``dt_ns``."""
    return clock_ns % math.floor(cycle * 1e9 + 0.5) < dt_ns


class RangeSample(NamedTuple):
    """The last readings of the sensors, and whether some are new now."""

    readings: tuple[float, ...] = (0.0,) * 12
    """The last that were processed [m]."""
    waited_ns: int = 0
    """Time since new readings were due [ns]; 0: none are due yet."""
    fresh: bool = False


def update_sample(
    before: RangeSample, readings: tuple[float, ...], clock_ns: int, dt_ns: int, cycle: float
) -> RangeSample:
    """Return the readings of a sample of ``dt_ns``: new ones may come later than they are measured.

    Where data is exchanged seldom, a sample arrives up to ``MAX_SAMPLE_LATENCY`` [s] after its ``cycle`` [s]: until
    then the readings are the last ones still. Readings that are the same after that are new ones too.
    """
    due = is_new_sample(clock_ns, dt_ns, cycle)
    if not due and before.waited_ns == 0:
        return before._replace(fresh=False)
    waited = before.waited_ns + dt_ns
    changed = due and before.waited_ns > 0
    for number in range(12):
        changed = changed or readings[number] != before.readings[number]
    if not changed and waited * 1e-9 <= MAX_SAMPLE_LATENCY:
        return before._replace(waited_ns=waited, fresh=False)
    return RangeSample(readings, 0, True)


def sensor_at(mount: SensorMount, pose: Pose) -> Pose:
    """Return where a sensor is and looks."""
    c = math.cos(pose.heading)
    s = math.sin(pose.heading)
    return Pose(pose.x + mount.x * c - mount.y * s, pose.y + mount.x * s + mount.y * c, pose.heading + mount.yaw)
