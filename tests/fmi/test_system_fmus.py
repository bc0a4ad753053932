"""A controller with one system: the code of the whole one, showing what that system reads and tells."""

import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from controller_fmu import MODEL, SYSTEM_MODELS, SYSTEMS
from controller_fmu.registry import System
from fmus.contents.arrays import fmi_arrays, visible_arrays
from fmus.contents.description import model_description
from fmus.contents.description3 import model_description3
from fmus.contents.variables import fmi_variables, visible_variables
from fmus.python import fmu as python_fmu
from modelkit.variables import constructor, flatten, variables, with_values
from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from tests.fmi.built import native_fmu_of
from tests.fmi.fmpy_check import problems_of
from tests.fmi.host import ERROR, OK, Host, random_inputs
from tests.fmi.test_python_fmu import bits
from tests.native_runs import native_recording

RUNS = {
    System.NTBPTCWPT: ("guo2015-case4", 30.0),
    System.NTBPT: ("guo2015-case1", 30.0),
    System.ZHANG2022: ("zhang2022", 30.0),
    System.HSIC: ("hsic", 40.0),
    System.PREVIEW: ("preview", 12.0),
    System.ADAPTIVE: ("adaptive", 30.0),
}
CHECKED_ONLY = {"system", "target.x", "target.y", "target.heading"}
"""Read by the clock of all systems, which refuses numbers that their ranges refuse already."""
STEP_NS = 10_000_000
HSIC = SYSTEM_MODELS[System.HSIC]
each = pytest.mark.parametrize("system", SYSTEM_MODELS, ids=lambda system: system.name.lower())
EACH_CHANGE = (System.HSIC, System.NTBPTCWPT)
"""Systems whose FMUs are run on each change, those of the others by ``make release``: one writer makes all."""
some = pytest.mark.parametrize(
    "system",
    [
        pytest.param(system, marks=() if system in EACH_CHANGE else pytest.mark.release, id=system.name.lower())
        for system in SYSTEM_MODELS
    ],
)


class Watched:
    """A tuple of a model's types that notes which of its scalars are read."""

    def __init__(self, value: Any, name: Any, seen: Any) -> None:
        self.value, self.name, self.seen = value, name, seen

    def _item(self, value: Any, name: Any) -> Any:
        if isinstance(value, Watched):
            return value
        if isinstance(value, tuple):
            return Watched(value, name, self.seen)
        self.seen.add(name)
        return value

    def __getattr__(self, field: Any) -> Any:
        return self._item(getattr(self.value, field), f"{self.name}.{field}" if self.name else field)

    def __getitem__(self, place: Any) -> Any:
        places = range(len(self.value))[place]
        if isinstance(places, range):
            return tuple(self[number] for number in places)
        return self._item(self.value[places], f"{self.name}[{places + 1}]")

    def __iter__(self) -> Any:
        return (self[number] for number in range(len(self.value)))

    def __len__(self) -> Any:
        return len(self.value)

    def _replace(self, **changes: Any) -> Any:
        return Watched(self.value._replace(**changes), self.name, self.seen)


def unwrapped(value: Any) -> Any:
    """Return outputs in which what is put out of a parameter or an input is that value itself."""
    if isinstance(value, Watched):
        return unwrapped(value.value)
    if hasattr(value, "_fields"):
        return type(value)(*(unwrapped(item) for item in value))
    return tuple(unwrapped(item) for item in value) if isinstance(value, tuple) else value


@cache
def read_and_told(system: Any) -> Any:
    """Return the parameters and inputs that a scenario's run reads, and the outputs that it changes."""
    name, stop = RUNS[system]
    system_set = f"controller.system={system.name.lower()}"
    scenario = load_scenario(name, [system_set])
    read: set[str] = set()
    heard: set[str] = set()
    signals = native_recording(name, system_set, f"stop_time={stop}", f"step={STEP_NS / 1e9}").signals
    params: Any = Watched(with_values(MODEL.params, dict(scenario.controller)), "", read)
    inputs = np.column_stack([signals[f"controller.{item.name}"] for item in variables(MODEL.inputs)]).tolist()
    as_inputs, step = constructor(MODEL.inputs), MODEL.stepper(None)
    controller, asked = MODEL.initialize(params)
    for row in inputs[:-1]:
        controller, asked = step(controller, Watched(as_inputs(row), "", heard), params, STEP_NS)
    outputs = variables(MODEL.outputs)
    assert flatten(unwrapped(asked)) == [signals[f"controller.{item.name}"][-1] for item in outputs]
    told_by = {item.name for item in outputs if (signals[f"controller.{item.name}"] != item.start).any()}
    return read, heard, told_by


def shown(model: Any, cls: Any) -> Any:
    return {item.name for item in variables(cls) if model.shows(item.name)}


@each
def test_it_shows_every_parameter_that_the_system_reads(system: Any) -> None:
    read, _, _ = read_and_told(system)
    assert read - shown(SYSTEM_MODELS[system], MODEL.params) <= CHECKED_ONLY


@each
def test_what_it_shows_beside_what_all_have_is_read(system: Any) -> None:
    read, heard, reported = read_and_told(system)
    all_have = set.intersection(*(set(item.own) for item in SYSTEMS.systems))
    own = set(next(item.own for item in SYSTEMS.systems if system in item.values)) - all_have
    used = (
        read | heard | reported | ({"threshold.standstill"} if system == System.PREVIEW else set())
    )  # at the road's end
    groups = [
        group for group in own if not any(name == group or name.startswith((f"{group}.", f"{group}[")) for name in used)
    ]
    assert groups == []


@each
def test_it_has_the_inputs_that_the_system_reads(system: Any) -> None:
    _, heard, _ = read_and_told(system)
    inputs = shown(SYSTEM_MODELS[system], MODEL.inputs)
    reported = {
        name for name in inputs if name.startswith("external_slot.") and "external_slot.kind" in heard
    }  # the kind says that it is
    assert inputs == heard | reported


@each
def test_it_shows_every_output_that_the_system_changes(system: Any) -> None:
    _, _, reported = read_and_told(system)
    assert reported <= shown(SYSTEM_MODELS[system], MODEL.outputs)


@each
def test_its_description_has_only_those_and_the_system_is_no_parameter(system: Any) -> None:
    model = SYSTEM_MODELS[system]
    assert model.name == f"Controller_{system.name.lower()}"
    root: Any = ElementTree.fromstring(model_description(model, guid="", generation_tool="", flags={}))
    assert root.find("CoSimulation").get("modelIdentifier") == model.name
    names = [node.get("name") for node in root.find("ModelVariables")]
    assert names == [item.name for item in visible_variables(model)]
    expected = shown(model, MODEL.params) | shown(model, MODEL.inputs) | shown(model, MODEL.outputs) | {"time"}
    assert set(names) == expected
    assert "system" not in names
    assert len(names) < 0.55 * len(fmi_variables(MODEL))
    start = next(item for item in fmi_variables(model) if item.name == "system")
    assert (start.start, start.is_exposed) == (int(system), False)


@each
def test_as_fmi_3_it_has_the_same(system: Any) -> None:
    model = SYSTEM_MODELS[system]
    root: Any = ElementTree.fromstring(model_description3(model, token="", generation_tool="", flags={}))
    names = [node.get("name") for node in root.find("ModelVariables")]
    assert names == [item.name for item in visible_arrays(model)]
    assert len(names) < len(fmi_arrays(model))
    scalars = {item.name for array in visible_arrays(model) for item in array.elements}
    assert scalars == {item.name for item in visible_variables(model)}


def test_value_references_are_those_of_the_whole_controller() -> None:
    whole = {item.name: item.vr for item in fmi_variables(MODEL)}
    assert {item.name: item.vr for item in visible_variables(HSIC)}.items() <= whole.items()


@pytest.fixture(scope="module")
def python_system(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The function from a system to its PythonFMU, built once."""
    folder = tmp_path_factory.mktemp("python_systems")
    return cache(lambda system: python_fmu.build(SYSTEM_MODELS[system], folder))


@pytest.fixture(scope="module")
def native_hsic() -> Any:
    return native_fmu_of(HSIC)


@some
def test_checkers_find_nothing(python_system: Any, system: Any) -> None:
    check(python_system(system))


@pytest.mark.release
def test_checkers_find_nothing_in_a_native_one(native_hsic: Any) -> None:
    check(native_hsic)


def check(path: Any) -> None:
    assert problems_of(path) == []
    command = [Path(sys.executable).parent / "fmutool", "-input", path, "-check"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "No semantic error" in done.stdout + done.stderr
    assert "ERROR" not in done.stdout + done.stderr


@some
def test_it_gives_the_bits_of_the_whole_controller(python_system: Any, system: Any) -> None:
    twin(python_system(system), system)


@pytest.mark.release
def test_a_native_one_gives_the_bits_of_the_whole_controller(native_hsic: Any) -> None:
    twin(native_hsic, System.HSIC)


def twin(path: Any, system: Any) -> None:
    model = SYSTEM_MODELS[system]
    params = with_values(MODEL.params, {"system": int(system), "car.steering.ratio": 17.0})
    inputs = random_inputs(visible_variables(model), 3, 60)
    start = {item.name: item.start for item in variables(MODEL.inputs)}
    make, names = constructor(MODEL.inputs), [item.name for item in variables(MODEL.outputs)]
    state, outputs = MODEL.initialize(params)
    with Host(path) as host:
        reported = [item.name for item in fmi_variables(model) if item.is_exposed and item.initial == "calculated"]
        host.initialize(**{"car.steering.ratio": 17.0})
        for number, values in enumerate(inputs):
            expected = dict(zip(names, flatten(outputs), strict=True))
            assert bits(host.outputs()) == bits([expected[name] for name in reported])
            state, outputs = MODEL.stepper(None)(state, make(list((start | values).values())), params, STEP_NS)
            host.set(values)
            assert host.step(number * 0.01, 0.01) == OK


def test_what_is_not_shown_cannot_be_read_or_set_in_a_python_one(python_system: Any) -> None:
    hidden = next(item for item in fmi_variables(HSIC) if item.name == "guo2015.k1")
    with Host(python_system(System.HSIC)) as host:
        host.fmu.getReal([hidden.vr])
        assert host.log[-1][0] == ERROR
    with Host(python_system(System.HSIC)) as host:
        host.fmu.setReal([hidden.vr], [2.0])
        assert host.log[-1][0] == ERROR


def test_apa_build_makes_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", "--system", "hsic,APA", "--fmus", "python", "--out", str(tmp_path)]) == 0
    assert {path.name for path in (tmp_path / "python").iterdir()} == {"Controller_apa.fmu", "Controller_hsic.fmu"}
    assert "Controller_apa.fmu" in capsys.readouterr().out
    assert main(["build", "--system", "appa", "--fmus", "python", "--out", str(tmp_path)]) == 2
    assert "did you mean apa" in capsys.readouterr().err


@pytest.mark.release
def test_a_scenario_passes_with_it(native_hsic: Any, tmp_path: Path) -> None:
    assert main(["test", "hsic", "--controller", str(native_hsic), "--out", str(tmp_path)]) == 0
