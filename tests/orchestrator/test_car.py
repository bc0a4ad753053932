"""A scenario's car: given once, for the vehicle and for the controller's model of it."""

from pathlib import Path
from typing import Any

import pytest

from modelkit.car import Car
from modelkit.variables import variables
from orchestrator.inputs.scenario.car import car_parameters
from orchestrator.inputs.scenario.files import LIBRARY, car_names
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.yaml_file import read_mapping
from orchestrator.studies.sweep.study.sampling import make_design
from orchestrator.studies.sweep.study.study_file import StudyFile

BASE = "extends: guo2015-case4\n"


def write(folder: Path, text: str, name: str = "mine.yaml") -> str:
    (folder / name).write_text(text)
    return str(folder / name)


def reported(scenario: Scenario, owner: str) -> dict[str, Any]:
    return {name: value for name, value in getattr(scenario, owner).items() if name.startswith("car.")}


@pytest.mark.parametrize("car", car_names())
def test_both_models_are_told_the_same_car_and_the_file_says_all_of_its_geometry(car: str) -> None:
    scenario = load_scenario("apa-parallel", [f"car={car}"])
    assert scenario.car == car
    assert reported(scenario, "vehicle") == reported(scenario, "controller")
    unsaid = {item.name for item in variables(Car)} - {name[4:] for name in reported(scenario, "vehicle")}
    assert not {name for name in unsaid if name.startswith(("wheelbase", "width", "front", "rear", "steering"))}
    assert not {name for name in unsaid if "mounts" in name}


@pytest.mark.parametrize("car", car_names())
def test_a_car_file_says_nothing_twice(car: str) -> None:
    content = read_mapping(LIBRARY / "cars" / f"{car}.yaml")
    assert set(content) <= {"title", "source", "car", "vehicle"}
    assert not {"steering", "wheelbase", "width", "ultrasonic"} & set(content.get("vehicle", {}))


def test_a_car_with_something_changed_and_one_told_otherwise(tmp_path: Path) -> None:
    path = write(tmp_path, BASE + "car: {extends: zhang2022, width: 1.9, steering: {rate_limit: 400 deg/s}}")
    scenario = load_scenario(path, ["vehicle.car.steering.ratio=20"])
    assert scenario.car == "zhang2022"
    assert scenario.controller["car.width"] == scenario.vehicle["car.width"] == 1.9
    assert scenario.controller["car.steering.rate_limit"] == pytest.approx(6.98132)
    assert (scenario.vehicle["car.steering.ratio"], scenario.controller["car.steering.ratio"]) == (20.0, 17.0)
    assert scenario.vehicle["chassis.mass"] == 1370.0
    assert not [name for name in scenario.controller if name.startswith("chassis")]


def test_a_change_goes_with_the_car_below_and_another_car_takes_the_place_of_all(tmp_path: Path) -> None:
    write(tmp_path, BASE + "car: {extends: zhang2022, width: 1.9}", "below.yaml")
    path = write(tmp_path, "extends: below.yaml\ncar: {rear_overhang: 1 m}")
    changed = load_scenario(path)
    assert (changed.vehicle["car.width"], changed.vehicle["car.rear_overhang"]) == (1.9, 1.0)
    assert load_scenario(path, ["car.width=1.7"]).controller["car.rear_overhang"] == 1.0
    other = load_scenario(path, ["car=commonroad2", "car.width=1.7"])
    assert (other.car, other.vehicle["car.width"], other.vehicle["car.rear_overhang"]) == ("commonroad2", 1.7, 0.9645)


def test_a_car_of_ones_own_lies_beside_the_scenario_that_names_it(tmp_path: Path) -> None:
    (tmp_path / "cars").mkdir()
    write(
        tmp_path / "cars", "car: {width: 1.5, ultrasonic: {cycle: 60 ms}}\nvehicle: {chassis: {mass: 900}}", "own.yaml"
    )
    write(tmp_path / "cars", BASE + "car: own.yaml", "below.yaml")
    scenario = load_scenario(write(tmp_path, "extends: cars/below.yaml"))
    assert scenario.vehicle["car.ultrasonic.cycle"] == scenario.controller["car.ultrasonic.cycle"] == 0.06
    assert scenario.vehicle["chassis.mass"] == 900.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("car: {widht: 2}", r"car\.widht: unknown; did you mean car\.width"),
        ("car: {width: 2 s}", r"car\.width: '2 s' is in 's'"),
        ("car: {width: 200}", r"car\.width: 200 is out of range"),
        ("car: {extends: zhang2023}", "zhang2023: no car of this name; did you mean zhang2022"),
        ("car: {extends: [1]}", r"car\.extends: \[1\]: expected the name of a car"),
        ("car: 3", "car: 3: expected the name of a car, a file, or a mapping"),
        ("car: own.yaml", r"own\.yaml(:\d+)?: controller: unknown; expected one of: .*car"),
    ],
)
def test_a_mistake_in_a_car_is_explained(tmp_path: Path, text: str, message: str) -> None:
    write(tmp_path, "controller: {car: {width: 2}}", "own.yaml")
    with pytest.raises(BadInput, match=message):
        load_scenario(write(tmp_path, BASE + text))


def test_a_study_varies_the_car_of_both() -> None:
    runs: Any = {"grid": {"car.width": [1.5, "160 cm"]}}
    file = StudyFile(name="any", scenario="guo2015-case4", runs=runs)
    design = make_design(file, load_scenario("guo2015-case4"))
    assert [field.key for field in design.fields] == ["vehicle.car.width", "controller.car.width"]
    assert design.values.tolist() == [[1.5, 1.5], [1.6, 1.6]]


def test_a_car_as_parameters() -> None:
    flat = car_parameters(Car(width=1.5))
    assert flat["car.width"] == 1.5
    assert set(flat) == {f"car.{item.name}" for item in variables(Car)}


def test_a_car_on_the_command_line_is_a_path_from_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cars").mkdir()
    (tmp_path / "cars" / "mine.yaml").write_text("car: {wheelbase: 2.9}\n", encoding="utf-8")
    assert load_scenario("guo2015-case4", ["car=cars/mine.yaml"]).vehicle["car.wheelbase"] == 2.9
