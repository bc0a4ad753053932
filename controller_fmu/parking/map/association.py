"""Data association: which landmark an echo feature came from, by Mahalanobis distance inside a gate.

The distance to a segment is the point's offset from its line over the standard deviation of both, and how far beyond an
end it lies over that of its bearing. Where two landmarks agree about as well the feature is *ambiguous* and updates
neither. If none agrees it is *unexplained* and begins a landmark.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from controller_fmu.parking.map.landmark import (
    LANDMARKS,
    Landmark,
    LandmarkType,
    along_of,
    end_point,
    length_of,
    offset_of,
    offset_variance,
    start_point,
)
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.measurement.echo_feature import EchoFeature, FeatureType
from controller_fmu.parking.measurement.predicted_range import (
    EchoOrigin,
    PredictedRange,
    predicted_range_to_point,
    predicted_range_to_segment,
)
from controller_fmu.parking.measurement.sensor import SensorPose, in_field_of_view
from modelkit.geometry import NO_HIT

NO_LANDMARK = -1
CONTIGUOUS = 0.12
"""A feature up to this [m] beyond an end continues the side: one measurement cycle at 10 km/h."""
SURFACE_DEVIATION = 0.02
"""Standard deviation [m] of a vehicle's side from a straight line: bumpers, mirrors, wheels."""
CORNER_DEVIATION = 0.05
"""The same [m] at a corner, which is rounded by about twice as much."""
FACING_COS = 0.8
"""Cosine of the angle between a side's normal and the direction of its echo, at least: 37 deg, past the half cone."""
OPEN_EXTENSION = 1.5
"""Beyond an open end echoes of the same line are expected for this far [m]: the range of monitored echoes."""
BODY_BETWEEN = 1.0
"""A segment shorter than this [m] may stand for a narrow body anywhere on it (a hitch): a sensor that sees part of it
contradicts nothing, so what has come between two cones is kept."""
WELL_IN_VIEW = 0.87
"""A point counts as surely in view within this fraction of the half cone: the mounting errs by some degrees."""


class Explanation(IntEnum):
    """How a feature relates to the map."""

    UNEXPLAINED = 0
    EXPLAINED = 1
    AMBIGUOUS = 2


class Association(NamedTuple):
    """The landmark that a feature came from, and the squared Mahalanobis distance."""

    explanation: int = Explanation.UNEXPLAINED
    landmark: int = NO_LANDMARK
    chi_square: float = NO_HIT


def associate(
    landmarks: tuple[Landmark, ...], feature: EchoFeature, variance: float, params: MappingParams
) -> Association:
    """Return what a feature came from; ``variance`` [m2] of its range."""
    best = NO_HIT
    second = NO_HIT
    index = NO_LANDMARK
    for number in range(LANDMARKS):
        if landmarks[number].type != LandmarkType.NONE:
            chi_square = mahalanobis(landmarks[number], feature, variance)
            if chi_square < best:
                second = best
                best = chi_square
                index = number
            else:
                second = min(second, chi_square)
    if best > params.gate:
        return Association()
    ambiguous = second < params.gate and second - best < params.ambiguity
    return Association(Explanation.AMBIGUOUS if ambiguous else Explanation.EXPLAINED, index, best)


def mahalanobis(landmark: Landmark, feature: EchoFeature, variance: float) -> float:
    """Return the squared Mahalanobis distance of a feature from a landmark; ``NO_HIT``: cannot be of it."""
    lateral = feature.range * feature.bearing_sigma
    deviation = CORNER_DEVIATION if feature.type == FeatureType.CORNER else SURFACE_DEVIATION
    roughness = deviation * deviation
    if landmark.type == LandmarkType.POINT:
        if feature.type == FeatureType.SIDE:
            return NO_HIT
        return _point_distance(landmark, feature, variance + roughness, lateral * lateral + roughness)
    facing = feature.uy * math.cos(landmark.heading) - feature.ux * math.sin(landmark.heading)
    if facing > 0.0 or (facing > -FACING_COS and feature.type == FeatureType.SIDE):
        return NO_HIT
    along = along_of(landmark, feature.x, feature.y)
    offset = offset_of(landmark, feature.x, feature.y)
    beyond = max(0.0, max(landmark.start - along, along - landmark.end) - CONTIGUOUS)
    tilt = 1.0 - facing * facing
    across = offset_variance(landmark, along) + variance + roughness + tilt * lateral * lateral
    end_variance = landmark.start_variance if along < landmark.start else landmark.end_variance
    return offset * offset / across + beyond * beyond / (lateral * lateral + end_variance)


def _point_distance(landmark: Landmark, feature: EchoFeature, radial: float, lateral: float) -> float:
    """Return d' (P + R)^-1 d of a feature's point and a point landmark, R along and across the feature's direction."""
    ux = feature.ux
    uy = feature.uy
    dx = feature.x - landmark.x
    dy = feature.y - landmark.y
    sxx = landmark.xx + radial * ux * ux + lateral * uy * uy
    sxy = landmark.xy + (radial - lateral) * ux * uy
    syy = landmark.yy + radial * uy * uy + lateral * ux * ux
    determinant = sxx * syy - sxy * sxy
    return (syy * dx * dx - 2.0 * sxy * dx * dy + sxx * dy * dy) / max(determinant, 1e-12)


def predict_range(sensor: SensorPose, landmark: Landmark) -> PredictedRange:
    """Return the predicted range to a landmark as it is observed, without what may lie beyond an open end."""
    if landmark.type == LandmarkType.POINT:
        return predicted_range_to_point(sensor, landmark.x, landmark.y)
    return predicted_range_to_segment(sensor, start_point(landmark), end_point(landmark))


def is_in_reach(landmark: Landmark, sensor: SensorPose, reach: float) -> bool:
    """Return whether any point of a landmark, open ends extended, may lie before a sensor and within ``reach`` [m].

    A bound by the distance of its reference point, without the directions of cone and segment.
    """
    if landmark.type == LandmarkType.NONE:
        return False
    extent = max(landmark.end, -landmark.start) + OPEN_EXTENSION
    dx = landmark.x - sensor.x
    dy = landmark.y - sensor.y
    farthest = reach + extent
    return dx * sensor.axis_x + dy * sensor.axis_y > -extent and dx * dx + dy * dy < farthest * farthest


def with_open_ends_extended(landmark: Landmark) -> Landmark:
    """Return a landmark as it may be: beyond an open end a side goes on, so that its echoes are expected there."""
    if landmark.type != LandmarkType.SEGMENT:
        return landmark
    start = landmark.start if landmark.start_known else landmark.start - OPEN_EXTENSION
    end = landmark.end if landmark.end_known else landmark.end + OPEN_EXTENSION
    return landmark._replace(start=start, end=end)


def _is_all_in_view(landmark: Landmark, sensor: SensorPose) -> bool:
    """Return whether both ends of a segment lie in a sensor's cone."""
    a = start_point(landmark)
    b = end_point(landmark)
    return in_field_of_view(sensor, a.x, a.y) and in_field_of_view(sensor, b.x, b.y)


def is_contradicted(
    landmark: Landmark, sensor: SensorPose, free_range: float, min_range: float, variance: float
) -> bool:
    """Return whether a landmark had to return an echo, but the first one is beyond ``free_range`` [m].

    Only where the predicted echo lies well inside the cone, beyond the blind zone and outside the gate; of a segment
    only the side, since the corners may lie outside a narrower cone, or all of it if it is short.
    """
    predicted = predict_range(sensor, landmark)
    if predicted.origin == EchoOrigin.OUT_OF_VIEW or predicted.origin == EchoOrigin.CONE_EDGE:
        return False
    if landmark.type == LandmarkType.SEGMENT:
        is_short = length_of(landmark) < BODY_BETWEEN
        decides = _is_all_in_view(landmark, sensor) if is_short else predicted.origin == EchoOrigin.INTERIOR
        if not decides:
            return False
    along = along_of(landmark, predicted.x, predicted.y)
    roughness = SURFACE_DEVIATION * SURFACE_DEVIATION
    sigma = math.sqrt(offset_variance(landmark, along) + variance + roughness)
    ux = predicted.x - sensor.x
    uy = predicted.y - sensor.y
    ahead = ux * sensor.axis_x + uy * sensor.axis_y
    across = abs(uy * sensor.axis_x - ux * sensor.axis_y)
    surely_in_view = across * sensor.cone_cos <= WELL_IN_VIEW * ahead * sensor.cone_sin
    beyond_blind_zone = predicted.distance > min_range + 3.0 * sigma
    return surely_in_view and beyond_blind_zone and predicted.distance < free_range - 3.0 * sigma
