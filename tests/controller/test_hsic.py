"""Key points, characteristic states, rules and control modes of HSIC."""

import itertools
import math
from typing import Any

import pytest

from controller_fmu.hsic.characteristic_states import Characteristic, Errors, HsicStage, errors, recognise
from controller_fmu.hsic.control import Situation, curvature, speed
from controller_fmu.hsic.key_points import key_points, ready_point
from controller_fmu.hsic.params import HsicGains, HsicParams, HsicSlot, HsicThresholds
from controller_fmu.hsic.phases import HsicPhase
from controller_fmu.hsic.rules import RULES, SpeedMode, SteerMode
from controller_fmu.hsic.stages import Course, is_parked
from controller_fmu.hsic.system import HsicState, hsic_sample
from controller_fmu.interface import Reason
from controller_fmu.registry import ControllerInput, ControllerParams
from modelkit.car import Car
from modelkit.vocabulary import Pose

SLOT, RADIUS = HsicSlot(), 4.3
CAR = Car(wheelbase=2.62, front_overhang=0.966, rear_overhang=0.85, width=1.82)


def test_ready_point_is_half_a_metre_beside_and_tail_level() -> None:
    p1 = ready_point(SLOT, CAR, RADIUS)
    assert p1.y - CAR.width / 2 - SLOT.slot_width / 2 == pytest.approx(0.5)
    front_end = SLOT.slot_length - SLOT.rear_gap - CAR.rear_overhang
    assert p1.x - CAR.rear_overhang == pytest.approx(front_end)


def test_key_points_lie_on_two_tangent_arcs_and_their_tangent() -> None:
    p1 = ready_point(SLOT, CAR, RADIUS)
    points = key_points(p1, SLOT, CAR, RADIUS)
    assert points.found
    for point, centre in ((points.p3, (0.0, RADIUS)), (points.p2, (p1.x, p1.y - RADIUS))):
        assert math.dist((point.x, point.y), centre) == pytest.approx(RADIUS)
    slope = math.atan2(points.p2.y - points.p3.y, points.p2.x - points.p3.x)
    assert slope == pytest.approx(points.p2.heading)
    assert points.p2.heading == points.p3.heading


def test_no_key_points_too_near() -> None:
    assert not key_points(Pose(3.0, 2.5, 0.0), SLOT, CAR, RADIUS).found


def test_every_state_is_recognised_and_has_its_rule() -> None:
    threshold, seen = HsicThresholds(), set()
    for stage, rate, heading, distance in itertools.product(HsicStage, (0.1, -0.1), (0.0, 0.3, -0.3), (0.1, 3.0)):
        state = recognise(int(stage), Errors(distance, 0.0, heading, distance, rate), threshold)
        group = {HsicStage.READY: "READY", HsicStage.SHUFFLE: "SHUFFLE"}.get(stage, "SLOT")
        kind = "AWAY" if rate > 0 else "TURNED" if heading else "FAR" if distance > 1 else "NEAR"
        assert Characteristic(state).name == f"{group}_{kind}"
        seen.add(state)
        speed_mode, steer_mode = RULES[state]
        assert SpeedMode(speed_mode) != SpeedMode.STAND
        assert SteerMode(steer_mode) != SteerMode.STRAIGHT
    assert len(seen) == 12


@pytest.mark.parametrize(("x", "direction", "rate"), [(2.0, -1, -1), (2.0, 1, 1), (-2.0, 1, -1), (-2.0, -1, 1)])
def test_rate_of_the_distance_at_speed_and_at_standstill(x: float, direction: int, rate: int) -> None:
    for v in (0.5 * direction, 0.0):
        assert errors(Pose(x, 0.0, 0.0), Pose(0.0, 0.0, 0.0), v, direction).rate * rate > 0.0


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("mode", [SteerMode.PD, SteerMode.STRONG_PD, SteerMode.BANG_BANG])
def test_steering_brings_the_car_to_the_axis_in_both_directions(direction: int, mode: Any) -> None:
    y, heading, step = 0.4, 0.0, 0.005
    for _ in range(int(8.0 / step)):
        found = Errors(1.0, y, heading, 1.0, -0.1)
        k = curvature(int(mode), Situation(int(HsicStage.SHUFFLE), direction, found, 0.0), 0.2, 0.25, HsicGains())
        y += direction * math.sin(heading) * step
        heading += direction * k * step
        assert abs(k) <= 0.25
    assert abs(y) < 0.02
    assert abs(heading) < 0.03


def test_extremum_hold_turns_in_and_counter_steers() -> None:
    far = Errors(3.0, 0.0, 0.5, 3.0, -0.1)
    hold = int(SteerMode.EXTREMUM_HOLD)
    assert curvature(hold, Situation(int(HsicStage.TURN_IN), -1, far, 0.0), 0.2, 0.25, HsicGains()) == -0.2
    assert curvature(hold, Situation(int(HsicStage.COUNTER), -1, far, 0.0), 0.2, 0.25, HsicGains()) == 0.2


def test_speeds_of_the_modes() -> None:
    gain = HsicGains()
    near, far = Errors(0.3, 0, 0, 0.3, -1), Errors(5.0, 0, 0, 5.0, -1)
    assert speed(int(SpeedMode.STAND), far, gain) == 0.0
    assert speed(int(SpeedMode.FAST), far, gain) == gain.max_speed
    assert gain.min_speed <= speed(int(SpeedMode.APPROACH), near, gain) < gain.max_speed
    assert speed(int(SpeedMode.SLOW), far, gain) == speed(int(SpeedMode.TURN_ROUND), far, gain) == gain.corrective_speed


def test_parked_by_the_paper_s_limits() -> None:
    p = HsicParams()
    assert is_parked(Pose(0.3, 0.09, math.radians(4.9)), 1.0, p)
    assert not is_parked(Pose(0.0, 0.11, 0.0), 1.0, p)
    assert not is_parked(Pose(0.0, 0.0, math.radians(5.1)), 1.0, p)


def test_a_car_is_lost_three_times_as_far_from_an_axis_as_from_a_path() -> None:
    params = ControllerParams()
    far = 3.0 * params.threshold.abort_lateral_error
    for lateral, stage, reason in (
        (far - 0.01, HsicStage.COUNTER, Reason.NONE),
        (far + 0.01, HsicStage.COUNTER, Reason.LEFT_PATH),
        (-far - 0.01, HsicStage.TURN_IN, Reason.LEFT_PATH),
        (far + 0.01, HsicStage.READY, Reason.NONE),
    ):
        begun = HsicState(phase=HsicPhase.PATH_TRACKING, direction=-1, course=Course(stage=stage))
        state = begun._replace(found=begun.found._replace(lateral=lateral))
        assert hsic_sample(state, ControllerInput(), params, 10_000_000).reason == reason
