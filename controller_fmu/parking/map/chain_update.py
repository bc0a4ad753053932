"""From chains of echoes to landmarks: fit a segment, split it where two bodies seem one, merge it with the map.

One convex body leaves ranges that fall, stay and rise. Where they rise and fall again in between, two bodies stand side
by side; the fit of two segments must then explain the echoes better than that of one (ratio of likelihoods).
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import planar_distance
from controller_fmu.parking.map.echo_chain import (
    MAX_ECHOES,
    MAX_EDGE_RANGE,
    ChainEcho,
    EchoChain,
    Ending,
    append_echo,
    begin_chain,
    continues,
    is_passed,
    is_turned_back,
    without_echoes_before,
)
from controller_fmu.parking.map.landmark import (
    MAX_LANDMARKS,
    Landmark,
    LandmarkType,
    along_of,
    end_point,
    free_index,
    length_of,
    offset_of,
    offset_variance,
    replace_landmark,
    segment_point,
    start_point,
)
from controller_fmu.parking.map.params import BAY_SIGMA, BAY_WIDTH, CAR_WIDTH, CAR_WIDTH_SIGMA, MappingParams
from controller_fmu.parking.map.segment_fit import (
    ROBUST_SIGMA,
    SURFACE_DEVIATION,
    EndGuess,
    SegmentFit,
    SegmentGuess,
    fit_segment,
)
from controller_fmu.parking.measurement.predicted_range import EchoOrigin, predict_range_to_segment
from controller_fmu.parking.measurement.sensor import Measurement, ReadingStatus, SensorPose, boundary_point
from modelkit.maths import wrap_angle

MIN_ECHOES = 4
"""Of a chain that makes a landmark: three unknowns and one to spare."""
REFIT_ECHOES = 3
"""A chain is fitted again after so many more echoes."""
CONE_SIGMA = 0.08
"""Tangent of the half cone: how far it may be off (26 to 34 deg instead of 30), standard deviation."""
OPEN_SIGMA = 0.5
"""An end at which the chain was hidden or has not ended is not known: standard deviation [m]."""
OPEN_INSET = 0.3
"""Half of the widest gap [m] over which the echoes of two bodies go on without a jump."""
HUMP_HALF_WIDTH = 4
"""Echoes on either side of a hump's middle: the ranges over a gap of 0.7 m, at 2 m/s."""
MIN_PART = HUMP_HALF_WIDTH + 1
"""Echoes of either part of a chain that is split."""
MIN_HUMP = MIN_PART + HUMP_HALF_WIDTH
"""Echoes before and after a hump's middle."""
SPLIT_CHI_SQUARE = 16.3
"""Two segments must explain the echoes better by this: three unknowns more, chi square at 0.1 %."""
SPLIT_UNKNOWNS = 7
"""Two lines of two unknowns, and three ends."""
GAP_WIDTHS = (0.4, 0.6, 0.8, 1.0, 1.2)
"""Between cars in a row [m], each as likely as the others."""
MAX_GAP_EVIDENCE = 9.2
"""Log-likelihood ratio beyond which echoes of a hump decide nothing more."""
KNOWN_SIGMA = 0.25
"""An edge is known once its standard deviation [m] is below this: half of the widest gap inside a row."""
POINT_LENGTH = 0.15
"""What is shorter [m] is a post or one corner, of unknown direction."""
SAME_OVERLAP = 0.3
"""Two sides are one if they overlap by this fraction of the shorter."""
MIN_SURE_LENGTH = 0.5
MAX_TURN_SIGMA = 0.08
"""A segment longer than ``MIN_SURE_LENGTH`` [m] whose direction has a larger standard deviation [rad] is two faces of a
body, measured in a turn."""
VIEW_TOLERANCE = 0.07
"""A point may lie so far outside the cone, in cosine: cones open by up to 34 deg instead of 30, and sensors look 2 deg
aside."""
MAX_MISFIT = 4.0
"""Mean squared residual over the variance of a chain that no segment explains."""


class ChainEnd(NamedTuple):
    """Whether a part of a chain ends at an edge, else how far [m] inside its last echo the side may end."""

    is_edge: bool
    inset: float
    is_known: bool
    """The side ends there: at an edge, or where the chain is split."""


class ChainUpdate(NamedTuple):
    """Landmarks and the chain after a fit."""

    landmarks: tuple[Landmark, ...] = (Landmark(),) * MAX_LANDMARKS
    chain: EchoChain = EchoChain()


def chain_ending(chain: EchoChain, reading: Measurement) -> int:
    """Return the ``Ending`` of a chain that a reading shows: hidden, too, where the vehicle turns back."""
    if reading.status == ReadingStatus.BLIND_ZONE or reading.status == ReadingStatus.INVALID:
        return Ending.HIDDEN
    if chain.used == 0:
        return Ending.CONTINUES
    if reading.status == ReadingStatus.NO_ECHO:
        passed = is_passed(chain._replace(lost=chain.lost + 1), reading.sensor)
        end = Ending.EDGE if last_range(chain) < MAX_EDGE_RANGE else Ending.HIDDEN
        return end if passed else Ending.CONTINUES
    if is_turned_back(chain, reading.sensor):
        return Ending.HIDDEN
    if continues(chain, reading.sensor, reading.range, reading.variance):
        return Ending.CONTINUES
    return Ending.EDGE if reading.range > last_range(chain) else Ending.HIDDEN


def next_chain(chain: EchoChain, reading: Measurement, ending: int) -> EchoChain:
    """Return the chain after a reading: with one more echo, or the one that begins."""
    if reading.status == ReadingStatus.BLIND_ZONE or reading.status == ReadingStatus.INVALID:
        return EchoChain()
    if reading.status == ReadingStatus.NO_ECHO:
        lost = chain.lost + 1
        return chain._replace(lost=lost) if ending == Ending.CONTINUES else EchoChain(lost=lost)
    if chain.used == 0:
        return begin_chain(reading.sensor, reading.range, chain.lost > 0 and reading.range < MAX_EDGE_RANGE)
    if ending != Ending.CONTINUES:
        hides = not is_turned_back(chain, reading.sensor) and reading.range < last_range(chain)
        return begin_chain(reading.sensor, reading.range, hides)
    return append_echo(chain, reading.sensor, reading.range)


def last_range(chain: EchoChain) -> float:
    """Return the range [m] of a chain's last echo."""
    return chain.echoes[max(chain.used - 1, 0)].range


def fit_chain(update: ChainUpdate, reading: Measurement, ends_at_edge: bool, params: MappingParams) -> ChainUpdate:
    """Return landmarks and chain after a fit; of a chain of two bodies the first is mapped, the second goes on."""
    chain = update.chain
    last = chain.used - 1
    begins = ChainEnd(chain.begins_at_edge, OPEN_INSET, chain.begins_at_edge)
    ends = ChainEnd(ends_at_edge, OPEN_INSET, ends_at_edge)
    whole = _fit_part(chain, first_of_body(chain, reading.variance), last, reading, begins, ends)
    at = parting_echo(chain, whole.landmark)
    if at > 0:
        # half of the gap between both bodies, by the echo at its middle: range2 = distance2 + (gap / 2)2
        distance = distance_to_segment(whole.landmark, chain.echoes[at].x, chain.echoes[at].y)
        square = chain.echoes[at].range * chain.echoes[at].range - distance * distance
        parts = ChainEnd(False, math.sqrt(max(square, 0.0)), True)
        first = _fit_part(chain, 0, at - 1, reading, begins, parts)
        second = _fit_part(chain, at, last, reading, parts, ends)
        segments = (whole.landmark, first.landmark, second.landmark)
        if split_gain(chain, at, segments, reading.variance) > SPLIT_CHI_SQUARE:
            first = _with_gap_evidence(first, chain, 0, at - 1, at // 2, reading.variance)
            update = _put(update, first, at, params)
            update = update._replace(chain=without_echoes_before(chain, at))
            second = _with_gap_evidence(second, chain, at, last, (at + last) // 2, reading.variance)
            return _put(update, second, update.chain.used, params)
    if whole.chi_square > MAX_MISFIT * chain.used or not is_explained(
        chain, whole.landmark, reading.sensor, reading.variance
    ):
        return update._replace(chain=update.chain._replace(fitted=update.chain.used))
    whole = _with_gap_evidence(whole, chain, 0, last, at if at > 0 else last // 2, reading.variance)
    return _put(update, whole, update.chain.used, params)


def _with_gap_evidence(
    fit: SegmentFit, chain: EchoChain, first: int, last: int, top: int, variance: float
) -> SegmentFit:
    """Return the fit of a part of a chain with the log-likelihood ratio of a gap between cars across the road in it.

    Over a gap of width w ranges at the distance d rise by t2 / 2d, t from the nearer corner. A matched filter tells how
    well that explains the hump with its ``top``; a gap there leaves whole cars on both sides. The ``variance`` [m2] of
    an echo is at least that of the residuals.
    """
    segment = fit.landmark
    total = 0.0
    for number in range(MAX_ECHOES):
        if first <= number <= last:
            total += chi_square_of(segment, chain.echoes[number], variance)
    noise = variance * max(1.0, total / (last - first + 1))
    middle = along_of(segment, chain.echoes[top].x, chain.echoes[top].y)
    ratio = 0.0
    for width in GAP_WIDTHS:
        found = 0.0
        expected = 0.0
        for number in range(MAX_ECHOES):
            echo = chain.echoes[number]
            t = 0.5 * width - abs(along_of(segment, echo.x, echo.y) - middle)
            if first <= number <= last and t > 0.0:
                rise = 0.5 * t * t / echo.range
                found += rise * range_behind(segment, echo) / noise
                expected += rise * rise / noise
        before = _share_of_cars(middle - 0.5 * width - segment.start)
        share = before * _share_of_cars(segment.end - middle - 0.5 * width)
        elsewhere = math.exp(-min(0.5 * expected, MAX_GAP_EVIDENCE))
        there = math.exp(min(max(found - 0.5 * expected, -MAX_GAP_EVIDENCE), MAX_GAP_EVIDENCE))
        ratio += elsewhere + (there - elsewhere) * share
    return fit._replace(landmark=segment._replace(gap_evidence=math.log(ratio / len(GAP_WIDTHS))))


def _share_of_cars(length: float) -> float:
    """Return how well cars across the road, one per bay, explain a part of a side of ``length`` [m]: 0 to 1.

    The last one may be observed in part only; beyond the side's end there is none.
    """
    excess = max(length - CAR_WIDTH, 0.0)
    bays = math.floor(excess / BAY_WIDTH + 0.5)
    deviation = excess - bays * BAY_WIDTH
    variance = CAR_WIDTH_SIGMA * CAR_WIDTH_SIGMA + bays * BAY_SIGMA * BAY_SIGMA
    return math.exp(-0.5 * deviation * deviation / variance) if length > 0.0 else 0.0


def first_of_body(chain: EchoChain, variance: float) -> int:
    """Return the index of a chain's first echo (``variance`` [m2]) after those of a nearer body: ranges rise, fall."""
    top = 0
    for number in range(1, MIN_PART):
        if number + MIN_ECHOES < chain.used and chain.echoes[number].range > chain.echoes[top].range:
            top = number
    rise = chain.echoes[top].range - chain.echoes[0].range
    falls = chain.echoes[top + 1].range < chain.echoes[top].range
    return top if not chain.begins_at_edge and falls and rise > ROBUST_SIGMA * math.sqrt(2.0 * variance) else 0


def is_explained(chain: EchoChain, segment: Landmark, sensor: SensorPose, variance: float) -> bool:
    """Return whether a segment returns three of four echoes (``variance`` [m2]) where the ``sensor`` measured them.

    Else they came from several bodies, or from where the cone's boundary met a side turned away from the sensor: that
    point moves along the side, so the ranges are those of another line. The boundary may be off by ``CONE_SIGMA``.
    """
    a = start_point(segment)
    b = end_point(segment)
    wide = sensor._replace(cone_cos=sensor.cone_cos - VIEW_TOLERANCE, cone_sin=sensor.cone_sin + CONE_SIGMA)
    tolerance = ROBUST_SIGMA * math.sqrt(variance + SURFACE_DEVIATION * SURFACE_DEVIATION)
    outside = 0
    for number in range(MAX_ECHOES):
        if number < chain.used:
            echo = chain.echoes[number]
            at = wide._replace(x=echo.x, y=echo.y, axis_x=echo.axis_x, axis_y=echo.axis_y)
            predicted_echo = predict_range_to_segment(at, a, b)
            opening = CONE_SIGMA * echo.range if predicted_echo.origin == EchoOrigin.CONE_EDGE else 0.0
            if abs(predicted_echo.distance - echo.range) > tolerance + opening:
                outside += 1
    return 4 * outside <= chain.used


def range_behind(segment: Landmark, echo: ChainEcho) -> float:
    """Return how much farther [m] an echo is than the segment."""
    return echo.range - distance_to_segment(segment, echo.x, echo.y)


def _fit_part(
    chain: EchoChain, first: int, last: int, reading: Measurement, begins: ChainEnd, ends: ChainEnd
) -> SegmentFit:
    """Return the fit of a part of a chain whose ends are edges or not."""
    sensor = reading.sensor
    line = initial_line(chain, first, last, sensor)
    a = chain.echoes[first]
    b = chain.echoes[last]
    start = along_of(line, a.x, a.y)
    end = along_of(line, b.x, b.y)
    towards = 1.0 if start < end else -1.0
    a_guess = EndGuess(start, OPEN_SIGMA, begins.inset)
    b_guess = EndGuess(end, OPEN_SIGMA, ends.inset)
    if begins.is_edge:
        a_guess = edge_guess(line, a, sensor, towards, _step(a, chain.echoes[min(first + 1, MAX_ECHOES - 1)]))
    if ends.is_edge:
        b_guess = edge_guess(line, b, sensor, -towards, _step(b, chain.echoes[max(last - 1, 0)]))
    if towards < 0.0:
        guess = SegmentGuess(line, b_guess, a_guess)
        return _as_observed(fit_segment(chain, first, last, guess, reading.variance), b, a, ends, begins)
    guess = SegmentGuess(line, a_guess, b_guess)
    return _as_observed(fit_segment(chain, first, last, guess, reading.variance), a, b, begins, ends)


def _as_observed(fit: SegmentFit, start: ChainEcho, end: ChainEcho, starts: ChainEnd, ends: ChainEnd) -> SegmentFit:
    """Return a fit that goes on, at an end that is no edge, only as far as its outermost echo shows the line."""
    segment = fit.landmark._replace(start_known=starts.is_known, end_known=ends.is_known)
    low = segment.start if starts.is_edge else max(segment.start, along_of(segment, start.x, start.y))
    high = segment.end if ends.is_edge else min(segment.end, along_of(segment, end.x, end.y))
    if low < high:
        segment = segment._replace(start=low, end=high)
    return fit._replace(landmark=segment)


def edge_guess(line: Landmark, echo: ChainEcho, sensor: SensorPose, inwards: float, step: float) -> EndGuess:
    """Return where a body that lies ``inwards`` (1, -1) along ``line`` ends, by its outermost echo.

    The end came into the cone at any place of the ``step`` [m] before that echo (evenly distributed).
    """
    along = inwards * along_of(line, echo.x, echo.y)
    at = sensor._replace(x=echo.x, y=echo.y, axis_x=echo.axis_x, axis_y=echo.axis_y)
    for side in (-1.0, 1.0):
        point = boundary_point(at, echo.range, side)
        along = max(along, inwards * along_of(line, point.x, point.y))
    opening = CONE_SIGMA * echo.range
    return EndGuess(inwards * (along - 0.5 * step), math.sqrt(opening * opening + step * step / 12.0))


def _step(echo: ChainEcho, other: ChainEcho) -> float:
    """Return the distance [m] between the places of a sensor at two echoes."""
    return planar_distance(echo.x, echo.y, other.x, other.y)


def initial_line(chain: EchoChain, first: int, last: int, sensor: SensorPose) -> Landmark:
    """Return a line along the path of a part of a chain, through the point on the axis of its nearest echo."""
    a = chain.echoes[first]
    b = chain.echoes[last]
    nearest = first
    for number in range(MAX_ECHOES):
        if first <= number <= last and chain.echoes[number].range < chain.echoes[nearest].range:
            nearest = number
    heading = math.atan2(b.y - a.y, b.x - a.x)
    left_is_sensor = (sensor.axis_y * math.cos(heading) - sensor.axis_x * math.sin(heading)) < 0.0
    if not left_is_sensor:
        heading = wrap_angle(heading + math.pi)
    echo = chain.echoes[nearest]
    x = echo.x + echo.range * math.sin(heading)
    y = echo.y - echo.range * math.cos(heading)
    return Landmark(type=LandmarkType.SEGMENT, x=x, y=y, heading=heading)


def parting_echo(chain: EchoChain, segment: Landmark) -> int:
    """Return the index of the echo that divides two bodies: the top of the largest hump over ``segment``; 0: none."""
    best = 0.0
    at = 0
    for number in range(MAX_ECHOES):
        if MIN_HUMP <= number <= chain.used - 1 - MIN_HUMP:
            total = 0.0
            for near in range(-HUMP_HALF_WIDTH, HUMP_HALF_WIDTH + 1):
                total += range_behind(segment, chain.echoes[number + near])
            if total > best:
                best = total
                at = number
    return _hump_top(chain, segment, at) if at > 0 else 0


def _hump_top(chain: EchoChain, segment: Landmark, middle: int) -> int:
    """Return the echo of a hump that lies farthest behind the segment: there both corners are equally far."""
    top = middle
    most = 0.0
    for near in range(-HUMP_HALF_WIDTH, HUMP_HALF_WIDTH + 1):
        behind = range_behind(segment, chain.echoes[middle + near])
        if behind > most:
            most = behind
            top = middle + near
    return top


def split_gain(chain: EchoChain, at: int, segments: tuple[Landmark, Landmark, Landmark], variance: float) -> float:
    """Return by how much chi square falls if one segment becomes two, the first before the echo ``at``.

    Where the two do not explain the echoes either, they are noisier than ``variance`` [m2]: it is scaled (F test).
    """
    gain = 0.0
    left = 0.0
    for number in range(MAX_ECHOES):
        if number < chain.used:
            before = chi_square_of(segments[0], chain.echoes[number], variance)
            after = chi_square_of(segments[1] if number < at else segments[2], chain.echoes[number], variance)
            gain += before - after
            left += after
    return gain / max(1.0, left / max(chain.used - SPLIT_UNKNOWNS, 1))


def chi_square_of(segment: Landmark, echo: ChainEcho, variance: float) -> float:
    """Return the squared residual of an echo over its ``variance`` [m2], limited so that no outlier decides."""
    residual = range_behind(segment, echo)
    return min(residual * residual / variance, ROBUST_SIGMA * ROBUST_SIGMA)


def distance_to_segment(segment: Landmark, x: float, y: float) -> float:
    """Return the distance [m] of a sensor at (x, y) to a segment, whatever its field of view."""
    u = along_of(segment, x, y)
    v = offset_of(segment, x, y)
    t = min(max(u, segment.start), segment.end)
    return math.sqrt((u - t) * (u - t) + v * v)


def _put(update: ChainUpdate, fit: SegmentFit, echoes: int, params: MappingParams) -> ChainUpdate:
    """Return landmarks and chain with a chain's landmark set: the chain's renewed, or a new one.

    Its ends are known where edges were passed, if their place is known well.
    A side that the map holds already, from another chain, takes the place of a shorter look at it. A long segment of
    unsure direction is none: the chain went round a corner. A direction is that of the chain's middle; from there to
    its end the odometry drifts over half of its path.
    """
    path = _step(update.chain.echoes[max(echoes - 1, 0)], update.chain.echoes[0])
    segment = fit.landmark
    new = segment._replace(
        start_known=segment.start_known and segment.start_variance < KNOWN_SIGMA * KNOWN_SIGMA,
        end_known=segment.end_known and segment.end_variance < KNOWN_SIGMA * KNOWN_SIGMA,
        confirmations=echoes,
        hh=segment.hh + 0.5 * path * params.heading_variance,
    )
    update = update._replace(chain=update.chain._replace(fitted=update.chain.used))
    if new.hh > MAX_TURN_SIGMA * MAX_TURN_SIGMA and length_of(new) > MIN_SURE_LENGTH:
        return update
    if length_of(new) < POINT_LENGTH:
        new = as_point(new)
    index = update.chain.landmark
    landmarks = update.landmarks
    other = same_side(landmarks, new, index, params)
    is_known = other >= 0 and is_better(landmarks[other], new)
    if other >= 0 and index >= 0:
        landmarks = replace_landmark(landmarks, index if is_known else other, Landmark())
    if not is_known:
        if index < 0:
            index = other if other >= 0 else free_index(landmarks)
        landmarks = replace_landmark(landmarks, index, new)
    return ChainUpdate(landmarks, update.chain._replace(landmark=-1 if is_known else index))


def same_side(landmarks: tuple[Landmark, ...], new: Landmark, index: int, params: MappingParams) -> int:
    """Return the index of the segment of the map that is the same side as ``new``, not ``index``; -1: none."""
    if new.type != LandmarkType.SEGMENT:
        return -1
    for number in range(MAX_LANDMARKS):
        other = landmarks[number]
        if number != index and other.type == LandmarkType.SEGMENT and math.cos(other.heading - new.heading) > 0.0:
            turn = wrap_angle(other.heading - new.heading)
            a = start_point(new)
            b = end_point(new)
            first = along_of(other, a.x, a.y)
            last = along_of(other, b.x, b.y)
            overlap = min(last, other.end) - max(first, other.start)
            shorter = min(length_of(new), length_of(other))
            across = offset_of(other, 0.5 * (a.x + b.x), 0.5 * (a.y + b.y))
            variance = offset_variance(other, 0.5 * (first + last)) + offset_variance(new, 0.5 * (new.start + new.end))
            turns = turn * turn < params.gate * (other.hh + new.hh)
            if turns and overlap > SAME_OVERLAP * shorter and across * across < params.gate * variance:
                return number
    return -1


def put_facing(landmarks: tuple[Landmark, ...], new: Landmark, params: MappingParams) -> tuple[Landmark, ...]:
    """Return the landmarks with a surface that a bumper approaches: the same side of the map is moved, else added."""
    if new.type == LandmarkType.NONE:
        return landmarks
    index = same_side(landmarks, new, -1, params)
    if index < 0:
        return replace_landmark(landmarks, free_index(landmarks), new)
    known = landmarks[index]
    if length_of(known) <= 2.0 * length_of(new):
        return replace_landmark(landmarks, index, new)
    shift = offset_of(known, new.x, new.y)
    moved = known._replace(x=known.x - shift * math.sin(known.heading), y=known.y + shift * math.cos(known.heading))
    return replace_landmark(landmarks, index, moved)


def is_better(before: Landmark, new: Landmark) -> bool:
    """Return whether ``before``, a side in the map, is known better than ``new``: more known ends, more updates."""
    known_before = (1 if before.start_known else 0) + (1 if before.end_known else 0)
    known_new = (1 if new.start_known else 0) + (1 if new.end_known else 0)
    if known_before != known_new:
        return known_before > known_new
    return before.confirmations > new.confirmations


def as_point(segment: Landmark) -> Landmark:
    """Return a very short segment as a point landmark."""
    at = segment_point(segment, 0.5 * (segment.start + segment.end))
    cos = math.cos(segment.heading)
    sin = math.sin(segment.heading)
    along = 0.5 * (segment.start_variance + segment.end_variance)
    return Landmark(
        type=LandmarkType.POINT,
        x=at.x,
        y=at.y,
        xx=segment.xx + along * cos * cos,
        xy=segment.xy + along * cos * sin,
        yy=segment.yy + along * sin * sin,
        confirmations=segment.confirmations,
    )
