"""The vehicle as a rectangle about its rear axle, and its motion along lines and arcs."""

import math
from typing import NamedTuple

from modelkit.car import Car, car_length, largest_curvature
from modelkit.vocabulary import Pose

SAME_CURVATURE = 1e-6
"""Curvatures nearer than this [1/m] are one: 10 m along them they are 0.05 mm apart."""


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


def frame_along_arc(frame: OutlineFrame, heading: float, distance: float, curvature: float) -> OutlineFrame:
    """Return ``frame``, at ``heading`` [rad], after ``distance`` [m] (reverse negative) along an arc, 0: a line."""
    if abs(curvature) < SAME_CURVATURE:
        return OutlineFrame(frame.x + distance * frame.cos, frame.y + distance * frame.sin, frame.cos, frame.sin)
    cos = math.cos(heading + distance * curvature)
    sin = math.sin(heading + distance * curvature)
    return OutlineFrame(frame.x + (sin - frame.sin) / curvature, frame.y + (frame.cos - cos) / curvature, cos, sin)


def pose_along_arc(pose: Pose, distance: float, curvature: float) -> Pose:
    """Return the pose after ``distance`` [m] (reverse negative) along an arc of ``curvature`` [1/m], 0: a line."""
    frame = frame_along_arc(outline_frame(pose), pose.heading, distance, curvature)
    return Pose(frame.x, frame.y, pose.heading + distance * curvature)
