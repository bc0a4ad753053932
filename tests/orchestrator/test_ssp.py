"""Systems made elsewhere, .ssp files, run here as they are, and as a part of a scenario that judges them."""

import json
import math
import zipfile
from pathlib import Path

import pytest

from orchestrator.cli import main
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.read_log import read_log
from orchestrator.session.foreign import load_bound_scenario
from orchestrator.session.session import NOBODY, Messages, make_instances
from orchestrator.simulation.system.assemble import ElaboratedSystem, elaborate
from orchestrator.simulation.system.diagnostics import remarks
from tests.orchestrator import c_fmus
from tests.orchestrator.foreign_fmus import changed

SSV = """<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0">
<ssv:Parameters><ssv:Parameter name="base"><ssv:Real value="2.405"/></ssv:Parameter></ssv:Parameters></ssv:ParameterSet>
"""
SSM = """<ssm:ParameterMapping xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" version="1.0">
<ssm:MappingEntry source="base" target="plant.Wheelbase"/></ssm:ParameterMapping>
"""
JUDGED = """
name: yard
extends: guo2015-case4
requirements: [project]
system:
  ssp: yard.ssp
  frames: {nautical: {y: right, ahead: 2.405 m}}
  roles:
    pose: {from: "plant.East [cm], plant.South [cm], plant.Course [deg]", out_of: nautical}
    speed: plant.Speed
    wheel: -brain_arcs.StrWhlAngReq
    mode: {from: brain_arcs.State, map: {1: standby, 2: path tracking, 3: straighten, 4: parked}}
    manoeuvres: brain_arcs.Moves
"""


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a third-party system: two levels, a parameter set, a mapping, transformations."""
    folder = tmp_path_factory.mktemp("desk")
    with zipfile.ZipFile(folder / "yard.ssp", "w") as archive:
        archive.write(c_fmus.THEIR / "system.ssd", "SystemStructure.ssd")
        archive.write(c_fmus.plant(folder), "resources/plant.fmu")
        archive.write(c_fmus.two_arcs(folder), "resources/two_arcs.fmu")
        archive.writestr("resources/car.ssv", SSV)
        archive.writestr("resources/car.ssm", SSM)
    (folder / "yard.yaml").write_text(JUDGED)
    return folder


def test_a_system_of_others_runs_as_it_is(desk: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(desk / "yard.ssp"), "--out", str(tmp_path), "--json"]) == 0
    captured = capsys.readouterr()
    summary = json.loads(captured.out)
    assert (summary["outcome"], summary["duration"]) == ("finished", 35.0)
    assert [item["name"] for item in summary["fmus"]] == ["plant", "brain_arcs"]
    log = read_log(tmp_path / "run.mcap")
    assert log.parameters["brain_arcs.TurnTime"] == 1.5
    assert log.parameters["plant.Wheelbase"] == 2.405
    assert log.signals["brain_arcs.State"][-1] == 4
    assert log.signals["plant.Demand"].min() == pytest.approx(-0.3)
    assert log.signals["plant.Steer"][100] == -log.signals["brain_arcs.StrWhlAngReq"][100] != 0.0
    assert "nothing feeds" not in captured.err


def test_roles_in_a_scenario_have_it_judged(desk: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(desk / "yard.yaml"), "--out", str(tmp_path), "--no-page", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["outcome"] == "parked"
    words = ["run", str(desk / "yard.yaml"), "--out", str(tmp_path), "--force", "--no-page", "--json"]
    main([*words, "--set", "brain_arcs.TurnTime=2"])
    assert read_log(tmp_path / "run.mcap").parameters["brain_arcs.TurnTime"] == 2.0


def test_what_is_exported_comes_back_with_its_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "again.ssp"
    scenario = "guo2015-case4-105"  # the FMUs of tests/twin/test_interop.py, compiled once for both
    assert main(["export", "ssp", scenario, "--out", str(file), "--quiet"]) == 0
    ends = []
    for name in (scenario, str(file)):
        capsys.readouterr()
        assert main(["run", name, "--out", str(tmp_path / "out"), "--force", "--no-page", "--json"]) == 0
        ends.append(json.loads(capsys.readouterr().out)["final"])
    same = ("x", "y", "heading", "lateral_error", "longitudinal_error")
    assert {key: ends[0][key] for key in same} == {key: ends[1][key] for key in same}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("resources/plant.fmu", "resources/nothing.fmu"), "there is no resources/nothing.fmu in it"),
        (("resources/plant.fmu", "http://elsewhere/plant.fmu"), "plant: http://elsewhere/plant.fmu is no FMU in this"),
        (('endConnector="Steer"', 'endConnector="Stear"'), "plant has no input 'Stear'; did you mean plant.Steer?"),
        (("<ssd:System ", "<ssd:System"), "cannot be read"),
        (("UTF-8", "U1F-8"), "cannot be read: unknown encoding"),
        (('endElement="brain" endConnector="course"', 'endElement="brian" endConnector="course"'), "no element brian"),
        (('endConnector="course"', 'endConnector="cours"'), "brain.cours is connected, but there is no such connector"),
        (
            ('startConnector="VehSpdReq"', 'startConnector="Yaw"'),
            "brain/arcs.Yaw and brain.speed are connected, but",
        ),
        (('endConnector="Demand"', 'endConnector="Steer"'), "plant.Steer is fed twice"),
    ],
)
def test_what_is_wrong_with_it_is_said(
    change: tuple[str, str], said: str, desk: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bad = tmp_path / "bad.ssp"
    with zipfile.ZipFile(desk / "yard.ssp") as source, zipfile.ZipFile(bad, "w") as target:
        for name in source.namelist():
            data = source.read(name)
            is_structure = name == "SystemStructure.ssd"
            target.writestr(name, data.decode().replace(*change) if is_structure else data)
    assert main(["run", str(bad), "--out", str(tmp_path / "out")]) == 2
    assert said in capsys.readouterr().err


XML = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="M" guid="g"><CoSimulation modelIdentifier="m"/>
<ModelVariables>{variables}</ModelVariables><ModelStructure/></fmiModelDescription>"""
SSD = """<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
 xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
 xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" name="S" version="1.0">
<ssd:System name="S"><ssd:Elements>
<ssd:Component name="brain" source="brain.fmu"><ssd:Connectors>{brain}</ssd:Connectors></ssd:Component>
<ssd:Component name="plant" source="my%20plant.fmu"><ssd:Connectors>{plant}</ssd:Connectors>
<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
<ssv:ParameterSet name="p" version="1.0"><ssv:Parameters>
{values}</ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>
</ssd:Component></ssd:Elements><ssd:Connections>{connections}</ssd:Connections></ssd:System>
<ssd:Units><ssc:Unit name="gon"><ssc:BaseUnit rad="1" factor="0.015707963267948967"/></ssc:Unit>
<ssc:Unit name="deg"><ssc:BaseUnit rad="1" factor="0.017453292519943295"/></ssc:Unit>
<ssc:Unit name="rad"><ssc:BaseUnit rad="1"/></ssc:Unit></ssd:Units></ssd:SystemStructureDescription>"""
BRAIN = (("Wheel Angle, left", "output", "Real", "rad"), ("count", "output", "Integer", ""))
PLANT = (
    ("Steer Angle", "input", "Real", ""),
    ("Offset", "input", "Real", ""),
    ("gain", "parameter", "Real", "rad"),
    ("bare", "parameter", "Real", ""),
    ("share", "parameter", "Real", "-"),
    ("file", "parameter", "String", ""),
)
STRAIGHT = """<ssd:Connection startElement="brain" startConnector="Wheel Angle, left" endElement="plant"
 endConnector="Steer Angle"/>"""
BACKWARDS = """<ssd:Connection startElement="plant" startConnector="Steer Angle" endElement="brain"
 endConnector="Wheel Angle, left"/>"""


def fmu(path: Path, variables: tuple[tuple[str, str, str, str], ...]) -> Path:
    parts = [
        f'<ScalarVariable name="{name}" valueReference="{number}" causality="{causality}">'
        f"""<{kind}{f' unit="{unit}"' if unit else ""}/></ScalarVariable>"""
        for number, (name, causality, kind, unit) in enumerate(variables)
    ]
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", XML.format(variables="".join(parts)))
    return path


def connectors(variables: tuple[tuple[str, str, str, str], ...], units: dict[str, str]) -> str:
    return "".join(
        f"""<ssd:Connector name="{name}" kind="{kind}"><ssc:Real{f' unit="{units[name]}"' if name in units else ""}/>"""
        "</ssd:Connector>"
        for name, kind, _, _ in variables
    )


def small(
    folder: Path,
    connections: str = STRAIGHT,
    values: str = "",
    plant: dict[str, str] | None = None,
    brain: dict[str, str] | None = None,
) -> Path:
    """Return a system of two FMUs without code: enough for what is connected and set."""
    text = SSD.format(
        brain=connectors(BRAIN, brain or {}),
        plant=connectors(PLANT, plant or {}),
        connections=connections,
        values=values,
    )
    with zipfile.ZipFile(folder / "small.ssp", "w") as archive:
        archive.writestr("SystemStructure.ssd", text)
        archive.write(fmu(folder / "brain.fmu", BRAIN), "brain.fmu")
        archive.write(fmu(folder / "plant.fmu", PLANT), "my plant.fmu")
    return folder / "small.ssp"


def real(name: str, value: str, unit: str = "") -> str:
    with_unit = f' unit="{unit}"' if unit else ""
    return f'<ssv:Parameter name="{name}"><ssv:Real value="{value}"{with_unit}/></ssv:Parameter>'


def assembled(path: Path) -> tuple[Scenario, ElaboratedSystem]:
    scenario, _, foreign = load_bound_scenario(str(path), [], NOBODY)
    instances = make_instances(scenario, None, Messages(), foreign)
    return scenario, elaborate(scenario, instances)


def moved(system: ElaboratedSystem, value: float) -> float:
    """Return what the plant's steering input gets of a number of the brain."""
    (link,) = system.connections
    brain = next(item for item in system.instances if item.name == "brain")
    brain.outputs.values[link.source_places] = value
    given = brain.outputs.values[link.source_places]
    return float((given if link.convert is None else link.convert(given))[0])


@pytest.mark.parametrize("connection", [STRAIGHT, BACKWARDS])
def test_a_connection_has_the_direction_of_its_connectors(connection: str, tmp_path: Path) -> None:
    _, system = assembled(small(tmp_path, connection))
    assert moved(system, 0.25) == 0.25


@pytest.mark.parametrize(("unit", "factor"), [("deg", 180.0 / math.pi), ("gon", 200.0 / math.pi), ("rad", 1.0)])
def test_a_connectors_unit_holds_where_the_fmu_has_none(unit: str, factor: float, tmp_path: Path) -> None:
    _, system = assembled(small(tmp_path, plant={"Steer Angle": unit}))
    assert moved(system, 1.0) == pytest.approx(factor, rel=1e-15)
    assert not [text for text in remarks(system, None) if "Steer Angle" in text]


def test_a_number_without_unit_is_said_to_be_passed_on_as_it_is(tmp_path: Path) -> None:
    small(tmp_path)
    fmu(tmp_path / "degrees.fmu", (("Wheel Angle, left", "output", "Real", "deg"),))
    (tmp_path / "both.yaml").write_text(
        "task: open_loop\nsystem:\n"
        "  components: {vehicle: none, controller: none, brain: degrees.fmu, plant: plant.fmu}\n"
        "  connections: {plant.Steer Angle: 'brain.Wheel Angle, left'}\n"
    )
    _, system = assembled(tmp_path / "both.yaml")
    assert moved(system, 180.0) == 180.0
    said = [text for text in remarks(system, None) if "Steer Angle" in text]
    assert "connected with brain.Wheel Angle, left [deg]: its number is taken as it is" in said[0]


def test_a_connectors_unit_of_another_quantity_is_refused(tmp_path: Path) -> None:
    path = small(tmp_path, plant={"gain": "m"})
    with zipfile.ZipFile(path) as archive:
        files = {name: archive.read(name).decode() for name in ("SystemStructure.ssd",)}
    metre = '<ssc:Unit name="m"><ssc:BaseUnit m="1"/></ssc:Unit></ssd:Units>'
    defined = '<UnitDefinitions><Unit name="rad"><BaseUnit rad="1"/></Unit></UnitDefinitions><ModelVariables>'
    changed(fmu(tmp_path / "plain.fmu", PLANT), tmp_path / "p.fmu", lambda x: x.replace("<ModelVariables>", defined))
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", files["SystemStructure.ssd"].replace("</ssd:Units>", metre))
        archive.write(tmp_path / "brain.fmu", "brain.fmu")
        archive.write(tmp_path / "p.fmu", "my plant.fmu")
    with pytest.raises(BadInput, match=r"connector plant\.gain is in m, but its FMU has it in rad"):
        assembled(path)


def test_values_come_in_the_unit_of_the_fmu(tmp_path: Path) -> None:
    values = real("gain", "180", "deg") + real("bare", "200", "gon") + real("share", "5", "-")
    scenario, _ = assembled(small(tmp_path, values=values))
    assert scenario.parameters_for("plant") == {"gain": pytest.approx(math.pi), "bare": 200.0, "share": 5.0}


def test_a_value_without_unit_is_in_that_of_its_connector(tmp_path: Path) -> None:
    scenario, _ = assembled(small(tmp_path, values=real("gain", "180"), plant={"gain": "deg"}))
    assert scenario.parameters_for("plant") == {"gain": pytest.approx(math.pi)}


def test_a_value_of_an_input_is_its_start_and_one_of_nothing_is_told(tmp_path: Path) -> None:
    scenario, system = assembled(small(tmp_path, values=real("Offset", "2.5") + real("Ofset", "1")))
    plant = next(item for item in system.instances if item.name == "plant")
    assert plant.inputs.values[plant.inputs.index["Offset"]] == 2.5
    assert scenario.system is not None
    assert remarks(system, None, scenario.system.ignored)[-1].endswith("plant.Ofset: its FMU has no such variable")


def test_elements_whose_names_differ_in_signs_alone_stay_apart(tmp_path: Path) -> None:
    path = small(tmp_path)
    with zipfile.ZipFile(path) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    one, other = (
        '<ssd:Component name="pla.nt" source="my%20plant.fmu"/>',
        '<ssd:Component name="pla-nt" source="brain.fmu"/>',
    )
    twin = f"{one}{other}</ssd:El"
    files["SystemStructure.ssd"] = files["SystemStructure.ssd"].decode().replace("</ssd:El", twin, 1).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    scenario, _ = assembled(path)
    assert scenario.system is not None
    assert {"pla_nt", "pla_nt_2"} <= set(scenario.places)
