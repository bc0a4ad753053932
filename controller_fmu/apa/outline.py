"""The car's outline against boxes: clearance, free way.

Two rectangles that do not touch are nearest at a corner of one of them; whether they touch is told
by the separating axis theorem on the four directions of their sides.

Of a way that is looked at every few centimetres no place is looked at that the clearance seen last reaches beyond: no
point of the outline comes nearer to anything than it moves.
"""

import math
from typing import NamedTuple

from controller_fmu.common.curve import advance
from modelkit.vocabulary import Pose

FAR = 60.0
"""Half length [m] of a box that stands for a wall without end."""
CREPT = 0.005
"""So much [m] nearer is taken for no nearer."""
ROUNDING = 1e-4
"""Clearance [m] that rounding and the integral of a ramp surely leave."""


class Shape(NamedTuple):
    """What a planner needs to know of the car."""

    front: float = 3.2
    """Rear axle to front bumper [m]."""
    rear: float = 0.6
    """Rear axle to rear bumper [m]."""
    half_width: float = 0.825
    curvature: float = 0.2
    """Largest curvature [1/m] that is planned."""
    ramp: float = 0.8
    """Way [m] over which the curvature goes from 0 to the largest."""


class Stand(NamedTuple):
    """Where the rear axle is [m], and the unit vector ahead."""

    x: float
    y: float
    cos: float
    sin: float


class Box(NamedTuple):
    """Something solid: from ``x0`` to ``x1`` and ``y0`` to ``y1`` [m] along its own axes; empty if x0 > x1."""

    x0: float = 1.0
    x1: float = -1.0
    y0: float = 1.0
    y1: float = -1.0
    x: float = 0.0
    """Where its own axes cross [m]."""
    y: float = 0.0
    cos: float = 1.0
    """Direction of its own x axis."""
    sin: float = 0.0


class Obstacles(NamedTuple):
    """What stands around a slot, in the slot's frame."""

    behind: Box = Box()
    ahead: Box = Box()
    beside: Box = Box()
    """Kerb or wall that the slot ends at."""
    opposite: Box = Box()


def turned_box(box: Box, x: float, y: float, heading: float) -> Box:
    """Return the box with its axes crossing at (x, y) [m], turned by ``heading`` [rad]."""
    return box._replace(x=x, y=y, cos=math.cos(heading), sin=math.sin(heading))


def box_clearance(pose: Pose, car: Shape, box: Box, enough: float = FAR) -> float:
    """Return the distance [m] of the outline to the box; negative: how deep they overlap at least.

    What is farther than ``enough`` need not be exact: then it is ``enough`` or more, and no more than the distance.
    """
    return stand_clearance(stand_at(pose), car, box, enough)


def stand_at(pose: Pose) -> Stand:
    """Return how a car stands at ``pose``."""
    return Stand(pose.x, pose.y, math.cos(pose.heading), math.sin(pose.heading))


def stand_clearance(stand: Stand, car: Shape, box: Box, enough: float = FAR) -> float:
    """Return the same [m] of a car that stands so: of many boxes the heading is looked up once."""
    if box.x0 > box.x1:
        return FAR
    c = stand.cos * box.cos + stand.sin * box.sin
    s = stand.sin * box.cos - stand.cos * box.sin
    ox = stand.x - box.x
    oy = stand.y - box.y
    middle = 0.5 * (car.front - car.rear)
    half = 0.5 * (car.front + car.rear)
    side = car.half_width
    a = 0.5 * (box.x1 - box.x0)
    b = 0.5 * (box.y1 - box.y0)
    dx = ox * box.cos + oy * box.sin + middle * c - 0.5 * (box.x0 + box.x1)
    dy = oy * box.cos - ox * box.sin + middle * s - 0.5 * (box.y0 + box.y1)
    ac = abs(c)
    ass = abs(s)
    along = dx * c + dy * s
    across = dy * c - dx * s
    gap = _larger(
        _larger(abs(dx) - a - half * ac - side * ass, abs(dy) - b - half * ass - side * ac),
        _larger(abs(along) - half - a * ac - b * ass, abs(across) - side - a * ass - b * ac),
    )
    if gap <= 0.0 or gap >= enough:
        return gap
    best = _corner_squared(dx + half * c - side * s, dy + half * s + side * c, a, b)
    best = _smaller(best, _corner_squared(dx + half * c + side * s, dy + half * s - side * c, a, b))
    best = _smaller(best, _corner_squared(dx - half * c - side * s, dy - half * s + side * c, a, b))
    best = _smaller(best, _corner_squared(dx - half * c + side * s, dy - half * s - side * c, a, b))
    best = _smaller(best, _corner_squared(along - a * c - b * s, across + a * s - b * c, half, side))
    best = _smaller(best, _corner_squared(along - a * c + b * s, across + a * s + b * c, half, side))
    best = _smaller(best, _corner_squared(along + a * c - b * s, across - a * s - b * c, half, side))
    best = _smaller(best, _corner_squared(along + a * c + b * s, across - a * s + b * c, half, side))
    return math.sqrt(best)


def clearance(pose: Pose, car: Shape, obstacles: Obstacles, enough: float = FAR) -> float:
    """Return the distance [m] of the outline to the nearest obstacle, exact up to ``enough``; <= 0: contact."""
    stand = stand_at(pose)
    nearest = stand_clearance(stand, car, obstacles.behind, enough)
    nearest = _smaller(nearest, stand_clearance(stand, car, obstacles.ahead, enough))
    nearest = _smaller(nearest, stand_clearance(stand, car, obstacles.beside, enough))
    return _smaller(nearest, stand_clearance(stand, car, obstacles.opposite, enough))


def free_way(pose: Pose, direction: float, curvature: float, longest: float, car: Shape, obstacles: Obstacles) -> float:
    """Return how far [m] the car can drive at this curvature before an obstacle is nearer than 0.

    The boxes are grown by the margin beforehand. A car that stands within a margin may leave it, but not go further
    into it. Looked at every 4 cm.
    """
    least = least_from(pose, car, obstacles)
    step = 0.04
    moved = step * outline_rate(curvature, car)
    way = 0.0
    sure = 0
    while way < longest:
        next_way = _smaller(way + step, longest)
        if sure > 0:
            sure -= 1
        else:
            gap = clearance(advance(pose, direction, next_way, curvature, curvature), car, obstacles, 0.0)
            if gap <= least:
                return way
            least = max(least, gap - CREPT) if gap <= 0.0 else 0.0
            sure = sure_steps(gap, moved)
        way = next_way
    return longest


def least_from(pose: Pose, car: Shape, obstacles: Obstacles) -> float:
    """Return the clearance [m] that a car at ``pose`` must not fall below: 0, or less where it has less already."""
    gap = clearance(pose, car, obstacles, 0.0)
    return gap - CREPT if gap <= 0.0 else 0.0


def outline_rate(curvature: float, car: Shape) -> float:
    """Return how far [m] a point of the outline moves at most while the rear axle moves 1 m at this curvature."""
    along = 1.0 + abs(curvature) * car.half_width
    across = curvature * _larger(car.front, car.rear)
    return math.sqrt(along * along + across * across)


def sure_steps(gap: float, moved: float) -> int:
    """Return how many more steps surely meet nothing, if each moves the outline by ``moved`` [m] at most."""
    return math.floor((gap - ROUNDING) / moved) if gap > ROUNDING else 0


def grown(box: Box, margin: float) -> Box:
    """Return the box with its sides moved out by ``margin`` [m]; an empty one stays empty."""
    if box.x0 > box.x1:
        return box
    return box._replace(x0=box.x0 - margin, x1=box.x1 + margin, y0=box.y0 - margin, y1=box.y1 + margin)


def _corner_squared(x: float, y: float, half_length: float, half_width: float) -> float:
    """Return the squared distance [m2] of a point to a box around the origin."""
    dx = abs(x) - half_length
    dy = abs(y) - half_width
    dx = dx if dx > 0.0 else 0.0
    dy = dy if dy > 0.0 else 0.0
    return dx * dx + dy * dy


def _smaller(a: float, b: float) -> float:
    return a if a < b else b


def _larger(a: float, b: float) -> float:
    return a if a > b else b
