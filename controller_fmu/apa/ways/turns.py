"""Turns with ramps, and the straight lines that touch them.

A ramp of length w and curvature k brings a car from a line onto the circle of radius R = 1/k, as if
the circle touched a line further out by p: effective radius rho = R + p, touched a way t after the
ramp began. So two circles with ramps are joined like two circles of radius rho, the line being
shorter by t at each end; and a turn by delta between two lines begins t + rho tan(delta / 2) before
the lines cross.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.ways.move import NO_PIECE, Move, Piece
from controller_fmu.common.curve import advance
from modelkit.vocabulary import Pose

STEEPEST = 85.0 * math.pi / 180.0


class Turn(NamedTuple):
    """A circle with a ramp."""

    curvature: float
    """> 0 [1/m]."""
    ramp: float
    """Length of the ramp [m]."""
    angle: float
    """Turned on the ramp [rad]: k w / 2."""
    rho: float
    """Effective radius [m]."""
    tangent: float
    """From the start of the ramp to the touching point of the effective circle [m]."""


def turn_of(curvature: float, largest: float, ramp: float) -> Turn:
    """Return the turn of ``curvature`` whose ramp rises as steeply as ``ramp`` [m] does to ``largest``."""
    w = ramp * curvature / largest
    end = advance(Pose(0.0, 0.0, 0.0), 1.0, w, 0.0, curvature)
    r = 1.0 / curvature
    return Turn(curvature, w, end.heading, end.y + r * math.cos(end.heading), end.x - r * math.sin(end.heading))


def reverse_s(start: Pose, end: Pose, straight: float, first: Turn, second: Turn) -> Move:
    """Return the reverse move: line, right arc, line, left arc, from ``start`` to ``end``; no direction if none.

    ``straight`` [m] is the way driven straight back at first; with none of it the wheel is turned to
    the first arc at standstill. Both effective radii summed take the place of Guo's 2 R.
    """
    none = Move(start)
    h0 = start.heading
    ramp0 = first.ramp if straight > 0.0 else 0.0
    gone = advance(start, -1.0, straight, 0.0, 0.0)
    on_arc = advance(gone, -1.0, ramp0, 0.0, -first.curvature) if ramp0 > 0.0 else gone
    r1 = 1.0 / first.curvature
    r2 = 1.0 / second.curvature
    dx = on_arc.x + r1 * math.sin(on_arc.heading) - (end.x - r2 * math.sin(end.heading))
    dy = on_arc.y - r1 * math.cos(on_arc.heading) - (end.y + r2 * math.cos(end.heading))
    both = first.rho + second.rho
    squared = dx * dx + dy * dy - both * both
    if squared < 0.0:
        return none
    between = math.sqrt(squared)
    h1 = math.atan2(dy, dx) - math.atan2(-both, between)
    line = between - first.tangent - second.tangent
    arc1 = h1 - first.angle - on_arc.heading
    arc2 = h1 - second.angle - end.heading
    if line < 0.0 or arc1 < 0.0 or arc2 < 0.0 or h1 > STEEPEST or h0 < -1.0:
        return none
    k1 = -first.curvature
    k2 = second.curvature
    pieces = (
        Piece(straight, 0.0, 0.0),
        Piece(ramp0, 0.0, k1),
        Piece(arc1 * r1, k1, k1),
        Piece(first.ramp, k1, 0.0),
        Piece(line, 0.0, 0.0),
        Piece(second.ramp, 0.0, k2),
        Piece(arc2 * r2, k2, k2),
    )
    return Move(start, -1, pieces)


def reverse_turn(start: Pose, turn: Turn) -> Move:
    """Return the reverse move: line, arc to the right, line, from ``start`` to the origin; no direction if none.

    The lines are those of the start and of the x axis, which must cross ahead of the origin.
    """
    none = Move(start)
    delta = -start.heading
    if delta < 2.0 * turn.angle or delta > STEEPEST + 0.35:
        return none
    crossing = -start.y / math.sin(delta)
    needed = turn.tangent + turn.rho * math.tan(0.5 * delta)
    first = crossing - needed
    last = start.x - crossing * math.cos(delta) - needed
    if first < 0.0 or last < 0.0:
        return none
    k = -turn.curvature
    pieces = (
        Piece(first, 0.0, 0.0),
        Piece(turn.ramp, 0.0, k),
        Piece((delta - 2.0 * turn.angle) / turn.curvature, k, k),
        Piece(turn.ramp, k, 0.0),
        Piece(last, 0.0, 0.0),
        NO_PIECE,
        NO_PIECE,
    )
    return Move(start, -1, pieces)


def forward_turn(start: Pose, straight: float, angle: float, turn: Turn) -> Move:
    """Return the forward move: line, arc to the left by ``angle`` in all [rad]; no direction if it is too small."""
    arc = (angle - 2.0 * turn.angle) / turn.curvature
    if arc < 0.0:
        return Move(start)
    k = turn.curvature
    pieces = (
        Piece(straight, 0.0, 0.0),
        Piece(turn.ramp, 0.0, k),
        Piece(arc, k, k),
        Piece(turn.ramp, k, 0.0),
        NO_PIECE,
        NO_PIECE,
        NO_PIECE,
    )
    return Move(start, 1, pieces)


def straight_move(start: Pose, direction: int, length: float) -> Move:
    """Return a straight move."""
    return Move(start, direction, (Piece(length, 0.0, 0.0), NO_PIECE, NO_PIECE, NO_PIECE, NO_PIECE, NO_PIECE, NO_PIECE))


def two_arcs(start: Pose, direction: int, k: float, first: float, second: float, line: float) -> Move:
    """Return a move of an arc of curvature ``k``, one of ``-k`` and a line; the wheel turns at standstill between."""
    pieces = (
        Piece(first, k, k),
        Piece(second, -k, -k),
        Piece(line, 0.0, 0.0),
        NO_PIECE,
        NO_PIECE,
        NO_PIECE,
        NO_PIECE,
    )
    return Move(start, direction, pieces)
