"""The side of a neighbour from distances heard while driving past it.

A sensor at (u, w) hears the distance r to the nearest point of a flat side, which is its distance to
the line w = a + b u; with the slope's angle alpha

    w - r / cos(alpha) = a + b u

so b and a follow from the regressions of w and of r on u, whatever way the car took and however it
was turned (as long as the foot lies in the cone).
"""

import math
from typing import NamedTuple


class Sums(NamedTuple):
    """Sums over the samples (u, w, r)."""

    n: float = 0.0
    u: float = 0.0
    w: float = 0.0
    r: float = 0.0
    uu: float = 0.0
    uw: float = 0.0
    ur: float = 0.0


class FittedLine(NamedTuple):
    """w = a + b u."""

    a: float = 0.0
    b: float = 0.0


LEAST_SPREAD = 1e-6
ASKEW = 0.06
OFF = 0.02
CONTRADICTS = 0.5
"""A side that is turned against the other by ``ASKEW`` is believed so much less, by the square where it is more."""
NO_SUMS = Sums(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def add(sums: Sums, u: float, w: float, r: float) -> Sums:
    """Return the sums with one sample more."""
    return Sums(sums.n + 1.0, sums.u + u, sums.w + w, sums.r + r, sums.uu + u * u, sums.uw + u * w, sums.ur + u * r)


def spread(sums: Sums) -> float:
    """Return the sum of squared distances [m2] of u from its mean."""
    return sums.uu - sums.u * sums.u / sums.n if sums.n > 0.0 else 0.0


def slope(first: Sums, second: Sums, third: Sums = NO_SUMS) -> float:
    """Return b of two or three sides taken as parallel, each with its own offset."""
    s = spread(first) + spread(second) + spread(third)
    if s <= LEAST_SPREAD:
        return 0.0
    w = _with_w(first) + _with_w(second) + _with_w(third)
    r = _with_r(first) + _with_r(second) + _with_r(third)
    b = 0.0
    for _ in range(6):
        b = (w - r * math.sqrt(1.0 + b * b)) / s
    return b


def leaning(known: Sums, own: Sums) -> float:
    """Return b of a side that stands about as the one ``known`` does, with what is heard of itself: the mean of both.

    Each is weighted by how sure it is; neighbours stand askew by ``ASKEW``, a sample is off by ``OFF`` [m], by more
    the more the two contradict each other: what is heard of a corner ahead comes nearer as no side does.
    """
    before = slope(known, NO_SUMS)
    turned = (slope(own, NO_SUMS) - before) / ASKEW
    weight = spread(own) * ASKEW * ASKEW / (OFF * OFF * (1.0 + CONTRADICTS * turned * turned))
    return before + ASKEW * turned * weight / (1.0 + weight)


def offset(sums: Sums, b: float) -> float:
    """Return a [m] of a side of slope ``b``; 0 without samples."""
    if sums.n <= 0.0:
        return 0.0
    return (sums.w - sums.r * math.sqrt(1.0 + b * b) - b * sums.u) / sums.n


def distance(line: FittedLine, u: float, w: float) -> float:
    """Return the distance [m] of a point from the line, positive on the road's side (larger w)."""
    return (w - line.a - line.b * u) / math.sqrt(1.0 + line.b * line.b)


def _with_w(sums: Sums) -> float:
    return sums.uw - sums.u * sums.w / sums.n if sums.n > 0.0 else 0.0


def _with_r(sums: Sums) -> float:
    return sums.ur - sums.u * sums.r / sums.n if sums.n > 0.0 else 0.0
