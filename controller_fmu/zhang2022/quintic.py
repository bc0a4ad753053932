"""One quintic y(x) between two points, equation (4) of Zhang 2022."""

import math
from typing import Annotated, NamedTuple

from modelkit.signal import Signal


class Quintic(NamedTuple):
    """y(t) = y0 + m0 t + c2 t^2 + c3 t^3 + c4 t^4 + c5 t^5 with t = (x - x0) / length in [0, 1]."""

    x0: Annotated[float, Signal("m", "x at t = 0")] = 0.0
    length: Annotated[float, Signal("m", "x at t = 1 less x0")] = 1.0
    y0: Annotated[float, Signal("m", "y at t = 0")] = 0.0
    m0: Annotated[float, Signal("m", "factor of t")] = 0.0
    c2: Annotated[float, Signal("m", "factor of t^2")] = 0.0
    c3: Annotated[float, Signal("m", "factor of t^3")] = 0.0
    c4: Annotated[float, Signal("m", "factor of t^4")] = 0.0
    c5: Annotated[float, Signal("m", "factor of t^5")] = 0.0


class Derivatives(NamedTuple):
    """What a path y(x) does at one x."""

    y: float
    slope: float
    curvature: float


def quintic(x0: float, y0: float, slope0: float, x1: float, y1: float, slope1: float) -> Quintic:
    """Return the quintic with the given positions [m] and slopes at both ends and zero curvature there.

    (5) of the paper gives four conditions for six coefficients; the two it leaves out are y'' = 0
    at both ends, so that neighbouring pieces join with continuous curvature. Needs x1 != x0.
    """
    length = x1 - x0
    rise = y1 - y0
    m0 = slope0 * length
    m1 = slope1 * length
    return Quintic(
        x0,
        length,
        y0,
        m0,
        0.0,
        10.0 * rise - 6.0 * m0 - 4.0 * m1,
        -15.0 * rise + 8.0 * m0 + 7.0 * m1,
        6.0 * rise - 3.0 * m0 - 3.0 * m1,
    )


class Knot(NamedTuple):
    """A point of a path y(x), with y' and y''."""

    x: float
    y: float
    slope: float
    bend: float


def quintic_between(low: Knot, high: Knot) -> Quintic:
    """Return the quintic with position, slope and bend of both knots. Needs ``high.x`` above ``low.x``."""
    length = high.x - low.x
    m0 = low.slope * length
    c2 = 0.5 * low.bend * length * length
    d = high.y - low.y - m0 - c2
    e = high.slope * length - m0 - 2.0 * c2
    f = high.bend * length * length - 2.0 * c2
    return Quintic(
        low.x,
        length,
        low.y,
        m0,
        c2,
        10.0 * d - 4.0 * e + 0.5 * f,
        -15.0 * d + 7.0 * e - f,
        6.0 * d - 3.0 * e + 0.5 * f,
    )


def shape(piece: Quintic, x: float) -> Derivatives:
    """Return y [m], slope and curvature y'' / (1 + y'^2)^(3/2) [1/m] at ``x`` [m]."""
    t = (x - piece.x0) / piece.length
    y = piece.y0 + t * (piece.m0 + t * (piece.c2 + t * (piece.c3 + t * (piece.c4 + t * piece.c5))))
    rise = piece.m0 + t * (2.0 * piece.c2 + t * (3.0 * piece.c3 + t * (4.0 * piece.c4 + t * 5.0 * piece.c5)))
    slope = rise / piece.length
    bend = 2.0 * piece.c2 + t * (6.0 * piece.c3 + t * (12.0 * piece.c4 + t * 20.0 * piece.c5))
    bend = bend / (piece.length * piece.length)
    norm = 1.0 + slope * slope
    return Derivatives(y, slope, bend / (norm * math.sqrt(norm)))
