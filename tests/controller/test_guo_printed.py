"""What Guo 2015 prints, typed from the source: gains, Tables 1 and 2, eq. (6), (9), (17), Fig. 9 and 11 as guards."""

import math
from typing import Any

import pytest

from controller_fmu.common.chart import ANY_STATE
from controller_fmu.guo2015.chart import SAME_LEG, TRANSITIONS, Guard
from controller_fmu.guo2015.guards import standing_guards, way_guards
from controller_fmu.guo2015.legs import Tracking, point_of_leg, track
from controller_fmu.guo2015.params import GuoParams
from controller_fmu.guo2015.path import BEYOND_PATH, FIRST_ARC, SECOND_ARC, Reference, reference_at
from controller_fmu.guo2015.path_tracking import path_tracking_angle
from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.guo2015.planner import TwoArcPath, plan
from controller_fmu.guo2015.point_tracking import PointError, point_error, point_tracking_angle
from controller_fmu.guo2015.prompts import PROMPT_OF_PHASE
from controller_fmu.registry import ControllerInput, ControllerParams, System
from modelkit.vocabulary import Pose, Prompt
from orchestrator.inputs.scenario.load_scenario import load_scenario

PARAMS = ControllerParams()
ON_PATH = Tracking()
Q1, Q2, Q3, Q4 = (-3.798, -1.522, 0.765), (-3.077, -0.830, 0.765), (-7.608, -3.056, 0.0), (-5.108, -3.056, 0.0)


@pytest.fixture(scope="module")
def path() -> TwoArcPath:
    return plan(Pose(), PARAMS.target, PARAMS.guo2015.radius, 4.0).path


@pytest.mark.parametrize(
    ("name", "printed"),
    [("k1", 1.0), ("k2", 0.8), ("k3", 1.0), ("k4", 4.0), ("radius", 5.5), ("q2_distance", 1.0), ("q4_distance", 2.5)],
)
def test_gains_radius_and_distances(name: str, printed: float) -> None:
    assert getattr(GuoParams(), name) == printed


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("car.wheelbase", 2.405),
        ("car.steering.angle_limit", math.radians(570.0)),
        ("car.steering.rate_limit", math.radians(570.0)),
        ("car.steering.ratio", 19.0),
    ],
)
@pytest.mark.parametrize("place", ["vehicle", "controller"])
def test_table_1(place: str, name: str, printed: float) -> None:
    assert load_scenario("guo2015-case4").parameters_of(place)[name] == pytest.approx(printed, abs=1e-12)


@pytest.mark.parametrize(
    ("leg", "printed"),
    [(GuoPhase.TO_Q1, Q1), (GuoPhase.TO_Q2, Q2), (GuoPhase.TO_Q3, Q3), (GuoPhase.TO_Q4, Q4)],
)
def test_table_2(leg: GuoPhase, printed: tuple[float, float, float], path: TwoArcPath) -> None:
    point = point_of_leg(leg, path, PARAMS.guo2015)
    assert (point.x + Q3[0], point.y + Q3[1], point.heading) == pytest.approx(printed, abs=7e-3)
    assert point.heading == pytest.approx(printed[2], abs=1.2e-3)


def test_q2_lies_on_the_tangent_at_q1(path: TwoArcPath) -> None:
    one, two = (point_of_leg(leg, path, PARAMS.guo2015) for leg in (GuoPhase.TO_Q1, GuoPhase.TO_Q2))
    assert math.atan2(two.y - one.y, two.x - one.x) == pytest.approx(one.heading, abs=1e-12)
    assert math.hypot(two.x - one.x, two.y - one.y) == pytest.approx(math.hypot(0.721, 0.692), abs=1e-3)


@pytest.mark.parametrize("x", [-0.001, -0.7, -1.9, -3.2, -3.79, -3.81, -4.9, -6.3, -7.6])
def test_equation_9(x: float, path: TwoArcPath) -> None:
    first = x > -3.80
    at = reference_at(path, x - Q3[0], FIRST_ARC)
    printed = -5.5 + math.sqrt(30.25 - x**2) if first else 2.44 - math.sqrt(30.25 - (x + 7.61) ** 2)
    sine = -x / 5.5 if first else (x + 7.61) / 5.5
    assert at.y + Q3[1] == pytest.approx(printed, abs=5e-3)
    assert at.heading == pytest.approx(math.asin(sine), abs=1.5e-3)
    assert at.curvature == pytest.approx(-1.0 / 5.5 if first else 1.0 / 5.5, rel=1e-3)
    assert at.piece == (FIRST_ARC if first else SECOND_ARC)
    assert reference_at(path, -0.1, FIRST_ARC).piece == BEYOND_PATH


@pytest.mark.parametrize(
    ("y", "heading", "y_r", "heading_r", "rho"),
    [(0.1, 0.3, 0.0, 0.35, 0.18), (-0.2, 0.7, -0.15, 0.6, -0.18), (0.0, 0.0, 0.05, -0.2, 0.0)],
)
def test_equation_6_both_signs_corrected(y: float, heading: float, y_r: float, heading_r: float, rho: float) -> None:
    ours = path_tracking_angle(Pose(0.0, y, heading), Reference(0.0, y_r, heading_r, rho, 0), 1.0, 0.8, 2.405)
    bend = rho / math.cos(heading_r) ** 3 + 1.0 * (y_r - y) - 0.8 * (math.tan(heading_r) - math.tan(heading))
    assert ours == pytest.approx(math.atan(2.405 * math.cos(heading) ** 3 * bend), abs=1e-12)


@pytest.mark.parametrize(("x", "y", "heading"), [(-4.8, -2.44, 0.588), (-2.0, -0.5, 0.9), (-5.0, -1.0, 0.2)])
@pytest.mark.parametrize("leg", [GuoPhase.TO_Q1, GuoPhase.TO_Q2, GuoPhase.TO_Q3, GuoPhase.TO_Q4])
def test_equations_10_and_17_on_every_leg(leg: GuoPhase, x: float, y: float, heading: float, path: TwoArcPath) -> None:
    pose = Pose(x - Q3[0], y - Q3[1], heading)
    at = point_of_leg(leg, path, PARAMS.guo2015)
    dx, dy, off = pose.x - at.x, pose.y - at.y, heading - at.heading
    beside = dy * math.cos(at.heading) - dx * math.sin(at.heading)
    sign = 1.0 if leg in (GuoPhase.TO_Q2, GuoPhase.TO_Q4) else -1.0
    found = track(leg, pose, path, 0, PARAMS)
    assert found.ahead == pytest.approx(dx * math.cos(at.heading) + dy * math.sin(at.heading), abs=1e-12)
    assert found.lateral_error == pytest.approx(beside, abs=1e-12)
    wanted = math.atan(2.405 * math.cos(off) ** 3 * (-1.0 * beside - sign * 4.0 * math.tan(off)))
    assert found.front_wheel_angle == pytest.approx(wanted, abs=1e-12)
    assert point_error(pose, at) == pytest.approx((found.ahead, beside, off), abs=1e-12)
    assert point_tracking_angle(PointError(*point_error(pose, at)), sign, 1.0, 4.0, 2.405) == pytest.approx(wanted)


@pytest.mark.parametrize(
    ("name", "chosen"),
    [
        ("leave_lateral", 0.154),
        ("leave_heading", 0.25),
        ("resume_lateral", 0.05),
        ("resume_heading", 0.05),
        ("park_lateral", 0.03),
        ("park_heading", math.radians(0.8)),
        ("park_longitudinal", 100.0),
        ("moving_share", 0.35),
    ],
)
def test_thresholds_are_those_the_page_states(name: str, chosen: float) -> None:
    assert getattr(GuoParams().threshold, name) == pytest.approx(chosen, abs=1e-12)


def raised(path: TwoArcPath, pose: Pose, tracking: Tracking = ON_PATH, speed: float = 0.0, **kept: Any) -> set[Guard]:
    bits = way_guards(GuoPhase.PATH_TRACKING, tracking, pose, path, speed, PARAMS._replace(**kept))
    return {guard for guard in Guard if (bits >> guard) & 1}


E = 1e-6
"""Just within and just beyond a limit."""


@pytest.mark.parametrize(
    ("lateral", "heading", "off"),
    [
        (0.154 - E, 0.0, False), (0.154 + E, 0.0, True), (-0.154 - E, 0.0, True),
        (0.0, 0.25 - E, False), (0.0, 0.25 + E, True), (0.0, -0.25 - E, True),
    ],
)  # fmt: skip
def test_off_the_path_by_either_error(lateral: float, heading: float, off: bool, path: TwoArcPath) -> None:
    tracking = Tracking(lateral_error=lateral, heading_error=heading)
    assert (Guard.OFF_PATH in raised(path, Pose(6.0, 2.9, 0.1), tracking)) == off
    assert Guard.OFF_PATH not in raised(path, Pose(6.0, 2.9, 0.1), tracking, system=System.NTBPT)


@pytest.mark.parametrize(("dx", "dy", "past"), [(-E, -E, False), (E, -0.5, True), (-0.5, E, True), (E, E, True)])
def test_past_q2_by_x_or_by_y(dx: float, dy: float, past: bool, path: TwoArcPath) -> None:
    q2 = point_of_leg(GuoPhase.TO_Q2, path, PARAMS.guo2015)
    assert (Guard.PAST_Q2 in raised(path, Pose(q2.x + dx, q2.y + dy, q2.heading))) == past


@pytest.mark.parametrize(
    ("ahead", "lateral", "heading", "found"),
    [
        (E, 0.0, 0.0, None),
        (0.0, 0.05 - E, 0.0, Guard.AT_Q1_RIGHT), (-0.1, 0.0, -0.05 + E, Guard.AT_Q1_RIGHT),
        (0.0, 0.05 + E, 0.0, Guard.AT_Q1_WRONG), (0.0, -0.05 - E, 0.0, Guard.AT_Q1_WRONG),
        (0.0, 0.0, 0.05 + E, Guard.AT_Q1_WRONG),
    ],
)  # fmt: skip
def test_at_q1_both_errors_under_5_cm_and_50_mrad(
    ahead: float, lateral: float, heading: float, found: Guard | None, path: TwoArcPath
) -> None:
    tracking = Tracking(ahead=ahead, lateral_error=lateral, heading_error=heading)
    both = {Guard.AT_Q1_RIGHT, Guard.AT_Q1_WRONG}
    assert raised(path, Pose(3.8, 1.5, 0.7), tracking) & both == ({found} if found is not None else set())


@pytest.mark.parametrize("speed", [0.0, -0.2, -0.5, 1.0])
def test_stop_is_prompted_ahead_of_q3_by_the_way_to_stop(speed: float, path: TwoArcPath) -> None:
    """0.3 s of reaction and 2 m/s2 are assumed, at Q3 and at the end of the path alike."""
    stop = 0.3 * abs(speed) + speed**2 / (2.0 * 2.0)
    assert Guard.AT_Q3 in raised(path, Pose(stop - E, 0.0, 0.0), speed=speed)
    assert Guard.AT_Q3 not in raised(path, Pose(stop + E, 0.0, 0.0), speed=speed)
    for off in (-1e-3, 1e-3):
        at = Pose(5.4993 * math.sin((stop + off) / 5.4993), 0.0, 0.0)
        tracking = track(GuoPhase.PATH_TRACKING, at, path, FIRST_ARC, PARAMS)
        assert (Guard.PATH_END in raised(path, at, tracking, speed)) == (off < 0.0)


@pytest.mark.parametrize(("x", "past"), [(2.5 - E, False), (2.5 + E, True)])
def test_past_q4(x: float, past: bool, path: TwoArcPath) -> None:
    assert (Guard.PAST_Q4 in raised(path, Pose(x, 0.0, 0.0))) == past


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("off", [-E, E])
def test_pose_is_right_within_a_third_of_the_limits_on_the_move_and_within_them_at_rest(
    sign: float, off: float, path: TwoArcPath
) -> None:
    lateral, heading = 0.35 * 0.03, 0.35 * math.radians(0.8)
    for pose in (Pose(1.0, sign * (lateral + off), 0.0), Pose(1.0, 0.0, sign * (heading + off))):
        assert (Guard.POSE_RIGHT in raised(path, pose)) == (off < 0.0)
    for pose in (Pose(0.0, sign * (0.03 + off), 0.0), Pose(0.0, 0.0, sign * (math.radians(0.8) + off))):
        bits = standing_guards(GuoPhase.STRAIGHTEN, pose, ControllerInput(), PARAMS)
        right = {guard for guard in Guard if (bits >> guard) & 1}
        assert right == {Guard.STANDING_AT_END if off < 0.0 else Guard.STANDING_AT_END_WRONG}


@pytest.mark.parametrize(("x", "found"), [(0.5 - E, Guard.STANDING_AT_END), (0.5 + E, Guard.STANDING_AHEAD)])
def test_a_right_pose_too_far_ahead_of_q3_is_driven_back_where_that_is_asked_for(x: float, found: Guard) -> None:
    threshold = PARAMS.guo2015.threshold._replace(park_longitudinal=0.5)
    params = PARAMS._replace(guo2015=PARAMS.guo2015._replace(threshold=threshold))
    for asked, wanted in ((params, found), (PARAMS, Guard.STANDING_AT_END)):
        bits = standing_guards(GuoPhase.STRAIGHTEN, Pose(x, 0.0, 0.0), ControllerInput(), asked)
        assert {guard for guard in Guard if (bits >> guard) & 1} == {wanted}


def test_the_chart_is_that_of_figures_9_and_11() -> None:
    P, G = GuoPhase, Guard
    assert TRANSITIONS == (
        (ANY_STATE, G.TAKEOVER, P.TAKEOVER, SAME_LEG),
        (ANY_STATE, G.FAULT, P.FAILED, SAME_LEG),
        (P.STANDBY, G.PLANNED, P.PRE_STEER, P.PATH_TRACKING),
        (P.PRE_STEER, G.WHEEL_SET_FOR_PATH, P.PATH_TRACKING, SAME_LEG),
        (P.PRE_STEER, G.WHEEL_SET_FOR_Q2, P.TO_Q2, SAME_LEG),
        (P.PRE_STEER, G.WHEEL_SET_FOR_Q1, P.TO_Q1, SAME_LEG),
        (P.PRE_STEER, G.WHEEL_SET_FOR_Q4, P.TO_Q4, SAME_LEG),
        (P.PRE_STEER, G.WHEEL_SET_FOR_Q3, P.TO_Q3, SAME_LEG),
        (P.PATH_TRACKING, G.PATH_END, P.STOP, P.STRAIGHTEN),
        (P.PATH_TRACKING, G.OFF_PATH, P.STOP, P.TO_Q2),
        (P.TO_Q2, G.PAST_Q2, P.STOP, P.TO_Q1),
        (P.TO_Q1, G.AT_Q1_RIGHT, P.STOP, P.PATH_TRACKING),
        (P.TO_Q1, G.AT_Q1_WRONG, P.STOP, P.TO_Q2),
        (P.TO_Q4, G.POSE_RIGHT, P.STOP, P.STRAIGHTEN),
        (P.TO_Q4, G.PAST_Q4, P.STOP, P.TO_Q3),
        (P.TO_Q3, G.AT_Q3, P.STOP, P.STRAIGHTEN),
        (P.STOP, G.STANDING_TO_DRIVE, P.PRE_STEER, SAME_LEG),
        (P.STOP, G.STANDING_AT_END_WRONG, P.PRE_STEER, P.TO_Q4),
        (P.STOP, G.STANDING_AHEAD, P.PRE_STEER, P.TO_Q3),
        (P.STOP, G.STANDING_AT_END, P.STRAIGHTEN, SAME_LEG),
        (P.STRAIGHTEN, G.WHEEL_STRAIGHT, P.PARKED, SAME_LEG),
    )


def test_prompts_are_the_paper_s() -> None:
    reported = {phase.name: PROMPT_OF_PHASE[phase] for phase in GuoPhase}
    reverse = dict.fromkeys(("PATH_TRACKING", "TO_Q1", "TO_Q3"), Prompt.REVERSE)
    stop = dict.fromkeys(("PRE_STEER", "STOP", "STRAIGHTEN", "PARKED", "FAILED"), Prompt.STOP)
    forward = dict.fromkeys(("TO_Q2", "TO_Q4"), Prompt.FORWARD)
    assert reported == reverse | stop | forward | {"STANDBY": Prompt.NONE, "TAKEOVER": Prompt.NONE}
    prompting = GuoParams().prompting
    assert (prompting.reaction, prompting.deceleration, prompting.point_speed) == (0.3, 2.0, 0.5)
    assert (prompting.creep_speed, prompting.speed_limit, prompting.jump_deviation) == (0.2, 2.5, 0.025)
