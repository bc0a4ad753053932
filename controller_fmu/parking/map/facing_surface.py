"""Surfaces that a bumper approaches: two sensors beside each other that measure about the same range.

An echo straight ahead of a moving sensor says nothing of its bearing (the range falls by the distance driven, wherever
in the cone it came from). Two sensors whose cones overlap do: equal ranges come from a surface across both axes, or
from a body between them. The segment between the feet on both axes stands for either.
"""

import math

from controller_fmu.parking.map.landmark import Landmark, segment_between
from controller_fmu.parking.measurement.sensor import SensorPose
from modelkit.geometry import Point

FACING_ECHOES = 8
"""Echoes of a track after which its object counts as at rest: its closing rate is then known to 0.2 m/s."""
MAX_TILT_SLOPE = 0.34
"""Sine of the largest tilt of a surface against the bumper: 20 deg."""
MAX_FACING_RANGE = 1.5
"""Farther echoes [m] are not used yet."""
LATERAL_SIGMA = 0.15
"""Standard deviation [m] of where such a segment ends."""


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
    """Return the segment between the feet of two sensors on a surface; ``variance`` [m2]; type NONE if they disagree.

    The surface is the common tangent of both circles of equal range: its normal need not lie on either axis.
    """
    dx = b.x - a.x
    dy = b.y - a.y
    base = math.sqrt(dx * dx + dy * dy)
    tilt = (a_range - b_range) / base
    if abs(tilt) > MAX_TILT_SLOPE + 3.0 * math.sqrt(2.0 * variance) / base:
        return Landmark()
    ahead = math.sqrt(max(1.0 - tilt * tilt, 0.0))
    ahead = ahead if a.axis_y * dx - a.axis_x * dy > 0.0 else -ahead
    nx = (tilt * dx - ahead * dy) / base
    ny = (tilt * dy + ahead * dx) / base
    foot = Point(a.x + a_range * nx, a.y + a_range * ny)
    other = Point(b.x + b_range * nx, b.y + b_range * ny)
    segment = segment_between(foot, other, Point(a.x, a.y), variance, LATERAL_SIGMA * LATERAL_SIGMA)
    return segment._replace(confirmations=FACING_ECHOES)
