"""Scenarios: what can be written, how layers merge, and one clear sentence for every mistake."""

import math
from pathlib import Path

import pytest

from orchestrator.inputs.scenario.files import car_names
from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.quantities import number

DEMO = str(Path(__file__).with_name("demo.yaml"))


def write(tmp_path: Path, text: str, name: str = "mine.yaml") -> str:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("name", scenario_names())
def test_every_shipped_scenario_loads_and_says_what_it_is(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.title
    assert scenario.requirements


def test_the_five_cases_and_their_car_are_shipped() -> None:
    assert {f"guo2015-case{n}{rate}" for n in range(1, 6) for rate in ("", "-105")} <= set(scenario_names())
    assert "guo2015" in car_names()


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("570 deg", "rad", 570 * math.pi / 180),
        ("105 deg/s", "rad/s", 105 * math.pi / 180),
        ("5 km/h", "m/s", 5 / 3.6),
        ("-2.5cm", "m", -0.025),
        ("1e-3", "s", 0.001),
        ("200 ms", "s", 0.2),
        (3, "m", 3.0),
        ("7 m/s2", "m/s2", 7.0),
    ],
)
def test_quantities(text: object, unit: str, value: float) -> None:
    assert number(text, unit) == pytest.approx(value, rel=1e-15)


def test_flat_nested_and_list_forms_mean_the_same(tmp_path: Path) -> None:
    flat = "vehicle: {'driver.profile[1].at': 1, 'driver.profile[1].speed': 5 km/h, start.heading: 90 deg}"
    nested = "vehicle: {driver: {profile: [{at: 1, speed: 5 km/h}]}, start: {heading: 90 deg}}"
    listed = "vehicle: {driver.profile: [[1, 5 km/h]], start: [0, 0, 90 deg]}"
    found = [load_scenario(write(tmp_path, text)).vehicle for text in (flat, nested, listed)]
    assert found[0] == found[1]
    assert {**found[0], "start.x": 0.0, "start.y": 0.0} == found[2]


def test_layers_car_base_file_and_set(tmp_path: Path) -> None:
    write(tmp_path, "car: {wheelbase: 2.0, width: 1.5}", "small.yaml")
    base = "car: small.yaml\nseed: 7\nslot: {x: 1, y: 2, length: 6, width: 2}\ntarget: [1, 2, 3 deg]\n"
    write(tmp_path, base + "vehicle: {car.width: 1.6, driver.profile: [[0, 1], [2, 0.5]]}", "below.yaml")
    path = write(
        tmp_path, "extends: below.yaml\nslot: {width: 3}\nvehicle: {driver.profile: [[0, 0.3]]}\ntarget: {x: 9}"
    )
    scenario = load_scenario(path, ["vehicle.car.front_overhang=90 cm", "controller.system=ntbpt", "stop_time=12 s"])
    assert scenario.vehicle["car.wheelbase"] == 2.0
    assert scenario.vehicle["car.width"] == 1.6
    assert scenario.vehicle["car.front_overhang"] == pytest.approx(0.9)
    assert {key for key in scenario.vehicle if "profile" in key} == {"driver.profile[1].at", "driver.profile[1].speed"}
    assert scenario.controller["system"] == 1
    assert scenario.controller["target.x"] == 9.0
    assert scenario.controller["target.y"] == 2.0
    assert scenario.slot is not None
    assert (scenario.slot.x, scenario.slot.width) == (1.0, 3.0)
    assert (scenario.seed, scenario.stop_time, scenario.name) == (7, 12.0, "mine")


@pytest.mark.parametrize(
    ("text", "changes"),
    [
        ("vehicle.driver.profile[1].speed=1.2", {"driver.profile[1].speed": 1.2}),
        ("vehicle.driver.profile[2].speed=1.2", {"driver.profile[2].speed": 1.2}),
        ("vehicle.driver.profile[1]={speed: 1.2}", {"driver.profile[1].speed": 1.2}),
        ("scene.boxes[1].length=3", {"scene.boxes[1].length": 3.0}),
        ("vehicle.scene.boxes[2].length=3", {"scene.boxes[2].length": 3.0}),
        ("scene.boxes[3]={x: 30}", {"scene.boxes[3].x": 30.0}),
        ("car.ultrasonic.mounts[1].x=3.5", {"car.ultrasonic.mounts[1].x": 3.5}),
    ],
)
def test_an_entry_of_a_list_that_is_set_keeps_all_else(tmp_path: Path, text: str, changes: dict[str, float]) -> None:
    mounts = "car: {ultrasonic: {mounts: [[3.6, 0.5, 0.1], [3.7, 0.2, 0]]}}"
    boxes = "scene: {boxes: [[1, 2, 0, 4, 2], [8, 2, 0, 4, 2]]}"
    path = write(tmp_path, f"vehicle: {{driver: {{profile: [[1, 2], [3, 4]]}}}}\n{boxes}\n{mounts}\n")
    assert load_scenario(path, [text]).vehicle == load_scenario(path).vehicle | changes


@pytest.mark.parametrize("text", ["scene.boxes=[]", "scene.boxes=[[5, 6]]", "vehicle.scene.boxes=[{x: 5, y: 6}]"])
def test_a_list_that_is_set_replaces_the_list(tmp_path: Path, text: str) -> None:
    path = write(tmp_path, "scene: {boxes: [[1, 2, 0, 4, 2], [8, 2, 0, 4, 2]]}")
    found = {name: value for name, value in load_scenario(path, [text]).vehicle.items() if "boxes" in name}
    assert found == ({} if "[]" in text else {"scene.boxes[1].x": 5.0, "scene.boxes[1].y": 6.0})


def test_a_chain_of_files_without_end_is_refused(tmp_path: Path) -> None:
    for place in range(50):
        (tmp_path / f"{place}.yaml").write_text(f"name: x\nextends: {place + 1}.yaml\n")
    with pytest.raises(BadInput, match=r"0.yaml:2: extends: a chain of more than 40 files"):
        load_scenario(str(tmp_path / "0.yaml"), [])


def test_title_is_not_inherited(tmp_path: Path) -> None:
    assert load_scenario(write(tmp_path, "extends: guo2015-case4")).title == ""


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("stop_tim: 3", r"mine\.yaml(:\d+)?: stop_tim: unknown; did you mean stop_time or stop_condition\?"),
        ("wheelbase: 3", r"wheelbase: unknown; did you mean .*car\.wheelbase"),
        ("car: {wheelbas: 3}", r"mine\.yaml(:\d+)?: car\.wheelbas: unknown; did you mean car.wheelbase"),
        ("vehicle: {ratio: 3}", r"vehicle\.ratio: unknown; did you mean vehicle\.car\.steering\.ratio"),
        ("car: {wheelbase: long}", r"mine\.yaml(:\d+)?: car\.wheelbase: 'long' is not a number"),
        ("car: {wheelbase: 3 deg}", r"car\.wheelbase: '3 deg' is in 'deg', expected a number in m"),
        ("car: {wheelbase: -3}", r"car\.wheelbase: -3 is out of range, expected 0\.1 to 20 m"),
        ("car: {wheelbase: .nan}", r"car\.wheelbase: nan: expected a finite number"),
        ("car: {wheelbase: [1, 2]}", r"car\.wheelbase: \[1, 2\] is not a number"),
        ("vehicle: {body: kinematik}", r"vehicle\.body: 'kinematik' is none of kinematic.*did you mean kinematic"),
        ("vehicle: {body: 77}", r"vehicle\.body: 77 is none of 0 kinematic"),
        ("vehicle: {start: 3}", r"vehicle\.start: 3 is one value, expected a mapping or list of x, y, heading"),
        ("vehicle: {start: [1, 2, 3, 4]}", r"vehicle\.start: 4 values given, expected at most 3"),
        ("vehicle: {driver: {complies_with_stop: maybe}}", r"complies_with_stop: 'maybe' is neither true nor false"),
        ("vehicle: 3", r"vehicle: 3: expected a mapping"),
        ("step: 0", r"step: 0 s is not a whole positive number of nanoseconds"),
        ("step: 0.5e-9", r"step: 5e-10 s is not a whole positive number"),
        ("stop_time: -1", r"stop_time: -1 is not a time from 0 to"),
        ("stop_time: 4 m", r"stop_time: '4 m' is in 'm', expected a number in s"),
        ("seed: -1", r"mine\.yaml(:\d+)?: seed: -1: input should be greater than or equal to 0"),
        ("decimation: {plant: 2}", r"decimation\.plant: unknown; expected one of: vehicle, controller"),
        ("decimation: {vehicle: 0}", r"decimation\.vehicle: 0 is not a whole number from 1"),
        ("slot: {x: 1}", r"mine\.yaml(:\d+)?: slot\.y: is missing"),
        ("slot: {x: 1, y: 2, length: 0, width: 1}", r"slot\.length"),
        ("faults: [{signal: vehicle.speed, kind: melt}]", r"faults\[1\]\.kind: 'melt'"),
        ("faults: [{signal: vehicle.speed, kind: stuck_at_last, when: 3}]", r"faults\[1\]\.when: unknown"),
        ("expected_outcome: glory", r"expected_outcome: 'glory'"),
        ("requirements: [projec]", r"projec: no set of requirements of this name; did you mean project"),
        ("car: tank", r"tank: no car of this name; "),
        ("seed: 1\nextends: guo2015-case9", r"mine\.yaml:2: extends: guo2015-case9: no scenario of this name; did you"),
        ("extends: nowhere.yaml", r"mine\.yaml:1: extends: nowhere\.yaml: no such file"),
        ("requirements: [projekt]", r"mine\.yaml:1: requirements: projekt: no set of requirements of this name"),
        ("seed: 1\ncar: tesla", r"mine\.yaml:2: car: tesla: no car of this name"),
        ("seed: 1\ncar: {extends: tesla}", r"mine\.yaml:2: car: tesla: no car of this name"),
        ("seed: 1\nsystem: {componets: {}}", r"mine\.yaml:2: system\.componets: unknown; did you mean components"),
        ("name: straße", "'straße': expected letters and digits without accents"),
        ("stop_time: .nan", r"mine\.yaml:1: stop_time: nan: expected a finite number"),
        ("faults: [{signal: vehicle.odometry, knid: delay}]", r"faults\[1\]\.knid: unknown; did you mean kind\?"),
        ("extends: mine.yaml", r"extends: inherits from itself"),
        ("a: [1", r"mine\.yaml(:\d+)?: line \d+, column \d+"),
        ("seed: 1\nseed: 2", r"line 2, column 1: key 'seed' is written twice"),
        ("- 1", r"mine\.yaml(:\d+)?: expected a mapping"),
    ],
)
def test_a_mistake_is_one_clear_sentence(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(BadInput, match=message) as caught:
        load_scenario(write(tmp_path, text))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("car.wheelbase", "expected KEY=VALUE"),
        ("car.wheelbas=3", r"--set: car\.wheelbas: unknown; did you mean car.wheelbase"),
        ("controller.system=mpcc", r"--set: controller\.system: 'mpcc' is none of ntbptcwpt"),
        ("nothing=3", "--set: nothing: unknown"),
        ("faults[1].delay=3", r"--set: faults\[1\]\.delay: unknown; set the whole list: faults=\[\.\.\.\]"),
        ("controller.system=1 kg", r"--set: controller\.system: '1 kg' is none of ntbptcwpt"),
        ("decimation.vehicle=two", "'two'"),
    ],
)
def test_a_wrong_set_is_explained(given: str, message: str) -> None:
    with pytest.raises(BadInput, match=message):
        load_scenario(DEMO, [given])


def test_names_and_paths_that_do_not_exist() -> None:
    with pytest.raises(BadInput, match="guo2015-case44: no scenario of this name; did you mean guo2015-case4"):
        load_scenario("guo2015-case44")
    with pytest.raises(BadInput, match=r"nowhere/x\.yaml: no such file"):
        load_scenario("nowhere/x.yaml")
