"""What a sensor should measure of a landmark, and when an echo that does not come contradicts it."""

import math

from controller_fmu.parking.map.facing_surface import FACING_ECHOES
from controller_fmu.parking.map.landmark import (
    Landmark,
    LandmarkType,
    along_of,
    end_point,
    length_of,
    offset_variance,
    start_point,
)
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.measurement.predicted_range import (
    EchoOrigin,
    PredictedRange,
    predict_range_to_point,
    predict_range_to_segment,
)
from controller_fmu.parking.measurement.sensor import Measurement, SensorPose, in_field_of_view
from modelkit.geometry import Point

SIDE_DEVIATION = 0.02
"""Standard deviation [m] of a vehicle's side from a straight line: bumpers, mirrors, wheels."""
OPEN_EXTENSION = 1.5
"""Beyond an open end echoes of the same line are expected for this far [m]: the range of monitored echoes."""
BODY_BETWEEN = 1.0
"""A segment shorter than this [m] may stand for a narrow body anywhere on it (a hitch): a sensor that sees part of it
contradicts nothing, so what has come between two cones is kept."""
WELL_IN_VIEW = 0.87
"""A point counts as surely in view within this fraction of the half cone: the mounting errs by some degrees."""
MIN_LENGTH = 0.3
"""A segment shortened below this [m] is deleted."""


def predict_range(sensor: SensorPose, landmark: Landmark) -> PredictedRange:
    """Return the predicted range to a landmark as it is observed, without what may lie beyond an open end."""
    if landmark.type == LandmarkType.POINT:
        return predict_range_to_point(sensor, landmark.x, landmark.y)
    return predict_range_to_segment(sensor, start_point(landmark), end_point(landmark))


def may_be_in_view(sensor: SensorPose, at: Point) -> bool:
    """Return whether a sensor whose mounting errs may see a point."""
    return in_field_of_view(sensor._replace(cone_sin=sensor.cone_sin / WELL_IN_VIEW), at.x, at.y)


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


def is_contradicted(landmark: Landmark, measurement: Measurement) -> bool:
    """Return whether a landmark had to return an echo, but the first one is farther.

    Only where the predicted echo lies well inside the cone, beyond the blind zone and outside the gate; of a segment
    only the side, as corners may lie outside a narrower cone, or all of it if it is short.
    """
    sensor = measurement.sensor
    predicted = predict_range(sensor, landmark)
    if predicted.origin == EchoOrigin.OUT_OF_VIEW or predicted.origin == EchoOrigin.CONE_EDGE:
        return False
    if landmark.type == LandmarkType.SEGMENT:
        a = start_point(landmark)
        b = end_point(landmark)
        is_all_in_view = in_field_of_view(sensor, a.x, a.y) and in_field_of_view(sensor, b.x, b.y)
        if not (is_all_in_view if length_of(landmark) < BODY_BETWEEN else predicted.origin == EchoOrigin.INTERIOR):
            return False
    along = along_of(landmark, predicted.x, predicted.y)
    sigma = math.sqrt(offset_variance(landmark, along) + measurement.variance + SIDE_DEVIATION * SIDE_DEVIATION)
    narrow = sensor._replace(cone_sin=WELL_IN_VIEW * sensor.cone_sin)
    surely_in_view = in_field_of_view(narrow, predicted.x, predicted.y)
    beyond_blind_zone = predicted.distance > measurement.min_range + 3.0 * sigma
    return surely_in_view and beyond_blind_zone and predicted.distance < measurement.range - 3.0 * sigma


def contradict(landmark: Landmark, predicted: PredictedRange, params: MappingParams) -> Landmark:
    """Return the landmark after an expected echo did not come: counted, then shortened or deleted.

    A permanent side loses the end that the contradiction is nearer to, the other one remains; of anything else, what
    two sensors measured as one surface among it, nothing is left, nor of what would be left too short.
    """
    count = landmark.contradictions + 1
    if count < params.contradictions:
        return landmark._replace(contradictions=count)
    if not is_permanent(landmark):
        return Landmark()
    along = along_of(landmark, predicted.x, predicted.y)
    if along - landmark.start < landmark.end - along:
        shortened = landmark._replace(start=along + MIN_LENGTH, start_known=False, contradictions=0)
    else:
        shortened = landmark._replace(end=along - MIN_LENGTH, end_known=False, contradictions=0)
    return shortened if length_of(shortened) > MIN_LENGTH else Landmark()


def is_permanent(landmark: Landmark) -> bool:
    """Return whether a landmark does not leave, as a pedestrian may: a long segment, measured from a flank."""
    is_long = landmark.type == LandmarkType.SEGMENT and length_of(landmark) > BODY_BETWEEN
    return is_long and landmark.confirmations > FACING_ECHOES
