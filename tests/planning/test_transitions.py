"""Curvature transitions: the path still ends at the goal, keeps its margin, and the wheel can follow at speed."""

import math
from itertools import pairwise

import pytest

from controller_fmu.parking.following.params import FollowingContext, FollowingParams
from controller_fmu.parking.following.rolling_steering import (
    is_transition,
    standstill_before,
    transition_after,
    upcoming_stop,
)
from controller_fmu.parking.planning.gear_segments import without_short_end
from controller_fmu.parking.planning.planner import MAX_SEGMENTS, PlannedPath, PlanningStatus, path_of_plan
from controller_fmu.parking.planning.problem import DrivingDynamics
from controller_fmu.parking.planning.steering_transitions import MARGIN_FRACTION
from controller_fmu.parking.planning.work import PlanCount, PlanValue
from modelkit.car import Car
from modelkit.vocabulary import Pose
from tests.planning.scenes import CAR, kept, least_clearance, plan, poses_along, request_of, scene_of

BOXES = [[(-9.0, -3.0), (-3.5, -3.0), (-3.5, -1.0), (-9.0, -1.0)], [(5.0, -3.0), (9.0, -3.0), (9.0, -1.0), (5.0, -1.0)]]
WALL = [[(-9.0, 5.2), (9.0, 5.2), (9.0, 5.4), (-9.0, 5.4)]]
GOAL = Pose(-1.2, -2.0, 0.0)
DYNAMICS = DrivingDynamics(2.8, 0.45, 0.95 * CAR.max_curvature, 0.8, 1.0, 0.5)
STARTS = [Pose(1.0, 3.0, 0.0), Pose(1.0, 3.0, 0.2)]


def path_with(start: Pose, polygons: list[list[tuple[float, float]]], dynamics: DrivingDynamics) -> PlannedPath:
    request = request_of(start, GOAL, 0.1, dynamics)
    store = plan(request, scene_of(polygons))
    assert store.counts[PlanCount.STATUS] == PlanningStatus.PLANNED
    poses = poses_along(start, kept(store))
    assert poses[-1][:2] == pytest.approx(GOAL[:2], abs=1e-4)
    assert math.remainder(poses[-1].heading - GOAL.heading, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-4)
    assert least_clearance(poses, polygons, CAR) >= MARGIN_FRACTION * store.values[PlanValue.BEST_PATH_MARGIN] - 1e-3
    return path_of_plan(store, request)


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("polygons", [BOXES, BOXES + WALL], ids=["road", "narrow road"])
def test_a_path_with_transitions_ends_at_the_goal_and_keeps_its_margin(
    start: Pose, polygons: list[list[tuple[float, float]]]
) -> None:
    path = path_with(start, polygons, DYNAMICS)
    turning = [piece for piece in path.segments if piece.speed > 0.0]
    assert turning
    assert path.used <= MAX_SEGMENTS
    assert max(abs(piece.curvature) for piece in turning) <= CAR.max_curvature
    for before, after in pairwise(path.segments[: path.used]):
        if before.speed == after.speed > 0.0 and before.distance == pytest.approx(after.distance, rel=1e-9):
            turned = abs(math.atan(2.8 * after.curvature) - math.atan(2.8 * before.curvature))
            assert turned <= DYNAMICS.rate * abs(after.distance) / after.speed + 1e-9, "the wheel can follow at speed"


def test_within_transitions_the_car_stops_only_where_the_gear_changes() -> None:
    context = FollowingContext(Car(), FollowingParams())
    path = without_short_end(path_with(STARTS[0], BOXES, DYNAMICS))
    for number in range(path.used - 1):
        same_gear = path.segments[number].distance * path.segments[number + 1].distance > 0.0
        if is_transition(path, number + 1):
            assert (transition_after(path, number, context).transition > 0.0) == same_gear
            if not same_gear:
                rest = standstill_before(path, number + 1, context)
                assert rest.overrun == 0.0
                assert rest.before > 0.0
                assert rest.after > 0.0
        if path.segments[number].speed > 0.0:
            assert upcoming_stop(path, number, 0.0, context).speed <= path.segments[number].speed + 1e-12
    assert is_transition(path, path.used), "the last arc, too, is turned out of on the move"


def test_where_the_wheel_turns_at_rest_nothing_is_changed() -> None:
    still = path_with(STARTS[0], BOXES, DYNAMICS._replace(rate=0.0))
    assert still == path_with(STARTS[0], BOXES, DrivingDynamics())
