"""Runs with FMUs: the same bits as in process, errors reported, nothing left behind."""

import shutil
import tempfile
import zipfile
from pathlib import Path

import numpy as np
import pytest

from fmus.build import build_all
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.text.errors import BadInput, RunError
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.local_instance import LocalInstance
from orchestrator.simulation.cosim.model_description import ports_of, read_description

DEMO = str(Path(__file__).with_name("demo.yaml"))


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    out = tmp_path_factory.mktemp("fmus")
    build_all(out, ("python",))
    return {name: out / "python" / f"{model.name}.fmu" for name, model in MODELS.items()}


def silent(name: str, status: int, text: str) -> None:
    pass


@pytest.mark.parametrize(
    "more", [[], ["decimation={controller: 2}"], ["faults=[{signal: vehicle.odometry.x, kind: noise, sigma: 2 mm}]"]]
)
def test_fmus_give_the_bits_of_the_models_in_process(files: dict[str, Path], more: list[str]) -> None:
    scenario = load_scenario(DEMO, ["stop_time=15", *more])
    here = run_scenario(scenario).recording
    there = run_scenario(scenario, files, kind="python").recording
    assert there.signals.keys() == here.signals.keys()
    for name, values in here.signals.items():
        assert np.ascontiguousarray(there.signals[name]).tobytes() == np.ascontiguousarray(values).tobytes(), name
    assert there.parameters == here.parameters
    assert {name: there.states(name) for name in here.signals} == {name: here.states(name) for name in here.signals}


def test_nothing_is_left_behind(files: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    run_scenario(load_scenario(DEMO, ["stop_time=0.1"]), files, kind="python")
    bad = load_scenario(DEMO, ["stop_time=0.1", "faults=[{signal: vehicle.nothing, kind: stuck_at_last}]"])
    with pytest.raises(BadInput):
        run_scenario(bad, files, kind="python")
    assert list(tmp_path.iterdir()) == []


def test_a_description_is_read_once_until_its_file_changes(files: dict[str, Path], tmp_path: Path) -> None:
    path = tmp_path / "model.fmu"
    shutil.copy(files["vehicle"], path)
    first = read_description(path)
    assert read_description(path) is first
    ports = ports_of(first, "input", None, path)
    ports.add_told(ports.variables[0]._replace(name="more"))
    assert ports_of(first, "input", None, path).names == ports.names[:-1]
    shutil.copy(files["controller"], path)
    assert read_description(path).modelName != first.modelName


def test_sources_and_documentation_are_not_extracted(files: dict[str, Path]) -> None:
    instance = LocalInstance("vehicle", files["vehicle"], {}, silent)
    instance.initialize(1_000_000_000)
    with zipfile.ZipFile(files["vehicle"]) as archive:
        there = {name.split("/")[0] for name in archive.namelist()}
    kept = {path.name for path in Path(instance._directory).iterdir()}
    instance.close()
    assert kept == {"modelDescription.xml", "binaries", "resources"}
    assert there > kept


def test_extraction_goes_to_an_ascii_path(
    files: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    odd = tmp_path / "größe"
    odd.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(odd))
    ran = run_scenario(load_scenario(DEMO, ["stop_time=0.1"]), files, kind="python")
    assert ran.end.reason == "stop_time"
    assert list(odd.iterdir()) == []


def test_a_parameter_the_fmu_does_not_have_is_named(files: dict[str, Path]) -> None:
    with pytest.raises(RunError, match=r"Vehicle\.fmu has no parameter tail; is it outdated\?"):
        LocalInstance("vehicle", files["vehicle"], {"tail": 3.0}, silent)


def test_a_file_that_is_no_fmu(tmp_path: Path) -> None:
    path = tmp_path / "x.fmu"
    path.write_text("no zip")
    with pytest.raises(BadInput, match=r"x\.fmu: is not an FMU"):
        LocalInstance("vehicle", path, {}, silent)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("readme.txt", "empty")
    with pytest.raises(BadInput, match=r"x\.fmu: is not an FMU"):
        LocalInstance("vehicle", path, {}, silent)


def test_units_and_start_values_come_from_the_fmu(files: dict[str, Path]) -> None:
    instance = LocalInstance("vehicle", files["vehicle"], {"car.wheelbase": 2.5}, silent)
    place = instance.parameters.index["car.wheelbase"]
    assert instance.parameters.values[place] == 2.5
    assert instance.parameters.variables[place].signal.unit == "m"
    assert instance.outputs.variables[instance.outputs.index["pose.heading"]].signal.unit == "rad"
    instance.close()
