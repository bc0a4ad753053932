"""The sensor model against exact geometry, and the echo feature against numpy's least squares."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller_fmu.parking.measurement.cycle import MeasurementCycle, next_cycle
from controller_fmu.parking.measurement.echo_feature import EchoFeature, FeatureType, echo_feature, fit_range
from controller_fmu.parking.measurement.echo_window import WINDOW, EchoWindow, push_echo
from controller_fmu.parking.measurement.predicted_range import (
    EchoOrigin,
    PredictedRange,
    direction_of,
    predicted_range_to_segment,
)
from controller_fmu.parking.measurement.sensor import ReadingStatus, SensorPose, reading_status, sensor_pose
from controller_fmu.parking.measurement.silent_sensor import (
    MISSED_ECHOES,
    MissedEchoes,
    count_missed_echo,
    is_credible_miss,
    silent_sensors,
)
from modelkit.car import Car, SensorMount
from modelkit.geometry import NO_HIT, Point, cone_line
from modelkit.vocabulary import Pose

HALF = math.radians(30.0)
COORDINATE = st.floats(-4.0, 4.0)


@given(COORDINATE, COORDINATE, COORDINATE, COORDINATE, st.floats(-3.0, 3.0))
def test_predicted_range_is_that_of_the_exact_cone(ax: float, ay: float, bx: float, by: float, axis: float) -> None:
    sensor = sensor_pose(SensorMount(), HALF, Pose(0.3, -0.2, axis))
    predicted = predicted_range_to_segment(sensor, Point(ax, ay), Point(bx, by))
    exact = cone_line(Point(0.3, -0.2), axis, HALF, Point(ax, ay), Point(bx, by))
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
    assert predicted_range_to_segment(sensor, Point(1.0, -1.0), Point(1.0, 1.0)).origin == EchoOrigin.INTERIOR
    assert predicted_range_to_segment(sensor, Point(1.0, 0.1), Point(1.0, 1.0)).origin == EchoOrigin.START
    assert predicted_range_to_segment(sensor, Point(1.0, -1.0), Point(1.0, -0.1)).origin == EchoOrigin.END
    assert predicted_range_to_segment(sensor, Point(0.5, 0.5), Point(4.0, 0.5)).origin == EchoOrigin.CONE_EDGE


def test_meaning_of_a_reading() -> None:
    sensors = Car().ultrasonic
    readings = (sensors.max_range, sensors.min_range, 1.0, math.nan, -1.0)
    expected = (ReadingStatus.NO_ECHO, ReadingStatus.BLIND_ZONE, ReadingStatus.ECHO, ReadingStatus.INVALID)
    assert tuple(reading_status(reading, sensors) for reading in readings) == (*expected, ReadingStatus.INVALID)


def window_past(
    body: Callable[[float], float], spacing: float = 0.08, noise: float = 0.0, seed: int = 0, first: float = -0.32
) -> EchoWindow:
    """A sensor that looks to the right drives along x past a body given by its distance function."""
    rng = np.random.default_rng(seed)
    window = EchoWindow()
    for number in range(WINDOW):
        x = first + spacing * number
        sensor = SensorPose(x, 0.0, 0.0, -1.0, math.cos(HALF), math.sin(HALF))
        window = push_echo(window, sensor, body(x) + noise * rng.standard_normal(), 1e-4)
    return window


def test_range_fit_is_the_least_squares_parabola() -> None:
    window = window_past(lambda x: 1.0 + 0.1 * x + 0.3 * x * x, noise=0.01, seed=3)
    s = np.array([sample.x - window.samples[WINDOW // 2].x for sample in window.samples])
    r = np.array([sample.range for sample in window.samples])
    design = np.stack([np.ones(WINDOW), s, s * s], axis=1)
    expected = np.linalg.lstsq(design, r, rcond=None)[0]
    covariance = np.linalg.inv(design.T @ design)
    fit = fit_range(window, 1.0, 0.0)
    assert (fit.a, fit.b, fit.c) == pytest.approx(tuple(expected))
    assert (fit.b_sigma, fit.c_sigma) == pytest.approx((covariance[1, 1] ** 0.5, covariance[2, 2] ** 0.5))


def feature_of(body: Callable[[float], float], noise: float = 0.01, seed: int = 0) -> EchoFeature:
    return echo_feature(window_past(body, noise=noise, seed=seed), 1e-4, math.cos(HALF))


def test_a_wall_is_a_side_and_a_post_is_a_corner() -> None:
    found = [feature_of(lambda x: 1.0, seed=seed).type for seed in range(200)]
    assert found.count(FeatureType.CORNER) <= 5
    assert found.count(FeatureType.SIDE) >= 170
    found = [feature_of(lambda x: math.hypot(x - 0.1, 1.0), seed=seed).type for seed in range(200)]
    assert found.count(FeatureType.SIDE) <= 5
    assert found.count(FeatureType.CORNER) >= 170


def test_bearing_of_a_corner_lies_within_its_standard_deviation() -> None:
    errors = []
    for seed in range(300):
        feature = feature_of(lambda x: math.hypot(x - 0.2, 1.0), seed=seed)
        bearing = math.atan2(feature.ux, -feature.uy)
        errors.append((bearing - math.atan2(0.2, 1.0)) / feature.bearing_sigma)
    assert np.mean(np.square(errors)) == pytest.approx(1.0, abs=0.35)
    assert abs(np.mean(errors)) < 0.4


def test_a_window_over_two_bodies_tells_nothing() -> None:
    def gap(x: float) -> float:
        return min(math.hypot(x + 0.35, 1.0), math.hypot(x - 0.35, 1.0))

    found = [feature_of(gap, seed=seed).type for seed in range(100)]
    assert found.count(FeatureType.NONE) >= 90


def test_a_beam_edge_tells_nothing() -> None:
    """A wall along the path, in front of a sensor that looks 60 deg forward: the perpendicular is not in its cone."""
    window = EchoWindow()
    for number in range(WINDOW):
        sensor = SensorPose(0.08 * number, 0.0, math.cos(-0.5), math.sin(-0.5), math.cos(HALF), math.sin(HALF))
        window = push_echo(window, sensor, 1.2, 1e-4)
    assert echo_feature(window, 1e-4, math.cos(HALF)).type == FeatureType.NONE


def test_a_jump_begins_a_new_window() -> None:
    window = window_past(lambda x: 1.0)
    sensor = SensorPose(0.4, 0.0, 0.0, -1.0, math.cos(HALF), math.sin(HALF))
    assert push_echo(window, sensor, 1.05, 1e-4).used == WINDOW
    assert push_echo(window, sensor, 2.0, 1e-4).used == 1


def test_a_sensor_is_silent_after_enough_missed_echoes() -> None:
    missed = MissedEchoes()
    for number in range(MISSED_ECHOES):
        assert silent_sensors(missed) == 0
        assert is_credible_miss(missed, 3) == (number < MISSED_ECHOES // 2)
        missed = count_missed_echo(missed, 3, ReadingStatus.NO_ECHO, True)
        missed = count_missed_echo(missed, 4, ReadingStatus.NO_ECHO, False)
    assert silent_sensors(missed) == 1
    assert silent_sensors(count_missed_echo(missed, 3, ReadingStatus.ECHO, False)) == 0


def test_readings_are_new_once_a_cycle() -> None:
    cycle, new = MeasurementCycle(), []
    for sample in range(12):
        readings = (1.0 + (sample // 4),) * 12
        cycle = next_cycle(cycle, readings, sample * 10_000_000, 10_000_000, 0.04)
        new.append(cycle.is_new)
    assert sum(new) == 3
