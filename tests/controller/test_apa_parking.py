"""The assist in the closed loop: parked where it should be, and every way to fail with its reason."""

import math
from typing import Any

import pytest

from controller_fmu.apa.chart import Mode
from controller_fmu.apa.manoeuvre_chart import Step
from controller_fmu.apa.parking import Parking, has_shifted
from controller_fmu.apa.ways.move import Move
from controller_fmu.apa.ways.planner import FOUND, PlanSearch, new_search
from controller_fmu.interface import Reason
from modelkit.vocabulary import Pose
from tests.controller.apa_bench import CAR, Run, box, car_settings, drive

HALF = 0.5 * CAR.width
FRONT = CAR.wheelbase + CAR.front_overhang


def given(kind: str, length: float, side: int, **more: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the parameters of a car that stands past a slot it is told of."""
    vehicle, controller = car_settings(CAR)
    along, deep = (4.4, 1.8) if kind == "parallel" else (1.8, 4.6)
    for number, x in enumerate((-along, length), start=1):
        vehicle |= box(number, x, x + along, *((-deep, 0.0) if side > 0 else (0.0, deep)))
    vehicle |= {"start.x": length + 1.0, "start.y": side * (1.0 + HALF), "driver.apa_switch_time": 0.05}
    slot = {"kind": 1 if kind == "parallel" else 2, "side": 0 if side > 0 else 1, "length": length}
    controller |= {"apa.search.given": True} | {f"apa.search.slot.{name}": value for name, value in slot.items()}
    return vehicle | more, controller


def run(more: dict[str, Any] | None = None, asked: dict[str, Any] | None = None, stop: float = 60.0) -> Run:
    vehicle, controller = given("parallel", 7.2, 1)
    return drive(vehicle | (more or {}), controller | (asked or {}), stop)


@pytest.mark.parametrize(("kind", "length"), [("parallel", 7.2), ("parallel", 5.7), ("perpendicular", 3.1)])
@pytest.mark.parametrize("side", [1, -1])
def test_the_car_is_parked_within_the_project_limits(kind: str, length: float, side: int) -> None:
    end = drive(*given(kind, length, side), 90.0)
    pose = end.vehicle.pose
    assert end.controller.apa.mode == Mode.PARKING_FINISH
    if kind == "parallel":
        lateral, turned = pose.y + side * HALF, pose.heading
    else:
        lateral, turned = pose.x - 0.5 * length, pose.heading - side * 0.5 * math.pi
        assert pose.y == pytest.approx(-side * FRONT, abs=0.1)
    assert abs(lateral) < 0.05
    assert abs(turned) < math.radians(1.0)
    assert end.nearest > 0.1
    assert end.controller.manoeuvres <= (8 if length == 5.7 else 3)
    assert abs(end.vehicle.steering_wheel_angle) < math.radians(5.0)


def test_a_drive_is_asked_for_little_more_speed_than_it_has() -> None:
    rows = drive(*given("parallel", 7.2, 1), 4.0, keep=True).rows
    over = [abs(asked.speed_request) - abs(car.measured_speed) for _, car, asked in rows]
    assert 0.1 < max(over) < 0.151


def test_the_first_plan_is_made_again_where_the_slot_turns_out_to_lie_elsewhere() -> None:
    start = Pose(6.0, 2.0, 0.1)
    planned = Parking(step=Step.PLAN, plan=PlanSearch(status=FOUND, move=Move(start)))
    assert not has_shifted(planned, start)
    assert not has_shifted(planned, Pose(6.0, 2.05, 0.1)), "what the map learns at standstill"
    for moved in (Pose(6.0, 2.1, 0.1), Pose(6.1, 2.0, 0.1), Pose(6.0, 2.0, 0.15)):
        assert has_shifted(planned, moved)
        assert not has_shifted(planned._replace(direction=-1), moved), "a car under way plans at the end of its move"
        assert not has_shifted(planned._replace(plan=new_search(start)), moved), "nothing is planned yet"


def test_the_left_is_the_mirror_image_of_the_right() -> None:
    right, left = (drive(*given("parallel", 7.2, side), 60.0).vehicle.pose for side in (1, -1))
    assert (left.x, left.y, left.heading) == pytest.approx((right.x, -right.y, -right.heading), abs=1e-9)


@pytest.mark.parametrize("reaction", [0.0, 0.05, 0.1, 0.3])
def test_the_driver_drives_as_prompted(reaction: float) -> None:
    driver = {"driver.profile[1].speed": 0.6, "driver.reaction_delay": reaction}
    end = run(driver, {"apa.drive.longitudinal": 1}, 90.0)
    assert end.controller.apa.mode == Mode.PARKING_FINISH
    assert end.nearest > 0.1
    assert not end.controller.speed_control_active


@pytest.mark.parametrize(
    "more",
    [
        {"driver.takeover_time": 6.0},
        {"driver.brake_time": 6.0},
        {"driver.steering_override_time": 6.0, "driver.steering_override_angle": 9.0},
    ],
)
def test_the_driver_takes_over_at_any_time(more: dict[str, Any]) -> None:
    end = run(more)
    assert end.controller.apa.mode == Mode.FAIL
    assert end.controller.phase == 11
    assert end.controller.reason == Reason.NONE
    assert not end.controller.steering_active
    assert end.time < 9.0


def test_switching_off_is_taking_over() -> None:
    end = run({"driver.apa_switch_off_time": 6.0}, stop=8.0)
    assert end.controller.apa.mode == Mode.OFF
    assert not end.controller.steering_active


@pytest.mark.parametrize(
    ("more", "asked", "reason"),
    [
        ({}, {"apa.guard.duration": 8.0}, Reason.TIMEOUT),
        (
            {"driver.profile[1].speed": 2.0, "driver.complies_with_slow_down": False},
            {"apa.drive.longitudinal": 1, "apa.guard.over_speed": 1.0},
            Reason.OVER_SPEED,
        ),
        (
            {},
            {"car.ultrasonic.min_range": 10.0},
            Reason.SENSOR_LOSS,
        ),
        ({"car.steering.rate_limit": 0.02}, {}, Reason.STEERING_FAULT),
        ({}, {"apa.plan.manoeuvres": 1, "apa.search.slot.length": 5.7}, Reason.TOO_MANY_SHIFTS),
    ],
)
def test_every_failure_has_its_reason(more: dict[str, Any], asked: dict[str, Any], reason: Reason) -> None:
    end = run(more, asked)
    assert end.controller.apa.mode == Mode.FAIL
    assert Reason(end.controller.reason) == reason
    assert end.vehicle.clearance > 0.0


def test_something_that_stays_in_the_way_is_not_touched() -> None:
    thing = box(4, 2.0, 2.6, -0.8, -0.2) | {"scene.boxes[4].appear_at": 5.0}
    end = run(thing, stop=60.0)
    assert Reason(end.controller.reason) == Reason.BLOCKED
    assert end.nearest > 0.1


def test_something_that_goes_away_again_is_waited_for() -> None:
    thing = box(4, 2.0, 2.6, -0.8, -0.2) | {"scene.boxes[4].appear_at": 5.0, "scene.boxes[4].disappear_at": 14.0}
    end = run(thing, stop=60.0)
    assert end.controller.apa.mode == Mode.PARKING_FINISH
    assert end.nearest > 0.1
