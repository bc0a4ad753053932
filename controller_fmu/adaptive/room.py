"""The room around the target: neighbours, the far sides of slot and road, and what a route leaves free."""

from typing import NamedTuple

from controller_fmu.adaptive.params import RoomParams
from controller_fmu.adaptive.route import Route
from controller_fmu.common.curve import advance
from modelkit.car import Car
from modelkit.geometry import NO_HIT, Box, boxes_gap, boxes_overlap, corners, outline
from modelkit.vocabulary import Pose

LOOKED_AT = 0.2
"""Poses of a route are looked at so far [m] apart."""
NEIGHBOUR_LENGTH = 8.0


class Room(NamedTuple):
    """Neighbours as boxes in the slot's frame, and how far the outline may go aside."""

    wheelbase: float
    front_overhang: float
    rear_overhang: float
    width: float
    front: Box
    rear: Box
    lowest: float
    highest: float
    margin: float


def room_of(car: Car, params: RoomParams) -> Room:
    """Return the room, in the slot's frame."""
    middle = params.line - 0.5 * params.depth
    front = Box(params.slot_front + 0.5 * NEIGHBOUR_LENGTH, middle, 0.0, NEIGHBOUR_LENGTH, params.depth)
    rear = Box(-params.slot_rear - 0.5 * NEIGHBOUR_LENGTH, middle, 0.0, NEIGHBOUR_LENGTH, params.depth)
    return Room(
        car.wheelbase,
        car.front_overhang,
        car.rear_overhang,
        car.width,
        front,
        rear,
        params.line - params.depth,
        params.line + params.road,
        params.margin,
    )


def room_at(pose: Pose, room: Room) -> float:
    """Return the least distance [m] of a car at ``pose`` to all that is around; negative beyond a far side."""
    car = outline(pose, room.wheelbase, room.front_overhang, room.rear_overhang, room.width)
    around = corners(car)
    ys = (around.front_left.y, around.front_right.y, around.rear_left.y, around.rear_right.y)
    aside = min(min(ys) - room.lowest, room.highest - max(ys))
    if boxes_overlap(car, room.front) or boxes_overlap(car, room.rear):
        return -1.0
    return min(aside, boxes_gap(car, room.front), boxes_gap(car, room.rear))


def room_along(route: Route, room: Room, enough: float) -> float:
    """Return the least distance [m] along a route; as soon as it is below ``enough`` that of the first such pose."""
    direction = float(route.direction)
    pose = route.start
    least = NO_HIT
    for piece in route.pieces:
        if piece.length > 0.0:
            steps = int(piece.length / LOOKED_AT) + 1
            for number in range(1, steps + 1):
                s = piece.length * number / steps
                k = piece.k0 + (piece.k1 - piece.k0) * number / steps
                gap = room_at(advance(pose, direction, s, piece.k0, k), room)
                least = min(least, gap)
                if least < enough:
                    return least
            pose = advance(pose, direction, piece.length, piece.k0, piece.k1)
    return least
