"""The predicted range of a sensor to a point, a segment or polygons, and which part of them returns the echo.

The echo of a segment comes from its nearest point inside the cone: the foot of the perpendicular (``INTERIOR``), an end
of the segment (``START``, ``END``), or where the boundary of the cone cuts it (``CONE_EDGE``). The last says where the
beam ends rather than where the segment is, so it carries no information for an update.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import planar_distance
from controller_fmu.parking.geometry.polygons import SegmentPart, Vertex, next_index
from controller_fmu.parking.measurement.sensor import SensorPose, in_field_of_view
from modelkit.geometry import NO_HIT, Point


class EchoOrigin(IntEnum):
    """Which part of a landmark returns the echo."""

    OUT_OF_VIEW = 0
    INTERIOR = 1
    START = 2
    END = 3
    CONE_EDGE = 4


class EchoSurface(NamedTuple):
    """A straight side through an echo's point, along a unit vector from ``low`` <= 0 to ``high`` >= 0 [m]; 0: none."""

    along_x: float = 0.0
    along_y: float = 0.0
    low: float = 0.0
    high: float = 0.0


class PredictedRange(NamedTuple):
    """The nearest point of a landmark in a field of view."""

    distance: float = NO_HIT
    """From the sensor [m]; ``NO_HIT``: out of view."""
    origin: int = EchoOrigin.OUT_OF_VIEW
    x: float = 0.0
    y: float = 0.0
    surface: EchoSurface = EchoSurface()
    """The segment; of a point none."""


def direction_of(predicted: PredictedRange, sensor: SensorPose) -> Point:
    """Return the unit vector from a sensor to where its echo is predicted to come from; at the sensor itself its axis.

    It has length 1 at any distance: an echo farther than predicted is placed along it.
    """
    if predicted.distance <= 0.0:
        return Point(sensor.axis_x, sensor.axis_y)
    return Point((predicted.x - sensor.x) / predicted.distance, (predicted.y - sensor.y) / predicted.distance)


def predict_range_to_point(sensor: SensorPose, x: float, y: float) -> PredictedRange:
    """Return the predicted range to the point (x, y) [m]; its origin is ``START``."""
    if not in_field_of_view(sensor, x, y):
        return PredictedRange()
    return PredictedRange(planar_distance(x, y, sensor.x, sensor.y), EchoOrigin.START, x, y)


def predict_range_to_segment(sensor: SensorPose, a: Point, b: Point) -> PredictedRange:
    """Return the predicted range to the segment from ``a`` (start) to ``b`` (end) [m]."""
    beam = _part_in_beam(sensor, a, b)
    if beam.enter > beam.leave:
        return PredictedRange()
    dx = b.x - a.x
    dy = b.y - a.y
    square = dx * dx + dy * dy
    foot = ((sensor.x - a.x) * dx + (sensor.y - a.y) * dy) / square if square > 0.0 else 0.0
    origin = EchoOrigin.INTERIOR
    if foot <= beam.enter:
        foot = beam.enter
        origin = EchoOrigin.START if beam.enter <= 0.0 else EchoOrigin.CONE_EDGE
    elif foot >= beam.leave:
        foot = beam.leave
        origin = EchoOrigin.END if beam.leave >= 1.0 else EchoOrigin.CONE_EDGE
    x = a.x + foot * dx
    y = a.y + foot * dy
    length = math.sqrt(square)
    surface = EchoSurface()
    if length > 0.0:
        surface = EchoSurface(dx / length, dy / length, -foot * length, (1.0 - foot) * length)
    return PredictedRange(planar_distance(x, y, sensor.x, sensor.y), int(origin), x, y, surface)


def _part_in_beam(sensor: SensorPose, a: Point, b: Point) -> SegmentPart:
    """Return the part of a segment with |across| cos <= along sin in the sensor's frame."""
    ax = (a.x - sensor.x) * sensor.axis_x + (a.y - sensor.y) * sensor.axis_y
    ay = (a.y - sensor.y) * sensor.axis_x - (a.x - sensor.x) * sensor.axis_y
    bx = (b.x - sensor.x) * sensor.axis_x + (b.y - sensor.y) * sensor.axis_y
    by = (b.y - sensor.y) * sensor.axis_x - (b.x - sensor.x) * sensor.axis_y
    low = 0.0
    high = 1.0
    for side in (-1.0, 1.0):
        at_a = ax * sensor.cone_sin + side * ay * sensor.cone_cos
        at_b = bx * sensor.cone_sin + side * by * sensor.cone_cos
        if at_a < 0.0 and at_b < 0.0:
            return SegmentPart(1.0, 0.0)
        if at_a < 0.0:
            low = max(low, at_a / (at_a - at_b))
        elif at_b < 0.0:
            high = min(high, at_a / (at_a - at_b))
    return SegmentPart(low, high)


def range_to_polygons(sensor: SensorPose, vertices: tuple[Vertex, ...], max_range: float) -> PredictedRange:
    """Return the nearest point of all polygons in a sensor's view, at most ``max_range`` [m] away, else on its axis."""
    x = sensor.x + max_range * sensor.axis_x
    y = sensor.y + max_range * sensor.axis_y
    nearest = PredictedRange(max_range, int(EchoOrigin.OUT_OF_VIEW), x, y)
    for number in range(len(vertices)):
        a = vertices[number]
        if a.polygon > 0:
            b = vertices[next_index(vertices, number)]
            predicted = predict_range_to_segment(sensor, Point(a.x, a.y), Point(b.x, b.y))
            if predicted.distance < nearest.distance:
                nearest = predicted
    return nearest
