"""The vehicle as a rectangle about its rear axle, and its motion along lines and arcs."""

import math
from typing import NamedTuple

from modelkit.car import Car, car_length, largest_curvature
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
