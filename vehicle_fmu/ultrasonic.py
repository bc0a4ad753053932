"""Twelve ultrasonic sensors: distance to the nearest surface inside each cone.

Numbers: 1 to 4 front, from left to right; 5 to 8 rear, from left to right; 9 front left side,
10 rear left side; 11 front right side, 12 rear right side. A reading of ``max_range`` means that
there was no echo; nothing reads less than ``min_range``. All sensors measure together, every
``cycle``: the exact distance, plus noise, rounded to the resolution, or lost. With its seed, a
run repeats to the bit.
"""

import math
from typing import Annotated, NamedTuple

from modelkit.car import CarUltrasonic, SensorMount
from modelkit.geometry import (
    Box,
    Cone,
    Corners,
    OrientedBox,
    Point,
    box_corners,
    cone_gap,
    line_box,
    orient,
    reach,
)
from modelkit.maths import clamp
from modelkit.random import normal, seed_state, uniform
from modelkit.signal import Role, Signal
from modelkit.vocabulary import Pose
from vehicle_fmu.scene import HOUSE, SceneParams, is_there, obstacle_box


class UltrasonicParams(NamedTuple):
    """What spoils the readings; noise and dropout are off by default. The rest is in ``car.ultrasonic``."""

    noise: Annotated[float, Signal("m", "standard deviation of a measurement", 0.0, 10.0, HOUSE), Role.TUNABLE] = 0.0
    dropout: Annotated[float, Signal("1", "probability that a measurement is lost", 0.0, 1.0, HOUSE), Role.TUNABLE] = (
        0.0
    )
    kerb_height: Annotated[float, Signal("m", "kerbs and boxes lower than this are not detected", 0.0, 10.0, HOUSE)] = (
        0.08
    )
    seed: Annotated[int, Signal("1", "seed of noise and dropout", 0, 2147483647)] = 1


class RangeSensor(NamedTuple):
    """What turns an exact distance into a reading."""

    min_range: float
    max_range: float
    resolution: float
    noise: float
    dropout: float


class UltrasonicState(NamedTuple):
    """Readings held until the next cycle, and the random generator."""

    readings: tuple[float, ...] = (0.0,) * 12
    random: int = 1


def first_readings(pose: Pose, scene: SceneParams, sensors: CarUltrasonic, params: UltrasonicParams) -> UltrasonicState:
    """Return the readings [m] at time zero."""
    return measure(UltrasonicState(random=seed_state(params.seed)), pose, scene, sensors, params, 0)


def is_due(before_ns: int, now_ns: int, cycle: float) -> bool:
    """Return whether a multiple of ``cycle`` [s] lies in (before, now]."""
    cycle_ns = int(cycle * 1e9 + 0.5)
    return now_ns // cycle_ns > before_ns // cycle_ns


def measure(
    state: UltrasonicState,
    pose: Pose,
    scene: SceneParams,
    sensors: CarUltrasonic,
    params: UltrasonicParams,
    time_ns: int,
) -> UltrasonicState:
    """Return new readings [m] of all sensors of a car at ``pose``."""
    random = state.random
    sensor = RangeSensor(sensors.min_range, sensors.max_range, sensors.resolution, params.noise, params.dropout)
    readings = state.readings
    for distance in range_measurements(pose, scene, sensors, params.kerb_height, time_ns):
        random, reading = _reading(random, distance, sensor)
        readings = readings[1:] + (reading,)
    return UltrasonicState(readings, random)


def range_measurements(
    pose: Pose, scene: SceneParams, sensors: CarUltrasonic, kerb_height: float, time_ns: int
) -> tuple[float, ...]:
    """Return the exact distance [m] from each sensor to the nearest thing in its cone, at most ``max_range``."""
    distances: tuple[float, ...] = (sensors.max_range,) * 12
    ahead = Point(math.cos(pose.heading), math.sin(pose.heading))
    side = Point(math.sin(sensors.half_angle), math.cos(sensors.half_angle))
    for obstacle in scene.boxes:
        if is_there(obstacle, time_ns) and obstacle.height >= kerb_height:
            distances = _hear(distances, pose, ahead, sensors, side, obstacle_box(obstacle, time_ns))
    for kerb in scene.kerbs:
        if kerb.height > 0.0 and kerb.height >= kerb_height:
            line = line_box(kerb.x1, kerb.y1, kerb.x2, kerb.y2)
            distances = _hear(distances, pose, ahead, sensors, side, line)
    return distances


class ScannedBox(NamedTuple):
    """A box of the scene with all that the sensors share of it."""

    box: OrientedBox
    corners: Corners
    radius: float
    """Of the circle around it [m]."""


def _hear(
    distances: tuple[float, ...], pose: Pose, ahead: Point, sensors: CarUltrasonic, side: Point, box: Box
) -> tuple[float, ...]:
    turned = orient(box)
    seen = ScannedBox(turned, box_corners(turned), reach(box.length, box.width))
    return tuple(
        _nearer(nearest, pose, ahead, mount, side, seen)
        for nearest, mount in zip(distances, sensors.mounts, strict=True)
    )


def _nearer(nearest: float, pose: Pose, ahead: Point, mount: SensorMount, side: Point, seen: ScannedBox) -> float:
    """Return the smaller of ``nearest`` and what one sensor hears of a box.

    ``ahead``: the car's unit vector; ``side``: sine and cosine of half the cone's angle.
    """
    start = Point(
        pose.x + mount.x * ahead.x - mount.y * ahead.y,
        pose.y + mount.x * ahead.y + mount.y * ahead.x,
    )
    dx = seen.box.x - start.x
    dy = seen.box.y - start.y
    far = nearest + seen.radius
    if dx * dx + dy * dy >= far * far:
        return nearest
    direction = pose.heading + mount.yaw
    cone = Cone(start, Point(math.cos(direction), math.sin(direction)), side)
    return min(nearest, cone_gap(cone, seen.box, seen.corners))


def _reading(random: int, distance: float, sensor: RangeSensor) -> tuple[int, float]:
    """Return the generator and a reading; with neither noise nor dropout no random number is taken."""
    chance = 1.0
    error = 0.0
    if sensor.noise > 0.0 or sensor.dropout > 0.0:
        random, chance = uniform(random)
        random, error = normal(random)
    if chance < sensor.dropout or distance >= sensor.max_range:
        return random, sensor.max_range
    reading = distance + sensor.noise * error
    if sensor.resolution > 0.0:
        reading = sensor.resolution * math.floor(reading / sensor.resolution + 0.5)
    return random, clamp(reading, sensor.min_range, sensor.max_range)
