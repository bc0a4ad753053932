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
from controller_fmu.parking.map.landmark import Landmark, LandmarkType
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
    """J'WJ (upper triangle) and J'Wr of shift c, turn q, start a and end b; ``chi_square``: the weighted residuals."""

    cc: float = 0.0
    cq: float = 0.0
    ca: float = 0.0
    cb: float = 0.0
    qq: float = 0.0
    qa: float = 0.0
    qb: float = 0.0
    aa: float = 0.0
    bb: float = 0.0
    rc: float = 0.0
    rq: float = 0.0
    ra: float = 0.0
    rb: float = 0.0
    chi_square: float = 0.0


class SegmentStep(NamedTuple):
    """A change of shift [m], turn [rad], start and end [m]."""

    shift: float
    turn: float
    start: float
    end: float


class SegmentFit(NamedTuple):
    """The segment with its covariance, and the robust sum of squared residuals over the variance."""

    landmark: Landmark
    chi_square: float


def fit_segment(chain: EchoChain, first: int, last: int, guess: SegmentGuess, variance: float) -> SegmentFit:
    """Return the segment that the echoes ``first`` to ``last`` of a chain came from; ``variance`` [m2] of an echo.

    The guesses of the ends weigh as measurements do.
    """
    start = guess.start
    end = guess.end
    initial = guess.line
    first_start = start.along + start.inset
    segment = initial._replace(start=first_start, end=max(end.along - end.inset, first_start + MIN_EXTENT))
    heading = initial.heading
    normal = NormalEquations()
    for _ in range(MAX_ITERATIONS):
        normal = _normal_equations(chain, first, last, segment, guess, variance)
        normal = _with_turn_prior(normal, wrap_angle(heading - segment.heading))
        step = solve(normal, normal.rc, normal.rq, normal.ra, normal.rb)
        segment = _apply_step(segment, step)
    return SegmentFit(_with_covariance(segment, normal), normal.chi_square)


class EchoRow(NamedTuple):
    """A row of the Jacobian: derivatives of a predicted range by shift, turn, start and end; residual [m], weight."""

    shift: float
    turn: float
    start: float
    end: float
    residual: float
    weight: float


def _normal_equations(
    chain: EchoChain, first: int, last: int, segment: Landmark, guess: SegmentGuess, variance: float
) -> NormalEquations:
    """Return the normal equations at ``segment``, with the guesses of the ends."""
    start = guess.start
    end = guess.end
    aa = 1.0 / (start.sigma * start.sigma)
    bb = 1.0 / (end.sigma * end.sigma)
    normal = NormalEquations(aa=aa, bb=bb, ra=(start.along - segment.start) * aa, rb=(end.along - segment.end) * bb)
    cos = math.cos(segment.heading)
    sin = math.sin(segment.heading)
    for number in range(MAX_ECHOES):
        if first <= number <= last:
            echo = chain.echoes[number]
            dx = echo.x - segment.x
            dy = echo.y - segment.y
            row = _echo_row(dx * cos + dy * sin, dy * cos - dx * sin, echo.range, segment, variance)
            normal = _with_row(normal, row)
    return normal


def _echo_row(u: float, v: float, measured: float, segment: Landmark, variance: float) -> EchoRow:
    """Return the row of an echo measured at (u, v) [m] in the segment's frame; its weight is robust."""
    t = min(max(u, segment.start), segment.end)
    h = max(math.sqrt((u - t) * (u - t) + v * v), MIN_EXTENT)
    residual = measured - h
    weight = 1.0 / (variance + residual * residual / (ROBUST_SIGMA * ROBUST_SIGMA))
    across = -v / h
    along = -(u - t) / h
    return EchoRow(
        across,
        across * t,
        along if u < segment.start else 0.0,
        along if u > segment.end else 0.0,
        residual,
        weight,
    )


def _with_row(normal: NormalEquations, row: EchoRow) -> NormalEquations:
    """Return the normal equations with one more echo."""
    w = row.weight
    r = row.residual
    return NormalEquations(
        normal.cc + w * row.shift * row.shift,
        normal.cq + w * row.shift * row.turn,
        normal.ca + w * row.shift * row.start,
        normal.cb + w * row.shift * row.end,
        normal.qq + w * row.turn * row.turn,
        normal.qa + w * row.turn * row.start,
        normal.qb + w * row.turn * row.end,
        normal.aa + w * row.start * row.start,
        normal.bb + w * row.end * row.end,
        normal.rc + w * row.shift * r,
        normal.rq + w * row.turn * r,
        normal.ra + w * row.start * r,
        normal.rb + w * row.end * r,
        normal.chi_square + w * r * r,
    )


def _with_turn_prior(normal: NormalEquations, turn: float) -> NormalEquations:
    """Return the equations with the initial direction, ``turn`` [rad] off the present one, as a measurement."""
    weight = 1.0 / (ASKEW_SIGMA * ASKEW_SIGMA)
    return normal._replace(qq=normal.qq + weight, rq=normal.rq + weight * turn, cc=normal.cc + 1.0)


def solve(normal: NormalEquations, rc: float, rq: float, ra: float, rb: float) -> SegmentStep:
    """Return the step [m, rad] for a right-hand side: the ends are eliminated (they do not couple), then 2 x 2."""
    aa = max(normal.aa, LEAST_WEIGHT)
    bb = max(normal.bb, LEAST_WEIGHT)
    cc = normal.cc - normal.ca * normal.ca / aa - normal.cb * normal.cb / bb
    cq = normal.cq - normal.ca * normal.qa / aa - normal.cb * normal.qb / bb
    qq = normal.qq - normal.qa * normal.qa / aa - normal.qb * normal.qb / bb
    c = rc - normal.ca * ra / aa - normal.cb * rb / bb
    q = rq - normal.qa * ra / aa - normal.qb * rb / bb
    determinant = max(cc * qq - cq * cq, LEAST_WEIGHT)
    shift = (qq * c - cq * q) / determinant
    turn = (cc * q - cq * c) / determinant
    start = (ra - normal.ca * shift - normal.qa * turn) / aa
    end = (rb - normal.cb * shift - normal.qb * turn) / bb
    return SegmentStep(shift, turn, start, end)


def _apply_step(segment: Landmark, step: SegmentStep) -> Landmark:
    """Return the segment changed by a step of bounded size."""
    shift = min(max(step.shift, -MAX_SHIFT), MAX_SHIFT)
    turn = min(max(step.turn, -MAX_TURN), MAX_TURN)
    start = segment.start + min(max(step.start, -MAX_SHIFT), MAX_SHIFT)
    end = segment.end + min(max(step.end, -MAX_SHIFT), MAX_SHIFT)
    if end < start + MIN_EXTENT:
        start = 0.5 * (start + end - MIN_EXTENT)
        end = start + MIN_EXTENT
    return segment._replace(
        x=segment.x - shift * math.sin(segment.heading),
        y=segment.y + shift * math.cos(segment.heading),
        heading=wrap_angle(segment.heading + turn),
        start=start,
        end=end,
    )


def _with_covariance(segment: Landmark, normal: NormalEquations) -> Landmark:
    """Return the segment with the inverse of its normal matrix as covariance."""
    nx = -math.sin(segment.heading)
    ny = math.cos(segment.heading)
    of_shift = solve(normal, 1.0, 0.0, 0.0, 0.0)
    of_turn = solve(normal, 0.0, 1.0, 0.0, 0.0)
    of_start = solve(normal, 0.0, 0.0, 1.0, 0.0)
    of_end = solve(normal, 0.0, 0.0, 0.0, 1.0)
    across = of_shift.shift + SURFACE_DEVIATION * SURFACE_DEVIATION
    return segment._replace(
        type=LandmarkType.SEGMENT,
        xx=across * nx * nx,
        xy=across * nx * ny,
        yy=across * ny * ny,
        xh=of_shift.turn * nx,
        yh=of_shift.turn * ny,
        hh=of_turn.turn,
        start_variance=of_start.start,
        end_variance=of_end.end,
    )
