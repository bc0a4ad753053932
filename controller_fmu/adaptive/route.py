"""A route: a path in one direction, of pieces whose curvature is linear in arc length (line, arc, clothoid)."""

import math
from typing import NamedTuple

from controller_fmu.common.curve import advance
from modelkit.maths import wrap_angle
from modelkit.vocabulary import Pose

MAX_PIECES = 9
JUMP_DISTANCE = 1e-6
STANDSTILL_LOOKAHEAD = 0.001
"""So far [m] into a route its curvature is looked up at standstill: past a jump at its start."""


class Piece(NamedTuple):
    """A line, an arc or a clothoid: its length [m] and the curvatures [1/m] at its ends."""

    length: float = 0.0
    k0: float = 0.0
    k1: float = 0.0


class Route(NamedTuple):
    """Start (slot's frame), direction (1, -1; 0: none) and pieces; those of length 0 are unused."""

    start: Pose = Pose()
    direction: int = 0
    pieces: tuple[Piece, ...] = (Piece(),) * MAX_PIECES


class RoutePoint(NamedTuple):
    """A point of a route: its pose and curvature [1/m]."""

    pose: Pose
    curvature: float


class Foot(NamedTuple):
    """Where the car is along its route, and how far off it."""

    s: float = 0.0
    """Driven of the route [m]."""
    reference: Pose = Pose()
    lateral_error: float = 0.0
    heading_error: float = 0.0


def drivable(route: Route) -> float:
    """Return the way [m] to the first jump of curvature, where the car has to stand, or to the end."""
    along = 0.0
    last = 0.0
    begun = False
    for piece in route.pieces:
        if piece.length > 0.0:
            if begun and abs(piece.k0 - last) > JUMP_DISTANCE:
                return along
            along += piece.length
            last = piece.k1
            begun = True
    return along


def point_at(route: Route, s: float) -> RoutePoint:
    """Return the point ``s`` [m] along a route; before its start straight, past its end as curved as there."""
    direction = float(route.direction)
    pose = route.start
    if s < 0.0:
        return RoutePoint(advance(pose, direction, s, 0.0, 0.0), curvature_at(route, 0.0))
    rest = s
    last = 0.0
    for piece in route.pieces:
        if piece.length > 0.0:
            if rest <= piece.length:
                k = piece.k0 + (piece.k1 - piece.k0) * rest / piece.length
                return RoutePoint(advance(pose, direction, rest, piece.k0, k), k)
            pose = advance(pose, direction, piece.length, piece.k0, piece.k1)
            rest -= piece.length
            last = piece.k1
    return RoutePoint(advance(pose, direction, rest, last, last), last)


def curvature_at(route: Route, s: float) -> float:
    """Return the curvature [1/m] ``s`` [m] along a route, held to its ends."""
    rest = s
    last = 0.0
    for piece in route.pieces:
        if piece.length > 0.0:
            if rest <= piece.length:
                return piece.k0 + (piece.k1 - piece.k0) * (rest if rest > 0.0 else 0.0) / piece.length
            rest -= piece.length
            last = piece.k1
    return last


def foot_on(route: Route, s: float, pose: Pose) -> Foot:
    """Return the foot of a car at ``pose`` (slot's frame) that was at ``s`` [m] before."""
    direction = float(route.direction)
    at = point_at(route, s).pose
    s += direction * ((pose.x - at.x) * math.cos(at.heading) + (pose.y - at.y) * math.sin(at.heading))
    at = point_at(route, s).pose
    e = (pose.y - at.y) * math.cos(at.heading) - (pose.x - at.x) * math.sin(at.heading)
    return Foot(s, at, e, wrap_angle(pose.heading - at.heading))


def mirror_route(route: Route, mirror: float, start: Pose, direction: int) -> Route:
    """Return a route from ``start`` in ``direction`` with every curvature multiplied by ``mirror`` (1 or -1)."""
    pieces = tuple(Piece(item.length, mirror * item.k0, mirror * item.k1) for item in route.pieces)
    return Route(start, direction if route.direction != 0 else 0, pieces)
