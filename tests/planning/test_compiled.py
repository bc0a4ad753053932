"""The planner in C has the bits of CPython in every column of its store, at every step."""

from itertools import pairwise
from typing import Any

import pytest

from controller_fmu.parking.planning.planner import PlanningStatus
from controller_fmu.parking.planning.problem import PlanningRequest
from fmus.compiler import translate
from modelkit.vocabulary import Pose
from tests.compiler.c_model import CModel
from tests.planning import plan_model
from tests.planning.plan_model import Input, Params
from tests.planning.scenes import CAR, least_clearance, poses_along, read_case, request_of, scene_of, tpcap_folder

TPCAP = pytest.mark.skipif(tpcap_folder() is None, reason="TPCAP's cases are not here")
BOXES = [[(-9.0, -3.0), (-3.5, -3.0), (-3.5, -1.0), (-9.0, -1.0)], [(5.0, -3.0), (9.0, -3.0), (9.0, -1.0), (5.0, -1.0)]]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return tmp_path_factory.mktemp("planner")


@pytest.fixture(scope="module")
def translation() -> Any:
    return translate(plan_model.MODEL)


def twins(translation: Any, folder: Any, scene: Any, request: PlanningRequest, each: Any) -> Any:
    """Return the planner in C and in CPython, and both outputs' differences after each call until it has ended."""
    compiled = CModel(plan_model.MODEL, translation, folder)
    params = Params(scene, request, each)
    compiled.initialize(params)
    store = plan_model.MODEL.new_store()
    step, (state, outputs) = plan_model.MODEL.stepper(store), plan_model.MODEL.initialize(params)
    while outputs.status == PlanningStatus.PLANNING:
        state, outputs = step(state, Input(), params, 0)
        compiled.step(Input(), 0)
        assert compiled.differing(state, outputs) == []
        assert compiled.differing_columns(store) == []
    return outputs


def test_between_two_boxes(translation: Any, folder: Any) -> None:
    request = request_of(Pose(1.0, 3.0, 0.1), Pose(-1.2, -2.0, 0.0), 0.1)
    assert twins(translation, folder, scene_of(BOXES), request, 9).status == PlanningStatus.PLANNED


@TPCAP
@pytest.mark.parametrize("number", [6, 12, 17])
def test_cases_of_tpcap(translation: Any, folder: Any, number: int) -> None:
    start, goal, polygons = read_case(number)
    assert (
        twins(translation, folder, scene_of(polygons), request_of(start, goal, 0.1), 25).status
        == PlanningStatus.PLANNED
    )


@TPCAP
@pytest.mark.parametrize("number", range(1, 21))
def test_all_cases_of_tpcap_in_c(translation: Any, folder: Any, number: Any) -> None:
    start, goal, polygons = read_case(number)
    compiled = CModel(plan_model.MODEL, translation, folder)
    compiled.initialize(Params(scene_of(polygons), request_of(start, goal, 0.1), 50))
    while compiled.outputs.status == PlanningStatus.PLANNING:
        compiled.step(Input(), 0)
    assert compiled.outputs.status == PlanningStatus.PLANNED
    path = compiled.outputs.path
    pieces = [(piece.distance, piece.curvature) for piece in path.segments[: path.used]]
    poses = poses_along(start, pieces)
    assert max(abs(a - b) for a, b in zip(poses[-1][:2], goal[:2], strict=True)) < 1e-4
    assert least_clearance(poses, polygons, CAR) >= path.margin - 1e-3
    assert path.margin > (0.099 if number != 7 else 0.029)
    assert sum(a[0] * b[0] < 0.0 for a, b in pairwise(pieces)) <= 25
