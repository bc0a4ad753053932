"""Text parameters of other tools' FMUs, types that are not supported, and FMUs as unzipped folders."""

import shutil
import zipfile
from pathlib import Path

import pytest
from pythonfmu.builder import FmuBuilder

from orchestrator.cli import main
from orchestrator.presentation.log.read_log import read_log
from tests.orchestrator.c_fmus import THEIR, c_fmu

FMI2 = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="T" guid="t"><CoSimulation modelIdentifier="table"/><ModelVariables>
<ScalarVariable name="file" valueReference="1" causality="parameter" variability="fixed"><String start="a"/>
</ScalarVariable>
<ScalarVariable name="note" valueReference="5" causality="output"><String/></ScalarVariable>
<ScalarVariable name="y" valueReference="2" causality="output"><Real/></ScalarVariable>
</ModelVariables><ModelStructure><Outputs><Unknown index="2"/></Outputs></ModelStructure></fmiModelDescription>"""
FMI3 = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="3.0" modelName="T" instantiationToken="t"><CoSimulation modelIdentifier="table"/>
<ModelVariables>
<String name="file" valueReference="1" causality="parameter" variability="fixed"><Start value="a"/></String>
<String name="parts" valueReference="3" causality="parameter" variability="fixed"><Dimension start="2"/>
<Start value="b"/><Start value="c"/></String>
<Binary name="blob" valueReference="4" causality="parameter" variability="fixed"><Start value="00"/></Binary>
<Clock name="tick" valueReference="6" causality="input" intervalVariability="triggered"/>
<Float64 name="y" valueReference="2" causality="output"/>
</ModelVariables><ModelStructure><Output valueReference="2"/></ModelStructure></fmiModelDescription>"""
READER = '''
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real, String


class Reader(Fmi2Slave):
    """Counts the letters of its text."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.file, self.y = "a", 0.0
        fixed = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        self.register_variable(String("file", **fixed))
        self.register_variable(Real("y", causality=Fmi2Causality.output))

    def do_step(self, t, dt):
        self.y = float(len(self.file))
        return True
'''
SCENARIO = (
    "task: open_loop\nstop_time: 0.05\nrequirements: []\n"
    "system:\n  components: {vehicle: none, controller: none, table: %s}\n"
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    c_fmu(tmp_path / "two.fmu", THEIR / "table.c", FMI2, "table")
    c_fmu(tmp_path / "three.fmu", THEIR / "table.c", FMI3, "table")
    for name in ("two", "three"):
        (tmp_path / f"{name}.yaml").write_text(SCENARIO % f"{name}.fmu")
    return tmp_path


def letters(*texts: str) -> int:
    return sum(sum(text.encode()) for text in texts)


def end(folder: Path, name: str, *words: str) -> float:
    out = folder / "out"
    assert main(["run", str(folder / name), "--no-page", "--force", "--out", str(out), *words]) == 0
    return float(read_log(out / "run.mcap").signals["table.y"][-1])


def test_a_text_is_a_parameter_like_others(folder: Path) -> None:
    assert end(folder, "two.yaml", "--set", "table.file=tyre, böse.tir") == letters("tyre, böse.tir")
    assert end(folder, "two.yaml") == 0.0


def test_a_text_is_set_in_this_process_too(tmp_path: Path) -> None:
    (tmp_path / "reader.py").write_text(READER)
    FmuBuilder.build_FMU(tmp_path / "reader.py", dest=tmp_path)
    (tmp_path / "two.yaml").write_text(SCENARIO % "Reader.fmu")
    assert end(tmp_path, "two.yaml", "--set", "table.file=böse.tir", "--in-process") == len("böse.tir")


def test_texts_of_fmi_3_and_elements_of_arrays_of_them(folder: Path) -> None:
    assert end(folder, "three.yaml", "--set", "table.file=map") == letters("map")
    assert end(folder, "three.yaml", "--set", "table.parts[2]=xyz") == 10000 * letters("b", "xyz")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("table.file=7", "table.file: 7 is no text, which this is; write it in quotes: '7'"),
        ("table.fil=x", "did you mean table.file?"),
        ("table.blob=00", "table.blob: unknown"),
    ],
)
def test_a_value_that_is_no_text_or_of_no_parameter_is_refused(
    folder: Path, given: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", str(folder / "three.yaml"), "--set", given, "--out", str(folder / "out")]) == 2
    assert said in capsys.readouterr().err


def test_types_that_are_not_supported_are_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    end(folder, "three.yaml")
    said = "apa: warning: table has variables of types that are not supported here: tick (Clock), blob (Binary)"
    assert said in capsys.readouterr().err
    end(folder, "two.yaml")
    assert "note (String)" in capsys.readouterr().err


def test_a_text_of_the_fmu_in_the_place_of_the_vehicle(folder: Path) -> None:
    text = "task: open_loop\nstop_time: 0.05\nrequirements: []\n"
    text += "system: {components: {controller: none, vehicle: two.fmu}}\n"
    (folder / "car.yaml").write_text(text + "vehicle: {file: tyre.tir}\n")
    out = folder / "out"
    assert main(["run", str(folder / "car.yaml"), "--no-page", "--out", str(out)]) == 0
    log = read_log(out / "run.mcap")
    assert log.signals["vehicle.y"][-1] == letters("tyre.tir")
    assert log.info["scenario"]["texts"] == {"vehicle": {"file": "tyre.tir"}}


def test_an_unzipped_fmu_is_one(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with zipfile.ZipFile(folder / "two.fmu") as archive:
        archive.extractall(folder / "table two")
    (folder / "open.yaml").write_text(SCENARIO % "table two/")
    assert end(folder, "open.yaml", "--set", "table.file=map") == letters("map")
    first = read_log(folder / "out" / "run.mcap").info["fmus"][0]["sha256"]
    assert main(["fmu", "check", str(folder / "table two")]) in (0, 1)
    assert "two" in capsys.readouterr().out
    (folder / "table two" / "resources").mkdir()
    (folder / "table two" / "resources" / "more.txt").write_text("more")
    end(folder, "open.yaml")
    assert read_log(folder / "out" / "run.mcap").info["fmus"][0]["sha256"] != first
    shutil.rmtree(folder / "table two" / "binaries")
    assert main(["run", str(folder / "open.yaml"), "--out", str(folder / "out2")]) != 0
    (folder / "table two" / "modelDescription.xml").unlink()
    capsys.readouterr()
    assert main(["run", str(folder / "open.yaml"), "--out", str(folder / "out3")]) == 2
    assert "is a folder without modelDescription.xml, so no FMU" in capsys.readouterr().err
