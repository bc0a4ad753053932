"""A move: one way driven in one direction, as pieces of linear curvature.

Continuous curvature is a B-spline of degree one over the way driven (its knots are the ends of the
ramps), so the limits of curvature and curvature rate hold exactly and everywhere.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.outline import CREPT, Obstacles, Shape, clearance, least_from, outline_rate, sure_steps
from controller_fmu.common.curve import advance
from modelkit.vocabulary import Pose

PIECES = 7
MET = 1.0


class Piece(NamedTuple):
    """A line, an arc or a ramp."""

    length: float = 0.0
    k0: float = 0.0
    k1: float = 0.0


class Move(NamedTuple):
    """Start (slot's frame), direction (1, -1; 0: no move) and pieces; those of length 0 are unused."""

    start: Pose = Pose()
    direction: int = 0
    pieces: tuple[Piece, ...] = (Piece(),) * PIECES


NO_PIECE = Piece()


class PathPoint(NamedTuple):
    """A point of a move: pose, curvature [1/m], slope of the curvature [1/m2], way left to the end [m]."""

    pose: Pose
    curvature: float
    slope: float
    left: float


def length_of(move: Move) -> float:
    """Return the length [m] of a move."""
    total = 0.0
    for piece in move.pieces:
        total += piece.length
    return total


def end_of(move: Move) -> Pose:
    """Return the pose at the end of a move."""
    pose = move.start
    for piece in move.pieces:
        if piece.length > 0.0:
            pose = advance(pose, float(move.direction), piece.length, piece.k0, piece.k1)
    return pose


def point_at(move: Move, way: float) -> PathPoint:
    """Return the point ``way`` [m] along a move; before its start and past its end, straight on."""
    direction = float(move.direction)
    left = length_of(move) - way
    pose = move.start
    if way < 0.0:
        return PathPoint(advance(pose, direction, way, 0.0, 0.0), first_curvature(move), 0.0, left)
    rest = way
    last = 0.0
    for piece in move.pieces:
        if piece.length > 0.0:
            if rest <= piece.length:
                slope = (piece.k1 - piece.k0) / piece.length
                k = piece.k0 + slope * rest
                return PathPoint(advance(pose, direction, rest, piece.k0, k), k, slope, left)
            pose = advance(pose, direction, piece.length, piece.k0, piece.k1)
            rest -= piece.length
            last = piece.k1
    return PathPoint(advance(pose, direction, rest, 0.0, 0.0), last, 0.0, left)


def first_curvature(move: Move) -> float:
    """Return the curvature [1/m] that a move begins with."""
    for piece in move.pieces:
        if piece.length > 0.0:
            return piece.k0
    return 0.0


def is_move_free(move: Move, car: Shape, obstacles: Obstacles) -> bool:
    """Return whether a move meets no obstacle; one that begins within a margin has to lead out of it."""
    pose = move.start
    direction = float(move.direction)
    least = least_from(pose, car, obstacles)
    for piece in move.pieces:
        if piece.length > 0.0:
            least = _least_on(piece, pose, direction, least, car, obstacles)
            if least == MET:
                return False
            pose = advance(pose, direction, piece.length, piece.k0, piece.k1)
    return True


def _least_on(piece: Piece, pose: Pose, direction: float, least: float, car: Shape, obstacles: Obstacles) -> float:
    """Return the clearance [m] that must not be fallen below after a piece from ``pose``, ``MET`` if it was on it.

    ``least`` is that before it: 0, or less for a car that stands within a margin, which it may leave but
    not go further into. Looked at every 10 cm.
    """
    count = 1 + math.floor(piece.length / 0.1)
    moved = piece.length / count * outline_rate(max(abs(piece.k0), abs(piece.k1)), car)
    sure = 0
    for number in range(1, count + 1):
        if sure > 0:
            sure -= 1
        else:
            way = piece.length * number / count
            k = piece.k0 + (piece.k1 - piece.k0) * number / count
            gap = clearance(advance(pose, direction, way, piece.k0, k), car, obstacles, CREPT)
            if gap <= least:
                return MET
            if least < 0.0:
                least = gap - CREPT if gap < CREPT else 0.0
            if least == 0.0:
                sure = sure_steps(gap, moved)
    return least
