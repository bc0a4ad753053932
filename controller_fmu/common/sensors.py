"""The ultrasonic sensors as controllers use them: where one is, and when and whether it tells something."""

import math

from modelkit.car import SensorMount
from modelkit.vocabulary import Pose

LEFT_SENSOR = 8
RIGHT_SENSOR = 10
"""The front ones of the flanks, by which slots are found."""
HEARD = 0.99
"""A reading of more than this share of the range tells nothing."""


def is_told_anew(clock_ns: int, dt_ns: int, cycle: float) -> bool:
    """Return whether sensors that measure every ``cycle`` [s] tell something new in a sample of ``dt_ns``."""
    return clock_ns % math.floor(cycle * 1e9 + 0.5) < dt_ns


def sensor_at(mount: SensorMount, pose: Pose) -> Pose:
    """Return where a sensor is and looks."""
    c = math.cos(pose.heading)
    s = math.sin(pose.heading)
    return Pose(pose.x + mount.x * c - mount.y * s, pose.y + mount.x * s + mount.y * c, pose.heading + mount.yaw)
