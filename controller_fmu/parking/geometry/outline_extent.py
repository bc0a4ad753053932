"""How far the outline of a vehicle reaches into a region: its sampled boundary, seen from a frame."""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.geometry.outline import VehicleOutline
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

SAMPLES = 40
"""Points on the boundary: 0.3 m apart."""


class Extent(NamedTuple):
    """Least and largest coordinate of some points [m]; low > high: there are none."""

    low_x: float = 1e9
    high_x: float = -1e9
    low_y: float = 1e9
    high_y: float = -1e9


def extent_within(pose: Pose, outline: VehicleOutline, frame: Pose, side: float, low: Point, high: Point) -> Extent:
    """Return the extent of the boundary of a vehicle at ``pose`` as far as it lies within the box ``low`` to ``high``.

    The box and the result are in ``frame``, its y axis multiplied by ``side``.
    """
    cos = math.cos(pose.heading)
    sin = math.sin(pose.heading)
    found = Extent()
    for number in range(SAMPLES):
        at = boundary_point(outline, number)
        x = pose.x + at.x * cos - at.y * sin
        y = pose.y + at.x * sin + at.y * cos
        point = point_to_frame(x, y, frame)
        across = side * point.y
        if low.x <= point.x <= high.x and low.y <= across <= high.y:
            found = Extent(
                min(found.low_x, point.x),
                max(found.high_x, point.x),
                min(found.low_y, across),
                max(found.high_y, across),
            )
    return found


def boundary_point(outline: VehicleOutline, number: int) -> Point:
    """Return one of ``SAMPLES`` points on the outline [m] in the vehicle's frame: ten on each edge."""
    per_edge = SAMPLES // 4
    edge = number // per_edge
    share = 2.0 * (number % per_edge) / per_edge - 1.0
    ahead = outline.half_length
    left = outline.half_width
    x = ahead * share if edge == 0 else (ahead if edge == 1 else (-ahead * share if edge == 2 else -ahead))
    y = -left if edge == 0 else (left * share if edge == 1 else (left if edge == 2 else -left * share))
    return Point(outline.centre_ahead + x, y)
