"""Something that stands there as the assist believes it: place and heading of its corner, and how sure it is.

The belief is a mean (x, y, heading) and a covariance. It widens with the way driven, by what the
odometry may be wrong by, and narrows with each echo (one scalar Kalman update, e = heard - expected):

    S = J P J' + R    K = P J' / S    (x, y, h) += K e    P -= K J P
"""

import math
from typing import NamedTuple


class Thing(NamedTuple):
    """A corner of a neighbour, or a point of a wall, and the covariance of where it is."""

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0
    xx: float = 0.0
    xy: float = 0.0
    xh: float = 0.0
    yy: float = 0.0
    yh: float = 0.0
    hh: float = 0.0


class Slope(NamedTuple):
    """How an expected distance changes with x, y [1] and heading [m] of the thing heard."""

    x: float
    y: float
    heading: float


def thing_at(x: float, y: float, heading: float, place: float, turned: float) -> Thing:
    """Return a thing believed at (x, y), to ``place`` [m], and of this heading, to ``turned`` [rad]."""
    return Thing(x, y, heading, xx=place * place, yy=place * place, hh=turned * turned)


def wider(thing: Thing, place: float, turned: float) -> Thing:
    """Return the thing with standard deviations larger by ``place`` [m] and ``turned`` [rad]."""
    return thing._replace(
        xx=thing.xx + place * (2.0 * math.sqrt(thing.xx) + place),
        yy=thing.yy + place * (2.0 * math.sqrt(thing.yy) + place),
        hh=thing.hh + turned * (2.0 * math.sqrt(thing.hh) + turned),
    )


def spread_along(thing: Thing, slope: Slope) -> float:
    """Return J P J' [m2], the variance of an expected distance."""
    return (
        slope.x * slope.x * thing.xx
        + slope.y * slope.y * thing.yy
        + slope.heading * slope.heading * thing.hh
        + 2.0 * (slope.x * slope.y * thing.xy + slope.x * slope.heading * thing.xh + slope.y * slope.heading * thing.yh)
    )


def learnt(thing: Thing, slope: Slope, error: float, noise: float, floor: float) -> Thing:
    """Return the thing after it was heard ``error`` [m] further away than expected; ``noise`` [m2] of a reading.

    Its place never becomes surer than ``floor`` [m]: sensors are mounted no better.
    """
    px = slope.x * thing.xx + slope.y * thing.xy + slope.heading * thing.xh
    py = slope.x * thing.xy + slope.y * thing.yy + slope.heading * thing.yh
    ph = slope.x * thing.xh + slope.y * thing.yh + slope.heading * thing.hh
    s = slope.x * px + slope.y * py + slope.heading * ph + noise
    kx = px / s
    ky = py / s
    kh = ph / s
    least = floor * floor
    return Thing(
        thing.x + kx * error,
        thing.y + ky * error,
        thing.heading + kh * error,
        max(least, thing.xx - kx * px),
        thing.xy - kx * py,
        thing.xh - kx * ph,
        max(least, thing.yy - ky * py),
        thing.yh - ky * ph,
        max(1e-6, thing.hh - kh * ph),
    )
