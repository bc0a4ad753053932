"""One ultrasonic sensor: its pose, its field of view, and what a reading means.

A sensor reports the distance to the nearest point inside a cone about its axis. It reports ``min_range`` for anything
nearer (blind zone) and ``max_range`` where no echo returned, be it that nothing is there or that the echo was lost.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from modelkit.car import CarUltrasonic, SensorMount
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

MAX_SENSORS = 12
BUMPER_SENSORS = 8
"""Numbers 0 to 3 in front, 4 to 7 behind; then two on each flank."""
FRONT_MIDDLE = 1
REAR_MIDDLE = 5
"""Of the two in the middle of a bumper the first. The outer ones look aside: into a slot they measure its sides."""
FRONT_LEFT_SIDE = 8
FRONT_RIGHT_SIDE = 10
NO_ECHO_FRACTION = 0.99
"""A reading above this fraction of the range is no echo: noise and resolution are below 1 % of it."""


class SensorPose(NamedTuple):
    """A sensor in the odometry frame: position [m], unit vector of its axis, cosine and sine of its half cone."""

    x: float = 0.0
    y: float = 0.0
    axis_x: float = 1.0
    axis_y: float = 0.0
    cone_cos: float = 1.0
    cone_sin: float = 0.0


class ReadingStatus(IntEnum):
    """What a reading means."""

    ECHO = 0
    """A distance."""
    BLIND_ZONE = 1
    """Something is nearer than the sensor can measure."""
    NO_ECHO = 2
    """Nothing in the field of view, or a dropout."""
    INVALID = 3
    """Not a number, or nearer than a sensor ever reports."""


class Measurement(NamedTuple):
    """A reading: where its sensor was, its ``ReadingStatus``, range [m] and variance [m2]."""

    sensor: SensorPose
    status: int
    range: float
    variance: float
    number: int = 0
    """Of the sensor, 0 to 11."""
    min_range: float = 0.0
    """Blind zone of the sensor [m]."""


def sensor_pose(mount: SensorMount, half_angle: float, vehicle: Pose) -> SensorPose:
    """Return where a sensor on a vehicle at pose ``vehicle`` is; ``half_angle`` [rad] opens its cone."""
    cos = math.cos(vehicle.heading)
    sin = math.sin(vehicle.heading)
    axis = vehicle.heading + mount.yaw
    x = vehicle.x + mount.x * cos - mount.y * sin
    y = vehicle.y + mount.x * sin + mount.y * cos
    return SensorPose(x, y, math.cos(axis), math.sin(axis), math.cos(half_angle), math.sin(half_angle))


def reading_status(reading: float, sensors: CarUltrasonic) -> int:
    """Return the ``ReadingStatus`` of a reading [m]."""
    if not reading >= sensors.min_range - sensors.resolution:
        return ReadingStatus.INVALID
    if reading >= NO_ECHO_FRACTION * sensors.max_range:
        return ReadingStatus.NO_ECHO
    return ReadingStatus.BLIND_ZONE if reading <= sensors.min_range else ReadingStatus.ECHO


def in_field_of_view(sensor: SensorPose, x: float, y: float) -> bool:
    """Return whether the point (x, y) [m] lies inside the sensor's cone, at whatever distance."""
    dx = x - sensor.x
    dy = y - sensor.y
    along = dx * sensor.axis_x + dy * sensor.axis_y
    across = abs(dy * sensor.axis_x - dx * sensor.axis_y)
    return across * sensor.cone_cos <= along * sensor.cone_sin


def boundary_point(sensor: SensorPose, measured: float, turn: float) -> Point:
    """Return the point of the cone's boundary, to the left (1) or right (-1) of the axis, at a range [m]."""
    ux = sensor.axis_x * sensor.cone_cos - turn * sensor.axis_y * sensor.cone_sin
    uy = sensor.axis_y * sensor.cone_cos + turn * sensor.axis_x * sensor.cone_sin
    return Point(sensor.x + measured * ux, sensor.y + measured * uy)


def range_variance(noise: float, resolution: float) -> float:
    """Return the variance [m2] of an echo: Gaussian ``noise`` [m] plus rounding to ``resolution`` [m] (uniform)."""
    return noise * noise + resolution * resolution / 12.0


def measurement_of(number: int, reading: float, vehicle: Pose, sensors: CarUltrasonic, noise: float) -> Measurement:
    """Return what the ``reading`` [m] of a sensor on a vehicle at pose ``vehicle`` means; ``noise`` [m] of an echo."""
    at = min(max(number, 0), MAX_SENSORS - 1)
    sensor = sensor_pose(sensors.mounts[at], sensors.half_angle, vehicle)
    variance = range_variance(noise, sensors.resolution)
    return Measurement(sensor, reading_status(reading, sensors), reading, variance, number, sensors.min_range)
