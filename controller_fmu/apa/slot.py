"""A slot as found or given, its target, and what stands around it, in the frame of the target.

The slot's own frame (A's frame): origin at corner A, the edge passed first; x along the road towards
corner B; y out of the slot. A slot on the left is mirrored, so that it lies at y < 0 as well.
The target's frame has x along the parked heading: along the road (parallel), or out of the slot
(perpendicular, parked in reverse).
"""

import math
from enum import IntEnum
from typing import Annotated, NamedTuple

from controller_fmu.apa.outline import FAR, Box, Obstacles, Shape, grown, turned_box
from controller_fmu.common.slot_frame import SlotFrame, to_world
from modelkit.signal import Group, Signal
from modelkit.vocabulary import ANYWHERE, Pose


class Kind(IntEnum):
    """How a car stands in a slot."""

    NONE = 0
    PARALLEL = 1
    PERPENDICULAR = 2


class Side(IntEnum):
    """Where a slot lies, seen along the road from A to B."""

    RIGHT = 0
    LEFT = 1


UNSEEN = 50.0
REACH_PARALLEL = 8.0
REACH_PERPENDICULAR = 5.0
DEEP_DOWN = 30.0
"""A neighbour, and the row that it stands in, are taken to be so long along the road [m], and so deep."""
LESS_BESIDE = 0.01
"""The margin to kerb or wall is taken this much [m] smaller, so that a target at that margin is free."""
BEHIND = 0.08
"""A perpendicular slot's wall or wheel stop is left so far [m] behind the car at least."""
OUT_OF_LINE = 0.8
"""Neighbours of whom one stands so much [m] further out than the other make no line."""
DEEPER = 0.2
"""Where nothing is heard behind a perpendicular slot no move goes more than so far [m] deeper than the car is to stand:
wheel stops lower than 8 cm are not heard."""
LESS_OUT = 0.02
"""A move into a perpendicular slot ends so much [m] deeper than it need to be."""


class Slot(NamedTuple):
    """Corners and extents; the defaults are a slot that is not there."""

    kind: Annotated[int, Signal("1", "how the car will stand", states=Kind)] = Kind.NONE
    side: Annotated[int, Signal("1", "side of the road", states=Side)] = Side.RIGHT
    a: Annotated[Pose, Group("corner A in the world, heading along the road", ANYWHERE)] = Pose()
    length: Annotated[float, Signal("m", "corner A to corner B along the road", 0.0, 1e4)] = 0.0
    b_out: Annotated[float, Signal("m", "how far corner B stands out further than corner A", -1e3, 1e3)] = 0.0
    depth: Annotated[float, Signal("m", "corner A to the kerb or wall; 50: none seen", 0.0, 1e4)] = UNSEEN
    opposite: Annotated[float, Signal("m", "corner A to what lies across the road; 50: none seen", 0.0, 1e4)] = UNSEEN
    unsure: Annotated[float, Signal("m", "each corner may lie this much further in than it was found", 0.0, 10.0)] = 0.0
    skew_a: Annotated[
        float, Signal("rad", "heading of corner A's neighbour against the slot's, mirrored on the left", -1.6, 1.6)
    ] = 0.0
    skew_b: Annotated[float, Signal("rad", "the same of the neighbour at corner B", -1.6, 1.6)] = 0.0
    empty_a: Annotated[bool, Signal("1", "nobody stands at corner A: it is a line, kept clear all the same")] = False
    empty_b: Annotated[bool, Signal("1", "nobody stands at corner B")] = False
    line: Annotated[
        float, Signal("m", "a parked car stands so much further out than flush with the corners", -1e3, 1e3)
    ] = 0.0


class Site(NamedTuple):
    """A slot as the planner sees it: frame of the target, obstacles grown by the margin, where x may end."""

    kind: int = Kind.PARALLEL
    frame: SlotFrame = SlotFrame()
    obstacles: Obstacles = Obstacles()
    x_low: float = 0.0
    x_high: float = 0.0


class Margins(NamedTuple):
    """Distances [m] kept to the neighbours and to the kerb or wall, and how far inside the line to park."""

    neighbour: float = 0.2
    beside: float = 0.1
    inset: float = 0.0
    out: float = 0.14
    """Farthest [m] that a parked car stands out of the line."""
    wall: float = 0.0
    """Distance [m] kept to kerb or wall on the way into a parallel slot where the parked car leaves as much."""


def mirror_of(slot: Slot) -> float:
    """Return 1 for a slot on the right, -1 on the left."""
    return -1.0 if slot.side == Side.LEFT else 1.0


class Opening(NamedTuple):
    """From where to where [m] along the road a slot is free as deep as a car stands in it."""

    low: float
    high: float


def room_of(slot: Slot, deep: float) -> Opening:
    """Return the room [m] along the road between two neighbours that may lean into the slot, ``deep`` [m] in it."""
    return Opening(max(0.0, deep * math.sin(slot.skew_a)), slot.length + min(0.0, deep * math.sin(slot.skew_b)))


def flush_with(kind: int, b_out: float) -> float:
    """Return y [m] half way between the corners at the mouth, of which B stands out ``b_out`` [m] further.

    Across the road it is the corner further in where the other has come out of the row by so much that it is none.
    """
    if kind == Kind.PERPENDICULAR and abs(b_out) > OUT_OF_LINE:
        return min(0.0, b_out)
    return 0.5 * b_out


def line_of(slot: Slot) -> float:
    """Return y [m] of the line that a parked car stands flush with."""
    return flush_with(slot.kind, slot.b_out) + slot.line


def target_of(slot: Slot, car: Shape, margins: Margins) -> Pose:
    """Return the pose to park at, in A's frame."""
    line = line_of(slot) - margins.inset
    if slot.kind == Kind.PERPENDICULAR:
        room = room_of(slot, car.front + car.rear)
        y = line - car.front
        lowest = car.rear + max(margins.neighbour, BEHIND) - slot.depth
        return Pose(0.5 * (room.low + room.high), lowest if y < lowest else y, 0.5 * math.pi)
    room = room_of(slot, 2.0 * car.half_width)
    y = line - car.half_width
    lowest = car.half_width + margins.beside - slot.depth
    return Pose(0.5 * (room.low + room.high - car.front - car.rear) + car.rear, lowest if y < lowest else y, 0.0)


def no_deeper(slot: Slot, car: Shape, margins: Margins) -> Slot:
    """Return the slot that ends not far behind a car that stands across the road in it, if no end of it is heard."""
    if slot.kind != Kind.PERPENDICULAR or slot.depth < UNSEEN:
        return slot
    needed = car.front + car.rear + margins.inset - line_of(slot) + max(margins.neighbour, BEHIND)
    return slot._replace(depth=needed + DEEPER)


def stands_out_by(pose: Pose, slot: Slot, car: Shape) -> float:
    """Return how far [m] a car at ``pose`` (A's frame) stands out of the line between its neighbours' corners."""
    c = math.cos(pose.heading)
    s = math.sin(pose.heading)
    ahead = max(car.front * s, -car.rear * s)
    return pose.y + ahead + car.half_width * abs(c) - line_of(slot)


def site_of(slot: Slot, car: Shape, margins: Margins) -> Site:
    """Return the slot in the frame of its target."""
    target = target_of(slot, car, margins)
    frame = SlotFrame(to_world(target, SlotFrame(slot.a, mirror_of(slot))), mirror_of(slot))
    x = target.x
    y = target.y
    turned = slot.kind == Kind.PERPENDICULAR
    reach = REACH_PERPENDICULAR if turned else REACH_PARALLEL
    behind = turned_box(Box(-reach, slot.unsure, -DEEP_DOWN, 0.0), 0.0, 0.0, slot.skew_a)
    ahead = turned_box(Box(-slot.unsure, reach, -DEEP_DOWN, 0.0), slot.length, slot.b_out, slot.skew_b)
    beside = Box(-FAR, FAR, -FAR, -slot.depth) if slot.depth < UNSEEN else Box()
    opposite = Box(-FAR, FAR, slot.opposite, FAR) if slot.opposite < UNSEEN else Box()
    near = margins.neighbour
    left = y - car.half_width + slot.depth
    beside_margin = margins.neighbour if turned else max(margins.beside, min(margins.wall, left))
    obstacles = Obstacles(
        grown(_seen_from(behind, x, y, turned), near),
        grown(_seen_from(ahead, x, y, turned), near),
        grown(_seen_from(beside, x, y, turned), beside_margin - LESS_BESIDE),
        grown(_seen_from(opposite, x, y, turned), near),
    )
    if turned:
        most = margins.out - LESS_OUT - stands_out_by(target, slot, car)
        return Site(slot.kind, frame, obstacles, -0.05, most if most < 0.1 else 0.1)
    room = room_of(slot, 2.0 * car.half_width)
    slack = 0.5 * (room.high - room.low - car.front - car.rear) - near - slot.unsure
    slack = slack - 0.01 if slack > 0.01 else 0.0
    return Site(slot.kind, frame, obstacles, -slack, slack)


def shortest_for_one_move(car: Shape, inner_radius: float, depth: float) -> float:
    """Return L_min [m] = r + sqrt(2 (R_min + d) B_y + l^2 - B_y^2) of the source.

    r rear overhang, R_min the inner rear wheel's turning radius, d the width, l nose to rear axle,
    B_y how deep the car stands behind corner B. The corner of the nose, at radius
    sqrt((R_min + d)^2 + l^2), passes corner B, which lies R_min + d - B_y from the centre.
    """
    width = 2.0 * car.half_width
    under = 2.0 * (inner_radius + width) * depth + car.front * car.front - depth * depth
    return car.rear + (math.sqrt(under) if under > 0.0 else 0.0)


def _seen_from(box: Box, x: float, y: float, turned: bool) -> Box:
    """Return a box of A's frame in the frame of a target at (x, y), which is ``turned`` by 90 deg or not."""
    if box.x0 > box.x1:
        return box
    dx = box.x - x
    dy = box.y - y
    if turned:
        return box._replace(x=dy, y=-dx, cos=box.sin, sin=-box.cos)
    return box._replace(x=dx, y=dy)
