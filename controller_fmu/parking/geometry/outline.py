"""The vehicle as a rectangle about its rear axle, and its motion along lines and arcs."""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import point_to_frame
from modelkit.car import Car, car_length, largest_curvature
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

STRAIGHT_TURN = 1e-9
"""Below this half turn [rad] the chord of an arc equals its length to the last bit."""


class VehicleOutline(NamedTuple):
    """The rectangle of the body about its centre, and the path curvature that the steering reaches."""

    centre_ahead: float = 0.0
    """The rectangle's centre ahead of the rear-axle midpoint [m]."""
    half_length: float = 0.0
    half_width: float = 0.0
    max_curvature: float = 0.0
    """Of the rear-axle midpoint's path [1/m]."""


def vehicle_outline(car: Car, curvature_fraction: float) -> VehicleOutline:
    """Return the outline of ``car``, with ``curvature_fraction`` (0 to 1) of the curvature at full steering lock."""
    length = car_length(car)
    curvature = curvature_fraction * largest_curvature(car)
    return VehicleOutline(0.5 * length - car.rear_overhang, 0.5 * length, 0.5 * car.width, curvature)


def pose_along_arc(pose: Pose, distance: float, curvature: float) -> Pose:
    """Return the pose after ``distance`` [m] (reverse negative) along an arc of ``curvature`` [1/m], 0: a line."""
    half_turn = 0.5 * distance * curvature
    size = abs(half_turn)
    chord = distance
    if size > STRAIGHT_TURN:
        chord = distance * math.sin(size) / size
    heading = pose.heading + half_turn
    return Pose(pose.x + chord * math.cos(heading), pose.y + chord * math.sin(heading), heading + half_turn)


def max_point_speed_ratio(outline: VehicleOutline, curvature: float) -> float:
    """Return the largest distance [m] that any point of the outline moves per metre of the rear axle on an arc."""
    k = abs(curvature)
    across = 1.0 + k * outline.half_width
    along = k * (abs(outline.centre_ahead) + outline.half_length)
    return math.sqrt(across * across + along * along)


class OutlineFrame(NamedTuple):
    """A pose of the rear axle with the cosine and sine of its heading."""

    x: float = 0.0
    y: float = 0.0
    cos: float = 1.0
    sin: float = 0.0


def outline_frame(pose: Pose) -> OutlineFrame:
    """Return ``pose`` with the cosine and sine of its heading."""
    return OutlineFrame(pose.x, pose.y, math.cos(pose.heading), math.sin(pose.heading))


SAMPLE_COUNT = 40
"""Points on the boundary: 0.3 m apart."""


class Extent(NamedTuple):
    """Least and largest coordinate of some points [m]; low > high: there are none."""

    low_x: float = 1e9
    high_x: float = -1e9
    low_y: float = 1e9
    high_y: float = -1e9


def extent_within(pose: Pose, outline: VehicleOutline, frame: Pose, side: float, low: Point, high: Point) -> Extent:
    """Return the extent of the boundary of a vehicle at ``pose`` as far as it lies within the box ``low`` to ``high``.

    The box and the result [m] are in ``frame``, its y axis multiplied by ``side`` (1, -1).
    """
    cos = math.cos(pose.heading)
    sin = math.sin(pose.heading)
    found = Extent()
    for number in range(SAMPLE_COUNT):
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
    """Return one of ``SAMPLE_COUNT`` points on the outline [m] in the vehicle's frame: ten on each edge."""
    per_edge = SAMPLE_COUNT // 4
    edge = number // per_edge
    share = 2.0 * (number % per_edge) / per_edge - 1.0
    ahead = outline.half_length
    left = outline.half_width
    x = ahead * share if edge == 0 else (ahead if edge == 1 else (-ahead * share if edge == 2 else -ahead))
    y = -left if edge == 0 else (left * share if edge == 1 else (left if edge == 2 else -left * share))
    return Point(outline.centre_ahead + x, y)
