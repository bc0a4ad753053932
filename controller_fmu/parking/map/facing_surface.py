"""Surfaces that a bumper approaches: two sensors beside each other that measure about the same range.

An echo straight ahead of a moving sensor says nothing of its bearing (the range falls by the distance driven, wherever
in the cone it came from). Two sensors whose cones overlap do: equal ranges come from a surface across both axes, or
from a body between them. The segment between the feet on both axes stands for either.
"""

import math

from controller_fmu.parking.map.landmark import Landmark, LandmarkType
from controller_fmu.parking.measurement.sensor import SensorPose

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


def facing_segment(a: SensorPose, a_range: float, b: SensorPose, b_range: float, variance: float) -> Landmark:
    """Return the segment between the feet [m] on two sensors' axes; ``variance`` [m2]; type NONE if they disagree."""
    base = math.sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y))
    if abs(a_range - b_range) > MAX_TILT_SLOPE * base + 3.0 * math.sqrt(2.0 * variance):
        return Landmark()
    ax = a.x + a_range * a.axis_x
    ay = a.y + a_range * a.axis_y
    bx = b.x + b_range * b.axis_x
    by = b.y + b_range * b.axis_y
    length = math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
    x = 0.5 * (ax + bx)
    y = 0.5 * (ay + by)
    ux = a.axis_x + b.axis_x
    uy = a.axis_y + b.axis_y
    along = (bx - ax) * -uy + (by - ay) * ux
    towards = 1.0 if along > 0.0 else -1.0
    heading = math.atan2(towards * (by - ay), towards * (bx - ax))
    nx = -math.sin(heading)
    ny = math.cos(heading)
    turn = 4.0 * variance / max(length * length, variance)
    return Landmark(
        type=LandmarkType.SEGMENT,
        x=x,
        y=y,
        heading=heading,
        xx=variance * nx * nx,
        xy=variance * nx * ny,
        yy=variance * ny * ny,
        hh=turn,
        start=-0.5 * length,
        end=0.5 * length,
        start_variance=LATERAL_SIGMA * LATERAL_SIGMA,
        end_variance=LATERAL_SIGMA * LATERAL_SIGMA,
        confirmations=FACING_ECHOES,
    )
