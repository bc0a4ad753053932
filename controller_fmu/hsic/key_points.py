"""Key points P1 to P4 from the car and the slot, in the slot's frame: P4 is the origin."""

import math
from typing import NamedTuple

from controller_fmu.common.arc_line_arc import arc_line_arc
from controller_fmu.common.slot_clearance import SlotBounds
from controller_fmu.hsic.params import HsicSlot
from modelkit.car import Car
from modelkit.vocabulary import Pose

FAR_SIDE = 1e3
"""y [m] of the road's other side: not regarded."""


class KeyPoints(NamedTuple):
    """Ready point, two turning points on the common tangent, and how far the car may go in the slot."""

    p1: Pose = Pose()
    p2: Pose = Pose()
    p3: Pose = Pose()
    radius: float = 1.0
    found: bool = False
    rearmost: float = 0.0
    """Smallest x [m] of the rear axle in the slot."""
    foremost: float = 0.0
    """Largest x [m] of the rear axle in the slot."""


def slot_bounds(slot: HsicSlot, car: Car) -> SlotBounds:
    """Return the lines of the slot; the other side of the road is not known."""
    rear = -car.rear_overhang - slot.rear_gap
    return SlotBounds(True, rear + slot.slot_length, rear, 0.5 * slot.slot_width, FAR_SIDE)


def ready_point(slot: HsicSlot, car: Car, radius: float) -> Pose:
    """Return P1: parallel, ``ready_gap`` beside the neighbour, tail level with the slot's front end.

    At P4 the car stands ``rear_gap`` ahead of the slot's rear end. Where tail-level is too near for
    two arcs of ``radius`` (S^2 + H^2 < 4 H R) the point lies as far ahead as they need.
    """
    y = slot.ready_gap + 0.5 * (slot.slot_width + car.width)
    x = slot.slot_length - slot.rear_gap
    need = 4.0 * y * radius - y * y
    if need > x * x:
        x = math.sqrt(need) * 1.001
    return Pose(x, y, 0.0)


def key_points(start: Pose, slot: HsicSlot, car: Car, radius: float) -> KeyPoints:
    """Return the key points of the way from ``start`` (taken as P1, parallel) to the origin.

    P2 and P3 are the ends of the common tangent of two arcs of ``radius`` [m].
    """
    arcs = arc_line_arc(start.x, start.y, radius)
    sin = math.sin(arcs.angle)
    cos = math.cos(arcs.angle)
    p3 = Pose(radius * sin, radius * (1.0 - cos), arcs.angle)
    p2 = Pose(p3.x + arcs.line * cos, p3.y + arcs.line * sin, arcs.angle)
    ahead = slot.slot_length - slot.rear_gap - car.front_overhang - car.wheelbase - car.rear_overhang - slot.end_gap
    behind = slot.rear_gap - slot.end_gap
    foremost = ahead if ahead > 0.0 else 0.0
    rearmost = -behind if behind > 0.0 else 0.0
    found = arcs.line >= 0.0 and arcs.angle > 0.0
    return KeyPoints(start, p2, p3, radius, found, rearmost, foremost)
