"""``apa bench parking``: scenes planned and driven, rows kept, exit codes."""

import csv
import io
import json
from pathlib import Path
from typing import Any

import pytest
import yaml

from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.studies.benchmark import scenes
from orchestrator.studies.benchmark.driving import DrivenScene
from orchestrator.studies.benchmark.parkbench import read_parkbench
from orchestrator.studies.benchmark.planning import plan_scene
from tests.benchmark.parkbench_scene import scene, write

pytestmark = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")


def folder_of(tmp_path: Path, **changes: Any) -> Path:
    """Return a folder with our scene as a scenario, and another one with ``changes`` of it."""
    content = read_parkbench(write(tmp_path / "scene.json", scene()))
    folder = tmp_path / "own"
    folder.mkdir()
    (folder / "one.yaml").write_text(yaml.safe_dump(content | {"name": "one"}))
    if changes:
        (folder / "other.yaml").write_text(yaml.safe_dump(content | {"name": "other"} | changes))
    return folder


def bench(*words: Any) -> int:
    return main(["bench", "parking", *map(str, words)])


def test_scenes_have_a_known_goal_that_can_be_reached(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shipped = scenes.valet_scenarios()
    assert {"valet-dead-end", "valet-parallel", "valet-pull-out"} <= set(shipped)
    assert not {"valet-search-45", "valet-no-path", "valet-blocked"} & set(shipped)
    assert bench("valet-search-45", "--out", tmp_path) == 2
    assert "controller.search.active: true: the benchmark plans to a known goal" in capsys.readouterr().err


def test_a_scene_is_planned_and_driven_and_its_row_is_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, out = folder_of(tmp_path), tmp_path / "out"
    assert bench(folder, "--out", out, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    (row,) = found["scenes"]
    assert row["plan"]["found"]
    assert row["plan"]["margin"] == pytest.approx(0.1)
    assert set(row["drives"]) == {"kinematic", "double_track"}
    for drive in row["drives"].values():
        assert drive["parked"]
        assert not drive["contact"]
        assert 0.02 < drive["clearance"] < 0.2
        assert 9.0 < drive["length"] < 25.0
        assert drive["manoeuvres"] >= 2
    (group,) = found["groups"]
    assert (group["group"], group["planned"], group["parked"]["double_track"]) == ("own", 1, 1)

    def refuse(*_: Any) -> Any:
        raise BadInput("driven again")

    monkeypatch.setattr(scenes, "drive_scene", refuse)
    assert bench(folder, "--out", out, "--csv") == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert [(item["scene"], item["body"], item["parked"]) for item in rows] == [
        ("one", "kinematic", "True"),
        ("one", "double_track", "True"),
    ]
    assert rows[1]["clearance [m]"] == str(row["drives"]["double_track"]["clearance"])
    assert list(csv.DictReader(io.StringIO((out / "table.csv").read_text()))) == rows
    assert bench(folder, "--out", out, "--fresh") == 2
    assert "driven again" in capsys.readouterr().err


def test_a_changed_scene_is_driven_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, out = folder_of(tmp_path), tmp_path / "out"
    driven: list[str] = []

    def drive(name: str, body: str, *_: Any) -> Any:
        driven.append(body)
        return DrivenScene(True, "", False, 0.1, 10.0, 2, 20.0), None

    monkeypatch.setattr(scenes, "drive_scene", drive)
    assert bench(folder, "--out", out) == 0
    assert bench(folder, "--out", out) == 0
    assert driven == ["kinematic", "double_track"]
    assert bench(folder, "--out", out, "--body", "kinematic") == 0
    file = folder / "one.yaml"
    file.write_text(file.read_text().replace("margin: 0.1", "margin: 0.12"))
    assert bench(folder, "--out", out, "--body", "kinematic") == 0
    assert driven == ["kinematic", "double_track", "kinematic", "kinematic"]


def test_a_scene_without_a_path_and_one_with_contact_fail(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    closed = [
        [[-9.0, 6.5], [9.0, 6.5]],
        [[-9.0, 6.5], [-9.0, -3.0]],
        [[9.0, 6.5], [9.0, -3.0]],
        [[-9.0, -3.0], [9.0, -3.0]],
    ]
    folder, out = folder_of(tmp_path, obstacles=closed), tmp_path / "out"
    touched = DrivenScene(False, "", True, -0.01, 10.0, 2, 20.0)
    monkeypatch.setattr(scenes, "drive_scene", lambda *_: (touched, None))
    assert bench(folder, "--out", out) == 1
    text = capsys.readouterr().out
    assert "no_path" in text
    assert "own: 1 of 2 planned, 0 parked (kinematic), 1 with contact" in text


def test_what_cannot_be_benchmarked_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "empty").mkdir()
    assert bench(tmp_path / "empty", "--out", tmp_path / "out") == 2
    assert "no scenario (*.yaml) in this folder" in capsys.readouterr().err
    with pytest.raises(BadInput, match=r"expected apa or apa_large"):
        plan_scene(load_scenario("guo2015-case4"))
