"""Free space: the last echoes of both flanks, as rays. Inside a ray's cone nothing lies nearer than its echo."""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import planar_distance
from controller_fmu.parking.measurement.sensor import SensorPose, in_field_of_view

MAX_RAYS = 80
"""Kept for each side."""
RAY_SPACING = 0.2
"""Distance [m] between the sensor positions of two kept rays: they reach back 16 m, a slot at 30 deg and a car to each
side of it."""
RAY_MARGIN = 0.1
"""Of a ray, the last [m] are not taken as free: ten times the noise, and what the odometry drifts over a slot."""
MIN_RAYS = 2
"""Rays that must agree that a point is free: one may be a dropout."""


class Ray(NamedTuple):
    """A sensor pose and the range [m] up to which its cone is free; 0: unused."""

    sensor: SensorPose = SensorPose()
    range: float = 0.0
    is_echo: bool = False


class FreeSpace(NamedTuple):
    """Rays of the right and the left flank, oldest first."""

    right: tuple[Ray, ...] = (Ray(),) * MAX_RAYS
    left: tuple[Ray, ...] = (Ray(),) * MAX_RAYS


def path_curvature(rays: tuple[Ray, ...]) -> float:
    """Return the mean curvature [1/m], left positive, of the path on which the rays of one side were measured."""
    last = rays[MAX_RAYS - 1].sensor
    for ray in rays:
        first = ray.sensor
        length = planar_distance(first.x, first.y, last.x, last.y)
        if ray.range > 0.0 and length > 0.0:
            cross = first.axis_x * last.axis_y - first.axis_y * last.axis_x
            return math.atan2(cross, first.axis_x * last.axis_x + first.axis_y * last.axis_y) / length
    return 0.0


def is_next_ray(last: Ray, ray: Ray) -> bool:
    """Return whether a ray is kept after the ``last`` one of its side: its sensor has moved far enough."""
    return last.range <= 0.0 or planar_distance(ray.sensor.x, ray.sensor.y, last.sensor.x, last.sensor.y) >= RAY_SPACING


def is_free(rays: tuple[Ray, ...], x: float, y: float) -> bool:
    """Return whether the point (x, y) [m] lies in the free part of at least ``MIN_RAYS`` rays."""
    count = 0
    for ray in rays:
        dx = x - ray.sensor.x
        dy = y - ray.sensor.y
        free = ray.range - RAY_MARGIN
        if free > 0.0 and dx * dx + dy * dy < free * free and in_field_of_view(ray.sensor, x, y):
            count += 1
    return count >= MIN_RAYS
