"""Where an echo came from and off what: a quadratic regression of the range over the sensor's path.

Along a straight path s the range to a body at rest is r = a + b s + c s2 near the middle of the window, with

    b = -u d       u: unit vector from the sensor to the echo, d: unit vector of the path; so b gives the bearing
    c = 0          off a straight side (``SIDE``)
    c = (1 - b2) / 2 a   off a corner or a post (``CORNER``)
    c < 0          never off one convex body: the window spans two of them

A bearing outside the cone means that the boundary of the beam met the body: no feature. (Regression on the distance
function; its gradient is -u wherever it is smooth.)
"""

import math
from enum import IntEnum
from typing import NamedTuple

from controller_fmu.parking.measurement.echo_window import MIDDLE, WINDOW, EchoSample, EchoWindow
from modelkit.maths import clamp

DECISION_SIGMA = 2.0
"""A curvature this many standard deviations below 0 is concave: a window over two bodies (2 % of the others)."""
FAR_SIGMA = 3.0
"""Where a corner bends the range by less than three standard deviations it cannot be told from a side: a side is
assumed, which stays short if it is a corner. With 1 cm noise at 2 m/s that is beyond 1.9 m."""
ACROSS_SLOPE = 0.15
"""So it is only within 9 deg of across the path, as kerbs and walls along the road are."""
MAX_SLOPE = 0.9
"""Beyond |b| = 0.9 (bearing within 26 deg of the path) the bearing follows from b too badly."""
MAX_TURN_COS = 0.99
"""The sensor's axis turns by at most 8 deg over a window; else the path is not straight."""
VIEW_TOLERANCE = 0.05
"""A bearing may lie this much outside the cone, in cosine: 4 deg at a half cone of 30 deg, two standard deviations."""


class FeatureType(IntEnum):
    """What an echo came from."""

    NONE = 0
    SIDE = 1
    CORNER = 2
    UNDECIDED = 3
    """A point of a surface; side or corner is about as likely."""


class EchoFeature(NamedTuple):
    """The middle echo of a window, with the direction that it came from; SI units."""

    type: int = FeatureType.NONE
    x: float = 0.0
    """The point that returned the echo."""
    y: float = 0.0
    ux: float = 1.0
    """Unit vector from the sensor to that point."""
    uy: float = 0.0
    range: float = 0.0
    sensor_x: float = 0.0
    sensor_y: float = 0.0
    bearing_sigma: float = 0.0
    """Standard deviation of the direction [rad]."""


class RangeFit(NamedTuple):
    """r = a + b s + c s2, and the standard deviations of b [1] and c [1/m] per unit of range noise."""

    a: float
    b: float
    c: float
    b_sigma: float
    c_sigma: float


def echo_feature(window: EchoWindow, variance: float, cone_cos: float) -> EchoFeature:
    """Return the feature at the middle of a full window; ``variance`` [m2] of an echo, cosine of the half cone."""
    first = window.samples[0]
    middle = window.samples[MIDDLE]
    last = window.samples[WINDOW - 1]
    dx = last.x - first.x
    dy = last.y - first.y
    length = math.sqrt(dx * dx + dy * dy)
    straight = first.axis_x * last.axis_x + first.axis_y * last.axis_y > MAX_TURN_COS
    if window.used < WINDOW or not window.is_new or length <= 0.0 or not straight:
        return EchoFeature()
    dx = dx / length
    dy = dy / length
    fit = fit_range(window, dx, dy)
    sigma = math.sqrt(variance)
    if abs(fit.b) > MAX_SLOPE or fit.c < -DECISION_SIGMA * sigma * fit.c_sigma:
        return EchoFeature()
    side = 1.0 if dx * middle.axis_y - dy * middle.axis_x > 0.0 else -1.0
    across = side * math.sqrt(1.0 - fit.b * fit.b)
    ux = -fit.b * dx - across * dy
    uy = -fit.b * dy + across * dx
    if ux * middle.axis_x + uy * middle.axis_y < cone_cos - VIEW_TOLERANCE:
        return EchoFeature()
    kind = _feature_type(fit, sigma)
    bearing_sigma = sigma * fit.b_sigma / abs(across)
    x = middle.x + fit.a * ux
    y = middle.y + fit.a * uy
    return EchoFeature(kind, x, y, ux, uy, fit.a, middle.x, middle.y, bearing_sigma)


def _feature_type(fit: RangeFit, sigma: float) -> int:
    """Return side, corner or undecided: by the difference of chi-square of c = 0 and c = (1 - b2) / 2 a."""
    corner = (1.0 - fit.b * fit.b) / (2.0 * max(fit.a, 0.01))
    scale = sigma * fit.c_sigma
    as_side = fit.c / scale
    as_corner = (fit.c - corner) / scale
    if corner < FAR_SIGMA * scale and abs(as_side) < DECISION_SIGMA and abs(fit.b) < ACROSS_SLOPE:
        return FeatureType.SIDE
    difference = as_side * as_side - as_corner * as_corner
    if difference > DECISION_SIGMA * DECISION_SIGMA:
        return FeatureType.CORNER
    return FeatureType.SIDE if difference < -DECISION_SIGMA * DECISION_SIGMA else FeatureType.UNDECIDED


def fit_range(window: EchoWindow, dx: float, dy: float) -> RangeFit:
    """Return the least-squares parabola of range over distance along (dx, dy) from the middle echo."""
    middle = window.samples[MIDDLE]
    s1 = 0.0
    s2 = 0.0
    s3 = 0.0
    s4 = 0.0
    r0 = 0.0
    r1 = 0.0
    r2 = 0.0
    for number in range(WINDOW):
        sample = window.samples[number]
        s = _along(sample, middle, dx, dy)
        s1 += s
        s2 += s * s
        s3 += s * s * s
        s4 += s * s * s * s
        r0 += sample.range
        r1 += sample.range * s
        r2 += sample.range * s * s
    n = float(WINDOW)
    # the normal matrix [[n, s1, s2], [s1, s2, s3], [s2, s3, s4]] by cofactors
    c00 = s2 * s4 - s3 * s3
    c01 = s2 * s3 - s1 * s4
    c02 = s1 * s3 - s2 * s2
    c11 = n * s4 - s2 * s2
    c12 = s1 * s2 - n * s3
    c22 = n * s2 - s1 * s1
    determinant = n * c00 + s1 * c01 + s2 * c02
    if determinant <= 0.0:
        return RangeFit(middle.range, 1.0, 0.0, 1.0, 1.0)
    return RangeFit(
        (c00 * r0 + c01 * r1 + c02 * r2) / determinant,
        clamp((c01 * r0 + c11 * r1 + c12 * r2) / determinant, -1.0, 1.0),
        (c02 * r0 + c12 * r1 + c22 * r2) / determinant,
        math.sqrt(c11 / determinant),
        math.sqrt(c22 / determinant),
    )


def _along(sample: EchoSample, middle: EchoSample, dx: float, dy: float) -> float:
    return (sample.x - middle.x) * dx + (sample.y - middle.y) * dy
