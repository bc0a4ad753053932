"""Initialisation, merging, shortening and deletion of landmarks."""

import math

from controller_fmu.parking.map.landmark import (
    LANDMARKS,
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
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.map.update import BEARING_OVERLAP, update_end
from controller_fmu.parking.measurement.echo_feature import EchoFeature, FeatureType
from controller_fmu.parking.measurement.predicted_range import PredictedRange

MERGE_GAP = 0.3
"""Collinear segments nearer than this [m], and a point so near to a segment's end, are one thing: a gap narrower than
0.4 m cannot be told from none (sensor model, 1 cm noise)."""
MERGE_OFFSET = 0.03
"""Collinear: offset below this [m] beyond three standard deviations; bumpers are not flat."""
CORNER_RADIUS = 0.1
"""The corner of a vehicle is rounded by about this radius [m]: its echo comes from behind the line of its side."""
MIN_LENGTH = 0.3
"""A segment shortened below this [m] is deleted."""


def contradict(landmark: Landmark, predicted: PredictedRange, params: MappingParams) -> Landmark:
    """Return the landmark after an expected echo did not come: counted, then shortened or deleted.

    A segment that is contradicted nearer to one end than to the other loses that end, as an open one; a point, or what
    would be left too short, is deleted.
    """
    count = landmark.contradictions + 1
    if count < params.contradictions:
        return landmark._replace(contradictions=count)
    if landmark.type == LandmarkType.POINT:
        return Landmark()
    along = along_of(landmark, predicted.x, predicted.y)
    if along - landmark.start < landmark.end - along:
        shortened = landmark._replace(start=along + MIN_LENGTH, start_known=False, contradictions=0)
    else:
        shortened = landmark._replace(end=along - MIN_LENGTH, end_known=False, contradictions=0)
    return shortened if length_of(shortened) > MIN_LENGTH else Landmark()


def insert_landmark(landmarks: tuple[Landmark, ...], new: Landmark) -> tuple[Landmark, ...]:
    """Return the landmarks with a new one, in a free place or that of the least confirmed."""
    return replace_landmark(landmarks, free_index(landmarks), new)


def merge_into(landmarks: tuple[Landmark, ...], index: int, params: MappingParams) -> tuple[Landmark, ...]:
    """Return the landmarks with the one at ``index`` merged with those that are ends or parts of the same side."""
    segment = landmarks[index]
    if segment.type == LandmarkType.POINT or length_of(segment) < MERGE_GAP:
        return _merge_as_end(landmarks, index, params)
    for number in range(LANDMARKS):
        other = landmarks[number]
        merged = False
        is_short = other.type == LandmarkType.POINT or length_of(other) < MERGE_GAP
        if number != index and other.type != LandmarkType.NONE and is_short:
            merged = is_end_of(other, segment, params)
            segment = _with_end(segment, other) if merged else segment
        if number != index and other.type == LandmarkType.SEGMENT and not merged:
            merged = is_same_line(segment, other, params)
            segment = _joined(segment, other) if merged else segment
        if merged:
            landmarks = landmarks[:number] + (Landmark(),) + landmarks[number + 1 :]
    return replace_landmark(landmarks, index, segment)


def _merge_as_end(landmarks: tuple[Landmark, ...], index: int, params: MappingParams) -> tuple[Landmark, ...]:
    """Return the landmarks with the point or short segment at ``index`` merged into the segment that ends there."""
    for number in range(LANDMARKS):
        segment = landmarks[number]
        if number != index and segment.type == LandmarkType.SEGMENT and is_end_of(landmarks[index], segment, params):
            merged = replace_landmark(landmarks, number, _with_end(segment, landmarks[index]))
            return replace_landmark(merged, index, Landmark())
    return landmarks


def is_end_of(other: Landmark, segment: Landmark, params: MappingParams) -> bool:
    """Return whether a point landmark, or a short segment, lies at one of a longer segment's ends."""
    if length_of(other) >= length_of(segment):
        return False
    at = segment_point(other, 0.5 * (other.start + other.end))
    along = along_of(segment, at.x, at.y)
    variance = offset_variance(segment, along) + _variance_across(other, segment.heading)
    across = abs(offset_of(segment, at.x, at.y))
    near_start = abs(along - segment.start) < MERGE_GAP
    near_end = abs(along - segment.end) < MERGE_GAP
    return (near_start or near_end) and across < CORNER_RADIUS + math.sqrt(params.gate * variance)


def is_same_line(a: Landmark, b: Landmark, params: MappingParams) -> bool:
    """Return whether two segments are parts of one: same direction, no offset, and no known gap between them."""
    turn = math.sin(b.heading - a.heading)
    facing = math.cos(b.heading - a.heading) > 0.0
    if not facing or turn * turn > params.gate * (a.hh + b.hh):
        return False
    b_start = start_point(b)
    b_end = end_point(b)
    first = along_of(a, b_start.x, b_start.y)
    last = along_of(a, b_end.x, b_end.y)
    gap = max(first - a.end, a.start - last)
    knows_gap = (first > a.end and a.end_known) or (last < a.start and a.start_known)
    if gap > MERGE_GAP or (knows_gap and gap > 0.0):
        return False
    middle = 0.5 * (first + last)
    across = abs(offset_of(a, 0.5 * (b_start.x + b_end.x), 0.5 * (b_start.y + b_end.y)))
    variance = offset_variance(a, middle) + offset_variance(b, 0.5 * (b.start + b.end))
    return across < MERGE_OFFSET + math.sqrt(params.gate * variance)


def _variance_across(point: Landmark, heading: float) -> float:
    nx = -math.sin(heading)
    ny = math.cos(heading)
    return nx * nx * point.xx + 2.0 * nx * ny * point.xy + ny * ny * point.yy


def _with_end(segment: Landmark, other: Landmark) -> Landmark:
    """Return the segment with its nearer end updated by where a point landmark, or a short segment, is."""
    at = segment_point(other, 0.5 * (other.start + other.end))
    along = along_of(segment, at.x, at.y)
    cos = math.cos(segment.heading)
    sin = math.sin(segment.heading)
    half = 0.5 * length_of(other)
    variance = cos * cos * other.xx + 2.0 * cos * sin * other.xy + sin * sin * other.yy + half * half
    if along - segment.start < segment.end - along:
        wide = segment._replace(start=along, start_variance=variance) if along < segment.start else segment
    else:
        wide = segment._replace(end=along, end_variance=variance) if along > segment.end else segment
    return update_end(wide, along, variance)


def _joined(old: Landmark, new: Landmark) -> Landmark:
    """Return the old segment with the extent of both."""
    a = start_point(new)
    b = end_point(new)
    first = along_of(old, a.x, a.y)
    last = along_of(old, b.x, b.y)
    joined = old
    if first < old.start:
        joined = joined._replace(start=first, start_variance=new.start_variance, start_known=new.start_known)
    if last > old.end:
        joined = joined._replace(end=last, end_variance=new.end_variance, end_known=new.end_known)
    return joined._replace(confirmations=old.confirmations + new.confirmations)


def landmark_of(feature: EchoFeature, range_variance: float) -> Landmark:
    """Return a new landmark: a segment of no length for a side, a point for a corner, none if undecided.

    Along the echo's direction u the point is known to the range's sigma_r, across it to r sigma_b (bearing): the
    covariance is sigma_r2 u u' + (r sigma_b)2 v v', v perpendicular to u. A side lies across u: its line is known to
    sigma_r, its heading as an update by a bearing would tell it.
    """
    lateral = feature.range * feature.bearing_sigma
    lateral_variance = lateral * lateral
    ux = feature.ux
    uy = feature.uy
    if feature.type == FeatureType.CORNER:
        return Landmark(
            type=LandmarkType.POINT,
            x=feature.x,
            y=feature.y,
            xx=range_variance * ux * ux + lateral_variance * uy * uy,
            xy=(range_variance - lateral_variance) * ux * uy,
            yy=range_variance * uy * uy + lateral_variance * ux * ux,
            confirmations=1,
        )
    if feature.type != FeatureType.SIDE:
        return Landmark()
    return Landmark(
        type=LandmarkType.SEGMENT,
        x=feature.x,
        y=feature.y,
        heading=math.atan2(ux, -uy),
        xx=range_variance * ux * ux,
        xy=range_variance * ux * uy,
        yy=range_variance * uy * uy,
        hh=BEARING_OVERLAP * feature.bearing_sigma * feature.bearing_sigma,
        start_variance=lateral_variance,
        end_variance=lateral_variance,
        confirmations=1,
    )
