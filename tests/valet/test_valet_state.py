"""The FMU state of the valet has its search: saved in the middle of a plan, it goes on as if nothing had been."""

import ctypes
from ctypes import byref, c_size_t
from pathlib import Path
from typing import Any

import pytest

from controller_fmu import VALET
from controller_fmu.planning.plan_store import PlanStore
from fmus.native.compilers import can_compile
from fmus.native.libraries import load_model, memory_size
from fmus.python import fmu as python_fmu
from modelkit.store import size_of
from modelkit.variables import with_values
from orchestrator.inputs.scenario.load_scenario import load_scenario
from tests.fmi.built import native_fmu_of
from tests.fmi.host import Host
from tests.fmi.raw import OK, Library, state_pointer

pytestmark = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")
SHOWN = ("valet.searched", "valet.pieces", "valet.margin", "valet.move.pieces[1].length", "steering_wheel_request")


def stepped(fmu: Any, component: Any, first: Any, last: Any) -> Any:
    found = []
    for number in range(first, last):
        assert fmu.step(component, 0.01 * number) == OK
        found.append([fmu.get(component, name) for name in SHOWN])
    return found


def test_a_plan_goes_on_in_another_instance(tmp_path: Path) -> None:
    fmu = Library(native_fmu_of(VALET), tmp_path / "files")
    scenario = load_scenario("valet-nose-in")
    given = {name: value for name, value in scenario.controller.items() if VALET.shows(name)}
    start = {f"odometry.{axis}": scenario.vehicle.get(f"start.{axis}", 0.0) for axis in ("x", "y", "heading")}
    component, other = fmu.initialized(**given, **start), fmu.instantiate(b"other")
    assert stepped(fmu, component, 0, 8)[-1][1] == 0  # not planned yet
    state, size, restored = state_pointer(), c_size_t(), state_pointer()
    assert fmu.call("GetFMUstate", component, byref(state)) == OK
    assert fmu.call("SerializedFMUstateSize", component, state, byref(size)) == OK
    assert size_of(PlanStore) < size.value < 2_000_000
    content = ctypes.create_string_buffer(size.value)
    assert fmu.call("SerializeFMUstate", component, state, content, size) == OK
    expected = stepped(fmu, component, 8, 60)
    assert expected[-1][1] > 0
    assert fmu.call("SetFMUstate", component, state) == OK
    assert stepped(fmu, component, 8, 60) == expected
    assert fmu.call("DeSerializeFMUstate", other, content, size, byref(restored)) == OK
    assert fmu.call("SetFMUstate", other, restored) == OK
    assert stepped(fmu, other, 8, 60) == expected
    for instance, pointer in ((component, state), (other, restored)):
        fmu.call("FreeFMUstate", instance, byref(pointer))
        fmu.free(instance)


def test_an_instance_takes_less_than_two_megabytes() -> None:
    assert memory_size(load_model(VALET)) < 2_000_000


def test_the_python_fmu_plans_as_the_model_does(tmp_path: Path) -> None:
    scenario = load_scenario("valet-angled-45")
    given = {name: value for name, value in scenario.controller.items() if VALET.shows(name)}
    start = {f"odometry.{axis}": scenario.vehicle.get(f"start.{axis}", 0.0) for axis in ("x", "y", "heading")}
    step, params = VALET.stepper(VALET.new_store()), with_values(VALET.params, scenario.controller)
    state, _ = VALET.initialize(params)
    inputs = with_values(VALET.inputs, start)
    with Host(python_fmu.build(VALET, tmp_path)) as fmu:
        assert "system" not in fmu.refs
        fmu.initialize(**given)
        fmu.set(start)
        for number in range(3):
            state, outputs = step(state, inputs, params, 10_000_000)
            assert fmu.step(0.01 * number, 0.01) == OK
            assert fmu.get(["valet.searched"]) == [outputs.valet.searched]
        assert outputs.valet.searched > 2
