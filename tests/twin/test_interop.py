"""Other masters, with PythonFMUs and with native ones, end at the pose at which ours ends."""

import csv
import subprocess
import sys
import zipfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd, read_ssv
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver

from fmus.contents.xml_file import as_text
from fmus.systems.ssp import write_ssp
from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.export.system_of import parts_of, system_of
from orchestrator.presentation.log.read_log import read_log
from orchestrator.session.session import run_scenario
from tests.twin.toolbox_container import write_container

POSE = ("pose.x", "pose.y", "pose.heading")
KINDS = ("native", pytest.param("python", marks=pytest.mark.release))
SCENARIO = load_scenario("guo2015-case4-105", [])
TOLERANCE = 1e-9


@pytest.fixture(scope="module")
def ours(fmus: Any) -> Any:
    """(end time [s], steps, pose there) of our master."""
    recording = run_scenario(SCENARIO, fmus["native"], kind="native").recording
    return recording.t[-1], len(recording.t_ns) - 1, [recording.signals[f"vehicle.{name}"][-1] for name in POSE]


@pytest.fixture(scope="module", params=KINDS)
def kind(request: pytest.FixtureRequest) -> Any:
    return request.param


@pytest.fixture(scope="module")
def system(kind: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    return system_of(SCENARIO, tmp_path_factory.mktemp("fmus_of_a_scenario"), kind)


@pytest.fixture(scope="module")
def ssp(system: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    return write_ssp(system, tmp_path_factory.mktemp("ssp") / "case4.ssp")


@pytest.fixture(scope="module")
def container(system: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    return write_container(system, tmp_path_factory.mktemp("container"))


def references(path: Any) -> Any:
    return {v.name: v.valueReference for v in fmpy.read_model_description(str(path)).modelVariables}


def test_a_plain_loop_over_fmpy(system: Any, ours: Any, tmp_path: Path) -> None:
    parts = {part.name: load(part, tmp_path / part.name) for part in system.parts}
    links = [(parts[a.name], parts[b.name], name) for a, b, name in system.connections()]

    def exchange() -> None:
        values = [(receiver, name, get(sender, name)) for sender, receiver, name in links]
        for receiver, name, value in values:
            set_value(receiver, name, value)

    exchange()
    for part in parts.values():
        part.fmu.exitInitializationMode()
    for k in range(ours[1]):
        exchange()
        for part in parts.values():
            part.fmu.doStep(k * SCENARIO.step, SCENARIO.step)
    assert [get(parts["vehicle"], name) for name in POSE] == pytest.approx(ours[2], abs=TOLERANCE)
    for part in parts.values():
        part.fmu.terminate()
        part.fmu.freeInstance()


def load(part: Any, folder: Any) -> Any:
    fmpy.extract(str(part.fmu), str(folder))
    description = fmpy.read_model_description(str(folder))
    fmu = FMU2Slave(
        guid=description.guid, modelIdentifier=part.model.name, unzipDirectory=str(folder), instanceName=part.name
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    loaded = SimpleNamespace(fmu=fmu, variables={v.name: v for v in description.modelVariables})
    fmu.enterInitializationMode()
    return loaded


def get(part: Any, name: Any) -> Any:
    variable = part.variables[name]
    return getattr(part.fmu, f"get{variable.type}")([variable.valueReference])[0]


def set_value(part: Any, name: Any, value: Any) -> None:
    variable = part.variables[name]
    getattr(part.fmu, f"set{variable.type}")([variable.valueReference], [value])


def test_libcosim_reads_the_ssp(system: Any, ssp: Any, ours: Any) -> None:
    log_output_level(CosimLogLevel.FATAL)
    execution = CosimExecution.from_ssp_file(ssp_path=str(ssp))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    assert execution.step(ours[1])
    known = references(system.parts[0].fmu)
    index = execution.slave_index_from_instance_name("vehicle")
    found = observer.last_real_values(index, [known[name] for name in POSE])
    assert list(found) == pytest.approx(ours[2], abs=TOLERANCE)


@pytest.mark.parametrize("reported", [{"parameter_set": "scenario"}, {}], ids=["with the set", "with nothing"])
def test_ecos_reads_the_ssp(ssp: Any, ours: Any, reported: Any) -> None:
    """Where it is installed: it needs oneTBB besides its package. Without the set it drives the same scenario."""
    try:
        from ecospy import EcosSimulation
    except (ImportError, OSError) as error:
        pytest.skip(f"no ecospy: {error}")
    with EcosSimulation(step_size=SCENARIO.step, ssp_path=str(ssp)) as simulation:
        simulation.init(**reported)
        simulation.step(ours[1])
        found = [simulation.get_real(f"vehicle::{name}") for name in POSE]
    assert found == pytest.approx(ours[2], abs=TOLERANCE)


def test_fmpy_simulates_the_container_of_fmucontainer(container: Any, ours: Any, tmp_path: Path) -> None:
    table = tmp_path / "result.csv"
    command = [Path(sys.executable).parent / "fmpy", "simulate", container, "--stop-time", repr(float(ours[0]))]
    subprocess.run([*command, "--output-interval", "0.01", "--output-file", table], check=True, capture_output=True)
    with table.open() as file:
        last = list(csv.DictReader(file))[-1]
    assert float(last["time"]) == pytest.approx(ours[0])
    assert [float(last[f"vehicle.{name}"]) for name in POSE] == pytest.approx(ours[2], abs=TOLERANCE)


def test_fmpy_simulates_the_ssp(ssp: Any, ours: Any) -> None:
    """FMPy reads no parameter bindings: the FMUs start as the scenario does. Its last rows lie behind the stop time."""
    result = simulate_ssp(str(ssp), stop_time=ours[0], step_size=SCENARIO.step)
    found = [result[f"vehicle.{name}"][ours[1] - 1] for name in POSE]
    assert found == pytest.approx(ours[2], abs=TOLERANCE)


def test_fmpy_shows_the_outputs_of_the_system_itself(system: Any, ours: Any, tmp_path: Path) -> None:
    path = write_ssp(system, tmp_path / "with_outputs.ssp", with_outputs=True)
    result = simulate_ssp(str(path), stop_time=ours[0], step_size=SCENARIO.step)
    assert set(result.dtype.names) >= {name for _, _, name in system.outputs()} > {"pose.x", "phase"}
    assert [result[name][ours[1] - 1] for name in POSE] == pytest.approx(ours[2], abs=TOLERANCE)


def test_apa_run_reads_the_ssp(ssp: Any, ours: Any, tmp_path: Path) -> None:
    assert main(["run", str(ssp), "--out", str(tmp_path / "run"), "--no-page", "--quiet"]) == 0
    log = read_log(tmp_path / "run" / "run.mcap")
    assert [log.signals[f"vehicle.{name}"][ours[1]] for name in POSE] == pytest.approx(ours[2], abs=TOLERANCE)


@pytest.mark.parametrize("with_outputs", [False, True])
def test_the_ssp_is_valid_and_the_same_bytes_each_time(system: Any, tmp_path: Path, with_outputs: bool) -> None:
    one, other = (write_ssp(system, tmp_path / name, with_outputs) for name in ("one.ssp", "other.ssp"))
    assert one.read_bytes() == other.read_bytes()
    structure = read_ssd(str(one))  # against the schema
    assert structure.name == "Parking_guo2015_case4_105"
    assert [component.name for component in structure.system.elements] == ["vehicle", "controller"]
    outputs = len(list(system.outputs())) if with_outputs else 0
    assert len(structure.system.connections) == len(system.connections()) + outputs > 10
    assert len(structure.system.connectors) == outputs
    fed = {(receiver.name, name) for _, receiver, name in system.connections()}
    for part, component in zip(system.parts, structure.system.elements, strict=True):
        ports = {(port.name, port.kind) for port in component.connectors}
        kinds = ("input", "output", "parameter")
        shown = {(item.name, kind) for kind in kinds for item in part.of(kind)}
        unconnected = {(name, kind) for name, kind in shown if kind == "input" and (part.name, name) not in fed}
        assert ports == shown - unconnected, "FMPy feeds a connector without a connection from the one before it"
        assert len(part.of("parameter")) > 40


def test_the_ssp_says_what_other_tools_read(ssp: Any, system: Any) -> None:
    with zipfile.ZipFile(ssp) as archive:
        text = archive.read("SystemStructure.ssd").decode()
        sets = {part.name: archive.read(f"resources/{part.name}.ssv").decode() for part in system.parts}
    assert 'xmlns:osp="http://opensimulationplatform.com/SSP/OSPAnnotations"' in text
    assert 'baseStepSize="0.01"' in text
    assert 'stepSize="0.01"' in text
    assert '<ssc:BaseUnit m="1" s="-1" />' in text
    for part in system.parts:
        set_ones = {**getattr(SCENARIO, part.name)}.keys() & {item.name for item in part.of("parameter")}
        assert sets[part.name].count("<ssv:Parameter ") == len(set_ones) > 0
        assert f'<ssd:ParameterBinding source="resources/{part.name}.ssv" />' in text
        reported = {item.name: item.value for item in read_ssv(str(ssp), f"resources/{part.name}.ssv").parameters}
        assert reported == {variable.name: as_text(value) for variable, value in part.settings()}


def test_an_fmu_in_the_ssp_starts_with_what_the_scenario_sets(system: Any) -> None:
    for part in system.parts:
        starts = {v.name: v.start for v in fmpy.read_model_description(str(part.fmu)).modelVariables}
        for variable, value in part.settings():
            assert float({"true": "1", "false": "0"}.get(starts[variable.name], starts[variable.name])) == value
    assert {variable.name for variable, _ in system.parts[1].settings()} >= {"target.x", "car.wheelbase"}


@pytest.mark.parametrize("name", ["fault-pose-frozen"])
def test_what_a_system_file_cannot_say_is_refused(name: str) -> None:
    with pytest.raises(BadInput, match="faults live in apa's own master"):
        parts_of(load_scenario(name, []))
    with pytest.raises(BadInput, match="one communication step for all"):
        parts_of(load_scenario("guo2015-case4", ["decimation.controller=2"]))


def test_the_reference_is_a_parked_car(ours: Any) -> None:
    assert ours[1] > 1000
    assert np.isfinite(ours[2]).all()
