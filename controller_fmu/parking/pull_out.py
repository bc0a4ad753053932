"""Pulling out of a slot: what the sensors measure at rest as landmarks, and a pose on the road beside the slot.

A neighbour's bumper is measured at rest, its flank is not: it is taken to stand out of the row by ``MAX_STAND_OUT``
more than the vehicle. The bumper's end there is open: the monitor takes an echo near it for one of the bumper until a
sensor measures past it. The flank begins behind it, or its corner would explain such echoes. Where nothing is measured
behind the row, it ends as far off. Such landmarks are updated or contradicted on the way like all others.
"""

import math
from typing import NamedTuple

from controller_fmu.common.driver_selection import ChosenSide
from controller_fmu.parking.geometry.frames import point_from_frame
from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.map.landmark import Landmark, along_of, free_index, replace_landmark, segment_between
from controller_fmu.parking.map.params import CAR_LENGTH, CAR_WIDTH, MappingParams
from controller_fmu.parking.measurement.sensor import (
    BUMPER_SENSORS,
    FRONT_MIDDLE,
    MAX_SENSORS,
    REAR_MIDDLE,
    ReadingStatus,
    reading_status,
)
from modelkit.car import Car
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

MAX_STAND_OUT = 0.25
"""Neighbours stand out of the row by up to this [m] more than the vehicle: two standard deviations of a row."""
CLEAR_AHEAD = 4.0
"""Free distance [m] ahead with which the vehicle is out of the slot."""
ROAD_CLEARANCE = 0.3
"""Distance [m] of the vehicle on the road from the row."""


class FreeBox(NamedTuple):
    """Nearest obstacles in the vehicle's frame [m]: x ahead and behind, y left and right; beyond the range if none."""

    front: float
    rear: float
    left: float
    right: float


def free_box(readings: tuple[float, ...], car: Car) -> FreeBox:
    """Return the nearest obstacles that the sensors measure which look along or across the vehicle; readings in m.

    The others look sideways: their echoes come from that side of the cone which is nearer to a neighbour.
    """
    sensors = car.ultrasonic
    far = CAR_LENGTH + sensors.max_range
    box = FreeBox(far, -far, far, -far)
    for number in range(MAX_SENSORS):
        mount = sensors.mounts[number]
        if reading_status(readings[number], sensors) in (ReadingStatus.ECHO, ReadingStatus.BLIND_ZONE):
            x = mount.x + readings[number] * math.cos(mount.yaw)
            y = mount.y + readings[number] * math.sin(mount.yaw)
            if number in (FRONT_MIDDLE, FRONT_MIDDLE + 1):
                box = box._replace(front=min(box.front, x))
            elif number in (REAR_MIDDLE, REAR_MIDDLE + 1):
                box = box._replace(rear=max(box.rear, x))
            elif number >= BUMPER_SENSORS and mount.y > 0.0:
                box = box._replace(left=min(box.left, y))
            elif number >= BUMPER_SENSORS:
                box = box._replace(right=max(box.right, y))
    return box


def is_clear_ahead(readings: tuple[float, ...]) -> bool:
    """Return whether all sensors of the front bumper measure far enough for the driver to go on; readings in m."""
    return all(readings[number] >= CLEAR_AHEAD for number in range(BUMPER_SENSORS // 2))


def road_side(chosen: int) -> float:
    """Return on which side the road is: 1 left, -1 right; if nobody chose, traffic keeps to the right."""
    return -1.0 if chosen == ChosenSide.RIGHT else 1.0


def with_neighbours(
    landmarks: tuple[Landmark, ...], box: FreeBox, side: float, pose: Pose, car: Car, params: MappingParams
) -> tuple[Landmark, ...]:
    """Return the landmarks with what is measured of the neighbours and the row's end; ``side`` of the road: 1, -1."""
    road = side * (0.5 * car.width + MAX_STAND_OUT)
    deep = road - side * CAR_WIDTH
    far = CAR_LENGTH + car.ultrasonic.max_range
    for ahead in (1.0, -1.0):
        bumper = box.front if ahead > 0.0 else box.rear
        flank = Point(bumper + ahead * MAX_STAND_OUT, road)
        tail = Point(bumper + ahead * CAR_LENGTH, road)
        if ahead * bumper < far:
            landmarks = _with_segment(landmarks, Point(bumper, deep), Point(bumper, road), False, pose, params)
            landmarks = _with_segment(landmarks, flank, tail, True, pose, params)
    kerb = box.right if side > 0.0 else box.left
    if abs(kerb) >= far:
        kerb = -road
    return _with_segment(landmarks, Point(box.rear, kerb), Point(box.front, kerb), True, pose, params)


def pose_on_road(box: FreeBox, side: float, pose: Pose, outline: VehicleOutline) -> Pose:
    """Return the pose on the road, on its ``side`` (1 left, -1 right), of a vehicle that stands at ``pose``."""
    ahead = min(box.front, outline.centre_ahead + outline.half_length) + CAR_LENGTH - outline.centre_ahead
    point = point_from_frame(ahead, side * (2.0 * outline.half_width + MAX_STAND_OUT + ROAD_CLEARANCE), pose)
    return Pose(point.x, point.y, pose.heading)


def _with_segment(
    landmarks: tuple[Landmark, ...], a: Point, b: Point, is_closed: bool, pose: Pose, params: MappingParams
) -> tuple[Landmark, ...]:
    """Return the landmarks with the segment between two points of the vehicle's frame, known to ``MAX_STAND_OUT`` [m].

    If it is not closed its end at ``b`` is open. It takes a free place, or that of the least confirmed.
    """
    p = point_from_frame(a.x, a.y, pose)
    q = point_from_frame(b.x, b.y, pose)
    variance = 0.25 * MAX_STAND_OUT * MAX_STAND_OUT
    found = segment_between(p, q, Point(pose.x, pose.y), variance, variance)
    ends_at_b = along_of(found, q.x, q.y) > 0.0
    new = found._replace(start_known=is_closed or ends_at_b, end_known=is_closed or not ends_at_b)
    return replace_landmark(landmarks, free_index(landmarks), new._replace(confirmations=params.confirmations))
