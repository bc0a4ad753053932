"""The slot that a parked car stands in, made of what its sensors hear at standstill: the way out begins with it."""

import math
from typing import NamedTuple

from controller_fmu.apa.around.near import nearest_told
from controller_fmu.apa.outline import Shape
from controller_fmu.apa.params import ApaSystemParams
from controller_fmu.apa.signals import ApaInput
from controller_fmu.apa.slot import UNSEEN, Kind, Side, Slot, mirror_of
from controller_fmu.common.driver_selection import ChosenSide
from controller_fmu.common.sensors import LEFT_SENSOR, RIGHT_SENSOR, VALID_RANGE_FRACTION
from controller_fmu.common.slot_frame import SlotFrame, to_world
from modelkit.vocabulary import Pose

STANDS_OUT = 0.3
"""Neighbours are taken to stand out further than the car by so much [m]."""
KERB = 1.5
"""What is heard farther [m] beside the car is no kerb, and farther ahead or behind no end of the slot."""
ASKEW = 0.3
"""The readings of a flank's two sensors differ by less [m] where both are of one kerb or wall."""
FRONT = 1
REAR = 5
NARROWEST = 2.0
NARROWEST_ACROSS = 4.5
"""Streets are no narrower [m] beside a car, and before one across them: what is heard nearer is somebody."""
UNSURE = 0.015
"""What is told by the rim of a cone may be so much [m] nearer."""
NEAREST = 0.04
"""A kerb or wall is taken to be no nearer [m]."""


class HeardFlank(NamedTuple):
    """How far [m] something is beside a car, at its front sensor and at its rear one, and where along it these sit."""

    front: float
    rear: float
    x_front: float
    x_rear: float


class KerbLine(NamedTuple):
    """What stands beside the car, as a line: how far from its side at the rear axle [m], and how it falls away [1]."""

    beside: float
    slope: float


def slot_around(inputs: ApaInput, car: Shape, params: ApaSystemParams) -> Slot:
    """Return the slot around a standing car; the road is on the side that the driver chose, else on the left.

    What both sensors of that side hear near is a neighbour: the car stands across the road, its nose to it. They are
    where the sensors hear something, as far out as is likely.
    """
    right_is_road = inputs.driver_selection.side == ChosenSide.RIGHT
    road = flank_of(inputs, right_is_road, params)
    other = flank_of(inputs, not right_is_road, params)
    side = Side.LEFT if right_is_road else Side.RIGHT
    if max(road.front, road.rear) < KERB:
        return _across(road, other, side, inputs, car, params)
    return _along(road, other, side, inputs, car, params)


def _along(
    road: HeardFlank, other: HeardFlank, side: int, inputs: ApaInput, car: Shape, params: ApaSystemParams
) -> Slot:
    """Return the slot along the road: its direction is that of the kerb or wall beside, where one is heard."""
    ahead = _nearest(FRONT, inputs)
    behind = _nearest(REAR, inputs)
    far = min(road.front, road.rear)
    kerb = _line(other)
    walled = min(other.front, other.rear) < KERB
    slope = kerb.slope if walled else 0.0
    out = car.half_width + STANDS_OUT
    slot = Slot(kind=Kind.PARALLEL, side=side, length=behind + car.rear + car.front + ahead)
    mirror = mirror_of(slot)
    a = to_world(Pose(-car.rear - behind, mirror * out, -mirror * math.atan(slope)), SlotFrame(inputs.odometry, 1.0))
    depth = (out + car.half_width + kerb.beside - slope * (car.rear + behind)) * math.cos(math.atan(slope))
    return slot._replace(
        a=a,
        depth=depth if walled else UNSEEN,
        opposite=far - STANDS_OUT
        if NARROWEST < far < VALID_RANGE_FRACTION * params.car.ultrasonic.max_range
        else UNSEEN,
    )


def _across(
    road: HeardFlank, other: HeardFlank, side: int, inputs: ApaInput, car: Shape, params: ApaSystemParams
) -> Slot:
    """Return the slot across the road."""
    ahead = _nearest(FRONT, inputs)
    behind = _nearest(REAR, inputs)
    near = min(road.front, road.rear)
    far = min(other.front, other.rear)
    reach = VALID_RANGE_FRACTION * params.car.ultrasonic.max_range
    slot = Slot(kind=Kind.PERPENDICULAR, side=side, length=near + 2.0 * car.half_width + min(far, KERB))
    mirror = mirror_of(slot)
    out = car.front + STANDS_OUT
    corner = Pose(out, mirror * (car.half_width + near), -mirror * 0.5 * math.pi)
    return slot._replace(
        a=to_world(corner, SlotFrame(inputs.odometry, 1.0)),
        depth=out + car.rear + behind if behind < KERB else UNSEEN,
        opposite=ahead - STANDS_OUT if NARROWEST_ACROSS < ahead < reach else UNSEEN,
        empty_b=far >= KERB,
    )


def flank_of(inputs: ApaInput, right: bool, params: ApaSystemParams) -> HeardFlank:
    """Return what the sensors of one side hear.

    What is nearer than they tell is no nearer than what a bumper's outer sensor hears with the rim of its cone: a side
    at a distance d from it is heard at d / sin(yaw + half angle).
    """
    first = RIGHT_SENSOR if right else LEFT_SENSOR
    front = 3 if right else 0
    rear = 7 if right else 4
    mounts = params.car.ultrasonic.mounts
    return HeardFlank(
        _beside(first, front, inputs, params),
        _beside(first + 1, rear, inputs, params),
        mounts[first].x,
        mounts[first + 1].x,
    )


def _beside(number: int, corner: int, inputs: ApaInput, params: ApaSystemParams) -> float:
    """Return how far [m] something is beside the car, by a flank's sensor or by that of the bumper next to it."""
    sensors = params.car.ultrasonic
    reading = inputs.ultrasonic[number]
    if reading > nearest_told(sensors):
        return reading
    mount = sensors.mounts[corner]
    rim = math.sin(abs(math.atan2(math.sin(mount.yaw), abs(math.cos(mount.yaw)))) + sensors.half_angle)
    least = inputs.ultrasonic[corner] * rim - abs(sensors.mounts[number].y) + abs(mount.y)
    return max(NEAREST, min(reading, least - UNSURE))


def _line(heard: HeardFlank) -> KerbLine:
    """Return the line that both sensors of a flank hear, along the car if they disagree."""
    apart = heard.x_front - heard.x_rear
    slope = (heard.front - heard.rear) / apart
    if abs(heard.front - heard.rear) > ASKEW:
        return KerbLine(min(heard.front, heard.rear), 0.0)
    return KerbLine(heard.rear - slope * heard.x_rear, slope)


def _nearest(first: int, inputs: ApaInput) -> float:
    """Return the nearest distance [m] that two sensors hear: ``first`` and the next one."""
    return min(inputs.ultrasonic[first], inputs.ultrasonic[first + 1])
