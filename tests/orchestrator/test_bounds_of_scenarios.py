"""What a scenario or a log may hold: lengths of lists, whole numbers of steps, finite paths."""

import math
from pathlib import Path
from typing import Any

import pytest
import yaml

from orchestrator.cli import main
from orchestrator.evaluation.verdict.geometry import moving_boxes, sample_path
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.session import Messages, make_instances, run_instances
from orchestrator.simulation.cosim.fmu_instance import FmuInstance
from orchestrator.simulation.cosim.model_instance import ModelInstance
from orchestrator.testing.steptest.drive import drive
from orchestrator.testing.steptest.step_test import load_step_test


@pytest.mark.parametrize("corners", [[], [[0, 0]]])
def test_an_obstacle_is_a_wall_of_two_corners_or_a_polygon(tmp_path: Path, capsys: Any, corners: Any) -> None:
    square = [[5, 5], [6, 5], [6, 6]]
    path = tmp_path / "few.yaml"
    path.write_text(yaml.safe_dump({"extends": "guo2015-case4", "obstacles": [square, corners]}))
    assert main(["run", str(path), "--fmus", "none", "--no-page", "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert f"obstacles[2]: {len(corners)} corners: expected 2 or more" in said
    assert said.count("\n") == 1


def fixed(instances: list[FmuInstance], name: str) -> list[FmuInstance]:
    for item in instances:
        item.has_variable_step = item.name != name
    return instances


def test_a_run_ends_at_its_stop_time_also_between_two_steps() -> None:
    scenario = load_scenario("guo2015-case4", ["stop_time=10", "step=7"])
    ran = run_instances(scenario, make_instances(scenario, None, Messages()), Messages())
    assert ran.end.t_ns == 10_000_000_000
    assert ran.recording.t.tolist() == [0.0, 7.0, 10.0]
    assert not any("stop_time" in text for text in ran.remarks)


@pytest.mark.parametrize(("every", "end"), [(1, "0.9"), (2, "0.6")])
def test_a_stop_time_that_a_fixed_step_does_not_reach_is_reported(every: int, end: str) -> None:
    scenario = load_scenario("guo2015-case4", ["stop_time=1", "step=0.3", f"decimation.vehicle={every}"])
    ran = run_instances(scenario, fixed(make_instances(scenario, None, Messages()), "vehicle"), Messages())
    assert ran.end.t_ns == float(end) * 1e9
    assert any(f"the step of vehicle is fixed: a run ends at {end} s" in text for text in ran.remarks)


def test_a_stop_time_before_the_end_of_a_fixed_step_is_refused() -> None:
    scenario = load_scenario("guo2015-case4", ["stop_time=1", "step=0.3", "decimation.vehicle=5"])
    with pytest.raises(BadInput, match=r"stop_time: 1 s is less than the 1\.5 s which vehicle needs"):
        run_instances(scenario, fixed(make_instances(scenario, None, Messages()), "vehicle"), Messages())


def test_a_step_test_ends_at_its_stop_time_if_the_fmu_allows_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "odd.yaml"
    path.write_text("model: vehicle\nstop_time: 1 s\nstep: 0.3 s\nexpect: [{id: a, signal: speed, always: {max: 1}}]\n")
    recording = drive(load_step_test(path), "none")
    assert recording.t.tolist() == pytest.approx([0.0, 0.3, 0.6, 0.9, 1.0])
    assert recording.info["end"] == {"reason": "stop_time", "t_ns": 1_000_000_000}
    monkeypatch.setattr(ModelInstance, "has_variable_step", False)
    with pytest.raises(BadInput, match=r"stop_time: 1 s is no whole number of steps of 0\.3 s, which the FMU needs"):
        drive(load_step_test(path), "none")


MOVE = {
    "apa.move.direction": 1.0,
    **{f"apa.move.start.{axis}": 0.0 for axis in ("x", "y", "heading")},
    "apa.move.pieces[1].length": 1.0,
    "apa.move.pieces[1].start_curvature": 0.1,
    "apa.move.pieces[1].end_curvature": 0.1,
}
PATH = {
    **{f"path.start.{axis}": 0.0 for axis in ("x", "y", "heading")},
    "path.segments[1].length": 1.0,
    "path.segments[1].curvature": 0.1,
}


@pytest.mark.parametrize("odd", [math.inf, -math.inf, math.nan, 1e308, -1e308])
@pytest.mark.parametrize("values", [MOVE, PATH], ids=["move", "path"])
def test_a_path_that_is_not_finite_is_not_drawn(values: dict[str, float], odd: float) -> None:
    assert len(sample_path(values)) > 10
    for name in values:
        points = sample_path({**values, name: odd})
        assert all(math.isfinite(item) for point in points.tolist() for item in point)


def test_a_box_that_is_not_finite_is_not_drawn() -> None:
    box = {f"scene.boxes[1].{name}": 1.0 for name in ("x", "y", "length", "width", "speed_x")}
    assert len(moving_boxes(box)) == 1
    for name in (*box, "scene.boxes[1].moves_at"):
        assert moving_boxes({**box, name: math.nan}) == []


def test_more_boxes_than_there_are_is_refused() -> None:
    boxes = ", ".join("{x: 9, y: 9, length: 1, width: 1}" for _ in range(17))
    with pytest.raises(BadInput, match=r"scene\.boxes"):
        load_scenario("guo2015-case4", [f"scene.boxes=[{boxes}]"])
