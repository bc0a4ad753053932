"""A scenario's system as one FMU gives the bits of the pair under our master, and has what an importer looks for."""

import math
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest

from fmus.contents.dependencies import initial_dependencies
from fmus.contents.variables import visible_variables
from fmus.native.platforms import host as this_platform
from modelkit.assembly import assemble
from modelkit.variables import flatten, variables, with_values
from modelkit.vocabulary import Gear
from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import MODELS, models_for
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.export.system_of import one_model
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile
from tests.fmi.built import native_fmu_of
from tests.fmi.fmpy_check import problems_of
from tests.fmi.host import OK, Host
from tests.twin.replays import CLibrary, Fmi3
from tests.twin.test_same_bits import same
from vehicle_fmu import MODEL as VEHICLE

pytestmark = pytest.mark.skipif(not can_compile(), reason="needs a C compiler")
SCENARIOS = ("guo2015-case4-105",)
MORE_SCENARIOS = (
    "apa-parallel",
    *("guo2015-case1", "guo2015-case2", "zhang2022-double-track", "hsic-shuffle", "preview-18"),
    *("apa-perpendicular-left", "apa-takeover", "apa-no-slot", "adaptive", "valet-parallel"),
)
CASE = load_scenario("guo2015-case4-105", [])
COMPILES = pytest.mark.release
"""Compiles a container: ``tests/fmi/test_assembly.py`` has the FMU of two small models, ``tests/fmi/test_fmi3_fmu.py``
the calls, ``pair`` the bits of the models."""
STEP = 10_000_000
FIRST_NS = 21_000_000_000
"""Simulated time that is compared at several communication steps: a whole number of each."""
ODD = (3_000_000, 7_000_000, 10_000_000, 17_000_000, 1, 22_999_999, 250_000_000) * 4


@cache
def pair(step_ns: Any, controller: Any = MODELS["controller"]) -> Any:
    """Both models with all they have as one, and its library: what every scenario of this step can be played to."""
    parts = MODELS | {"controller": controller}
    model = assemble("Pair", "vehicle and controller", sys.modules[__name__], parts, step_ns)
    return model, CLibrary(model)


@pytest.fixture(scope="module")
def recording(fmus: Any) -> Any:
    return run_scenario(CASE, fmus["native"], kind="native").recording


@cache
def container(fmi: int = 2) -> Path:
    """Return the system of CASE as one FMU."""
    return native_fmu_of(one_model(CASE), fmi)


def names(cls: Any) -> Any:
    return [item.name for item in variables(cls)]


@pytest.mark.parametrize(
    "name", [*SCENARIOS, *(pytest.param(name, marks=pytest.mark.release) for name in MORE_SCENARIOS)]
)
def test_it_gives_the_bits_of_the_pair_under_the_master(fmus: Any, name: Any) -> None:
    scenario = load_scenario(name, [])
    model, library = pair(scenario.step_ns, models_for(scenario.controller)["controller"])
    expected = run_scenario(scenario, fmus["native"], kind="native").recording
    given = {f"{part}.{key}": value for part in MODELS for key, value in scenario.parameters_for(part).items()}
    params = np.array(flatten(with_values(model.params, given)), dtype=float)
    inputs = np.zeros((len(expected.t_ns), len(variables(model.inputs))))
    rows = library(params, inputs, scenario.step_ns)
    found = dict(zip(names(model.outputs), rows.T, strict=True))
    assert len(expected.t_ns) > 300
    assert [key for key, values in found.items() if not same(values, expected.signals[key])] == []


@pytest.mark.parametrize("milliseconds", [1, 2, 3, 7])
@pytest.mark.parametrize(
    "name",
    [*SCENARIOS, *(pytest.param(name, marks=pytest.mark.release) for name in ("apa-parallel", "valet-parallel"))],
)
def test_its_exchanges_are_exact_at_any_communication_step(name: Any, milliseconds: int) -> None:
    scenario = load_scenario(name, [])
    model, library = pair(scenario.step_ns, models_for(scenario.controller)["controller"])
    given = {f"{part}.{key}": value for part in MODELS for key, value in scenario.parameters_for(part).items()}
    params = np.array(flatten(with_values(model.params, given)), dtype=float)

    def rows(step_ns: int) -> Any:
        return library(params, np.zeros((FIRST_NS // step_ns + 1, len(variables(model.inputs)))), step_ns)

    step_ns = milliseconds * 1_000_000
    both_ns = math.lcm(step_ns, scenario.step_ns)
    expected = rows(scenario.step_ns)[:: both_ns // scenario.step_ns]
    found = rows(step_ns)[:: both_ns // step_ns]
    assert len(found) == len(expected) > 100
    assert [
        key for key, values in zip(names(model.outputs), found.T == expected.T, strict=True) if not all(values)
    ] == []


@COMPILES
def test_the_container_of_fmi_2_gives_them(recording: Any) -> None:
    model = one_model(CASE)
    order = [item.name for item in variables(model.outputs) if model.shows(item.name)]
    with Host(container()) as host:
        host.initialize()
        rows = [host.outputs()]
        for k in range(len(recording.t_ns) - 1):
            assert host.step(k * CASE.step, CASE.step) == OK
            rows.append(host.outputs())
        assert host.log == []
    found = dict(zip(order, np.array(rows, dtype=float).T, strict=True))
    assert len(found) > 50
    assert [key for key, values in found.items() if not same(values, recording.signals[key])] == []


@COMPILES
def test_the_container_of_fmi_3_gives_them(recording: Any, tmp_path: Path) -> None:
    model = one_model(CASE)
    params = np.array(flatten(model.first_params()), dtype=float)
    inputs = np.zeros((len(recording.t_ns), len(variables(model.inputs))))
    rows = Fmi3(model, container(3), tmp_path)(params, inputs, STEP)
    found = dict(zip(names(model.outputs), rows.T, strict=True))
    assert [key for key, values in found.items() if not same(values, recording.signals[key])] == []


@pytest.mark.parametrize("driver_changes", [False, True])
def test_its_python_gives_the_bits_of_its_c_at_steps_of_any_length(driver_changes: bool) -> None:
    """Steps within, on and across the exchanges, and inputs that change in between."""
    model, played = pair(STEP)
    params = with_values(
        model.params, {f"vehicle.{key}": value for key, value in CASE.parameters_for("vehicle").items()}
    )
    (state, outputs), inputs = model.initialize(params), model.inputs()
    library, memory = played.library, np.zeros(1_000_000, dtype=np.uint8)
    reported, given = np.empty(played.count), np.array(flatten(inputs), dtype=float)
    flat = np.array(flatten(params), dtype=float)
    library.model_start(memory.ctypes.data, flat.ctypes.data, reported.ctypes.data)
    for number, dt_ns in enumerate(ODD):
        if driver_changes:
            pedals = {"accelerator": 0.1 * (number % 3), "brake": 0.2 * (number % 2)}
            person = inputs.vehicle.manual._replace(active=True, lever=Gear.DRIVE, **pedals)
            inputs = inputs._replace(vehicle=inputs.vehicle._replace(manual=person))
            given = np.array(flatten(inputs), dtype=float)
        assert same(reported, np.array(flatten(outputs), dtype=float))
        state, outputs = model.step(state, inputs, params, dt_ns)
        library.model_step(memory.ctypes.data, given.ctypes.data, reported.ctypes.data, dt_ns)
    assert same(reported, np.array(flatten(outputs), dtype=float))
    assert outputs.vehicle.distance > 0.01
    assert state.to_exchange_ns == STEP - sum(ODD) % STEP


@COMPILES
def test_a_state_saved_between_two_exchanges_continues_to_the_same_bits() -> None:
    with Host(container()) as host, Host(container()) as other:
        host.initialize()
        for k in range(100):
            assert host.step(k * 0.007, 0.007) == OK
        content = host.fmu.serializeFMUstate(host.fmu.getFMUstate())
        other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(content))
        for k in range(100, 200):
            assert host.step(k * 0.007, 0.007) == other.step(k * 0.007, 0.007) == OK
        assert host.outputs() == other.outputs()


# What an importer sees


@COMPILES
@pytest.mark.parametrize("fmi", [2, 3])
def test_checkers_find_nothing(fmi: int) -> None:
    assert problems_of(container(fmi)) == []
    command = [str(Path(sys.executable).parent / "fmutool"), "-input", str(container(fmi)), "-check"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "ERROR" not in done.stdout + done.stderr


@COMPILES
def test_it_has_units_licence_parameters_and_its_own_reference_result(recording: Any, tmp_path: Path) -> None:
    description = fmpy.read_model_description(str(container()))
    known = {v.name: v for v in description.modelVariables}
    assert description.license == "MIT"
    assert description.modelName == "Parking_guo2015_case4_105"
    assert description.description == CASE.title
    assert description.defaultExperiment.stopTime == str(CASE.longest)
    assert known["vehicle.pose.x"].unit == "m"
    assert known["controller.guo2015.k1"].variability == "tunable"
    assert known["controller.lateral_error"].causality == "local"
    assert known["controller.phase"].variability == "discrete"
    assert "controller.hsic.gain.k1" not in known, "of another system"
    assert CASE.target is not None
    assert float(known["controller.target.x"].start) == CASE.target.x
    inputs = [v.name for v in description.modelVariables if v.causality == "input"]
    assert {name.rpartition(".")[0] for name in inputs} == {"vehicle.manual"}, "what neither feeds"
    fmpy.extract(str(container()), str(tmp_path))
    assert [path.name for path in (tmp_path / "binaries").iterdir()] == [this_platform()]
    (table,) = tmp_path.glob("extra/*/*_out.csv")
    rows = fmpy.util.read_csv(table)
    every = round(rows["time"][1] / CASE.step)
    expected = recording.signals["vehicle.pose.x"][::every]
    assert same(rows["vehicle.pose.x"][: len(expected)], expected)


def test_initial_dependencies_are_those_of_the_parts() -> None:
    model = one_model(CASE)
    found, of_vehicle = initial_dependencies(model), initial_dependencies(VEHICLE)
    assert found["vehicle.pose.x"] == [f"vehicle.{name}" for name in of_vehicle["pose.x"]] != []
    assert found.keys() == {item.name for item in visible_variables(model) if item.initial == "calculated"}


@COMPILES
def test_a_parameter_changes_what_it_changes_in_the_pair() -> None:
    with Host(container()) as host, Host(container()) as other:
        host.initialize()
        other.initialize(**{"vehicle.driver.profile[1].speed": 0.3})
        for k in range(600):
            assert host.step(k * 0.01, 0.01) == other.step(k * 0.01, 0.01) == OK
        assert other.get(["vehicle.distance"])[0] < 0.8 * host.get(["vehicle.distance"])[0]


# What is chosen


def test_inputs_parameters_and_outputs_are_chosen_by_patterns() -> None:
    model = one_model(CASE, ["vehicle.driver.*"], ["vehicle.prompt", "controller.driver_takeover"], ["*.pose.*"])
    ports: dict[str, list[str]] = {}
    for item in visible_variables(model):
        ports.setdefault(item.causality, []).append(item.name)
    own = [name for name in ports["input"] if not name.startswith("vehicle.manual.")]
    assert own == ["vehicle.prompt", "controller.driver_takeover"]
    assert ports["output"] == ["vehicle.pose.x", "vehicle.pose.y", "vehicle.pose.heading"]
    assert {name.split(".")[1] for name in ports["parameter"]} == {"driver"}
    with pytest.raises(BadInput, match=r"no signal fits; did you mean vehicle\.prompt"):
        one_model(CASE, None, ["vehicle.promt"], None)


@COMPILES
def test_an_input_left_open_is_what_the_tool_says(tmp_path: Path) -> None:
    out = tmp_path / "open.fmu"
    assert main(["export", "container", CASE.name, "--input", "vehicle.prompt", "--out", str(out)]) == 0
    assert problems_of(out) == []
    with Host(out) as host:
        host.initialize()
        for k in range(400):
            host.set({"vehicle.prompt": 1 if k >= 200 else 3})
            assert host.step(k * 0.01, 0.01) == OK
            if k == 199:
                moving = abs(host.get(["vehicle.speed"])[0])
        assert moving > 0.3
        assert host.get(["vehicle.speed"])[0] == 0.0, "a stop is requested, whatever the controller requests"
