"""What a scenario or a log may hold: lengths of lists, whole numbers of steps, finite paths."""

import math
from pathlib import Path
from typing import Any

import pytest
import yaml

from orchestrator.cli import main
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.steptest.step_test import load_step_test
from orchestrator.text.errors import BadInput
from orchestrator.verdict.geometry import sample_path, things


@pytest.mark.parametrize("corners", [[], [[0, 0]], [[0, 0], [1, 0]]])
def test_a_polygon_has_three_corners_or_more(tmp_path: Path, capsys: Any, corners: Any) -> None:
    square = [[5, 5], [6, 5], [6, 6]]
    path = tmp_path / "few.yaml"
    path.write_text(yaml.safe_dump({"base": "guo2015-case4", "polygons": [square, corners]}))
    assert main(["run", str(path), "--fmus", "none", "--no-page", "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert f"polygons[2]: {len(corners)} corners: expected 3 or more" in said
    assert said.count("\n") == 1


def test_a_stop_time_between_two_steps_is_reported(tmp_path: Path, capsys: Any) -> None:
    words = ["run", "guo2015-case4", "--fmus", "none", "--no-page", "--out", str(tmp_path)]
    main([*words, "--set", "stop_time=10", "--set", "step=7"])
    said = " ".join(capsys.readouterr().err.split())
    assert "stop_time 10 s is no whole number of steps of 7 s: a run ends at 7 s" in said


def test_a_step_test_of_no_whole_number_of_steps_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "odd.yaml"
    path.write_text("model: vehicle\nstop_time: 1 s\nstep: 0.3 s\nexpect: [{id: a, signal: speed, always: {max: 1}}]\n")
    with pytest.raises(BadInput, match=r"stop_time: 1 s is no whole number of steps of 0\.3 s"):
        load_step_test(path)


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
    assert len(things(box)) == 1
    for name in (*box, "scene.boxes[1].moves_at"):
        assert things({**box, name: math.nan}) == []


def test_more_boxes_than_there_are_is_refused() -> None:
    boxes = ", ".join("{x: 9, y: 9, length: 1, width: 1}" for _ in range(17))
    with pytest.raises(BadInput, match=r"scene\.boxes"):
        load_scenario("guo2015-case4", [f"scene.boxes=[{boxes}]"])
