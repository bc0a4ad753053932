"""Surfaces that a bumper approaches: two sensors beside each other that measure about the same range.

An echo straight ahead of a moving sensor says nothing of its bearing (the range falls by the distance driven, wherever
in the cone it came from). Two sensors whose cones overlap do: equal ranges come from a surface across both axes, or
from a body between them. The segment between the feet on both axes stands for either.
"""

import math

from controller_fmu.parking.map.landmark import Landmark, segment_between
from controller_fmu.parking.measurement.sensor import SensorPose
from modelkit.geometry import Point

BUMPER_SENSORS = 8
"""Numbers 0 to 3 in front, 4 to 7 behind."""
FACING_ECHOES = 8
"""Echoes of a track after which its object counts as at rest: its closing rate is then known to 0.2 m/s."""
MAX_TILT_SLOPE = 0.36
"""Tangent of the largest tilt of a surface against the bumper: 20 deg."""
MAX_FACING_RANGE = 1.5
"""Farther echoes [m] are not used yet."""
LATERAL_SIGMA = 0.15
"""Standard deviation [m] of where such a segment ends."""


def is_pair(number: int) -> bool:
    """Return whether sensor ``number`` (0 to 7) and the next are beside each other on one bumper."""
    return number != 3 and number != BUMPER_SENSORS - 1


def point_between(a: SensorPose, a_range: float, b: SensorPose, b_range: float) -> Point:
    """Return the point before two sensors that is at both ranges [m], or between them if there is none."""
    dx = b.x - a.x
    dy = b.y - a.y
    base = math.sqrt(dx * dx + dy * dy)
    along = 0.5 * (base + (a_range * a_range - b_range * b_range) / base)
    ahead = math.sqrt(max(a_range * a_range - along * along, 0.0))
    ahead = ahead if a.axis_y * dx - a.axis_x * dy > 0.0 else -ahead
    return Point(a.x + (along * dx - ahead * dy) / base, a.y + (along * dy + ahead * dx) / base)


def facing_segment(a: SensorPose, a_range: float, b: SensorPose, b_range: float, variance: float) -> Landmark:
    """Return the segment between the feet [m] on two sensors' axes; ``variance`` [m2]; type NONE if they disagree."""
    base = math.sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y))
    if abs(a_range - b_range) > MAX_TILT_SLOPE * base + 3.0 * math.sqrt(2.0 * variance):
        return Landmark()
    foot = Point(a.x + a_range * a.axis_x, a.y + a_range * a.axis_y)
    other = Point(b.x + b_range * b.axis_x, b.y + b_range * b.axis_y)
    segment = segment_between(foot, other, Point(a.x, a.y), variance, LATERAL_SIGMA * LATERAL_SIGMA)
    return segment._replace(confirmations=FACING_ECHOES)
