"""Paths y(x) of one piece that NBTPT can follow as well: sine, polynomial, B-spline, quintic (Guo 2015, conclusions).

Over t = x / x0 from the target (t = 0) to the start (t = 1) the path is

    y = y0 S(t) + (tan h0) x0 H(t)      S: 0 to 1 with slope 0 at both ends      H: 0 at both ends, slope 1 at t = 1

    sine        S = t - sin(2 pi t) / (2 pi)
    polynomial  S = 3 t^2 - 2 t^3, the only one that is curved at its ends; with H = t^3 - t^2
    B-spline    S cubic on the knots 0, 1/4, 1/2, 3/4, 1 with the ordinates 0, 0, 0, 1/2, 1, 1, 1
    quintic     S = 10 t^3 - 15 t^4 + 6 t^5 (Zhang 2022, eq. (4), with no curvature at the ends)

and H = -4 t^3 + 7 t^4 - 3 t^5 but for the polynomial: it is not curved at the ends either. Behind the target and ahead
of the start the path goes on straight.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from modelkit.maths import TWO_PI, clamp
from modelkit.vocabulary import Pose

PATH_SAMPLES = 64
NODES = (-0.906179845938664, -0.538469310105683, 0.0, 0.538469310105683, 0.906179845938664)
WEIGHTS = (0.236926885056189, 0.478628670499366, 0.568888888888889, 0.478628670499366, 0.236926885056189)


class PathShape(IntEnum):
    """What the path is made of."""

    TWO_ARCS = 0
    """Two arcs of one radius with a line between (eq. (9))."""
    SINE = 1
    POLYNOMIAL = 2
    B_SPLINE = 3
    QUINTIC = 4
    """Of Zhang 2022, in one piece."""


class Form(NamedTuple):
    """A function of t and its first two derivatives."""

    value: float
    slope: float
    bend: float


class Curve(NamedTuple):
    """The path from ``start`` (slot's frame) to the origin, and what it asks of the car."""

    shape: int = PathShape.TWO_ARCS
    start: Pose = Pose()
    curvature: float = 0.0
    """Largest [1/m]."""
    swing: float = 0.0
    """Largest change of the front-wheel angle over the way [rad/m]."""
    inflection: Pose = Pose()
    """Where the path begins to turn the other way: Q1."""


class OnCurve(NamedTuple):
    """The path at one x."""

    y: float
    heading: float
    curvature: float


def curve(shape: int, start: Pose, wheelbase: float) -> Curve:
    """Return the path of ``shape`` from ``start``, which lies ahead of the target."""
    bare = Curve(shape, start)
    largest = 0.0
    swing = 0.0
    inflection = Pose()
    before = on_curve(bare, start.x)
    step = start.x / PATH_SAMPLES
    for number in range(1, PATH_SAMPLES + 1):
        x = start.x - step * number
        here = on_curve(bare, x)
        largest = max(largest, abs(here.curvature))
        way = step / math.cos(0.5 * (here.heading + before.heading))
        turned = math.atan(wheelbase * here.curvature) - math.atan(wheelbase * before.curvature)
        swing = max(swing, abs(turned) / way)
        if before.curvature < 0.0 <= here.curvature:
            inflection = Pose(x, here.y, here.heading)
        before = here
    return Curve(shape, start, largest, swing, inflection)


def on_curve(path: Curve, x: float) -> OnCurve:
    """Return y [m], heading and curvature of the path at ``x`` [m]."""
    start = path.start
    slope0 = math.tan(start.heading)
    if x > start.x:
        return OnCurve(start.y + (x - start.x) * slope0, start.heading, 0.0)
    if x < 0.0:
        return OnCurve(0.0, 0.0, 0.0)
    rise = rising(path.shape, x / start.x)
    lean = leaning(path.shape, x / start.x)
    slope = start.y * rise.slope / start.x + slope0 * lean.slope
    bend = (start.y * rise.bend / start.x + slope0 * lean.bend) / start.x
    norm = 1.0 + slope * slope
    return OnCurve(
        start.y * rise.value + slope0 * start.x * lean.value, math.atan(slope), bend / (norm * math.sqrt(norm))
    )


def rising(shape: int, t: float) -> Form:
    """Return S of a shape."""
    if shape == PathShape.SINE:
        return Form(t - math.sin(TWO_PI * t) / TWO_PI, 1.0 - math.cos(TWO_PI * t), TWO_PI * math.sin(TWO_PI * t))
    if shape == PathShape.POLYNOMIAL:
        return Form(t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t), 6.0 - 12.0 * t)
    if shape == PathShape.B_SPLINE:
        half = _b_spline(t if t <= 0.5 else 1.0 - t)
        return half if t <= 0.5 else Form(1.0 - half.value, half.slope, -half.bend)
    return Form(
        t * t * t * (10.0 + t * (6.0 * t - 15.0)),
        30.0 * t * t * (1.0 + t * (t - 2.0)),
        60.0 * t * (1.0 + t * (2.0 * t - 3.0)),
    )


def leaning(shape: int, t: float) -> Form:
    """Return H of a shape."""
    if shape == PathShape.POLYNOMIAL:
        return Form(t * t * (t - 1.0), t * (3.0 * t - 2.0), 6.0 * t - 2.0)
    return Form(
        t * t * t * (-4.0 + t * (7.0 - 3.0 * t)),
        t * t * (-12.0 + t * (28.0 - 15.0 * t)),
        t * (-24.0 + t * (84.0 - 60.0 * t)),
    )


def way_left(path: Curve, x: float) -> float:
    """Return the way [m] along the path from ``x`` to the target."""
    half = 0.5 * clamp(x, 0.0, path.start.x)
    way = 0.0
    for number in range(5):
        way += WEIGHTS[number] / math.cos(on_curve(path, half * (1.0 + NODES[number])).heading)
    return half * way


def _b_spline(t: float) -> Form:
    """Return the first half of the B-spline, t up to 1/2."""
    if t <= 0.25:
        return Form(16.0 / 3.0 * t * t * t, 16.0 * t * t, 32.0 * t)
    u = t - 0.25
    return Form(1.0 / 12.0 + u * (1.0 + u * (4.0 - 16.0 / 3.0 * u)), 1.0 + u * (8.0 - 16.0 * u), 8.0 - 32.0 * u)
