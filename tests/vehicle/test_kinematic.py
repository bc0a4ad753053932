"""The kinematic car against CommonRoad's KS and against exact circles."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from vehiclemodels.vehicle_dynamics_ks import vehicle_dynamics_ks

from modelkit.car import CarSteering
from modelkit.vocabulary import Pose
from tests.vehicle.cars import CARS
from vehicle_fmu.bodies.kinematic import KinematicInput, move, resting_at
from vehicle_fmu.drive import change_speed
from vehicle_fmu.interface import DriveParams
from vehicle_fmu.steering import turn_steering_wheel


@given(st.sampled_from(CARS), st.floats(-13.0, 40.0), st.floats(-0.9, 0.9), st.floats(-4.0, 4.0))
def test_rates_equal_ks(car: Any, speed: float, angle: float, heading: float) -> None:
    held, h = KinematicInput(speed, angle), 1e-7
    ours = move(resting_at(Pose(0.0, 0.0, heading)), held, held, car.a + car.b, h).pose
    halfway = 0.5 * (heading + ours.heading)
    theirs = vehicle_dynamics_ks([1.0, 2.0, angle, speed, halfway], [0.0, 0.0], car)
    assert ours.x / h == pytest.approx(theirs[0], abs=1e-10)
    assert ours.y / h == pytest.approx(theirs[1], abs=1e-10)
    assert (ours.heading - heading) / h == pytest.approx(theirs[4], abs=1e-7)


@pytest.mark.parametrize("car", CARS)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_steering_stops_and_turns_as_fast_as_in_ks_at_its_limits(car: Any, side: float) -> None:
    params = CarSteering(1.0, car.steering.max, car.steering.v_max)
    h = 1e-3
    for angle, request in ((0.0, 9.0 * side), (0.3 * side, -9.0 * side), (car.steering.max * side, 9.0 * side)):
        rate = (turn_steering_wheel(angle, request, params, 0.0, h, 1.0) - angle) / h
        theirs = vehicle_dynamics_ks([0.0, 0.0, angle, 5.0, 0.0], [100.0 * math.copysign(1.0, request), 0.0], car)
        assert rate == pytest.approx(theirs[2], abs=1e-12)


@pytest.mark.parametrize("car", CARS)
def test_acceleration_is_limited_as_in_ks_below_its_switching_speed(car: Any) -> None:
    params = DriveParams(car.longitudinal.a_max, car.longitudinal.a_max)
    for speed, target in ((2.0, 30.0), (2.0, 0.0), (-2.0, -30.0), (-2.0, 0.0)):
        rate = (change_speed(speed, target, params, 1e-3) - speed) / 1e-3
        wish = math.copysign(100.0, target - speed)
        theirs = vehicle_dynamics_ks([0.0, 0.0, 0.0, speed, 0.0], [0.0, wish], car)
        assert rate == pytest.approx(theirs[3], rel=1e-12)


@given(st.floats(-2.0, 2.0), st.floats(-0.6, 0.6), st.floats(0.001, 0.1))
def test_a_held_wheel_drives_an_exact_circle(speed: float, angle: float, h: float) -> None:
    pose = move(resting_at(Pose()), KinematicInput(speed, angle), KinematicInput(speed, angle), 2.4, h).pose
    turn = speed * h * math.tan(angle) / 2.4
    x, y = speed * h, 0.0
    if abs(turn) > 1e-9:
        x, y = speed * h * math.sin(turn) / turn, speed * h * (1.0 - math.cos(turn)) / turn
    assert pose.heading == pytest.approx(turn, abs=1e-15, rel=1e-12)
    assert pose.x == pytest.approx(x, abs=1e-9)
    assert pose.y == pytest.approx(y, abs=1e-9)
