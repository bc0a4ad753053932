"""Oriented boxes in the plane: a car's outline, obstacles, kerbs (a box of no width); gaps, rays, cones.

A distance that does not exist is ``NO_HIT``. Boxes touch when their gap is 0; they overlap when
their insides share a point.
"""

import math
from typing import Annotated, NamedTuple

from modelkit.maths import clamp
from modelkit.signal import Signal
from modelkit.vocabulary import Pose

NO_HIT = 1e9
"""A distance [m] at which there is nothing."""


class Box(NamedTuple):
    """An oriented rectangle about its centre; length 0 and width 0: a point."""

    x: Annotated[float, Signal("m", "x of the centre")] = 0.0
    y: Annotated[float, Signal("m", "y of the centre")] = 0.0
    heading: Annotated[float, Signal("rad", "direction of the length, counter-clockwise from x")] = 0.0
    length: Annotated[float, Signal("m", "length, >= 0", 0.0)] = 0.0
    width: Annotated[float, Signal("m", "width, >= 0", 0.0)] = 0.0


class OrientedBox(NamedTuple):
    """A box with the cosine and sine of its heading in the place of it, which many questions about it share."""

    x: float
    y: float
    cos: float
    sin: float
    length: float
    width: float


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


def orient(box: Box) -> OrientedBox:
    """Return ``box`` with cosine and sine of its heading."""
    return OrientedBox(box.x, box.y, math.cos(box.heading), math.sin(box.heading), box.length, box.width)


def outline(pose: Pose, wheelbase: float, front_overhang: float, rear_overhang: float, width: float) -> Box:
    """Return the box around a car whose rear-axle midpoint is at ``pose``."""
    ahead = Point(math.cos(pose.heading), math.sin(pose.heading))
    box = outline_box(pose, ahead, wheelbase, front_overhang, rear_overhang, width)
    return Box(box.x, box.y, pose.heading, box.length, box.width)


def outline_box(
    pose: Pose, ahead: Point, wheelbase: float, front_overhang: float, rear_overhang: float, width: float
) -> OrientedBox:
    """Return the box around a car as :func:`outline`; ``ahead`` is the unit vector of its heading."""
    length = rear_overhang + wheelbase + front_overhang
    half = 0.5 * length - rear_overhang
    return OrientedBox(pose.x + half * ahead.x, pose.y + half * ahead.y, ahead.x, ahead.y, length, width)


def line_box(x1: float, y1: float, x2: float, y2: float) -> Box:
    """Return the straight line between two points [m] as a box of no width."""
    dx = x2 - x1
    dy = y2 - y1
    length = math.sqrt(dx * dx + dy * dy)
    heading = math.atan2(dy, dx) if length > 0.0 else 0.0
    return Box(0.5 * (x1 + x2), 0.5 * (y1 + y2), heading, length, 0.0)


def orient_line(x1: float, y1: float, x2: float, y2: float) -> OrientedBox:
    """Return the straight line between two points [m] as :func:`line_box`; a point has the direction of x."""
    dx = x2 - x1
    dy = y2 - y1
    length = math.sqrt(dx * dx + dy * dy)
    cos = dx / length if length > 0.0 else 1.0
    sin = dy / length if length > 0.0 else 0.0
    return OrientedBox(0.5 * (x1 + x2), 0.5 * (y1 + y2), cos, sin, length, 0.0)


def corners(box: Box) -> Corners:
    """Return the four corners of ``box``."""
    return box_corners(orient(box))


def box_corners(a: OrientedBox) -> Corners:
    """Return the four corners of a box."""
    ax = 0.5 * a.length * a.cos
    ay = 0.5 * a.length * a.sin
    bx = -0.5 * a.width * a.sin
    by = 0.5 * a.width * a.cos
    x = a.x
    y = a.y
    return Corners(
        Point(x + ax + bx, y + ay + by),
        Point(x - ax + bx, y - ay + by),
        Point(x - ax - bx, y - ay - by),
        Point(x + ax - bx, y + ay - by),
    )


def point_gap(point: Point, box: Box) -> float:
    """Return the distance [m] from ``point`` to ``box``; 0 inside."""
    return point_to_oriented(point, orient(box))


def point_to_oriented(point: Point, a: OrientedBox) -> float:
    """Return the distance [m] from ``point`` to a box; 0 inside."""
    return math.sqrt(distance_squared(point, a))


def distance_squared(point: Point, a: OrientedBox) -> float:
    """Return the square of the distance [m2] from ``point`` to a box; 0 inside."""
    dx = point.x - a.x
    dy = point.y - a.y
    along = abs(dx * a.cos + dy * a.sin) - 0.5 * a.length
    across = abs(dy * a.cos - dx * a.sin) - 0.5 * a.width
    along = along if along > 0.0 else 0.0
    across = across if across > 0.0 else 0.0
    return along * along + across * across


def boxes_overlap(a: Box, b: Box) -> bool:
    """Return whether the insides of two boxes share a point (separating axes; touching is not sharing)."""
    return overlap_depth(orient(a), orient(b)) > 0.0


def boxes_gap(a: Box, b: Box) -> float:
    """Return the distance [m] between two boxes; 0 where they touch or overlap."""
    gap = box_gap(orient(a), orient(b))
    return gap if gap > 0.0 else 0.0


def box_gap(a: OrientedBox, b: OrientedBox) -> float:
    """Return the distance [m] between two boxes; where they overlap, minus the :func:`overlap_depth`.

    Two rectangles apart are nearest at a corner of one of them.
    """
    depth = overlap_depth(a, b)
    return -depth if depth > 0.0 else separation(a, b)


def separation(a: OrientedBox, b: OrientedBox) -> float:
    """Return the distance [m] between two boxes that do not overlap."""
    return math.sqrt(_smaller(_corner_distance_squared(box_corners(a), b), _corner_distance_squared(box_corners(b), a)))


def overlap_depth(a: OrientedBox, b: OrientedBox) -> float:
    """Return the least overlap [m] along the four directions of two boxes' sides (separating axes).

    It is the penetration depth where it is positive; 0 or less where the boxes touch or are apart, and then minus a
    distance that their gap is never less than. Cosine and sine of the angle between them follow from theirs.
    """
    cos = abs(a.cos * b.cos + a.sin * b.sin)
    sin = abs(a.cos * b.sin - a.sin * b.cos)
    return _smaller(_depth_along(a, b, cos, sin), _depth_along(b, a, cos, sin))


def centre_gap(a: OrientedBox, b: Box) -> float:
    """Return a distance [m] that the gap of two boxes is never less than: that of the circles around them."""
    dx = a.x - b.x
    dy = a.y - b.y
    gap = math.sqrt(dx * dx + dy * dy) - reach(a.length, a.width) - reach(b.length, b.width)
    return gap if gap > 0.0 else 0.0


def reach(length: float, width: float) -> float:
    """Return the distance [m] from the centre of a box to its corners."""
    return 0.5 * math.sqrt(length * length + width * width)


class Cone(NamedTuple):
    """A cone with its apex at ``start``: unit vector of its axis, sine and cosine of half its opening angle."""

    start: Point
    axis: Point
    side: Point


def cone_of(start: Point, direction: float, half_angle: float) -> Cone:
    """Return the cone that opens by ``half_angle`` [rad], in (0, pi/2), to both sides of ``direction`` [rad]."""
    axis = Point(math.cos(direction), math.sin(direction))
    return Cone(start, axis, Point(math.sin(half_angle), math.cos(half_angle)))


def cone_gap(cone: Cone, a: OrientedBox, around: Corners) -> float:
    """Return the distance [m] to the part of a box, with the corners ``around``, inside a cone, else ``NO_HIT``."""
    if point_to_oriented(cone.start, a) == 0.0:
        return 0.0
    front_left = _in_cone_frame(around.front_left, cone)
    rear_left = _in_cone_frame(around.rear_left, cone)
    rear_right = _in_cone_frame(around.rear_right, cone)
    front_right = _in_cone_frame(around.front_right, cone)
    side = cone.side
    nearest = _smaller(_side_in_cone(front_left, rear_left, side), _side_in_cone(rear_left, rear_right, side))
    other = _smaller(_side_in_cone(rear_right, front_right, side), _side_in_cone(front_right, front_left, side))
    return _smaller(nearest, other)


def _depth_along(a: OrientedBox, b: OrientedBox, cos_turn: float, sin_turn: float) -> float:
    """Return the lesser overlap [m] of the boxes seen along the two axes of ``a``; negative where they are apart."""
    dx = b.x - a.x
    dy = b.y - a.y
    along = 0.5 * (a.length + b.length * cos_turn + b.width * sin_turn)
    across = 0.5 * (a.width + b.length * sin_turn + b.width * cos_turn)
    return _smaller(along - abs(dx * a.cos + dy * a.sin), across - abs(dy * a.cos - dx * a.sin))


def _corner_distance_squared(around: Corners, a: OrientedBox) -> float:
    """Return the square of the distance [m2] from a box to the nearest of another one's corners."""
    left = _smaller(distance_squared(around.front_left, a), distance_squared(around.rear_left, a))
    right = _smaller(distance_squared(around.rear_right, a), distance_squared(around.front_right, a))
    return _smaller(left, right)


def _in_cone_frame(point: Point, cone: Cone) -> Point:
    dx = point.x - cone.start.x
    dy = point.y - cone.start.y
    return Point(dx * cone.axis.x + dy * cone.axis.y, dy * cone.axis.x - dx * cone.axis.y)


def _side_in_cone(a: Point, b: Point, side: Point) -> float:
    """Return the distance from the origin to the part of the line a-b with |y| cos <= x sin, or ``NO_HIT``."""
    left = _cut(a.x * side.x - a.y * side.y, b.x * side.x - b.y * side.y)
    right = _cut(a.x * side.x + a.y * side.y, b.x * side.x + b.y * side.y)
    low = left.x if left.x > right.x else right.x
    high = left.y if left.y < right.y else right.y
    if low > high:
        return NO_HIT
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
