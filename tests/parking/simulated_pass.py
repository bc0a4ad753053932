"""A vehicle that drives past boxes: true echoes from the exact geometry, noise from numpy, odometry with drift."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from modelkit.car import Car, CarUltrasonic
from modelkit.geometry import Box, Point, box_corners, cone_gap, cone_of, orient
from modelkit.vocabulary import Pose

CAR = Car()


class Odometry(NamedTuple):
    """Systematic and random odometry errors."""

    scale: float = 0.0
    drift: float = 0.0
    """Heading error [rad/m]."""


PERFECT = Odometry()


def exact_ranges(pose: Pose, boxes: list[Box], sensors: CarUltrasonic) -> list[float]:
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    found = []
    for mount in sensors.mounts:
        at = Point(pose.x + mount.x * c - mount.y * s, pose.y + mount.x * s + mount.y * c)
        cone = cone_of(at, pose.heading + mount.yaw, sensors.half_angle)
        ranges = [cone_gap(cone, orient(box), box_corners(orient(box))) for box in boxes]
        found.append(min([sensors.max_range, *ranges]))
    return found


def drive_past(
    boxes: list[Box],
    start: Pose,
    distance: float,
    seed: int,
    noise: float = 0.01,
    dropout: float = 0.02,
    speed: float = 2.0,
    odometry: Odometry = PERFECT,
) -> Iterator[tuple[Pose, Pose, tuple[float, ...]]]:
    """Yield (true pose, odometry pose, readings) every 40 ms of a straight drive."""
    rng = np.random.default_rng(seed)
    sensors = CAR.ultrasonic
    step = speed * sensors.cycle
    true, believed = start, start
    for _ in range(int(distance / step)):
        true = Pose(true.x + step * math.cos(true.heading), true.y + step * math.sin(true.heading), true.heading)
        heading = believed.heading + odometry.drift * step
        way = step * (1.0 + odometry.scale)
        believed = Pose(believed.x + way * math.cos(heading), believed.y + way * math.sin(heading), heading)
        readings = []
        for exact in exact_ranges(true, boxes, sensors):
            if exact >= sensors.max_range or rng.random() < dropout:
                readings.append(sensors.max_range)
                continue
            value = exact + noise * rng.standard_normal()
            value = sensors.resolution * math.floor(value / sensors.resolution + 0.5)
            readings.append(min(max(value, sensors.min_range), sensors.max_range))
        yield true, believed, tuple(readings)
