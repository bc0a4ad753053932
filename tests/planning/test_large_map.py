"""The parking system with a large map: the same code with longer arrays, and so the same bits."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from controller_fmu import APART
from controller_fmu.parking.geometry.polygons import Vertex
from controller_fmu.parking.large_map import LargePlanningWork
from controller_fmu.parking.params import ParkingSystem
from controller_fmu.parking.planning.grids import add_edges
from controller_fmu.parking.planning.planner import PlanningStatus, search_status
from controller_fmu.parking.planning.search_schedule import search_region
from controller_fmu.parking.planning.work import PlanningWork
from fmus.native.libraries import load_model, memory_size
from modelkit.store import columns_of, new_store
from modelkit.variables import flatten, variables, with_values
from modelkit.vocabulary import Pose
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.studies.benchmark.parkbench import read_parkbench
from tests.benchmark.parkbench_scene import large_scene, scene, write
from tests.planning.plan_model import Scene
from tests.planning.scenes import request_of, scene_of, search

NATIVE = pytest.mark.skipif(not can_compile(), reason="needs a C compiler: pip install ziglang")


def test_more_corners_than_the_small_map_has_are_planned_around_in_python() -> None:
    """Two rows of posts, each a square of 4 cm, between which the car drives."""
    row = [(0.25 * n, y) for n in range(-25, 25) for y in (-2.0, 2.0)]
    posts = [[(x, y), (x + 0.04, y), (x + 0.04, y + 0.04), (x, y + 0.04)] for x, y in row]
    assert 4 * len(posts) == 400
    store = new_store(LargePlanningWork)
    request = request_of(Pose(-6.0, 0.0, 0.0), Pose(3.0, 0.0, 0.0), 0.1)
    posts_map = Scene(tuple(Vertex(x, y, number + 1) for number, post in enumerate(posts) for x, y in post))
    for count in range(1, 200):
        search(store, posts_map, request, count)
        if search_status(store):
            break
    assert search_status(store) == PlanningStatus.PLANNED


@pytest.mark.parametrize(("points", "edges"), [(2, 1), (3, 3), (4, 4)])
def test_a_wall_has_one_edge(points: int, edges: int) -> None:
    polygon = [(1.0, 5.0), (2.0, 5.0), (2.0, 6.0), (1.0, 6.0)][:points]
    store = new_store(PlanningWork)
    request = request_of(Pose(-6.0, 0.0, 0.0), Pose(3.0, 0.0, 0.0), 0.1)
    search(store, scene_of([polygon, polygon]), request, 0)
    assert add_edges(store, request.goal, search_region(request)) == 2 * edges


def test_only_arrays_of_the_scene_are_longer() -> None:
    own, large = columns_of(PlanningWork), columns_of(LargePlanningWork)
    assert list(own) == list(large)
    longer = {name for name in own if large[name].length > own[name].length}
    assert longer == {
        *("edge_x1", "edge_y1", "edge_x2", "edge_y2", "cell_edge"),
        *("corner_x", "corner_y", "corner_of"),
    }
    small, big = (variables(APART[choice].params) for choice in ParkingSystem)
    assert len([item for item in small if item.name.startswith("map[")]) == 3 * 360
    assert {item.name for item in big} - {item.name for item in small} == {
        f"map[{place}].{axis}" for place in range(361, 2049) for axis in ("x", "y", "polygon")
    }


def outputs(model: Any, scenario: Any, samples: int) -> Any:
    """Return all outputs of the controller of a standing car, sample by sample."""
    library, count = load_model(model), len(variables(model.outputs))
    given = {name: value for name, value in scenario.controller.items() if name != "system"}
    params = np.array(flatten(with_values(model.params, given)), dtype=float)
    u, y = np.zeros(len(variables(model.inputs))), np.zeros(count)
    names = [item.name for item in variables(model.inputs)]
    for axis in ("x", "y", "heading"):
        u[names.index(f"odometry.{axis}")] = scenario.vehicle[f"start.{axis}"]
    memory = np.zeros(memory_size(library), dtype=np.uint8)
    library.model_start(memory.ctypes.data, params.ctypes.data, y.ctypes.data)
    found = []
    for _ in range(samples):
        library.model_step(memory.ctypes.data, u.ctypes.data, y.ctypes.data, 10_000_000)
        found.append(y.tobytes())
    return found


@NATIVE
@pytest.mark.release
def test_a_small_scene_has_the_bits_of_the_small_map(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(yaml.safe_dump(read_parkbench(write(tmp_path / "a.json", scene()))))
    scenario = load_scenario(str(tmp_path / "a.yaml"))
    small, large = (outputs(APART[choice], scenario, 60) for choice in ParkingSystem)
    assert small == large
    assert len(set(small)) > 5


@NATIVE
@pytest.mark.release
def test_a_scene_of_many_corners_is_planned(tmp_path: Path) -> None:
    from orchestrator.studies.benchmark.planning import plan_scene

    (tmp_path / "a.yaml").write_text(yaml.safe_dump(read_parkbench(write(tmp_path / "a.json", large_scene(0.055)))))
    plan = plan_scene(load_scenario(str(tmp_path / "a.yaml")), passes=1)
    assert plan.found
    assert plan.margin == pytest.approx(0.1)
