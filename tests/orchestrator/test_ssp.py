"""Systems made elsewhere, .ssp files, run here as they are, and as a part of a scenario that judges them."""

import json
import zipfile
from pathlib import Path

import pytest

from orchestrator.cli import main
from orchestrator.log.read_log import read_log
from tests.orchestrator import c_fmus

SSV = """<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0">
<ssv:Parameters><ssv:Parameter name="base"><ssv:Real value="2.405"/></ssv:Parameter></ssv:Parameters></ssv:ParameterSet>
"""
SSM = """<ssm:ParameterMapping xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" version="1.0">
<ssm:MappingEntry source="base" target="plant.Wheelbase"/></ssm:ParameterMapping>
"""
JUDGED = """
name: yard
base: guo2015-case4
limits: [house]
system:
  ssp: yard.ssp
  frames: {nautical: {y: right, ahead: 2.405 m}}
  roles:
    pose: {from: "plant.East [cm], plant.South [cm], plant.Course [deg]", out_of: nautical}
    speed: plant.Speed
    wheel: -brain_arcs.StrWhlAngReq
    mode: {from: brain_arcs.State, map: {1: standby, 2: path tracking, 3: straighten, 4: parked}}
    shifts: brain_arcs.Moves
"""


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a system of somebody's: two levels, a parameter set, a mapping, transformations."""
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
    words = ["run", str(desk / "yard.yaml"), "--out", str(tmp_path), "--no-page", "--json"]
    main([*words, "--set", "brain_arcs.TurnTime=2"])
    assert read_log(tmp_path / "run.mcap").parameters["brain_arcs.TurnTime"] == 2.0


def test_what_is_exported_comes_back_with_its_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "again.ssp"
    assert main(["export", "ssp", "guo2015-case4", "--out", str(file), "--quiet"]) == 0
    ends = []
    for name in ("guo2015-case4", str(file)):
        capsys.readouterr()
        assert main(["run", name, "--out", str(tmp_path / "out"), "--no-page", "--json"]) == 0
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
        (("TurnTime", "TurnTim"), "brain_arcs.TurnTim: unknown; did you mean brain_arcs.TurnTime?"),
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
