"""Curvature transitions: the path still ends at the goal, keeps its margin, and the wheel can follow at speed."""

import math
from itertools import pairwise

import pytest

from controller_fmu.planning.plan import PATH, PLANNED, Path, path_of
from controller_fmu.planning.plan_store import KEPT_MARGIN, STATUS
from controller_fmu.planning.stretch import trimmed
from controller_fmu.planning.task import Dynamics, Request
from controller_fmu.planning.transitions import KEPT_SHARE
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.rolling import ahead_of, is_transition, joint_of, rest_before
from modelkit.car import Car
from modelkit.vocabulary import Pose
from tests.planning.scenes import CAR, kept, least_clearance, plan, poses_along, scene_of

BOXES = [[(-9.0, -3.0), (-3.5, -3.0), (-3.5, -1.0), (-9.0, -1.0)], [(5.0, -3.0), (9.0, -3.0), (9.0, -1.0), (5.0, -1.0)]]
WALL = [[(-9.0, 5.2), (9.0, 5.2), (9.0, 5.4), (-9.0, 5.4)]]
GOAL = Pose(-1.2, -2.0, 0.0)
DYNAMICS = Dynamics(2.8, 0.45, 0.95 * CAR.curvature, 0.8, 1.0, 0.5)
STARTS = [Pose(1.0, 3.0, 0.0), Pose(1.0, 3.0, 0.2)]


def path_with(start: Pose, polygons: list[list[tuple[float, float]]], dynamics: Dynamics) -> Path:
    store = plan(Request(start, GOAL, CAR, 0.1, dynamics), scene_of(polygons))
    assert store.mark[STATUS] == PLANNED
    poses = poses_along(start, kept(store))
    assert poses[-1][:2] == pytest.approx(GOAL[:2], abs=1e-4)
    assert math.remainder(poses[-1].heading - GOAL.heading, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-4)
    assert least_clearance(poses, polygons, CAR) >= KEPT_SHARE * store.measure[KEPT_MARGIN] - 1e-3
    return path_of(store)


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("polygons", [BOXES, BOXES + WALL], ids=["road", "narrow road"])
def test_a_path_with_transitions_ends_at_the_goal_and_keeps_its_margin(
    start: Pose, polygons: list[list[tuple[float, float]]]
) -> None:
    path = path_with(start, polygons, DYNAMICS)
    turning = [piece for piece in path.pieces if piece.speed > 0.0]
    assert turning
    assert path.used <= PATH
    assert max(abs(piece.k) for piece in turning) <= CAR.curvature
    for before, after in pairwise(path.pieces[: path.used]):
        if before.speed == after.speed > 0.0 and before.way == pytest.approx(after.way, rel=1e-9):
            turned = abs(math.atan(2.8 * after.k) - math.atan(2.8 * before.k))
            assert turned <= DYNAMICS.rate * abs(after.way) / after.speed + 1e-9, "the wheel can follow at speed"


def test_within_transitions_the_car_stops_only_where_the_gear_changes() -> None:
    params = ValetParams(car=Car())
    path = trimmed(path_with(STARTS[0], BOXES, DYNAMICS))
    for number in range(path.used - 1):
        same_gear = path.pieces[number].way * path.pieces[number + 1].way > 0.0
        if is_transition(path, number + 1):
            assert (joint_of(path, number, params).ramp > 0.0) == same_gear
            if not same_gear:
                rest = rest_before(path, number + 1, params)
                assert rest.over == 0.0
                assert rest.before > 0.0
                assert rest.after > 0.0
        if path.pieces[number].speed > 0.0:
            assert ahead_of(path, number, 0.0, params).speed <= path.pieces[number].speed + 1e-12
    assert is_transition(path, path.used), "the last arc, too, is turned out of on the move"


def test_where_the_wheel_turns_at_rest_nothing_is_changed() -> None:
    still = path_with(STARTS[0], BOXES, DYNAMICS._replace(rate=0.0))
    assert still == path_with(STARTS[0], BOXES, Dynamics())
