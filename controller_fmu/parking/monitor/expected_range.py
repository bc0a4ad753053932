"""What the sensors should measure among the polygons that a path was planned in, and which echoes are unexplained."""

from controller_fmu.parking.geometry.polygons import VERTICES, ObstacleMap, next_index
from controller_fmu.parking.measurement.predicted_range import EchoOrigin, PredictedRange, predicted_range_to_segment
from controller_fmu.parking.measurement.sensor import SensorPose
from modelkit.geometry import Point


def range_in_map(sensor: SensorPose, obstacles: ObstacleMap, max_range: float) -> PredictedRange:
    """Return the nearest point of all polygons in a sensor's view, at most ``max_range`` [m] away, else on its axis."""
    nearest = PredictedRange(
        max_range,
        int(EchoOrigin.OUT_OF_VIEW),
        sensor.x + max_range * sensor.axis_x,
        sensor.y + max_range * sensor.axis_y,
    )
    first = 0
    for number in range(VERTICES):
        a = obstacles.vertices[number]
        if a.polygon > 0:
            if number > 0 and obstacles.vertices[number - 1].polygon != a.polygon:
                first = number
            b = obstacles.vertices[next_index(obstacles, number, first)]
            predicted = predicted_range_to_segment(sensor, Point(a.x, a.y), Point(b.x, b.y))
            if predicted.distance < nearest.distance:
                nearest = predicted
    return nearest
