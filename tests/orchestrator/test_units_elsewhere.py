"""Units, names and numbers at other places where users' files are read: none of them is dropped without a word."""

import zipfile
from pathlib import Path
from typing import Any

import pytest

from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.plausible import implausible
from orchestrator.inputs.scenario.tpcap import read_tpcap
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.yaml_file import read_mapping
from orchestrator.session.foreign import load_bound_scenario
from orchestrator.session.session import NOBODY, Messages, make_instances
from orchestrator.simulation.cosim.model_description import read_description
from orchestrator.simulation.system.assemble import elaborate

HEAD = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="M" guid="g"><CoSimulation modelIdentifier="m"/>"""
VARIABLE = '<ScalarVariable name="{0}" valueReference="{1}" causality="output"><Real{2}/></ScalarVariable>'


def fmu(path: Path, *variables: tuple[str, str]) -> Path:
    parts = [
        VARIABLE.format(name, number, f' unit="{unit}"' if unit else "")
        for number, (name, unit) in enumerate(variables)
    ]
    with zipfile.ZipFile(path, "w") as archive:
        text = f"{HEAD}<ModelVariables>{''.join(parts)}</ModelVariables><ModelStructure/></fmiModelDescription>"
        archive.writestr("modelDescription.xml", text)
    return path


def assembled(folder: Path, system: str) -> Any:
    (folder / "scenario.yaml").write_text(f"task: open_loop\nsystem: {system}\n")
    scenario, _, foreign = load_bound_scenario(str(folder / "scenario.yaml"), [], NOBODY)
    return elaborate(scenario, make_instances(scenario, None, Messages(), foreign))


def test_an_output_that_is_judged_in_another_unit_is_refused_with_the_line_to_write(tmp_path: Path) -> None:
    fmu(tmp_path / "car.fmu", ("speed", "km/h"), ("pose.x", "m"))
    with pytest.raises(BadInput, match="is in km/h, but judged in m/s") as error:
        assembled(tmp_path, "{components: {controller: none, vehicle: car.fmu}}")
    assert "roles: {speed: plant.speed}" in str(error.value)
    assembled(tmp_path, "{components: {controller: none, vehicle: none, plant: car.fmu}, roles: {speed: plant.speed}}")


def test_a_unit_on_the_wrong_side_is_refused_with_the_line_to_write(tmp_path: Path) -> None:
    fmu(tmp_path / "car.fmu", ("angle", "rad"), ("bare", ""))
    instances = "components: {controller: none, plant: car.fmu}"
    with pytest.raises(BadInput) as error:
        assembled(tmp_path, f"{{{instances}, connections: {{'vehicle.steering_wheel_request [deg]': plant.bare}}}}")
    assert "write 'vehicle.steering_wheel_request: plant.bare [deg]'" in str(error.value)
    with pytest.raises(BadInput) as error:
        assembled(tmp_path, f"{{{instances}, connections: {{vehicle.steering_wheel_request: 'plant.angle [deg]'}}}}")
    assert "plant.angle is in rad, as its FMU says, not in deg" in str(error.value)


def test_an_fmu_with_two_variables_of_a_name_is_none(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="2 variables called 'speed'"):
        read_description(fmu(tmp_path / "two.fmu", ("speed", "m/s"), ("speed", "km/h")))


@pytest.mark.parametrize(("text", "said"), [("a: 010", "010 is a number of base 8"), ("a: 1:30", "1:30 is a number")])
def test_numbers_of_other_bases_are_refused(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(text)
    with pytest.raises(BadInput, match=said):
        read_mapping(tmp_path / "a.yaml")


@pytest.mark.parametrize("key", ["target.heading", "slot.heading", "vehicle.start.heading"])
def test_a_heading_of_90_rad_is_said(key: str) -> None:
    said = implausible(load_scenario("guo2015-case4", [f"{key}=90"]))
    assert any("write '90 deg' if degrees are meant" in text for text in said)
    assert not [text for text in implausible(load_scenario("guo2015-case4", [f"{key}=90 deg"])) if "degrees" in text]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("0,0,90,4,5,0,0", "heading of start 90: expected radians"),
        ("0,0,0,4,5,0,1,3.5,1,1,2,2,3,1", "3.5 corners: expected a whole number"),
    ],
)
def test_scenes_of_others_are_read_as_they_are_or_refused(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(BadInput, match=said):
        read_tpcap(tmp_path / "a.csv")
    (tmp_path / "b.csv").write_bytes(b"\xef\xbb\xbf0,0,0,4,5,0,0")
    assert read_tpcap(tmp_path / "b.csv")["vehicle"]["start"] == {"x": -4.0, "y": -5.0, "heading": 0.0}


def test_a_tolerance_that_fits_no_signal_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "a")
    main(["run", "guo2015-case4", "--fmus", "none", "--set", "stop_time=0.1", "--no-page", "--out", out])
    (tmp_path / "tolerances.yaml").write_text('"vehicle.pos.*": {abs: 1 cm}\n"vehicle.speed": {abs: 1}\n')
    log = str(tmp_path / "a" / "run.mcap")
    capsys.readouterr()
    assert main(["compare", log, log, "--tolerances", str(tmp_path / "tolerances.yaml")]) == 0
    said = capsys.readouterr().err
    assert "vehicle.pos.*: no signal fits" in said
    assert "vehicle.speed" not in said
