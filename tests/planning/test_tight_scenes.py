"""No path touches anything, however little room there is: checked with shapely in random scenes with 0 to 20 mm."""

from typing import Any

import pytest

from controller_fmu.parking.planning.planner import PlanningStatus
from controller_fmu.parking.planning.search_schedule import MIN_MARGIN
from fmus.compiler import translate
from modelkit.vocabulary import Pose
from tests.compiler.c_model import CModel
from tests.planning import plan_model
from tests.planning.scenes import CAR, request_of
from tests.planning.tight_scenes import TightScene, draw_scene, mistake_of, planned_by, rectangle, replanned

REAR, SIDE = CAR.centre_ahead - CAR.half_length, CAR.half_width


@pytest.fixture(scope="module")
def planner(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return CModel(plan_model.MODEL, translate(plan_model.MODEL), tmp_path_factory.mktemp("planner"))


def check(planner: Any, scene: TightScene) -> Any:
    """Return what the planner answers; it is right by shapely."""
    plan = planned_by(planner, scene)
    assert mistake_of(scene, plan) == "", scene
    return plan


def check_seeds(planner: Any, seeds: range) -> int:
    """Check scenes and, of each that has a path, one in which the car replans; returns how many have a path."""
    count = 0
    for seed in seeds:
        scene = draw_scene(seed)
        plan = check(planner, scene)
        if plan.status == PlanningStatus.PLANNED:
            count += 1
            check(planner, replanned(scene, plan, seed))
    return count


def test_no_path_touches_anything(planner: Any) -> None:
    assert check_seeds(planner, range(16)) >= 4


@pytest.mark.release
def test_no_path_touches_anything_in_2000_scenes(planner: Any) -> None:
    assert check_seeds(planner, range(1000, 3000)) >= 500


@pytest.mark.parametrize("margin", [0.0, 0.1])
@pytest.mark.parametrize("room", [0.0005, 0.001, 0.0025])
def test_less_room_than_the_least_margin_is_refused(planner: Any, room: float, margin: float) -> None:
    start, goal = Pose(6.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0)
    at_goal = TightScene("goal", request_of(start, goal, margin), [rectangle(goal, REAR, SIDE + room, 4.0, 1.0)])
    at_start = TightScene("start", request_of(goal, start, margin), at_goal.polygons)
    assert check(planner, at_goal).status == check(planner, at_start).status == PlanningStatus.MARGIN_TOO_SMALL


def test_a_little_room_is_used(planner: Any) -> None:
    start, goal = Pose(6.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0)
    plan = check(
        planner, TightScene("goal", request_of(start, goal, 0.1), [rectangle(goal, REAR, SIDE + 0.005, 4.0, 1.0)])
    )
    assert plan.status == PlanningStatus.PLANNED
    assert plan.margin == pytest.approx(0.004)


def test_without_a_margin_asked_for_the_path_keeps_the_least(planner: Any) -> None:
    start, goal = Pose(6.0, 3.0, 0.0), Pose(0.0, 0.0, 0.0)
    plan = check(planner, TightScene("goal", request_of(start, goal, 0.0), [rectangle(goal, 3.9, -2.0, 1.0, 4.0)]))
    assert plan.status == PlanningStatus.PLANNED
    assert plan.margin == MIN_MARGIN


def test_from_a_pose_to_itself_there_is_a_path_without_a_way(planner: Any) -> None:
    here = Pose(1.0, 2.0, 0.3)
    plan = check(planner, TightScene("goal", request_of(here, here, 0.1), [rectangle(here, 5.0, -1.0, 1.0, 2.0)]))
    assert plan.status == PlanningStatus.PLANNED
    assert plan.pieces == [(0.0, 0.0)]
