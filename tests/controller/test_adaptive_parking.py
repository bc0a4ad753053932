"""Driver-adaptive parking and the kinematic car in closed loop: who is stopped, who is not, and where they stand."""

import math
from typing import Any

import pytest

from controller_fmu.adaptive.phases import AdaptivePhase
from controller_fmu.interface import Reason
from controller_fmu.registry import System
from modelkit.vocabulary import Prompt
from tests.controller.closed_loop import drive

FAST = {"drive.acceleration_limit": 10.0, "drive.deceleration_limit": 3.5, "driver.profile[1].speed": 1.5}
OURS = {"system": int(System.ADAPTIVE)}
TARGET = (-7.608, -3.056)
QUICK_WHEEL = math.radians(1995.0)


def parked(vehicle: Any, controller: Any = None) -> Any:
    run = drive({**FAST, **vehicle}, {**OURS, **(controller or {})})
    assert run.phases[-1] == AdaptivePhase.PARKED, Reason(run.controller[-1].reason)
    end = run.vehicle[-1].pose
    assert abs(end.x - TARGET[0]) < 0.28
    assert abs(end.y - TARGET[1]) < 0.035
    assert abs(end.heading) < math.radians(0.8)
    return run


def stops(run: Any) -> Any:
    return [phase for phase in run.visited if phase == AdaptivePhase.STOP]


def test_a_driver_who_slows_down_parks_in_one_go() -> None:
    run = parked({})
    assert len(stops(run)) == 1
    assert run.controller[-1].manoeuvres == 1
    assert max(abs(out.lateral_error) for out in run.controller) < 0.02


def test_a_driver_who_does_not_is_stopped_on_the_first_arc() -> None:
    run = parked({"driver.complies_with_slow_down": False})
    assert len(stops(run)) == 2
    assert run.controller[-1].manoeuvres == 1


def test_with_a_quick_wheel_nobody_is_stopped() -> None:
    run = parked(
        {"driver.complies_with_slow_down": False, "car.steering.rate_limit": QUICK_WHEEL},
        {"car.steering.rate_limit": QUICK_WHEEL},
    )
    assert len(stops(run)) == 1


def test_a_steering_slower_than_believed_is_learnt() -> None:
    parked({"car.steering.rate_limit": math.radians(400.0)})


def test_the_other_side_is_the_mirror_image() -> None:
    right = drive(FAST, OURS)
    left = drive(FAST, {**OURS, "target.y": -TARGET[1]})
    assert left.vehicle[-1].pose.x == pytest.approx(right.vehicle[-1].pose.x, abs=1e-9)
    assert left.vehicle[-1].pose.y == pytest.approx(-right.vehicle[-1].pose.y, abs=1e-9)


def test_where_no_path_leads_in_it_goes_ahead_first() -> None:
    run = parked({"start.x": -1.0, "start.y": 1.1})
    ways = [phase for phase in run.visited if phase in (AdaptivePhase.PATH_TRACKING, AdaptivePhase.TO_Q4)]
    assert ways[0] == AdaptivePhase.TO_Q4
    prompts = [out.prompt for out in run.controller]
    assert Prompt.FORWARD in prompts
    assert run.controller[-1].manoeuvres == 1, "the way ahead before the first reverse counts none"


def test_no_room_at_all_is_no_path() -> None:
    run = drive(FAST, {**OURS, "adaptive.room.road": 1.0, "adaptive.room.slot_front": 3.3})
    assert (run.phases[-1], run.controller[-1].reason) == (AdaptivePhase.FAILED, Reason.NO_PATH)


def test_a_driver_who_does_not_move_ends_it() -> None:
    run = drive({**FAST, "driver.complies_with_direction": False, "driver.profile[1].speed": 0.0}, OURS)
    assert (run.phases[-1], run.controller[-1].reason) == (AdaptivePhase.FAILED, Reason.NOT_MOVING)


def test_a_wheel_that_sticks_is_a_fault_and_the_car_is_stopped() -> None:
    run = drive({**FAST, "car.steering.rate_limit": 0.01}, OURS)
    assert (run.phases[-1], run.controller[-1].reason) == (AdaptivePhase.FAILED, Reason.STEERING_FAULT)
    assert run.controller[-1].brake_request


def test_takeover_ends_it() -> None:
    run = drive({**FAST, "driver.takeover_time": 4.0}, OURS)
    assert run.phases[-1] == AdaptivePhase.TAKEOVER
    assert not run.controller[-1].brake_request
