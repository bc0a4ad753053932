"""What the HSIC paper states, typed from the source: 5 deg, 0.1 m, 0.5 m, key points, the 12 states and their rules."""

import math
from typing import Any

import pytest

from controller_fmu.common.arc_line_arc import arc_line_arc
from controller_fmu.common.slot_frame import SlotFrame, to_world
from controller_fmu.hsic.characteristic_states import Characteristic, Errors, HsicStage, errors, recognise
from controller_fmu.hsic.control import Situation, curvature, speed
from controller_fmu.hsic.key_points import key_points, ready_point
from controller_fmu.hsic.params import HsicGains, HsicParams, HsicSlot, HsicSystemParams, HsicThresholds
from controller_fmu.hsic.phases import HsicPhase
from controller_fmu.hsic.rules import RULES, SpeedMode, SteerMode
from controller_fmu.hsic.stages import Course, advance, is_parked
from controller_fmu.hsic.system import HsicState, hsic_sample, hsic_start
from controller_fmu.interface import ParkingInput, Reason
from modelkit.car import Car
from modelkit.vocabulary import Pose

GAIN, LIMIT, SLOT = HsicGains(), HsicThresholds(), HsicSlot()
HSIC = HsicSystemParams()
CAR = Car(wheelbase=2.62, front_overhang=0.966, rear_overhang=0.85, width=1.82)
DEGREE = math.pi / 180.0


def test_rules_of_the_twelve_states_as_the_paper_words_them() -> None:
    """States 1, 5, 9: turn round; 2, 6, 10: slow; 3, 7, 11: faster; 4, 8, 12: slower. Steering: its README.md."""
    speeds = [SpeedMode(row[0]).name for row in RULES]
    steering = [SteerMode(row[1]).name for row in RULES]
    assert speeds == ["STAND", *("TURN_ROUND", "SLOW", "FAST", "APPROACH") * 3]
    assert steering == [
        "STRAIGHT",
        *("STRONG_PD", "BANG_BANG", "PD", "PID"),
        *("EXTREMUM_HOLD", "EXTREMUM_HOLD", "PD", "PID"),
        *("STRONG_PD", "BANG_BANG", "PD", "PID"),
    ]


@pytest.mark.parametrize(
    ("group", "name", "stated"),
    [
        (SLOT, "ready_gap", 0.5),
        (SLOT, "slot_length", 7.2),
        (SLOT, "slot_width", 2.2),
        (SLOT, "rear_gap", 0.6),
        (SLOT, "end_gap", 0.2),
        (SLOT, "radius_reserve", 1.05),
        (LIMIT, "parked_heading", 5.0 * DEGREE),
        (LIMIT, "parked_lateral", 0.1),
        (LIMIT, "aligned", 5.0 * DEGREE),
        (LIMIT, "turned", 0.4 * DEGREE),
        (LIMIT, "near", 0.8),
        (LIMIT, "reached", 0.01),
        (LIMIT, "ready_heading", 1.0 * DEGREE),
        (LIMIT, "ready_lateral", 0.1),
        (LIMIT, "retry_distance", 3.0),
        (LIMIT, "shuffle_share", 0.6),
        (LIMIT, "steering_angle_reached", 2.0 * DEGREE),
        (GAIN, "lateral", 2.5),
        (GAIN, "heading", 4.0),
        (GAIN, "integral", 0.1),
        (GAIN, "max_approach_heading", 4.5 * DEGREE),
        (GAIN, "gain_boost", 2.0),
        (GAIN, "max_speed", 0.8),
        (GAIN, "corrective_speed", 0.35),
        (GAIN, "approach", 1.0),
        (GAIN, "min_speed", 0.12),
    ],
)
def test_stated_and_chosen_numbers(group: object, name: str, stated: float) -> None:
    assert getattr(group, name) == pytest.approx(stated, abs=1e-12)


@pytest.mark.parametrize(
    ("heading", "lateral", "parked"), [(4.99, 0.099, True), (5.01, 0.0, False), (0.0, -0.101, False)]
)
def test_parked_needs_both_limits(heading: float, lateral: float, parked: bool) -> None:
    assert is_parked(Pose(0.0, lateral, heading * DEGREE), 1.0, HsicParams()) == parked


def test_ready_point_and_turning_points() -> None:
    ready = ready_point(SLOT, CAR, 4.0)
    assert ready.y == pytest.approx(0.5 + 0.5 * (2.2 + 1.82))
    assert ready.x == pytest.approx(7.2 - 0.6)
    points = key_points(ready, SLOT, CAR, 4.0)
    arcs = arc_line_arc(ready.x, ready.y, 4.0)
    assert points.p3 == pytest.approx((4.0 * math.sin(arcs.angle), 4.0 * (1.0 - math.cos(arcs.angle)), arcs.angle))
    assert math.dist(points.p2[:2], points.p3[:2]) == pytest.approx(arcs.line)
    assert math.atan2(points.p2.y - points.p3.y, points.p2.x - points.p3.x) == pytest.approx(arcs.angle)
    assert points.rearmost == pytest.approx(-(0.6 - 0.2))
    assert points.foremost == pytest.approx(7.2 - 0.6 - 0.966 - 2.62 - 0.85 - 0.2)


@pytest.mark.parametrize("stage", list(HsicStage))
@pytest.mark.parametrize(
    ("rate", "heading", "distance", "offset"),
    [(0.1, 0.0, 0.1, 0), (-0.1, 5.01 * DEGREE, 0.1, 1), (-0.1, -5.01 * DEGREE, 5.0, 1), (-0.1, 4.99 * DEGREE, 0.81, 2),
     (0.0, 0.0, 0.79, 3)],
)  # fmt: skip
def test_states_in_the_paper_s_order(stage: int, rate: float, heading: float, distance: float, offset: int) -> None:
    first = {HsicStage.READY: 1, HsicStage.SHUFFLE: 9}.get(HsicStage(stage), 5)
    found = Errors(1.0, 0.0, heading, distance, rate)
    assert recognise(stage, found, LIMIT) == Characteristic(first + offset)


def test_errors_to_a_key_point() -> None:
    found = errors(Pose(2.0, 1.5, 0.5), Pose(1.0, 1.0, 0.3), -0.4, -1)
    c, s = math.cos(0.3), math.sin(0.3)
    assert found[:4] == pytest.approx((c + 0.5 * s, 0.5 * c - s, 0.2, math.hypot(1.0, 0.5)))
    assert found.rate == pytest.approx(-0.4 * math.cos(0.2))


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(
    ("mode", "factor", "integral"),
    [
        (SteerMode.PD, 1.0, 0.0),
        (SteerMode.STRONG_PD, 2.0, 0.0),
        (SteerMode.BANG_BANG, 10.0, 0.0),
        (SteerMode.PID, 1.0, 0.1),
    ],
)
def test_steering_modes(mode: SteerMode, factor: float, integral: float, direction: int) -> None:
    now = Situation(HsicStage.TANGENT, direction, Errors(1.0, 0.003, 0.002, 1.0, -0.1), 0.2)
    wanted = -(factor * (2.5 * 0.003 + 4.0 * direction * 0.002) + integral * 0.2)
    assert curvature(mode, now, 0.2, 0.22, GAIN) == pytest.approx(wanted, abs=1e-12)
    ready = now._replace(stage=HsicStage.READY, found=now.found._replace(lateral=3.0))
    line = 4.0 * (4.5 * DEGREE + direction * 0.002) * factor + integral * 0.2
    assert curvature(mode, ready, 0.2, 9.0, GAIN) == pytest.approx(-line, abs=1e-12)


def test_extremum_hold_is_the_planned_arc() -> None:
    found = Errors(1.0, 0.3, 0.2, 1.0, -0.1)
    held = {
        stage: curvature(SteerMode.EXTREMUM_HOLD, Situation(stage, -1, found, 0.0), 0.2, 0.22, GAIN) for stage in (1, 3)
    }
    assert held == {HsicStage.TURN_IN: -0.2, HsicStage.COUNTER: 0.2}
    assert curvature(SteerMode.STRAIGHT, Situation(1, -1, found, 0.0), 0.2, 0.22, GAIN) == 0.0


@pytest.mark.parametrize(
    ("mode", "ahead", "wanted"),
    [(SpeedMode.STAND, 1.0, 0.0), (SpeedMode.TURN_ROUND, 1.0, 0.35), (SpeedMode.SLOW, 1.0, 0.35),
     (SpeedMode.FAST, 1.0, 0.8), (SpeedMode.APPROACH, -0.5, 0.5), (SpeedMode.APPROACH, 0.01, 0.12),
     (SpeedMode.APPROACH, 2.0, 0.8)],
)  # fmt: skip
def test_speed_modes(mode: SpeedMode, ahead: float, wanted: float) -> None:
    assert speed(mode, Errors(ahead, 0.0, 0.0, abs(ahead), -0.1), GAIN) == pytest.approx(wanted)


def course(stage: HsicStage, goal: Pose, way: int) -> Course:
    points = key_points(ready_point(SLOT, CAR, 4.0), SLOT, CAR, 4.0)
    return Course(stage, points, goal, hold=False, way=way)


def after(now: Course, pose: Pose) -> Course:
    return advance(now, pose, errors(pose, now.goal, -0.3, now.way), CAR, HsicParams())


def test_stages_follow_each_other_at_the_key_points() -> None:
    points = course(HsicStage.READY, Pose(), 1).points
    begun = after(course(HsicStage.READY, points.p1, 1), points.p1)
    assert (begun.stage, begun.goal, begun.way) == (HsicStage.TURN_IN, begun.points.p2, -1)
    on = after(begun, begun.points.p2)
    assert (on.stage, on.goal, on.way, on.hold) == (HsicStage.TANGENT, on.points.p3, -1, False)
    still_turning = begun.points.p2._replace(x=begun.points.p2.x + 0.5, heading=begun.points.p2.heading - 0.5 * DEGREE)
    assert after(begun, still_turning).stage == HsicStage.TURN_IN
    counter = after(on, on.points.p3)
    assert (counter.stage, counter.goal, counter.hold) == (HsicStage.COUNTER, Pose(), True)
    assert after(counter, Pose(0.0, 0.05, 0.0)).done
    missed = after(counter, Pose(0.0, 0.15, 0.0))
    assert (missed.stage, missed.goal) == (HsicStage.COUNTER, Pose(points.rearmost, 0.0, 0.0))
    shuffle = after(missed, Pose(points.rearmost, 0.15, 0.0))
    assert (shuffle.stage, shuffle.goal, shuffle.way) == (HsicStage.SHUFFLE, Pose(points.foremost, 0.0, 0.0), 1)
    assert not after(shuffle, Pose(0.5, 0.061, 0.0)).done
    assert after(shuffle, Pose(0.5, 0.059, 2.9 * DEGREE)).done
    assert after(shuffle, Pose(points.foremost, 0.1, 0.0)).goal == Pose(points.rearmost, 0.0, 0.0)


@pytest.mark.parametrize(
    ("along", "lateral", "heading", "ready"),
    [(0.0, 0.099, 0.0, True), (0.0, 0.101, 0.0, False), (0.29, 0.0, 0.0, True), (0.31, 0.0, 0.0, False),
     (0.0, 0.0, 0.99 * DEGREE, True), (0.0, 0.0, 1.01 * DEGREE, False)],
)  # fmt: skip
def test_ready_within_its_limits_else_another_approach_from_3_m(
    along: float, lateral: float, heading: float, ready: bool
) -> None:
    p1 = course(HsicStage.READY, Pose(), 1).points.p1
    found = after(course(HsicStage.READY, p1, 1), Pose(p1.x + along, p1.y + lateral, heading))
    assert found.stage == (HsicStage.TURN_IN if ready else HsicStage.READY)
    if not ready:
        assert found.goal == Pose(p1.x + 3.0, p1.y, 0.0)


def test_a_slot_too_near_for_two_arcs_moves_the_ready_point_ahead() -> None:
    slot = SLOT._replace(slot_length=4.0)
    ready = ready_point(slot, CAR, 4.0)
    assert ready.x == pytest.approx(1.001 * math.sqrt(4.0 * ready.y * 4.0 - ready.y * ready.y), rel=1e-12)


def at_rest(**inputs: Any) -> Any:
    return ParkingInput()._replace(**inputs)


def sampled(state: HsicState, **inputs: Any) -> HsicState:
    return hsic_sample(state, at_rest(**inputs), HSIC, 10_000_000)


def begun(**kept: Any) -> HsicState:
    state = sampled(hsic_start(HSIC), odometry=to_world(Pose(1.0, 3.0, 0.0), SlotFrame(HSIC.target)))
    return state._replace(**kept)


@pytest.mark.parametrize(
    ("lateral", "heading", "phase", "reason"),
    [
        (0.099, 0.0, HsicPhase.PARKED, Reason.NONE),
        (0.101, 0.0, HsicPhase.FAILED, Reason.MISSED_TARGET),
        (0.0, 5.1 * DEGREE, HsicPhase.FAILED, Reason.MISSED_TARGET),
    ],
)
def test_a_car_with_straight_wheels_is_parked_within_the_printed_limits(
    lateral: float, heading: float, phase: int, reason: int
) -> None:
    pose = to_world(Pose(0.0, lateral, heading), SlotFrame(HSIC.target))
    after = sampled(begun(phase=HsicPhase.STRAIGHTEN), odometry=pose)
    assert (after.phase, after.reason) == (phase, reason)


@pytest.mark.parametrize(("share", "reason"), [(0.99, Reason.NONE), (1.01, Reason.LEFT_PATH)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_car_three_times_too_far_off_is_lost_but_not_on_its_way_to_the_ready_point(
    share: float, reason: int, side: float
) -> None:
    state = begun()
    off = state.found._replace(lateral=side * share * 3.0 * HSIC.threshold.abort_lateral_error)
    pose = to_world(Pose(5.0, 2.0, 0.0), SlotFrame(HSIC.target))
    turning = state._replace(found=off, course=state.course._replace(stage=HsicStage.TANGENT))
    assert sampled(turning, odometry=pose).reason == reason
    assert sampled(state._replace(found=off), odometry=pose).reason == Reason.NONE


def test_the_arc_held_is_the_planned_one_and_the_integral_is_limited() -> None:
    state = begun(integral=5.0)
    pose = to_world(Pose(5.0, 2.0, 0.0), SlotFrame(HSIC.target))
    radius = HSIC.hsic.slot.radius_reserve * HSIC.car.wheelbase
    radius /= math.tan(HSIC.car.steering.angle_limit / HSIC.car.steering.ratio)
    assert state.course.points.radius == pytest.approx(radius, rel=1e-12)
    for integral in (5.0, -5.0):
        after = sampled(state._replace(integral=integral), odometry=pose)
        assert after.integral == pytest.approx(math.copysign(1.0, integral))


def test_the_wheels_held_while_counter_steering_are_those_of_the_planned_arc() -> None:
    state = begun(direction=-1, phase=HsicPhase.PATH_TRACKING)
    points = state.course.points
    course = state.course._replace(stage=HsicStage.COUNTER, goal=Pose(), hold=False)
    pose = to_world(Pose(1.5, 0.3, 0.3), SlotFrame(HSIC.target))
    after = sampled(state._replace(course=course), odometry=pose, measured_speed=-0.4)
    assert after.course.stage == HsicStage.COUNTER
    assert RULES[after.characteristic][1] == SteerMode.EXTREMUM_HOLD
    assert abs(after.angle) == pytest.approx(math.atan(HSIC.car.wheelbase / points.radius), rel=1e-9)
