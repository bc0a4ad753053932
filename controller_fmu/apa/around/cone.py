"""What a sensor hears of a straight side: the nearest point of it inside its cone, and how that point moves.

Three kinds of echo: square to a side, from its end (a corner), or where the rim of the cone cuts the side.
The first two tell exactly where the side is; the third is as good as the rim is sharp.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from modelkit.geometry import Point

SILENT = 100.0
"""Distance [m] of what is not heard."""


class Hit(IntEnum):
    """Which part of a side is heard."""

    NOTHING = 0
    SQUARE = 1
    START = 2
    """The side's first end."""
    END = 3
    RIM = 4


class ConeEar(NamedTuple):
    """A sensor in the plane: where it is, the unit vector of its axis, sine and cosine of its half opening."""

    x: float
    y: float
    ax: float
    ay: float
    sine: float
    cosine: float


class Echo(NamedTuple):
    """The nearest point of a side inside a cone."""

    distance: float = SILENT
    hit: int = Hit.NOTHING
    x: float = 0.0
    y: float = 0.0


def ear_of(x: float, y: float, axis: float, half_angle: float) -> ConeEar:
    """Return the sensor at (x, y) [m] that looks along ``axis`` [rad]."""
    return ConeEar(x, y, math.cos(axis), math.sin(axis), math.sin(half_angle), math.cos(half_angle))


def echo_of(ear: ConeEar, a: Point, b: Point) -> Echo:
    """Return what is heard of the side from ``a`` to ``b``: of its part with |across| cos <= along sin."""
    ux = (a.x - ear.x) * ear.ax + (a.y - ear.y) * ear.ay
    uy = (a.y - ear.y) * ear.ax - (a.x - ear.x) * ear.ay
    vx = (b.x - ear.x) * ear.ax + (b.y - ear.y) * ear.ay
    vy = (b.y - ear.y) * ear.ax - (b.x - ear.x) * ear.ay
    low = 0.0
    high = 1.0
    for rim in (-1.0, 1.0):
        at_a = ux * ear.sine + rim * uy * ear.cosine
        at_b = vx * ear.sine + rim * vy * ear.cosine
        if at_a < 0.0 and at_b < 0.0:
            return Echo()
        if at_a < 0.0:
            low = max(low, at_a / (at_a - at_b))
        elif at_b < 0.0:
            high = min(high, at_a / (at_a - at_b))
    if low > high:
        return Echo()
    dx = vx - ux
    dy = vy - uy
    square = dx * dx + dy * dy
    t = -(ux * dx + uy * dy) / square if square > 0.0 else 0.0
    hit = Hit.SQUARE
    if t <= low:
        t = low
        hit = Hit.START if low == 0.0 else Hit.RIM
    elif t >= high:
        t = high
        hit = Hit.END if high == 1.0 else Hit.RIM
    x = ux + t * dx
    y = uy + t * dy
    return Echo(math.sqrt(x * x + y * y), int(hit), a.x + t * (b.x - a.x), a.y + t * (b.y - a.y))


def rim_point(ear: ConeEar, share: float, distance: float) -> Point:
    """Return the point ``distance`` [m] from the sensor, ``share`` (-1 to 1) of the way to the rims of its cone.

    Between axis and rim the chord is divided, which is near enough for cones up to 45 deg.
    """
    across = share * ear.sine
    along = math.sqrt(1.0 - across * across)
    return Point(
        ear.x + distance * (along * ear.ax - across * ear.ay), ear.y + distance * (along * ear.ay + across * ear.ax)
    )
