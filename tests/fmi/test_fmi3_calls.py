"""Wrong calls on an FMI 3.0 FMU: refused with fmi3Error and a message, nothing changed; state saved and restored."""

import ctypes
import math
import random
from ctypes import byref, c_bool, c_double, c_int64, c_size_t, c_uint32, c_void_p
from pathlib import Path
from typing import Any

import pytest

from tests.fmi.raw3 import ERROR, OK, Library3, array

ABSENT = (
    *("Float32", "Int8", "UInt8", "Int16", "UInt16", "UInt32", "UInt64", "String", "Binary", "Clock"),
    *("IntervalDecimal", "IntervalFraction", "ShiftDecimal", "ShiftFraction"),
)
MODES = (
    *("EnterEventMode", "EnterConfigurationMode", "ExitConfigurationMode", "EvaluateDiscreteStates"),
    *("EnterContinuousTimeMode", "EnterStepMode", "UpdateDiscreteStates", "CompletedIntegratorStep"),
    *("GetNumberOfContinuousStates", "GetNumberOfEventIndicators", "GetNumberOfVariableDependencies"),
)


@pytest.fixture
def toy(fmi3_fmus: Any, tmp_path: Path) -> Any:
    return Library3(fmi3_fmus["Toy"], tmp_path)


def test_version(toy: Any) -> None:
    assert toy.dll.fmi3GetVersion() == b"3.0"


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"name": b""}, "needs a name"),
        ({"name": None}, "needs a name"),
        ({"token": b"{another}"}, "instantiation token {another} is not that of this binary"),
        ({"token": b"100%d %s %n"}, "instantiation token 100%d %s %n is not"),
        ({"token": b""}, "instantiation token (null)"),
        ({"event_mode": True}, "no event mode"),
        ({"intermediate": 1}, "no intermediate update"),
    ],
)
def test_instantiate_refuses_and_says_why(toy: Any, wrong: Any, words: str) -> None:
    assert toy.instantiate(**wrong) is None
    (status, category, text) = toy.messages[-1]
    assert (status, category) == (ERROR, b"logStatusError")
    assert words in text


def test_it_is_for_co_simulation_only(toy: Any) -> None:
    token = toy.description.guid.encode()
    made = toy.dll.fmi3InstantiateModelExchange(b"x", token, b"/", c_bool(False), c_bool(False), None, toy.logger)
    assert made is None
    assert toy.messages[-1][2] == "this FMU is for co-simulation only"


def test_without_a_logger_nothing_is_said(toy: Any) -> None:
    token, off = toy.description.guid.encode(), c_bool(False)
    made = toy.dll.fmi3InstantiateCoSimulation(
        b"x", token, b"/", off, off, off, off, None, c_size_t(0), None, None, None
    )
    assert toy.step(made, 0.0) == ERROR
    assert toy.messages == []
    toy.free(made)


PHASES = ("instantiated", "initialization", "stepping", "terminated")
ALLOWED = {
    "EnterInitializationMode": ("instantiated",),
    "ExitInitializationMode": ("initialization",),
    "DoStep": ("stepping",),
    "Terminate": ("stepping",),
    "Reset": PHASES,
    "GetFloat64": ("initialization", "stepping", "terminated"),
    "GetInt32": ("initialization", "stepping", "terminated"),
    "GetInt64": ("initialization", "stepping", "terminated"),
    "GetBoolean": ("initialization", "stepping", "terminated"),
    "SetFloat64": ("instantiated", "initialization", "stepping"),
    "SetInt32": ("instantiated", "initialization", "stepping"),
    "SetInt64": ("instantiated", "initialization", "stepping"),
    "SetBoolean": ("instantiated", "initialization", "stepping"),
    "GetFMUState": PHASES,
    "SetDebugLogging": PHASES,
}


def in_phase(toy: Any, phase: Any) -> Any:
    component = toy.instantiate()
    if phase == "instantiated":
        return component
    toy.enter(component)
    if phase in ("stepping", "terminated"):
        toy.call("ExitInitializationMode", component)
    if phase == "terminated":
        toy.call("Terminate", component)
    return component


def call(toy: Any, function: Any, component: Any) -> Any:
    if function == "EnterInitializationMode":
        return toy.enter(component)
    if function == "DoStep":
        return toy.step(component, 0.0)
    if function == "GetFMUState":
        state = c_void_p(None)
        status = toy.call(function, component, byref(state))
        toy.call("FreeFMUState", component, byref(state))
        return status
    if function == "SetDebugLogging":
        return toy.call(function, component, c_bool(True), c_size_t(0), None)
    if function[:3] in ("Get", "Set"):
        return toy.call(function, component, None, c_size_t(0), None, c_size_t(0))
    return toy.call(function, component)


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("function", ALLOWED)
def test_calls_out_of_order_are_refused(toy: Any, phase: Any, function: Any) -> None:
    component = in_phase(toy, phase)
    expected = OK if phase in ALLOWED[function] else ERROR
    assert call(toy, function, component) == expected
    assert bool(toy.messages) == (expected == ERROR)
    assert all(function in text for _, _, text in toy.messages)
    toy.free(component)


@pytest.mark.parametrize("function", ALLOWED)
def test_no_instance_is_an_error_not_a_crash(toy: Any, function: Any) -> None:
    assert call(toy, function, None) == ERROR
    toy.free(None)


@pytest.mark.parametrize("kind", ABSENT)
@pytest.mark.parametrize("verb", ["Get", "Set"])
def test_types_that_no_variable_has(toy: Any, verb: str, kind: Any) -> None:
    component = toy.initialized()
    reference, one, room = c_uint32(toy.known["mass"].valueReference), c_size_t(1), (c_int64 * 4)()
    arguments = (byref(reference), one, room, room, one)
    assert toy.call(f"{verb}{kind}", component, *arguments) == ERROR
    assert toy.messages[-1][2].endswith("mass (value reference 1) is Float64")
    assert toy.call(f"{verb}{kind}", component, None, c_size_t(0), None, None, c_size_t(0)) == OK
    assert toy.call(f"{verb}{kind}", None, *arguments) == ERROR
    toy.free(component)


@pytest.mark.parametrize("function", MODES)
def test_modes_it_does_not_have(toy: Any, function: Any) -> None:
    component, room = toy.initialized(), (c_int64 * 8)()
    pointers = (byref(room, 8 * place) for place in range(6))
    assert toy.call(function, component, *pointers) == ERROR
    assert function in toy.messages[-1][2]
    toy.free(component)


def test_wrong_references_types_directions_and_sizes(toy: Any) -> None:
    component = toy.initialized()
    before = toy.outputs(component)
    room = (c_int64 * 8)()

    def refused(function: Any, name: Any, words: Any, count: Any = 1) -> None:
        vr = toy.known[name].valueReference if isinstance(name, str) else name
        arguments = (byref(c_uint32(vr)), c_size_t(1), room, c_size_t(count))
        assert toy.call(function, component, *arguments) == ERROR
        assert words in toy.messages[-1][2]

    refused("GetFloat64", 4_000_000_000, "no value reference 4000000000; the last is 22")
    refused("GetFloat64", "wish", "wish (value reference 10) is Enumeration")
    refused("GetInt32", "wish", "wish (value reference 10) is Enumeration")
    refused("GetInt64", "count", "count (value reference 17) is Int32")
    refused("GetBoolean", "mass", "mass (value reference 1) is Float64")
    refused("GetFloat64", "oscillators.position", "1 values for variables of 2 elements")
    refused("SetFloat64", "force", "3 values for variables of 2 elements", 3)
    refused("SetFloat64", "angle", "angle is calculated by the FMU")
    refused("SetFloat64", "time", "time is calculated by the FMU")
    refused("SetFloat64", "mass", "parameter mass is fixed after initialization")
    assert toy.call("GetFloat64", component, None, c_size_t(1), room, c_size_t(1)) == ERROR
    assert toy.call("SetFloat64", component, byref(c_uint32(9)), c_size_t(1), None, c_size_t(2)) == ERROR
    assert toy.outputs(component) == before
    toy.free(component)


def test_a_call_is_checked_wherever_it_differs_from_the_last_one(toy: Any) -> None:
    component, vr = toy.initialized(), {name: item.valueReference for name, item in toy.known.items()}
    room = array(c_double, *range(1, 9))

    def status(function: Any, second: Any, size: Any, first: str = "force") -> Any:
        references = array(c_uint32, vr[first], vr.get(second, 4_000_000_000))
        return toy.call(function, component, references, c_size_t(2), room, c_size_t(size))

    for _ in range(3):
        assert [status("GetFloat64", "oscillators.position", size) for size in (4, 4, 3, 5)] == [OK, OK, ERROR, ERROR]
        assert [status("GetFloat64", name, 3) for name in ("mass", "wish", "nothing")] == [OK, ERROR, ERROR]
        assert [status("SetFloat64", "divisor", size) for size in (3, 3, 2)] == [OK, OK, ERROR]
        assert [status("SetFloat64", name, 3) for name in ("angle", "mass", "nothing")] == [ERROR, ERROR, ERROR]
        assert [status("SetFloat64", "stiffness", size, "divisor") for size in (2, 2, 3)] == [OK, OK, ERROR]
    toy.free(component)


def test_any_number_of_values_in_one_call(toy: Any) -> None:
    component, names = toy.initialized(), ("oscillators.position", "mass", "time")
    expected = [value for name in names for value in toy.get(component, name)]
    for count in (1, 24, 25, 100, 2):
        references = array(c_uint32, *[toy.known[name].valueReference for name in names] * count)
        values = (c_double * (4 * count))()
        for _ in range(2):
            sizes = (c_size_t(3 * count), values, c_size_t(4 * count))
            assert toy.call("GetFloat64", component, references, *sizes) == OK
            assert list(values) == expected * count
        inputs = array(c_uint32, *[toy.known["force"].valueReference] * count)
        numbers = array(c_double, *range(2 * count))
        assert toy.call("SetFloat64", component, inputs, c_size_t(count), numbers, c_size_t(2 * count)) == OK
        assert toy.get(component, "force") == [2 * count - 2, 2 * count - 1]
    toy.free(component)


@pytest.mark.parametrize(("name", "value"), [("mass", 0.0), ("mass", math.nan), ("stiffness", math.inf), ("seed", -1)])
def test_a_parameter_out_of_range_is_refused(toy: Any, name: Any, value: Any) -> None:
    component = toy.instantiate()
    assert toy.set(component, name, value) == ERROR
    assert f"{name} = " in toy.messages[-1][2]
    assert "is not in [" in toy.messages[-1][2]
    toy.free(component)


def test_a_refused_set_changes_none_of_its_values(toy: Any) -> None:
    component = toy.initialized()
    references = array(c_uint32, toy.known["force"].valueReference, toy.known["mass"].valueReference)
    values = array(c_double, 5.0, 6.0, 3.0)
    assert toy.call("SetFloat64", component, references, c_size_t(2), values, c_size_t(3)) == ERROR
    assert toy.get(component, "force") == [0.0, 0.0]
    toy.free(component)


def test_several_variables_in_one_call(toy: Any) -> None:
    component = toy.initialized()
    references = array(c_uint32, toy.known["oscillators.position"].valueReference, toy.known["time"].valueReference)
    values = (c_double * 3)()
    assert toy.call("GetFloat64", component, references, c_size_t(2), values, c_size_t(3)) == OK
    assert list(values) == [0.1, -0.2, 0.0]
    toy.free(component)


@pytest.mark.parametrize(
    ("time", "size", "words"),
    [
        (0.0, 0.0, "is not in (0, 3600] s"),
        (0.0, math.nan, "is not in (0, 3600] s"),
        (1.0, 0.01, "called at 1.000000000 s, but the FMU is at 0.000000000 s"),
        (math.inf, 0.01, "is no time"),
    ],
)
def test_a_wrong_step_is_refused_and_the_next_one_goes_on(toy: Any, time: Any, size: Any, words: Any) -> None:
    component = toy.initialized()
    assert toy.step(component, time, size) == ERROR
    assert words in toy.messages[-1][2]
    assert [item.value for item in toy.reported] == [False, False, False, 0.0]
    assert toy.step(component, 0.0) == OK
    assert [item.value for item in toy.reported] == [False, False, False, 0.01]
    assert toy.step(component, 0.01, 1e-12) == OK
    assert toy.get(component, "count") == [1]
    toy.free(component)


def test_a_step_beyond_the_stop_time_is_an_error(toy: Any) -> None:
    component = toy.instantiate()
    assert toy.enter(component, 7.5, 7.52) == OK
    assert toy.call("ExitInitializationMode", component) == OK
    assert toy.step(component, 7.5) == OK
    assert toy.step(component, 7.51, 0.02) == ERROR
    assert "beyond the stop time" in toy.messages[-1][2]
    assert toy.reported[-1].value == 7.51
    assert toy.step(component, 7.51) == OK
    assert toy.step(component, 7.52, 2e-6) == ERROR
    assert toy.get(component, "count") == [2]
    toy.free(component)


def test_times_of_the_experiment_are_checked(toy: Any) -> None:
    component = toy.instantiate()
    assert toy.enter(component, math.nan) == ERROR
    assert toy.enter(component, 1.0, 0.5) == ERROR
    assert "is not after start time" in toy.messages[-1][2]
    assert toy.enter(component, 7.5, 9.0) == OK
    assert toy.get(component, "time") == [7.5]
    toy.free(component)


def test_log_categories(toy: Any) -> None:
    component = toy.instantiate(logging=False)
    assert toy.call("SetDebugLogging", component, c_bool(True), c_size_t(1), (ctypes.c_char_p * 1)(b"logAll")) == OK
    wrong = (ctypes.c_char_p * 1)(b"nonsense")
    assert toy.call("SetDebugLogging", component, c_bool(True), c_size_t(1), wrong) == ERROR
    assert toy.messages[-1][2] == "no log category nonsense"
    toy.free(component)


def run_on(toy: Any, component: Any, count: Any, first: Any = 0) -> Any:
    for k in range(first, first + count):
        toy.set(component, "force", [math.sin(0.3 * k), 0.0])
        assert toy.step(component, 0.01 * k) == OK
    return toy.outputs(component)


def test_a_state_is_restored_and_goes_on_in_another_instance(toy: Any) -> None:
    component, other = toy.initialized(), toy.instantiate(b"other")
    run_on(toy, component, 30)
    state, size, restored = c_void_p(None), c_size_t(), c_void_p(None)
    assert toy.call("GetFMUState", component, byref(state)) == OK
    expected = run_on(toy, component, 30, first=30)
    assert toy.call("SerializedFMUStateSize", component, state, byref(size)) == OK
    content = ctypes.create_string_buffer(size.value)
    assert toy.call("SerializeFMUState", component, state, content, size) == OK
    assert toy.call("DeserializeFMUState", other, content, size, byref(restored)) == OK
    for instance, saved in ((component, state), (other, restored)):
        assert toy.call("SetFMUState", instance, saved) == OK
        assert run_on(toy, instance, 30, first=30) == expected
        assert toy.call("FreeFMUState", instance, byref(saved)) == OK
        assert saved.value is None
        toy.free(instance)


def test_damaged_bytes_are_no_state(toy: Any) -> None:
    component = toy.initialized()
    state, size, nothing = c_void_p(None), c_size_t(), c_void_p(None)
    toy.call("GetFMUState", component, byref(state))
    toy.call("SerializedFMUStateSize", component, state, byref(size))
    content = ctypes.create_string_buffer(size.value)
    toy.call("SerializeFMUState", component, state, content, size)
    source = random.Random(4)
    for _ in range(100):
        damaged = bytearray(content.raw)
        damaged[source.randrange(len(damaged))] ^= 1 << source.randrange(8)
        buffer = ctypes.create_string_buffer(bytes(damaged), len(damaged))
        assert toy.call("DeserializeFMUState", component, buffer, size, byref(nothing)) == ERROR
    assert nothing.value is None
    assert toy.call("SetFMUState", component, None) == ERROR
    assert toy.call("GetFMUState", component, None) == ERROR
    assert toy.call("DeserializeFMUState", component, content, c_size_t(10), byref(nothing)) == ERROR
    toy.call("FreeFMUState", component, byref(state))
    toy.free(component)


def test_the_same_state_has_the_same_bytes(toy: Any) -> None:
    """Memory between the fields of a struct is not part of a state."""
    found = []
    for _ in range(3):
        component, state, size = toy.initialized(), c_void_p(None), c_size_t()
        run_on(toy, component, 20)
        toy.call("GetFMUState", component, byref(state))
        toy.call("SerializedFMUStateSize", component, state, byref(size))
        content = ctypes.create_string_buffer(size.value)
        assert toy.call("SerializeFMUState", component, state, content, size) == OK
        found.append(content.raw)
        toy.call("FreeFMUState", component, byref(state))
        toy.free(component)
    assert found[0] == found[1] == found[2]
