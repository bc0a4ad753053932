"""Oriented boxes in the plane: a car's outline, obstacles, kerbs (a box of no width); gaps, rays, cones.

A distance that does not exist is ``FAR``. Boxes touch when their gap is 0; they overlap when
their insides share a point.
"""

import math
from typing import Annotated, NamedTuple

from modelkit.maths import clamp
from modelkit.signal import Signal
from modelkit.vocabulary import Pose

FAR = 1e9
"""A distance [m] at which there is nothing."""


class Box(NamedTuple):
    """An oriented rectangle about its centre; length 0 and width 0: a point."""

    x: Annotated[float, Signal("m", "x of the centre")] = 0.0
    y: Annotated[float, Signal("m", "y of the centre")] = 0.0
    heading: Annotated[float, Signal("rad", "direction of the length, counter-clockwise from x")] = 0.0
    length: Annotated[float, Signal("m", "length, >= 0", 0.0)] = 0.0
    width: Annotated[float, Signal("m", "width, >= 0", 0.0)] = 0.0


class Point(NamedTuple):
    """A point in the plane [m]."""

    x: float
    y: float


class Corners(NamedTuple):
    """Corners of a box [m], counter-clockwise from the front left one."""

    front_left: Point
    rear_left: Point
    rear_right: Point
    front_right: Point


def outline(pose: Pose, wheelbase: float, front_overhang: float, rear_overhang: float, width: float) -> Box:
    """Return the box around a car whose rear-axle midpoint is at ``pose``."""
    length = rear_overhang + wheelbase + front_overhang
    ahead = 0.5 * length - rear_overhang
    return Box(
        pose.x + ahead * math.cos(pose.heading), pose.y + ahead * math.sin(pose.heading), pose.heading, length, width
    )


def line_box(x1: float, y1: float, x2: float, y2: float) -> Box:
    """Return the straight line between two points [m] as a box of no width."""
    dx = x2 - x1
    dy = y2 - y1
    length = math.sqrt(dx * dx + dy * dy)
    heading = math.atan2(dy, dx) if length > 0.0 else 0.0
    return Box(0.5 * (x1 + x2), 0.5 * (y1 + y2), heading, length, 0.0)


def corners(box: Box) -> Corners:
    """Return the four corners of ``box``."""
    cos = math.cos(box.heading)
    sin = math.sin(box.heading)
    ax = 0.5 * box.length * cos
    ay = 0.5 * box.length * sin
    bx = -0.5 * box.width * sin
    by = 0.5 * box.width * cos
    return Corners(
        Point(box.x + ax + bx, box.y + ay + by),
        Point(box.x - ax + bx, box.y - ay + by),
        Point(box.x - ax - bx, box.y - ay - by),
        Point(box.x + ax - bx, box.y + ay - by),
    )


def point_gap(point: Point, box: Box) -> float:
    """Return the distance [m] from ``point`` to ``box``; 0 inside."""
    dx = point.x - box.x
    dy = point.y - box.y
    cos = math.cos(box.heading)
    sin = math.sin(box.heading)
    along = abs(dx * cos + dy * sin) - 0.5 * box.length
    across = abs(dy * cos - dx * sin) - 0.5 * box.width
    along = along if along > 0.0 else 0.0
    across = across if across > 0.0 else 0.0
    return math.sqrt(along * along + across * across)


def boxes_overlap(a: Box, b: Box) -> bool:
    """Return whether the insides of two boxes share a point (separating axes; touching is not sharing)."""
    return _overlap_along(a, b) and _overlap_along(b, a)


def boxes_gap(a: Box, b: Box) -> float:
    """Return the distance [m] between two boxes; 0 where they touch or overlap.

    Two rectangles apart are nearest at a corner of one of them.
    """
    if boxes_overlap(a, b):
        return 0.0
    return _smaller(_corners_gap(corners(a), b), _corners_gap(corners(b), a))


def boxes_depth(a: Box, b: Box) -> float:
    """Return the penetration depth [m] of two boxes: the shortest move that parts them; 0 where they do not overlap.

    The least overlap along the four directions of their sides (separating axis theorem).
    """
    depth = _smaller(_depth_along(a, b), _depth_along(b, a))
    return depth if depth > 0.0 else 0.0


def centre_gap(a: Box, b: Box) -> float:
    """Return a distance [m] that the gap of two boxes is never less than: that of the circles around them."""
    dx = a.x - b.x
    dy = a.y - b.y
    gap = math.sqrt(dx * dx + dy * dy) - reach(a) - reach(b)
    return gap if gap > 0.0 else 0.0


def reach(box: Box) -> float:
    """Return the distance [m] from the centre of ``box`` to its corners."""
    return 0.5 * math.sqrt(box.length * box.length + box.width * box.width)


def ray_box(start: Point, direction: float, box: Box) -> float:
    """Return the distance [m] along the ray of angle ``direction`` [rad] to ``box``; 0 from inside, or ``FAR``."""
    cos = math.cos(box.heading)
    sin = math.sin(box.heading)
    dx = start.x - box.x
    dy = start.y - box.y
    turn = direction - box.heading
    first = _slab(dx * cos + dy * sin, math.cos(turn), 0.5 * box.length)
    second = _slab(dy * cos - dx * sin, math.sin(turn), 0.5 * box.width)
    enter = first.x if first.x > second.x else second.x
    leave = first.y if first.y < second.y else second.y
    if enter > leave or leave < 0.0:
        return FAR
    return enter if enter > 0.0 else 0.0


def cone_box(start: Point, direction: float, half_angle: float, box: Box) -> float:
    """Return the distance [m] from ``start`` to the part of ``box`` inside a cone; 0 from inside the box, or ``FAR``.

    The cone opens by ``half_angle`` [rad], in (0, pi/2), to both sides of ``direction`` [rad].
    """
    if point_gap(start, box) == 0.0:
        return 0.0
    cos = math.cos(direction)
    sin = math.sin(direction)
    around = corners(box)
    a = _seen_from(around.front_left, start, cos, sin)
    b = _seen_from(around.rear_left, start, cos, sin)
    c = _seen_from(around.rear_right, start, cos, sin)
    d = _seen_from(around.front_right, start, cos, sin)
    side = Point(math.sin(half_angle), math.cos(half_angle))
    nearest = _smaller(_side_in_cone(a, b, side), _side_in_cone(b, c, side))
    return _smaller(nearest, _smaller(_side_in_cone(c, d, side), _side_in_cone(d, a, side)))


def cone_line(start: Point, direction: float, half_angle: float, a: Point, b: Point) -> float:
    """Return the distance [m] to the part of the line a-b inside a cone, or ``FAR``; see ``cone_box``."""
    cos = math.cos(direction)
    sin = math.sin(direction)
    side = Point(math.sin(half_angle), math.cos(half_angle))
    return _side_in_cone(_seen_from(a, start, cos, sin), _seen_from(b, start, cos, sin), side)


def _overlap_along(a: Box, b: Box) -> bool:
    """Return whether the boxes overlap seen along both axes of ``a``."""
    cos = math.cos(a.heading)
    sin = math.sin(a.heading)
    dx = b.x - a.x
    dy = b.y - a.y
    turn = b.heading - a.heading
    cos_turn = abs(math.cos(turn))
    sin_turn = abs(math.sin(turn))
    along = 0.5 * (a.length + b.length * cos_turn + b.width * sin_turn)
    across = 0.5 * (a.width + b.length * sin_turn + b.width * cos_turn)
    return abs(dx * cos + dy * sin) < along and abs(dy * cos - dx * sin) < across


def _depth_along(a: Box, b: Box) -> float:
    """Return the lesser overlap [m] of the boxes seen along the two axes of ``a``; negative where they are apart."""
    cos = math.cos(a.heading)
    sin = math.sin(a.heading)
    dx = b.x - a.x
    dy = b.y - a.y
    turn = b.heading - a.heading
    cos_turn = abs(math.cos(turn))
    sin_turn = abs(math.sin(turn))
    along = 0.5 * (a.length + b.length * cos_turn + b.width * sin_turn)
    across = 0.5 * (a.width + b.length * sin_turn + b.width * cos_turn)
    return _smaller(along - abs(dx * cos + dy * sin), across - abs(dy * cos - dx * sin))


def _corners_gap(around: Corners, box: Box) -> float:
    left = _smaller(point_gap(around.front_left, box), point_gap(around.rear_left, box))
    return _smaller(left, _smaller(point_gap(around.rear_right, box), point_gap(around.front_right, box)))


def _slab(offset: float, rate: float, half: float) -> Point:
    """Return where a ray enters and leaves the strip |offset + t rate| <= half, as (t, t)."""
    if abs(rate) < 1e-12:
        return Point(-FAR, FAR) if abs(offset) <= half else Point(FAR, -FAR)
    one = (-half - offset) / rate
    other = (half - offset) / rate
    return Point(one, other) if one < other else Point(other, one)


def _seen_from(point: Point, start: Point, cos: float, sin: float) -> Point:
    dx = point.x - start.x
    dy = point.y - start.y
    return Point(dx * cos + dy * sin, dy * cos - dx * sin)


def _side_in_cone(a: Point, b: Point, side: Point) -> float:
    """Return the distance from the origin to the part of the line a-b with |y| cos <= x sin, or ``FAR``."""
    left = _cut(a.x * side.x - a.y * side.y, b.x * side.x - b.y * side.y)
    right = _cut(a.x * side.x + a.y * side.y, b.x * side.x + b.y * side.y)
    low = left.x if left.x > right.x else right.x
    high = left.y if left.y < right.y else right.y
    if low > high:
        return FAR
    dx = b.x - a.x
    dy = b.y - a.y
    square = dx * dx + dy * dy
    nearest = -(a.x * dx + a.y * dy) / square if square > 0.0 else 0.0
    t = clamp(nearest, low, high)
    x = a.x + t * dx
    y = a.y + t * dy
    return math.sqrt(x * x + y * y)


def _cut(at_a: float, at_b: float) -> Point:
    """Return the part (low, high) of [0, 1] where a line with these end values is >= 0; low > high if none."""
    if at_a >= 0.0 and at_b >= 0.0:
        return Point(0.0, 1.0)
    if at_a < 0.0 and at_b < 0.0:
        return Point(1.0, 0.0)
    zero = at_a / (at_a - at_b)
    return Point(0.0, zero) if at_a >= 0.0 else Point(zero, 1.0)


def _smaller(a: float, b: float) -> float:
    return a if a < b else b
