"""``apa bench parking --system parking``: scenes driven by another system than their own."""

import json
from pathlib import Path

import pytest
import yaml

from orchestrator.cli import main
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.studies.benchmark.driving import SceneChanges, load_scene
from orchestrator.studies.benchmark.parkbench import read_parkbench
from orchestrator.studies.parking.studied_systems import PARKING_SYSTEM
from tests.benchmark.parkbench_scene import scene, write

pytestmark = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")


def test_a_scene_is_driven_by_the_system_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "one.yaml"
    file.write_text(yaml.safe_dump(read_parkbench(write(tmp_path / "scene.json", scene())) | {"name": "one"}))
    own, other = load_scene(str(file)), load_scene(str(file), SceneChanges(system=PARKING_SYSTEM))
    assert other.controller["search.active"] is False
    assert {name for name in other.controller if name.startswith("map[")} == {
        name for name in own.controller if name.startswith("map[")
    }
    words = ["bench", "parking", str(file), "--system", "parking", "--body", "kinematic"]
    assert main([*words, "--out", str(tmp_path / "out"), "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["scenes"]
    assert row["plan"]["found"]
    assert row["drives"]["kinematic"]["parked"]


def test_a_map_that_is_too_large_is_refused_with_what_it_holds(tmp_path: Path) -> None:
    corners = [[[40.0 + number, 40.0], [40.5 + number, 40.0], [40.25 + number, 40.5]] for number in range(125)]
    content = read_parkbench(write(tmp_path / "scene.json", scene())) | {"name": "many"}
    content["obstacles"] = [*content["obstacles"], *corners]
    content["controller"]["system"] = "parking_large"
    file = tmp_path / "many.yaml"
    file.write_text(yaml.safe_dump(content))
    with pytest.raises(BadInput, match="holds 360 corners"):
        load_scene(str(file), SceneChanges(system=PARKING_SYSTEM))
