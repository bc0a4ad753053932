"""How far a car may go beside what is heard near it, wherever in its cone that may be and whatever the map has.

An echo tells how far something is, not where: it may come from anywhere on an arc. Five points of each arc are driven
past in thought, in the frame of the car. What this says slows the car down and never stops it, so that what is found
at last to be elsewhere than thought is found while the car can still be stopped.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.around.cone import ear_of, rim_point
from controller_fmu.apa.around.course import HeldCourse, after
from controller_fmu.apa.outline import Shape
from modelkit.car import CarUltrasonic
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

NEAR = 0.9
"""Echoes from farther away [m] are not looked at."""
CLOSE = 0.1
"""Nearer than this [m] is close: what is heard may go on beside the cone."""
NEARER = 0.004
"""A car that comes nearer by less [m] than this drives along something, not to it."""
WAYS = (0.1, 0.2, 0.3, 0.45, 0.6)
SHARES = (-1.0, -0.5, 0.0, 0.5, 1.0)
FREE = 100.0
"""Room [m], and speed [m/s], where nothing is near."""


class FurtherOn(NamedTuple):
    """Where the car is a way further on, in the frame of where it is now."""

    x: float
    y: float
    c: float
    """Cosine and sine of its heading."""
    s: float


def room_by_echoes(readings: tuple[float, ...], course: HeldCourse, mirror: float, sensors: CarUltrasonic) -> float:
    """Return how far [m] the outline can go on its ``course`` before it may come close to what any sensor hears."""
    lowest = nearest_told(sensors)
    heard = False
    for reading in readings:
        heard = heard or reading < NEAR
    if not heard:
        return FREE
    here = course._replace(pose=Pose(0.0, 0.0, 0.0))
    poses = tuple(_further_on(here, way) for way in WAYS)
    room = FREE
    for number in range(12):
        reading = readings[number]
        if reading < NEAR:
            mount = sensors.mounts[number]
            ear = ear_of(mount.x, mirror * mount.y, mirror * mount.yaw, sensors.half_angle)
            close = CLOSE if reading > lowest else reading - 0.02
            for share in SHARES:
                room = min(room, _room_beside(rim_point(ear, share, reading), close, poses, course.car))
    return room


def _further_on(course: HeldCourse, way: float) -> FurtherOn:
    pose = after(course, way)
    return FurtherOn(pose.x, pose.y, math.cos(pose.heading), math.sin(pose.heading))


def _room_beside(point: Point, close: float, poses: tuple[FurtherOn, ...], car: Shape) -> float:
    """Return how far [m] a car may go before it is nearer than ``close`` to a point, and nearer than now."""
    now = _gap(point, car)
    room = 0.0
    for number in range(len(WAYS)):
        pose = poses[number]
        dx = point.x - pose.x
        dy = point.y - pose.y
        there = _gap(Point(dx * pose.c + dy * pose.s, dy * pose.c - dx * pose.s), car)
        if there < close and there < now - NEARER:
            return room
        room = WAYS[number]
    return FREE


def _gap(point: Point, car: Shape) -> float:
    """Return the distance [m] of a point in the car's frame to its outline; 0 within."""
    x = max(0.0, max(point.x - car.front, -car.rear - point.x))
    y = max(0.0, abs(point.y) - car.half_width)
    return math.sqrt(x * x + y * y)


def nearest_told(sensors: CarUltrasonic) -> float:
    """Return the distance [m] above which a reading is one: the nearest told says that something is nearer still."""
    return sensors.min_range + 1.1 * sensors.resolution
