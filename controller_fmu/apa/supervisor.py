"""The clearance supervisor: slows down and stops before anything in the way, whoever drives.

The sensors on the driven side are compared with what they should hear from the slot as it is known.
Something nearer than that by ``surprise`` is unknown and is kept away from; what is known is left to
the path, except straight ahead, where the car stops at ``stop_gap``.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.outline import Box, Obstacles, grown
from controller_fmu.apa.speed import stopping_way
from controller_fmu.interface import ControllerParams
from modelkit.car import CarUltrasonic, SensorMount
from modelkit.geometry import Box as OrientedBox
from modelkit.geometry import Point, cone_box
from modelkit.vocabulary import Pose

FREE = 100.0
STRAIGHT = 0.2
LOOKED_AT = 1.5
WRONG = 0.03
"""A corner sensor hears something known this much [m] nearer than it should: the slot is not as it was found."""
UNSURE = 0.1
WIDER = 0.1
"""The edge of a cone may touch something known that stands so much [m] further out, or lies so much [rad] beside it."""


class Sight(NamedTuple):
    """What the supervisor says."""

    speed: float = FREE
    """Largest speed [m/s] with which the car still stops in time."""
    blocked: bool = False
    unknown: bool = False
    """What blocks is not part of the slot."""


def look(
    readings: tuple[float, ...],
    pose: Pose,
    mirror: float,
    direction: int,
    speed: float,
    around: Obstacles,
    params: ControllerParams,
) -> Sight:
    """Return the sight in ``direction`` of a car at ``pose`` (slot's frame) among obstacles not grown."""
    sensors = params.car.ultrasonic
    guard = params.apa.guard
    drive = params.apa.drive
    first = 0 if direction > 0 else 4
    gap = FREE
    unknown = False
    for number in range(first, first + 4):
        reading = readings[number]
        if reading < LOOKED_AT:
            mount = sensors.mounts[number]
            should = expected(mount, pose, mirror, around, sensors)
            nearer = reading < should - guard.surprise and not _grazes(mount, reading, pose, mirror, around, params)
            ahead = abs(mount.yaw) < STRAIGHT or abs(mount.yaw) > math.pi - STRAIGHT
            left = FREE
            if nearer:
                left = reading - guard.surprise_gap
            elif ahead:
                left = reading - guard.stop_gap
            elif reading < guard.corner_gap and reading < should - WRONG:
                left = -1.0
            if left < gap:
                gap = left
                unknown = nearer
    room = gap if gap > 0.0 else 0.0
    allowed = math.sqrt(drive.brake * room)
    blocked = gap <= stopping_way(speed, drive, drive.delay)
    return Sight(allowed, blocked, blocked and unknown)


def _grazes(
    mount: SensorMount, reading: float, pose: Pose, mirror: float, around: Obstacles, params: ControllerParams
) -> bool:
    """Return whether something known explains a reading, if it stands a little further out or in a wider cone."""
    near = Obstacles(
        grown(around.behind, UNSURE),
        grown(around.ahead, UNSURE),
        grown(around.beside, UNSURE),
        grown(around.opposite, UNSURE),
    )
    return reading >= expected(mount, pose, mirror, near, params.car.ultrasonic, WIDER) - params.apa.guard.surprise


def expected(
    mount: SensorMount, pose: Pose, mirror: float, around: Obstacles, sensors: CarUltrasonic, wider: float = 0.0
) -> float:
    """Return the distance [m] that a sensor should hear from the obstacles around, at most its range.

    Its cone is taken to be wider by ``wider`` [rad] to each side.
    """
    c = math.cos(pose.heading)
    s = math.sin(pose.heading)
    y = mirror * mount.y
    at = Point(pose.x + mount.x * c - y * s, pose.y + mount.x * s + y * c)
    axis = pose.heading + mirror * mount.yaw
    half = sensors.half_angle + wider
    nearest = _smaller(sensors.max_range, _heard(at, axis, half, around.behind))
    nearest = _smaller(nearest, _heard(at, axis, half, around.ahead))
    nearest = _smaller(nearest, _heard(at, axis, half, around.beside))
    return _smaller(nearest, _heard(at, axis, half, around.opposite))


def _heard(at: Point, axis: float, half_angle: float, box: Box) -> float:
    if box.x0 > box.x1:
        return FREE
    middle = OrientedBox(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1), 0.0, box.x1 - box.x0, box.y1 - box.y0)
    return cone_box(at, axis, half_angle, middle)


def _smaller(a: float, b: float) -> float:
    return a if a < b else b
