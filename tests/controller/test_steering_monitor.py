"""The monitor of the steering against the vehicle's own: dead time, rate and lag are no faults, and they are learnt."""

import math
from collections.abc import Callable
from typing import NamedTuple

import pytest

from controller_fmu.common.steering_monitor import SteeringMonitorState, at_rest, has_failed, watch_steering
from modelkit.car import CarSteering
from modelkit.random import seed_state, uniform
from vehicle_fmu.interface import SteeringParams
from vehicle_fmu.steering import DELAY_CELLS, SteeringState, delay_request, pass_request, turn_steering_wheel

LONGEST = 0.28
TOLERANCE = 0.1
DT_NS = 10_000_000
BELIEVED = math.radians(570.0)
Request = Callable[[float], float]


def swings(t: float) -> float:
    """As a parking manoeuvre: set at standstill, held, swung to the other side, given back, shifted."""
    return ((7.8, 7.8, -7.8, -6.0, 9.4, -9.4, 3.0, 0.0)[int(t / 2.5) % 8]) + 0.4 * math.sin(2.0 * t)


class Driven(NamedTuple):
    watch: SteeringMonitorState
    failed_at: float
    """When the wheel was called faulty [s]; inf: never."""


def drive(
    request: Request,
    params: SteeringParams,
    stop: float = 20.0,
    broken: Callable[..., float] | None = None,
    rate: float = BELIEVED,
) -> Driven:
    """Return the watch after ``stop`` s; ``broken(t, angle)`` is the wheel from the moment it returns a number."""
    angle, steering, watch, asked = 0.0, SteeringState(), at_rest(0.0, SteeringMonitorState().steering), 0.0
    line: tuple[float, ...] = (0.0,) * DELAY_CELLS
    for k in range(round(stop * 1e9) // DT_NS):
        span = (k * DT_NS, (k + 1) * DT_NS)
        line = delay_request(line, asked, params.dead_time, *span) if params.dead_time > 0.0 else (asked,)
        steering = pass_request(steering, line[0], params, *span)
        angle = turn_steering_wheel(angle, steering.lagged, CarSteering(rate_limit=rate), 0.0, DT_NS * 1e-9, 1.0)
        if broken is not None:
            angle = broken(k * DT_NS * 1e-9, angle)
        watch = watch_steering(watch, asked, angle, TOLERANCE, BELIEVED, DT_NS)
        if has_failed(watch, LONGEST):
            return Driven(watch, (k + 1) * DT_NS * 1e-9)
        asked = request((k + 1) * DT_NS * 1e-9)
    return Driven(watch, math.inf)


@pytest.mark.parametrize("rate", [0.5, 1.0, 1.5])
@pytest.mark.parametrize("dead_time", [0.0, 0.1, 0.2])
@pytest.mark.parametrize("lag", [0.0, 0.15])
def test_a_slow_late_or_lazy_wheel_is_no_fault(rate: float, dead_time: float, lag: float) -> None:
    params = SteeringParams(dead_time=dead_time, lag=lag)
    assert drive(swings, params, rate=rate * BELIEVED).failed_at == math.inf


def test_requests_at_random_are_no_fault() -> None:
    state = seed_state(7)
    for _ in range(40):
        drawn = []
        for _ in range(12):
            state, number = uniform(state)
            drawn.append(number)
        params = SteeringParams(dead_time=0.1 * drawn[1], lag=0.15 * drawn[2])
        rate = (0.5 + drawn[0]) * BELIEVED
        levels = [15.0 * number - 7.5 for number in drawn[3:]]
        slope = 2.0 * drawn[3]

        def request(t: float, levels: list[float] = levels, slope: float = slope) -> float:
            return levels[int(t / 1.3) % len(levels)] + slope * math.sin(t)

        assert drive(request, params, rate=rate).failed_at == math.inf


@pytest.mark.parametrize("rate", [0.4, 1.0, 1.4])
@pytest.mark.parametrize("dead_time", [0.0, 0.1, 0.18])
@pytest.mark.parametrize("lag", [0.0, 0.12])
def test_rate_and_dead_time_are_learnt_from_one_large_swing(rate: float, dead_time: float, lag: float) -> None:
    params = SteeringParams(dead_time=dead_time, lag=lag)
    learnt = drive(lambda t: 7.8 if t > 0.5 else 0.0, params, 4.0, rate=rate * BELIEVED).watch.steering
    assert (learnt.rate or BELIEVED) == pytest.approx(rate * BELIEVED, rel=0.02)
    assert learnt.dead_time == pytest.approx(dead_time, abs=0.02)


@pytest.mark.parametrize("lag", [0.0, 0.08, 0.15, 0.3])
def test_the_lag_is_learnt_from_a_small_swing(lag: float) -> None:
    """A large one hides it: the request has long passed the lag when the rate has brought the wheel there."""
    learnt = drive(lambda t: 0.8 if t > 0.5 else 0.0, SteeringParams(lag=lag), 4.0).watch.steering
    assert learnt.lag == pytest.approx(lag, rel=0.2)


def test_a_steering_as_believed_teaches_nothing() -> None:
    learnt = drive(swings, SteeringParams()).watch.steering
    assert (learnt.rate, learnt.dead_time, learnt.lag) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("at", [3.0, 3.7, 5.2])
def test_a_wheel_that_has_kept_up_with_its_request_is_known_to_move(at: float) -> None:
    """It was never off by more than the tolerance, so never seen to come nearer; stuck, it is found as soon as any."""

    def slowly(t: float) -> float:
        return 0.4 * math.sin(0.8 * t) + (1.5 if t >= at else 0.0)

    held: list[float] = []

    def stuck(t: float, angle: float) -> float:
        if t < at:
            return angle
        held.append(angle)
        return held[0]

    assert drive(slowly, SteeringParams(), broken=stuck).failed_at <= at + 0.31


@pytest.mark.parametrize("dead_time", [0.0, 0.1])
@pytest.mark.parametrize("at", [2.49, 5.5, 10.2])
def test_a_stuck_wheel_is_found_within_three_tenths_of_a_second(dead_time: float, at: float) -> None:
    held = [math.nan]

    def stuck(t: float, angle: float) -> float:
        if t < at:
            held[0] = angle
        return held[0]

    off = next(t for t in (at + 0.01 * k for k in range(1000)) if abs(swings(t) - swings(at)) > TOLERANCE + 0.1)
    found = drive(swings, SteeringParams(dead_time=dead_time), broken=stuck).failed_at
    assert at < found <= off + 0.31


@pytest.mark.parametrize("speed", [-3.0, -0.5, 0.5, 3.0])
def test_a_drifting_wheel_is_found_within_three_tenths_of_a_second(speed: float) -> None:
    found = drive(
        lambda t: 5.0, SteeringParams(), broken=lambda t, angle: angle if t < 3.0 else 5.0 + speed * (t - 3.0)
    )
    off = 3.0 + TOLERANCE / abs(speed)
    assert off < found.failed_at <= off + 0.31


def test_a_wheel_that_never_moves_is_found_before_the_car_does() -> None:
    assert drive(swings, SteeringParams(), broken=lambda t, angle: 0.0).failed_at <= 0.31


@pytest.mark.parametrize("asked", [0.15, 0.5, 3.0])
def test_a_wheel_that_begins_late_and_goes_slowly_for_the_first_time_is_no_fault(asked: float) -> None:
    params = SteeringParams(dead_time=0.2, lag=0.15)
    for rate in (0.33, 0.5, 1.0):
        assert drive(lambda t: asked, params, stop=2.0, rate=rate * BELIEVED).failed_at == math.inf


def test_a_wheel_that_begins_for_the_first_time_and_sticks_is_found_in_half_a_second() -> None:
    found = drive(lambda t: 0.15, SteeringParams(lag=0.15), broken=lambda t, angle: min(angle, 0.03)).failed_at
    assert 0.31 < found <= 0.51
