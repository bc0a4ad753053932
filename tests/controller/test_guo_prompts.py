"""What the driver sees: slow before trouble and until it is over, a direction whenever the car shall set out."""

import math
from typing import Any

import pytest

from controller_fmu.common.steering_monitor import Steering
from controller_fmu.guo2015.params import GuoPrompts
from controller_fmu.guo2015.phases import DIRECTION_OF_PHASE, GuoPhase
from controller_fmu.guo2015.prompts import stopping_distance, swing_speed
from controller_fmu.interface import Reason
from controller_fmu.registry import ControllerParams
from modelkit.vocabulary import Prompt
from tests.controller.closed_loop import Run, drive

TANGENT_X = -3.8
OBEYING = {"driver.profile[1].speed": 1.5, "driver.reaction_delay": 0.3}
TARGET = (-7.608, -3.056)


@pytest.fixture(scope="module")
def obeying() -> Run:
    return drive(OBEYING, {})


def test_the_advice_holds_until_the_wheel_has_swung(obeying: Run) -> None:
    """47 deg at 30 deg/s take 1.57 s; only then may the driver be faster than at the tangent point."""
    behind = [k for k, outputs in enumerate(obeying.vehicle) if outputs.pose.x <= TANGENT_X]
    swing = obeying.controller[behind[0] : behind[0] + 150]
    assert all(outputs.prompt == Prompt.SLOW_DOWN for outputs in swing)
    assert max(outputs.advised_speed for outputs in swing) < 0.31
    arrived = next(k for k in behind[10:] if obeying.controller[k].advised_speed > 1.0)
    wheel = obeying.vehicle[arrived].steering_wheel_angle
    assert wheel > 0.0
    assert abs(wheel - obeying.controller[arrived].steering_wheel_request) < 0.12


def test_the_car_stays_on_the_path(obeying: Run) -> None:
    on_it = [outputs.lateral_error for outputs in obeying.controller if outputs.phase == GuoPhase.PATH_TRACKING]
    assert max(map(abs, on_it)) < 0.12
    assert GuoPhase.TO_Q2 not in obeying.visited
    assert obeying.phases[-1] == GuoPhase.PARKED


@pytest.mark.parametrize("speed", [0.3, 1.5])
def test_the_advice_never_rises_with_a_stop(speed: float) -> None:
    run = drive(OBEYING | {"driver.profile[1].speed": speed, "driver.complies_with_slow_down": False}, {})
    for before, after in zip(run.controller, run.controller[1:], strict=False):
        if after.phase == GuoPhase.STOP:
            assert after.advised_speed <= before.advised_speed


def test_point_tracking_is_slow() -> None:
    """Guo 2015, Fig. 9: stop and drive slowly forward."""
    run = drive(OBEYING | {"driver.complies_with_slow_down": False}, {})
    points = (GuoPhase.TO_Q1, GuoPhase.TO_Q2, GuoPhase.TO_Q3, GuoPhase.TO_Q4)
    legs = [outputs for outputs in run.controller if outputs.phase in points]
    assert {Prompt.SLOW_DOWN, Prompt.FORWARD, Prompt.REVERSE} == {Prompt(outputs.prompt) for outputs in legs}
    assert max(outputs.advised_speed for outputs in legs) <= GuoPrompts().point_speed


@pytest.mark.parametrize(
    "reaction", [0.0, 1.0, *(pytest.param(time, marks=pytest.mark.release) for time in (0.05, 0.3))]
)
@pytest.mark.parametrize("start", [(0.0, 0.0), (-4.9, -2.8), (-5.5, -2.9)])
def test_a_direction_is_told_whenever_the_car_stands_and_shall_go(start: tuple[float, float], reaction: float) -> None:
    vehicle: dict[str, Any] = {"start.x": start[0], "start.y": start[1], "driver.reaction_delay": reaction}
    run = drive(OBEYING | vehicle, {})
    reported = {1: Prompt.FORWARD, -1: Prompt.REVERSE}
    for seen, outputs in zip(run.vehicle, run.controller[1:], strict=False):
        direction = DIRECTION_OF_PHASE[outputs.phase]
        if seen.speed == 0.0 and direction != 0:
            assert outputs.prompt == reported[direction]
    assert Reason(run.controller[-1].reason) == Reason.NONE
    assert run.phases[-1] == GuoPhase.PARKED


def test_the_speed_for_a_swing_is_what_its_deviation_allows() -> None:
    """The wheel turns evenly over v T, late by D: integrated twice over the way this is the deviation accepted."""
    params = ControllerParams()
    for steering in (Steering(), Steering(5.0, 0.1, 0.05, True)):
        speed = swing_speed(-0.4, 0.4, steering, params)
        rate = (steering.rate or params.car.steering.rate_limit) / params.car.steering.ratio
        late, swing = steering.dead_time + steering.lag, 0.8 / rate
        turned = shifted = 0.0
        step = 1e-4
        for k in range(round((late + swing) / step)):
            share = min(max(1.0 - (k * step - late) / swing, 0.0), 1.0)
            turned += share * 2.0 * math.tan(0.4) / params.car.wheelbase * speed * step
            shifted += turned * speed * step
        # the even fall of the angle is that of the curvature to 3 %, and so is what is left
        assert shifted == pytest.approx(params.guo2015.prompting.jump_deviation, rel=0.05)


def test_a_slower_steering_is_advised_a_slower_swing() -> None:
    slow = drive(OBEYING | {"car.steering.rate_limit": 0.5 * math.radians(570.0)}, {})
    behind = next(k for k, outputs in enumerate(slow.vehicle) if outputs.pose.x <= TANGENT_X)
    assert slow.controller[behind].advised_speed == pytest.approx(0.5 * 0.287, abs=0.01)
    assert GuoPhase.TO_Q2 not in slow.visited
    assert slow.phases[-1] == GuoPhase.PARKED


def test_the_way_to_stop_is_reaction_and_braking() -> None:
    assert stopping_distance(-1.0, GuoPrompts(reaction=0.5, deceleration=2.0)) == 0.75
