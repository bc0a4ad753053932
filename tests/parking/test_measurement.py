"""The sensor model against exact geometry."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller_fmu.parking.measurement.cycle import MeasurementCycle, next_cycle
from controller_fmu.parking.measurement.predicted_range import (
    EchoOrigin,
    PredictedRange,
    direction_of,
    predict_range_to_segment,
)
from controller_fmu.parking.measurement.sensor import ReadingStatus, reading_status, sensor_pose
from controller_fmu.parking.measurement.silent_sensor import (
    MISSED_ECHOES,
    MissedEchoes,
    count_missed_echo,
    is_credible_miss,
)
from modelkit.car import Car, SensorMount
from modelkit.geometry import NO_HIT, Point, _in_cone_frame, _side_in_cone, cone_of
from modelkit.vocabulary import Pose

HALF = math.radians(30.0)
COORDINATE = st.floats(-4.0, 4.0)


@given(COORDINATE, COORDINATE, COORDINATE, COORDINATE, st.floats(-3.0, 3.0))
def test_predicted_range_is_that_of_the_exact_cone(ax: float, ay: float, bx: float, by: float, axis: float) -> None:
    sensor = sensor_pose(SensorMount(), HALF, Pose(0.3, -0.2, axis))
    predicted = predict_range_to_segment(sensor, Point(ax, ay), Point(bx, by))
    cone = cone_of(Point(0.3, -0.2), axis, HALF)
    exact = _side_in_cone(_in_cone_frame(Point(ax, ay), cone), _in_cone_frame(Point(bx, by), cone), cone.side)
    if max(math.hypot(ax - 0.3, ay + 0.2), math.hypot(bx - 0.3, by + 0.2)) < 0.01:
        return
    assert predicted.distance == pytest.approx(exact, abs=1e-9)
    assert (predicted.origin == EchoOrigin.OUT_OF_VIEW) == (exact == NO_HIT)


@given(st.floats(1e-6, 5.0), st.floats(-3.0, 3.0))
def test_an_echo_has_a_direction_however_near_it_is_predicted(distance: float, bearing: float) -> None:
    """A sensor measures 0.22 m where the map holds a corner 0.02 m away: its echo is not on the vehicle's flank."""
    sensor = sensor_pose(SensorMount(), HALF, Pose(0.3, -0.2, 0.0))
    predicted = PredictedRange(
        distance, EchoOrigin.START, 0.3 + distance * math.cos(bearing), -0.2 + distance * math.sin(bearing)
    )
    towards = direction_of(predicted, sensor)
    assert (towards.x, towards.y) == pytest.approx((math.cos(bearing), math.sin(bearing)), abs=1e-4)


def test_an_echo_predicted_at_the_sensor_comes_along_its_axis() -> None:
    sensor = sensor_pose(SensorMount(), HALF, Pose(0.3, -0.2, 0.5))
    towards = direction_of(PredictedRange(0.0, EchoOrigin.START, 0.3, -0.2), sensor)
    assert (towards.x, towards.y) == (sensor.axis_x, sensor.axis_y)


def test_origin_of_an_echo() -> None:
    sensor = sensor_pose(SensorMount(), HALF, Pose())
    assert predict_range_to_segment(sensor, Point(1.0, -1.0), Point(1.0, 1.0)).origin == EchoOrigin.INTERIOR
    assert predict_range_to_segment(sensor, Point(1.0, 0.1), Point(1.0, 1.0)).origin == EchoOrigin.START
    assert predict_range_to_segment(sensor, Point(1.0, -1.0), Point(1.0, -0.1)).origin == EchoOrigin.END
    assert predict_range_to_segment(sensor, Point(0.5, 0.5), Point(4.0, 0.5)).origin == EchoOrigin.CONE_EDGE


def test_meaning_of_a_reading() -> None:
    sensors = Car().ultrasonic
    readings = (sensors.max_range, sensors.min_range, 1.0, math.nan, -1.0, 0.0)
    expected = (ReadingStatus.NO_ECHO, ReadingStatus.BLIND_ZONE, ReadingStatus.ECHO, ReadingStatus.INVALID)
    assert tuple(reading_status(reading, sensors) for reading in readings) == (*expected, *[ReadingStatus.INVALID] * 2)


def test_a_sensor_is_silent_after_enough_missed_echoes() -> None:
    missed = MissedEchoes()
    for number in range(MISSED_ECHOES):
        assert missed.counts.count(MISSED_ECHOES) == 0
        assert is_credible_miss(missed, 3) == (number < MISSED_ECHOES // 2)
        missed = count_missed_echo(missed, 3, ReadingStatus.NO_ECHO, True)
        missed = count_missed_echo(missed, 4, ReadingStatus.NO_ECHO, False)
    assert missed.counts.count(MISSED_ECHOES) == 1
    assert count_missed_echo(missed, 3, ReadingStatus.ECHO, False).counts.count(MISSED_ECHOES) == 0


def test_readings_are_new_once_a_cycle() -> None:
    cycle, new = MeasurementCycle(), []
    for sample in range(12):
        readings = (1.0 + (sample // 4),) * 12
        cycle = next_cycle(cycle, readings, sample * 10_000_000, 10_000_000, 0.04)
        new.append(cycle.is_new)
    assert sum(new) == 3
