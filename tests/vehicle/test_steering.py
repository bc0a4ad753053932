"""Dead time, lag, backlash and the slower rate at standstill."""

import math

import pytest

from modelkit.car import CarSteering
from modelkit.vocabulary import Pose
from vehicle_fmu.car import initial_car, step_car
from vehicle_fmu.interface import SteeringParams, VehicleInput, VehicleParams
from vehicle_fmu.steering import (
    DELAY_CELLS,
    SteeringState,
    delay_request,
    pass_request,
    take_up_play,
    turn_steering_wheel,
)

MS = 1_000_000


def lagged_step(params: SteeringParams, step_ms: int, until_ms: int) -> list[float]:
    """Return the request behind dead time and lag, every step, after a step of 1 rad at time zero."""
    state, line, found = SteeringState(), (0.0,) * DELAY_CELLS, []
    for t in range(0, until_ms, step_ms):
        span = (t * MS, (t + step_ms) * MS)
        line = delay_request(line, 1.0, params.dead_time, *span) if params.dead_time > 0.0 else (1.0,)
        state = pass_request(state, line[0], params, *span)
        found.append(state.lagged)
    return found


@pytest.mark.parametrize("step_ms", [1, 2, 5, 10, 40])
def test_dead_time_whatever_the_step(step_ms: int) -> None:
    found = lagged_step(SteeringParams(dead_time=0.16), step_ms, 400)
    first = (found.index(1.0) + 1) * step_ms
    assert 160 - 10 <= first <= 160 + max(step_ms, 10)
    assert set(found) == {0.0, 1.0}


@pytest.mark.parametrize("step_ms", [1, 5, 20])
def test_lag_is_the_exponential_whatever_the_step(step_ms: int) -> None:
    found = lagged_step(SteeringParams(lag=0.2), step_ms, 400)
    assert found[-1] == pytest.approx(1.0 - math.exp(-0.4 / 0.2), rel=1e-12)


def test_nothing_in_the_way_by_default() -> None:
    assert pass_request(SteeringState(), 0.3, SteeringParams(), 0, MS).lagged == 0.3


def test_backlash_is_crossed_before_the_wheels_follow() -> None:
    play, seen = 0.0, []
    for n in list(range(0, 101)) + list(range(100, -101, -1)):
        play = take_up_play(play, 0.01 * n, 0.2)
        seen.append(play)
    assert seen[100] == pytest.approx(0.9)
    assert seen[115] == pytest.approx(0.9), "turned back by less than the backlash"
    assert seen[-1] == pytest.approx(-0.9)
    assert take_up_play(0.5, 0.123, 0.0) == 0.123


def test_slower_at_standstill() -> None:
    car = CarSteering(rate_limit=8.0)
    assert turn_steering_wheel(0.0, 5.0, car, 2.0, 0.1, 0.0) == pytest.approx(0.2)
    assert turn_steering_wheel(0.0, 5.0, car, 2.0, 0.1, 1.0) == pytest.approx(0.8)
    assert turn_steering_wheel(0.0, 5.0, car, 0.0, 0.1, 0.0) == pytest.approx(0.8)


def test_a_held_wheel_leaves_nothing_on_its_way() -> None:
    params = VehicleParams(steering=SteeringParams(dead_time=0.16))
    state = initial_car(Pose(), True, params)
    for number in range(1, 11):
        state = step_car(
            state, VehicleInput(steering_active=True, steering_wheel_request=0.7), False, params, number * 10 * MS
        )
    assert set(state.request_line) == {0.0, 0.7}
    angle = state.steering_wheel_angle
    state = step_car(state, VehicleInput(), False, params, 110 * MS)
    assert set(state.request_line) == {angle}
    assert state.steering.lagged == angle
