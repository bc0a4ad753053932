"""The reference on the path for the car's x, in the slot's frame (Guo 2015, Fig. 4).

The path is driven towards falling x, so x finds the reference. A latched piece keeps the car
from falling back to an earlier one: after point tracking the reference is on the second arc.
"""

import math
from typing import NamedTuple

from controller_fmu.guo2015.planner import TwoArcPath
from controller_fmu.guo2015.smooth_path import PathShape, on_curve, way_left
from modelkit.maths import clamp

FIRST_ARC = 0
LINE_PIECE = 1
SECOND_ARC = 2
BEYOND_PATH = 3
LARGEST_SINE = 0.996
"""Keeps the reference heading under 85 deg where x leaves an arc."""


class Reference(NamedTuple):
    """The point of the path that the car should be at."""

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0
    curvature: float = 0.0
    """y'' / (1 + y'^2)^(3/2) [1/m]: left positive."""
    piece: int = FIRST_ARC


def reference_at(path: TwoArcPath, x: float, latched: int) -> Reference:
    """Return the reference for ``x`` [m], on the piece ``latched`` or a later one."""
    piece = (
        FIRST_ARC
        if x > path.tangent1.x
        else LINE_PIECE
        if x > path.tangent2.x
        else SECOND_ARC
        if x > 0.0
        else BEYOND_PATH
    )
    if piece < latched:
        piece = latched
    if path.curve.shape != PathShape.TWO_ARCS:
        at = on_curve(path.curve, x)
        return Reference(x, at.y, at.heading, at.curvature, piece)
    r = path.radius
    if piece == FIRST_ARC:
        s0 = math.sin(path.start.heading)
        c0 = math.cos(path.start.heading)
        sine = clamp((path.start.x + r * s0 - x) / r, -LARGEST_SINE, LARGEST_SINE)
        y = path.start.y - r * c0 + r * math.sqrt(1.0 - sine * sine)
        return Reference(x, y, math.asin(sine), -1.0 / r, piece)
    if piece == LINE_PIECE:
        q1 = path.tangent2
        return Reference(x, q1.y + (x - q1.x) * math.tan(q1.heading), q1.heading, 0.0, piece)
    if piece == SECOND_ARC:
        sine = clamp(x / r, -LARGEST_SINE, LARGEST_SINE)
        return Reference(x, r - r * math.sqrt(1.0 - sine * sine), math.asin(sine), 1.0 / r, piece)
    return Reference(x, 0.0, 0.0, 0.0, piece)


def distance_to_jump(path: TwoArcPath, reference: Reference) -> float:
    """Return the way [m] along the path to the end of the reference's piece; 0 beyond the path."""
    if reference.piece == FIRST_ARC:
        return path.radius * (path.tangent1.heading - reference.heading)
    if reference.piece == LINE_PIECE:
        return (reference.x - path.tangent2.x) / math.cos(reference.heading)
    if reference.piece == SECOND_ARC:
        return path.radius * reference.heading
    return 0.0


def curvature_after(path: TwoArcPath, piece: int) -> float:
    """Return the curvature [1/m] of the piece after ``piece``, a line of no length left out; 0 where none jumps."""
    if path.curve.shape != PathShape.TWO_ARCS:
        return 0.0
    if piece == FIRST_ARC and path.tangent1.x - path.tangent2.x > 1e-6:
        return 0.0
    if piece <= LINE_PIECE:
        return 1.0 / path.radius
    return 0.0


def distance_to_end(path: TwoArcPath, reference: Reference) -> float:
    """Return the way [m] along the path to its end."""
    if path.curve.shape != PathShape.TWO_ARCS:
        return way_left(path.curve, reference.x)
    line = path.tangent1.x - path.tangent2.x
    to_q1 = path.radius * path.tangent2.heading
    if reference.piece == FIRST_ARC:
        return distance_to_jump(path, reference) + line / math.cos(path.tangent2.heading) + to_q1
    if reference.piece == LINE_PIECE:
        return distance_to_jump(path, reference) + to_q1
    return distance_to_jump(path, reference)
