"""Switches between the legs of Guo 2015 cannot make the errors grow: one V = k3 y^2 + tan^2 h falls on all of them."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from controller_fmu.adaptive.planner import Demand, plan
from controller_fmu.adaptive.room import room_of
from controller_fmu.adaptive.system import wheel_of
from controller_fmu.common.path_law import angle_back, deviation
from controller_fmu.common.steering_monitor import Steering
from controller_fmu.guo2015.path import Reference
from controller_fmu.guo2015.path_tracking import path_tracking_angle
from controller_fmu.guo2015.point_tracking import point_error, point_tracking_angle
from controller_fmu.registry import ControllerParams
from modelkit.vocabulary import Pose

L = 2.405
LOCK = math.radians(570.0 / 19.0)
K3, K4 = 1.0, 4.0
ROOM = math.tan(LOCK) / (L * K3)
STEP = 0.005
TARGET = Pose(0.0, 0.0, 0.0)


def energy(pose: Pose) -> float:
    """Return V of a car seen from the target."""
    return K3 * pose.y**2 + math.tan(pose.heading) ** 2


def driven(pose: Pose, angle: float, way: float) -> Pose:
    """Return the pose after ``way`` [m] (reverse negative) with the front wheel at ``angle`` [rad] within its lock."""
    k = math.tan(max(-LOCK, min(LOCK, angle))) / L
    turned = k * way
    share = math.sin(0.5 * turned) / (0.5 * turned) if abs(turned) > 1e-12 else 1.0
    middle = pose.heading + 0.5 * turned
    return Pose(pose.x + way * share * math.cos(middle), pose.y + way * share * math.sin(middle), pose.heading + turned)


def leg(pose: Pose, direction: int, length: float, k4: float = K4) -> tuple[Pose, float]:
    """Return the pose after a leg of point tracking, and by how much V rose at most from one step to the next."""
    worst = -math.inf
    for _ in range(round(length / STEP)):
        angle = point_tracking_angle(point_error(pose, TARGET), direction, K3, k4, L)
        after = driven(pose, angle, direction * STEP)
        worst = max(worst, energy(after) - energy(pose))
        pose = after
    return pose, worst


@settings(max_examples=60)
@given(
    radius=st.floats(0.0, 0.99),
    turn=st.floats(-math.pi, math.pi),
    legs=st.lists(st.tuples(st.sampled_from([1, -1]), st.floats(0.1, 3.0)), min_size=1, max_size=6),
)
def test_no_order_of_legs_makes_the_errors_grow(radius: float, turn: float, legs: list[tuple[int, float]]) -> None:
    y, slope = radius * ROOM * math.cos(turn), radius * ROOM * math.sqrt(K3) * math.sin(turn)
    pose = Pose(0.0, y, math.atan(slope))
    before = energy(pose)
    for direction, length in legs:
        pose, worst = leg(pose, direction, length)
        assert worst <= 2.0 * STEP**2 * before + 1e-15, "V rises by more than a step of 5 mm explains"
    assert energy(pose) <= before * (1.0 + 0.02)


def test_damping_of_the_wrong_sign_makes_them_grow() -> None:
    pose, worst = leg(Pose(0.0, 0.1, 0.05), -1, 2.0, k4=-K4)
    assert worst > 1e-4
    assert energy(pose) > energy(Pose(0.0, 0.1, 0.05))


def test_two_and_a_half_metres_each_way_shrink_them_as_the_docs_say() -> None:
    turn = np.diag([1.0, -1.0])
    once = turn @ expm(np.array([[0.0, 1.0], [-K3, -K4]]) * 2.5)
    shift = once @ once
    assert np.linalg.norm(shift, 2) == pytest.approx(0.35, abs=0.005)
    pose = Pose(0.0, 0.154, 0.0)
    for said in (0.050, 0.018):
        pose = leg(leg(pose, 1, 2.5)[0], -1, 2.5)[0]
        assert pose.y == pytest.approx(said, abs=0.0015)


@settings(max_examples=40)
@given(y=st.floats(-0.1, 0.1), heading=st.floats(-0.1, 0.1))
def test_the_same_v_falls_on_a_straight_piece_of_path(y: float, heading: float) -> None:
    pose = Pose(0.0, y, heading)
    before = energy(pose)
    for _ in range(400):
        angle = path_tracking_angle(pose, Reference(pose.x, 0.0, 0.0, 0.0, 0), 1.0, 0.8, L)
        after = driven(pose, angle, -STEP)
        assert energy(after) - energy(pose) <= 2.0 * STEP**2 * before + 1e-15
        pose = after


def test_the_room_the_docs_state() -> None:
    assert pytest.approx(0.24, abs=0.001) == ROOM
    assert math.degrees(math.atan(math.sqrt(K3 * (ROOM**2 - 0.154**2)))) == pytest.approx(10.4, abs=0.05)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(("y", "heading"), [(0.12, 0.0), (-0.1, 0.1), (0.02, -0.15), (0.0, 0.12)])
def test_along_a_route_the_errors_fall_ahead_and_back(direction: int, y: float, heading: float) -> None:
    pose = Pose(0.0, y, heading)
    before = energy(pose)
    for _ in range(round(3.0 / STEP)):
        off = deviation(pose, Pose(pose.x, 0.0, 0.0))
        after = driven(pose, angle_back(off, 0.0, direction, 1.0, 2.0, L), direction * STEP)
        assert energy(after) <= energy(pose) + 2.0 * STEP**2 * before
        pose = after
    assert energy(pose) < 0.1 * before


@pytest.mark.parametrize(
    "pose",
    [Pose(7.6, 3.06, 0.0), Pose(0.5, 0.02, 0.01), Pose(1.5, 0.15, 0.1), Pose(-0.3, 0.12, -0.1), Pose(3.0, 0.6, 0.35)],
)
def test_a_new_plan_begins_where_the_car_stands_or_on_the_slot_line(pose: Pose) -> None:
    params = ControllerParams()
    room, wheel = room_of(params.car, params.adaptive.room), wheel_of(Steering(), params)
    route = plan(pose, Demand(0.8, True, 0.2, 0.5, 0.3), wheel, room).route
    assert route.direction != 0
    assert route.start in (pose, Pose(pose.x, 0.0, 0.0))
