"""A segment by least squares on the ranges of a chain of echoes: line and both ends at once (Gauss-Newton).

In a frame along the segment an echo at (u, v), v > 0 on the side of the sensor, comes from the nearest point t of it:

    h = sqrt((u - t)2 + v2),  t = u clamped to [start, end]
    dh = -(v / h) (dc + t dq) - (u - t) / h dt

with c the line's shift towards the sensor, q its turn, and dt that of an end where t is one. So the same few parameters
explain the side and, beyond it, the echoes of its corners: from these the ends are known far better than from where the
echoes cease, which the opening of the cone decides. Residuals beyond ``ROBUST_SIGMA`` count less (Cauchy weights).
"""

import math
from typing import NamedTuple

from controller_fmu.parking.map.echo_chain import MAX_ECHOES, EchoChain
from controller_fmu.parking.map.landmark import Landmark, with_offset_variance
from modelkit.geometry import Point
from modelkit.maths import wrap_angle

MAX_ITERATIONS = 5
"""Of Gauss and Newton."""
ROBUST_SIGMA = 3.0
"""Standard deviations."""
ASKEW_SIGMA = 0.15
"""Sides along a sensor's path are within 9 deg of it (misaligned cars, a pass that is not parallel)."""
MAX_TURN = 0.3
"""One step turns the line by at most this [rad]: the ranges are not linear beyond."""
MAX_SHIFT = 0.5
"""And shifts an end by at most this [m]."""
SURFACE_DEVIATION = 0.01
"""Standard deviation [m] of a side from a straight line, and of where its sensor is mounted."""
LEAST_WEIGHT = 1e-9
"""Of an unknown that no echo determines."""
MIN_EXTENT = 0.02
"""Shortest segment [m]."""


class EndGuess(NamedTuple):
    """Where an end is expected along the line [m], and its standard deviation [m]."""

    along: float
    sigma: float
    inset: float = 0.0
    """The iteration begins so far [m] inside of it: an end beyond all echoes would stay where it is."""


class SegmentGuess(NamedTuple):
    """A line near the segment, and where its ends are expected along that line."""

    line: Landmark
    start: EndGuess
    end: EndGuess


class NormalEquations(NamedTuple):
    """J'WJ and J'Wr (``right``) of shift c [m], turn q [rad], start a and end b [m]; chi square of the residuals r."""

    matrix: tuple[float, ...] = (0.0,) * 9
    """cc, cq, qq, ca, qa, aa, cb, qb, bb: the ends do not couple."""
    right: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    chi_square: float = 0.0


class SegmentFit(NamedTuple):
    """The segment with its covariance, and the robust sum of squared residuals over the variance."""

    landmark: Landmark
    chi_square: float


def fit_segment(chain: EchoChain, first: int, last: int, guess: SegmentGuess, variance: float) -> SegmentFit:
    """Return the segment that the echoes ``first`` to ``last`` of a chain came from; ``variance`` [m2] of an echo.

    The guesses of direction and ends weigh as measurements do.
    """
    start = guess.start.along + guess.start.inset
    end = max(guess.end.along - guess.end.inset, start + MIN_EXTENT)
    segment = guess.line._replace(start=start, end=end)
    normal = NormalEquations()
    for _ in range(MAX_ITERATIONS):
        normal = _normal_equations(chain, first, last, segment, guess, variance)
        segment = _apply_step(segment, solve(normal, normal.right))
    return SegmentFit(_with_covariance(segment, normal), normal.chi_square)


def _normal_equations(
    chain: EchoChain, first: int, last: int, segment: Landmark, guess: SegmentGuess, variance: float
) -> NormalEquations:
    """Return the normal equations at ``segment``, with the guesses of direction and ends."""
    aa = 1.0 / (guess.start.sigma * guess.start.sigma)
    bb = 1.0 / (guess.end.sigma * guess.end.sigma)
    right = (0.0, 0.0, (guess.start.along - segment.start) * aa, (guess.end.along - segment.end) * bb)
    normal = NormalEquations((0.0,) * 5 + (aa, 0.0, 0.0, bb), right)
    cos = math.cos(segment.heading)
    sin = math.sin(segment.heading)
    for number in range(MAX_ECHOES):
        if first <= number <= last:
            echo = chain.echoes[number]
            dx = echo.x - segment.x
            dy = echo.y - segment.y
            at = Point(dx * cos + dy * sin, dy * cos - dx * sin)
            normal = _with_echo(normal, at, echo.range, segment, variance)
    weight = 1.0 / (ASKEW_SIGMA * ASKEW_SIGMA)
    turn = wrap_angle(guess.line.heading - segment.heading)
    m = normal.matrix
    c, q, a, b = normal.right
    return normal._replace(matrix=(m[0] + 1.0, m[1], m[2] + weight) + m[3:], right=(c, q + weight * turn, a, b))


def _with_echo(
    normal: NormalEquations, at: Point, measured: float, segment: Landmark, variance: float
) -> NormalEquations:
    """Return the normal equations with an echo measured ``at`` (u, v) [m] in the segment's frame, of robust weight."""
    t = min(max(at.x, segment.start), segment.end)
    h = max(math.sqrt((at.x - t) * (at.x - t) + at.y * at.y), MIN_EXTENT)
    residual = measured - h
    weight = 1.0 / (variance + residual * residual / (ROBUST_SIGMA * ROBUST_SIGMA))
    across = -at.y / h
    along = -(at.x - t) / h
    turning = across * t
    of_start = along if at.x < segment.start else 0.0
    of_end = along if at.x > segment.end else 0.0
    row = (across, turning, turning, across, turning, of_start, across, turning, of_end)
    other = (across, across, turning, of_start, of_start, of_start, of_end, of_end, of_end)
    c, q, a, b = normal.right
    pull = weight * residual
    matrix = tuple(normal.matrix[number] + weight * row[number] * other[number] for number in range(9))
    right = (c + pull * across, q + pull * turning, a + pull * of_start, b + pull * of_end)
    return NormalEquations(matrix, right, normal.chi_square + pull * residual)


def solve(normal: NormalEquations, right: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    """Return the unknowns [m, rad] for a right-hand side: the ends are eliminated (they do not couple), then 2 x 2."""
    cc, cq, qq, ca, qa, aa, cb, qb, bb = normal.matrix
    aa = max(aa, LEAST_WEIGHT)
    bb = max(bb, LEAST_WEIGHT)
    cc = cc - ca * ca / aa - cb * cb / bb
    cq = cq - ca * qa / aa - cb * qb / bb
    qq = qq - qa * qa / aa - qb * qb / bb
    c = right[0] - ca * right[2] / aa - cb * right[3] / bb
    q = right[1] - qa * right[2] / aa - qb * right[3] / bb
    determinant = max(cc * qq - cq * cq, LEAST_WEIGHT)
    shift = (qq * c - cq * q) / determinant
    turn = (cc * q - cq * c) / determinant
    return (shift, turn, (right[2] - ca * shift - qa * turn) / aa, (right[3] - cb * shift - qb * turn) / bb)


def _apply_step(segment: Landmark, step: tuple[float, float, float, float]) -> Landmark:
    """Return the segment changed by a step of bounded size."""
    shift = min(max(step[0], -MAX_SHIFT), MAX_SHIFT)
    turn = min(max(step[1], -MAX_TURN), MAX_TURN)
    start = segment.start + min(max(step[2], -MAX_SHIFT), MAX_SHIFT)
    end = segment.end + min(max(step[3], -MAX_SHIFT), MAX_SHIFT)
    if end < start + MIN_EXTENT:
        start = 0.5 * (start + end - MIN_EXTENT)
        end = start + MIN_EXTENT
    x = segment.x - shift * math.sin(segment.heading)
    y = segment.y + shift * math.cos(segment.heading)
    return segment._replace(x=x, y=y, heading=wrap_angle(segment.heading + turn), start=start, end=end)


def _with_covariance(segment: Landmark, normal: NormalEquations) -> Landmark:
    """Return the segment with the inverse of its normal matrix as covariance."""
    of_shift = solve(normal, (1.0, 0.0, 0.0, 0.0))
    of_turn = solve(normal, (0.0, 1.0, 0.0, 0.0))
    of_start = solve(normal, (0.0, 0.0, 1.0, 0.0))
    of_end = solve(normal, (0.0, 0.0, 0.0, 1.0))
    segment = with_offset_variance(segment, of_shift[0] + SURFACE_DEVIATION * SURFACE_DEVIATION)
    xh = of_shift[1] * -math.sin(segment.heading)
    yh = of_shift[1] * math.cos(segment.heading)
    return segment._replace(xh=xh, yh=yh, hh=of_turn[1], start_variance=of_start[2], end_variance=of_end[3])
