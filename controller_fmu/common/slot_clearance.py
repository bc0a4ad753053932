"""Whether a car keeps clear of the two neighbours of a parallel slot and of the aisle's other side.

Slot frame: the target is the origin, x along the slot. A neighbour fills everything below the slot's open side and
beyond one of its ends, so a car touches it if one of the car's corners is in there, or its corner in the car.
"""

import math
from typing import NamedTuple

from modelkit.car import Car
from modelkit.vocabulary import Pose


class SlotBounds(NamedTuple):
    """Lines that the outline keeps behind [m]; a slot of no length is unknown, and bounds nothing."""

    known: bool = False
    front: float = 0.0
    """x of the slot's front end."""
    rear: float = 0.0
    opening: float = 0.0
    """y of the neighbours' side."""
    far: float = 0.0
    """y of the aisle's other side."""


class Outline(NamedTuple):
    """The car's rectangle about its rear-axle midpoint [m]."""

    front: float = 0.0
    rear: float = 0.0
    half_width: float = 0.0


def outline_of(car: Car) -> Outline:
    """Return the car's rectangle."""
    return Outline(car.wheelbase + car.front_overhang, car.rear_overhang, 0.5 * car.width)


def is_pose_clear(pose: Pose, car: Outline, slot: SlotBounds) -> bool:
    """Return whether a car at ``pose`` (slot frame) touches neither neighbour nor the aisle's other side."""
    c = math.cos(pose.heading)
    s = math.sin(pose.heading)
    for along in (car.front, -car.rear):
        for aside in (car.half_width, -car.half_width):
            x = pose.x + along * c - aside * s
            y = pose.y + along * s + aside * c
            if y > slot.far or (y < slot.opening and (x > slot.front or x < slot.rear)):
                return False
    for end in (slot.front, slot.rear):
        ahead = (end - pose.x) * c + (slot.opening - pose.y) * s
        left = (slot.opening - pose.y) * c - (end - pose.x) * s
        if -car.rear < ahead < car.front and abs(left) < car.half_width:
            return False
    return True
