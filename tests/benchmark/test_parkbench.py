"""Scenes of ParkBench as scenarios; the scenes are our own, in its format."""

import math
from pathlib import Path
from typing import Any

import pytest
import yaml

from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.benchmark.parkbench import DEFAULT_VEHICLE, map_corners, read_parkbench
from tests.benchmark.parkbench_scene import HIGH, LOW, TARGET, WHEEL_STOP, large_scene, polyline, scene, write

FAR = [(9000.0, 20.0), (9000.0, 21.0)]


def walls(content: Any) -> set[Any]:
    return {tuple(sorted((round(x, 6), round(y, 6)) for x, y in wall)) for wall in content["obstacles"]}


def read(tmp_path: Path, content: Any) -> Any:
    return read_parkbench(write(tmp_path / "scene.json", content))


def test_poses_and_walls_are_seen_from_the_target(tmp_path: Path) -> None:
    content = read(tmp_path, scene())
    assert content["target"] == {"x": 0.0, "y": 0.0, "heading": TARGET[2]}
    assert content["vehicle"]["start"] == {"x": -5.0, "y": 9.0, "heading": 0.0}
    assert len(content["obstacles"]) == 9
    assert ((-10.0, 13.0), (12.0, 13.0)) in walls(content)
    assert content["controller"]["system"] == "apa"


def test_poses_are_relative_to_an_origin_of_their_own(tmp_path: Path) -> None:
    shifted = scene(start=(-95.0, 79.0, 0.0), target=(-90.0, 70.0, TARGET[2]), m_origin=[104.0, -46.0])
    shifted["Frames"]["0"]["m_nfmOrigin"] = [4.0, 4.0]
    assert read(tmp_path, shifted)["obstacles"] == read(tmp_path, scene())["obstacles"]


def test_a_wheel_stop_under_the_vehicle_is_left_out_and_a_wall_there_is_cut(tmp_path: Path) -> None:
    plain = walls(read(tmp_path, scene()))
    objects = scene()["Frames"]["0"]["NfmAggregatedPolygonObjects"]
    low = read(tmp_path, scene(objects=[*objects, polyline(WHEEL_STOP, LOW)]))
    assert walls(low) == plain
    assert "1 pieces" in low["description"]
    high = read(tmp_path, scene(objects=[*objects, polyline([(7.0, 19.7), (12.0, 19.7)], HIGH)]))
    side = DEFAULT_VEHICLE.half_width + 0.05
    assert walls(high) - plain == {((-3.0, -0.3), (-side, -0.3)), ((side, -0.3), (2.0, -0.3))}


def test_a_low_object_beside_the_vehicle_stays(tmp_path: Path) -> None:
    objects = scene()["Frames"]["0"]["NfmAggregatedPolygonObjects"]
    kerb = polyline([(7.0, 18.0), (13.0, 18.0)], LOW)
    assert len(read(tmp_path, scene(objects=[*objects, kerb]))["obstacles"]) == 10


def test_outliers_are_left_out(tmp_path: Path) -> None:
    objects = scene()["Frames"]["0"]["NfmAggregatedPolygonObjects"]
    assert walls(read(tmp_path, scene(objects=[*objects, polyline(FAR)]))) == walls(read(tmp_path, scene()))


def test_the_vehicle_that_a_scene_states_is_driven(tmp_path: Path) -> None:
    contour = {"m_vehContourFrontX": [3.9, 0.0], "m_vehContourSideX": [3.6, 0.0], "m_vehContourRearX": [-1.0, 0.0]}
    contour["m_vehContourSideY"] = [0.95, 1.0]
    state = {"m_steeringAngleFront": 0.3, "m_vehicleCurvature": math.tan(0.3) / 2.7}
    car = read(tmp_path, scene(m_pmpParams={"m_vehicleContour": contour}, m_vehicleData=state))["car"]
    assert [car[key] for key in ("wheelbase", "front_overhang", "rear_overhang", "width")] == [2.7, 1.2, 1.0, 2.0]
    limits = {"m_wheelBase": 2.85, "m_maxFrontSteeringAngle": 0.6}
    stated = {"m_vehicleParams": contour, "m_vehicleKinematicConstraintParams": limits}
    car = read(tmp_path, scene(m_params=stated))["car"]
    assert (car["wheelbase"], car["steering"]["angle_limit"]) == (2.85, 9.6)


def test_a_scene_of_many_corners_gets_the_large_map(tmp_path: Path) -> None:
    content = read(tmp_path, large_scene())
    assert 360 < 2 * len(content["obstacles"]) < 2048
    assert content["controller"]["system"] == "apa_large"
    (tmp_path / "large.yaml").write_text(yaml.safe_dump(content))
    scenario = load_scenario(str(tmp_path / "large.yaml"))
    last = 2 * len(content["obstacles"])
    assert scenario.controller[f"map[{last}].polygon"] == last // 2
    assert map_corners("apa_large") == 2048
    with pytest.raises(BadInput, match="the largest map holds 2048"):
        read(tmp_path, large_scene(0.02))


def _without(*path: str) -> Any:
    content = scene()
    place = content
    for key in path[:-1]:
        place = place[key]
    del place[path[-1]]
    return content


REQUEST = ("Frames", "0", "PlanningRequest")
AREA = {"m_targetPosture": {"m_pose": list(TARGET)}}


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ([], "an object of a ParkBench scene"),
        (_without("Frames", "0"), r"Frames\.0"),
        (_without(*REQUEST), "PlanningRequest"),
        (_without(*REQUEST, "m_startPosture"), "m_startPosture"),
        (_without(*REQUEST, "m_targetArea"), "m_targetArea"),
        (_without("Frames", "0", "NfmAggregatedPolygonObjects"), "expected a list of objects"),
        (scene(start=(1.0, 2.0)), r"m_startPosture\.m_pose: expected x, y"),
        (scene(start=(1.0, 2.0, 90.0)), "expected radians"),
        (scene(target=(math.nan, 2.0, 0.0)), "expected a finite number"),
        (scene(objects=[polyline([(1.0, 2.0)])]), r"NfmAggregatedPolygonObjects\[1\]: expected two or more"),
        (scene(objects=[polyline([(1.0, "2"), (2.0, 2.0)])]), "'2': expected a finite number"),
        (scene(m_pmpParams={"m_vehicleContour": {}}), "m_vehContourFrontX: expected a list"),
        (scene(m_targetArea=AREA | {"m_longitudinalTolerance": "0"}), "m_longitudinalTolerance: '0'"),
    ],
)
def test_what_is_no_scene_is_refused_with_its_place(content: Any, said: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=rf"scene\.json.*{said}"):
        read(tmp_path, content)


def test_no_json_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text("{")
    with pytest.raises(BadInput, match=r"a\.json: cannot be read as JSON"):
        read_parkbench(tmp_path / "a.json")


def test_a_folder_is_imported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "in").mkdir()
    for name in ("b", "a"):
        write(tmp_path / "in" / f"{name}.json", scene())
    (tmp_path / "in" / "readme.md").write_text("-")
    out = tmp_path / "out"
    assert main(["import", "parkbench", str(tmp_path / "in"), "--out", str(out)]) == 0
    assert capsys.readouterr().out.split() == [str(out / "a.yaml"), str(out / "b.yaml")]
    assert load_scenario(str(out / "a.yaml")).controller["system"] == 5
    assert main(["import", "tpcap", str(tmp_path / "in"), "--out", str(out)]) == 2
    assert r"no file *.csv in this folder" in capsys.readouterr().err
