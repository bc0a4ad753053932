"""Wrong calls on a native FMU: refused with fmi2Error and a message, nothing changed; state saved and restored."""

import ctypes
import math
import random
from ctypes import byref, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import Any

import pytest

from tests.fmi.raw import DISCARD, ERROR, OK, Library, array, state_pointer

NO_REFERENCE = 4_000_000_000


@pytest.fixture
def toy(native_fmus: Any, tmp_path: Path) -> Any:
    return Library(native_fmus["Toy"], tmp_path)


def test_version_and_platform(toy: Any) -> None:
    assert toy.dll.fmi2GetVersion() == b"2.0"
    assert toy.dll.fmi2GetTypesPlatform() == b"default"


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"name": b""}, "needs a name"),
        ({"name": None}, "needs a name"),
        ({"kind": 0}, "co-simulation only"),
        ({"guid": b"{another}"}, "GUID {another} is not that of this binary"),
        ({"guid": b"100%d %s %n"}, "GUID 100%%d %%s %%n is not"),
        ({"guid": b""}, "GUID (null)"),
    ],
)
def test_instantiate_refuses_and_says_why(toy: Any, wrong: Any, words: str) -> None:
    assert toy.instantiate(**wrong) is None
    (status, category, text) = toy.messages[-1]
    assert (status, category) == (ERROR, "logStatusError")
    assert words in text


def test_instantiate_without_callbacks_gives_nothing(toy: Any) -> None:
    assert toy.instantiate(callbacks=False) is None


PHASES = ("instantiated", "initialization", "stepping", "terminated")
ALLOWED = {
    "SetupExperiment": ("instantiated",),
    "EnterInitializationMode": ("instantiated",),
    "ExitInitializationMode": ("initialization",),
    "DoStep": ("stepping",),
    "Terminate": ("stepping",),
    "Reset": PHASES,
    "GetReal": ("initialization", "stepping", "terminated"),
    "GetInteger": ("initialization", "stepping", "terminated"),
    "GetBoolean": ("initialization", "stepping", "terminated"),
    "SetReal": ("instantiated", "initialization", "stepping"),
    "SetInteger": ("instantiated", "initialization", "stepping"),
    "SetBoolean": ("instantiated", "initialization", "stepping"),
    "GetFMUstate": PHASES,
    "SetDebugLogging": PHASES,
    "CancelStep": (),
}


def in_phase(toy: Any, phase: Any) -> Any:
    component = toy.instantiate()
    if phase == "instantiated":
        return component
    toy.setup(component)
    toy.call("EnterInitializationMode", component)
    if phase in ("stepping", "terminated"):
        toy.call("ExitInitializationMode", component)
    if phase == "terminated":
        toy.call("Terminate", component)
    return component


def call(toy: Any, function: Any, component: Any) -> Any:
    if function == "SetupExperiment":
        return toy.setup(component)
    if function == "DoStep":
        return toy.step(component, 0.0)
    if function == "GetFMUstate":
        state = state_pointer()
        status = toy.call(function, component, byref(state))
        toy.call("FreeFMUstate", component, byref(state))
        return status
    if function == "SetDebugLogging":
        return toy.call(function, component, 1, c_size_t(0), None)
    if function[3:] in ("Real", "Integer", "Boolean"):
        return toy.call(function, component, None, c_size_t(0), None)
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


def test_wrong_references_types_and_directions(toy: Any) -> None:
    component = toy.initialized()
    one, number, flag = c_size_t(1), byref(c_double()), byref(c_int())
    before = toy.outputs(component)

    def refused(function: Any, reference: Any, value: Any, words: Any) -> None:
        assert toy.call(function, component, byref(c_uint(reference)), one, value) == ERROR
        assert words in toy.messages[-1][2]

    refused("GetReal", NO_REFERENCE, number, "no value reference 4000000000; the last is")
    refused("GetReal", toy.refs["wish"], number, f"wish (value reference {toy.refs['wish']}) is Integer")
    refused("GetBoolean", toy.refs["mass"], flag, "mass (value reference 1) is Real")
    refused("SetReal", toy.refs["angle"], number, "angle is calculated by the FMU")
    refused("SetReal", toy.refs["time"], number, "time is calculated by the FMU")
    refused("SetReal", toy.refs["mass"], number, "parameter mass is fixed after initialization")
    assert toy.call("GetReal", component, None, one, number) == ERROR
    assert toy.call("SetReal", component, byref(c_uint(8)), one, None) == ERROR
    assert toy.call("GetString", component, byref(c_uint(8)), one, None) == ERROR
    assert toy.call("SetString", component, None, c_size_t(0), None) == OK
    assert toy.outputs(component) == before
    toy.free(component)


def test_a_call_is_checked_wherever_it_differs_from_the_last_one(toy: Any) -> None:
    component, two = toy.initialized(), c_size_t(2)
    force, velocity = toy.refs["force[1]"], toy.refs["oscillators[2].velocity"]
    references, values = array(c_uint, toy.refs["pull"], velocity), (c_double * 2)()
    known = {"Get": [velocity, toy.refs["mass"], force], "Set": [toy.refs["force[2]"]]}
    wrong = {"Get": [NO_REFERENCE, toy.refs["wish"]], "Set": [NO_REFERENCE, toy.refs["angle"], toy.refs["mass"]]}
    for verb in ("Get", "Set", "Get"):
        references[0] = force if verb == "Set" else toy.refs["pull"]
        for _ in range(3):
            for reference in known[verb]:
                references[1], values[0], values[1] = reference, 1.5, 2.5
                assert toy.call(f"{verb}Real", component, references, two, values) == OK
                assert values[1] == toy.number(component, reference)
            for reference in wrong[verb]:
                references[1], values[0] = reference, 99.0
                assert toy.call(f"{verb}Real", component, references, two, values) == ERROR
    assert (toy.get(component, "force[1]"), toy.get(component, "force[2]")) == (1.5, 2.5)
    toy.free(component)


def test_parameters_keep_their_limits_however_often_they_are_set(toy: Any) -> None:
    component = toy.initialized()
    for value, status in [(50.0, OK), (60.0, OK), (-1.0, ERROR), (60.0, OK), (math.nan, ERROR), (2e4, ERROR)]:
        assert toy.set(component, "stiffness", value) == status
    assert toy.get(component, "stiffness") == 60.0
    toy.free(component)


def test_any_number_of_values_in_one_call(toy: Any) -> None:
    component, names = toy.initialized(), ("mass", "oscillators[1].position", "oscillators[2].position", "time")
    expected = [toy.get(component, name) for name in names]
    for count in (0, 1, 24, 25, 100, 3):
        references, values = array(c_uint, *[toy.refs[name] for name in names] * count), (c_double * (4 * count))()
        for _ in range(2):
            assert toy.call("GetReal", component, references, c_size_t(4 * count), values) == OK
            assert list(values) == expected * count
        inputs, numbers = array(c_uint, *[toy.refs["force[1]"]] * 4 * count), array(c_double, *range(4 * count))
        assert toy.call("SetReal", component, inputs, c_size_t(4 * count), numbers) == OK
        assert toy.get(component, "force[1]") == (4 * count - 1 if count else 0.0)
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
    references = array(c_uint, toy.refs["force[1]"], toy.refs["mass"])
    assert toy.call("SetReal", component, references, c_size_t(2), array(c_double, 5.0, 3.0)) == ERROR
    assert toy.get(component, "force[1]") == 0.0
    toy.free(component)


@pytest.mark.parametrize(
    ("time", "size", "words"),
    [
        (0.0, 0.0, "is not in (0, 3600] s"),
        (0.0, -0.01, "is not in (0, 3600] s"),
        (0.0, math.nan, "is not in (0, 3600] s"),
        (0.0, 1e300, "is not in (0, 3600] s"),
        (1.0, 0.01, "called at 1.000000000 s, but the FMU is at 0.000000000 s"),
        (math.inf, 0.01, "is no time"),
        (math.nan, 0.01, "is no time"),
    ],
)
def test_a_wrong_step_is_refused_and_the_next_one_goes_on(toy: Any, time: Any, size: Any, words: Any) -> None:
    component = toy.initialized()
    assert toy.step(component, time, size) == ERROR
    assert words in toy.messages[-1][2]
    assert toy.step(component, 0.0) == OK
    assert toy.get(component, "count") == 1
    toy.free(component)


@pytest.mark.parametrize("size", [1e-12, 4e-10, 5e-324])
def test_a_step_that_ends_before_the_next_nanosecond_does_nothing(toy: Any, size: float) -> None:
    component = toy.initialized()
    toy.step(component, 0.0)
    before = toy.outputs(component)
    assert toy.step(component, 0.01, size) == OK
    assert toy.step(component, 0.01 - 9e-7, 5e-7) == OK
    assert (toy.outputs(component), toy.get(component, "time")) == (before, 0.01)
    assert toy.messages == []
    assert toy.step(component, 0.01, 6e-10) == OK
    assert toy.get(component, "count") == 2
    toy.free(component)


def test_a_master_that_adds_up_its_steps_reaches_the_end(toy: Any) -> None:
    component = toy.initialized()
    time, stop = 0.0, 0.6
    while time < stop:
        size = min(0.01, stop - time)
        assert toy.step(component, time, size) == OK
        time += size
    assert toy.get(component, "time") == pytest.approx(stop)
    toy.free(component)


def test_times_of_the_experiment_are_checked(toy: Any) -> None:
    component = toy.instantiate()
    assert toy.setup(component, math.nan) == ERROR
    assert toy.call("SetupExperiment", component, 0, c_double(0), c_double(1), 1, c_double(0.5)) == ERROR
    assert "is not after start time" in toy.messages[-1][2]
    toy.free(component)


def with_stop(toy: Any, start: float, stop: float) -> Any:
    component = toy.instantiate()
    assert toy.call("SetupExperiment", component, 0, c_double(0), c_double(start), 1, c_double(stop)) == OK
    assert toy.call("EnterInitializationMode", component) == toy.call("ExitInitializationMode", component) == OK
    return component


@pytest.mark.parametrize("start", [0.0, 7.5])
def test_a_step_beyond_the_stop_time_is_an_error(toy: Any, start: float) -> None:
    component = with_stop(toy, start, start + 0.02)
    assert toy.step(component, start) == OK
    assert toy.step(component, start + 0.01, 0.02) == ERROR
    assert "beyond the stop time" in toy.messages[-1][2]
    assert toy.get(component, "count") == 1
    assert toy.step(component, start + 0.01, 0.01 + 9e-7) == OK
    assert toy.step(component, start + 0.02) == ERROR
    assert toy.get(component, "count") == 2
    toy.free(component)


def test_the_stop_time_belongs_to_the_experiment(toy: Any) -> None:
    component = with_stop(toy, 0.0, math.inf)
    assert toy.step(component, 0.0, 3600.0) == OK
    assert toy.call("Reset", component) == OK
    toy.free(component)
    component = with_stop(toy, 0.0, 0.01)
    assert toy.call("Reset", component) == OK
    assert toy.setup(component) == OK
    assert toy.call("EnterInitializationMode", component) == toy.call("ExitInitializationMode", component) == OK
    assert toy.step(component, 0.0, 1.0) == OK
    toy.free(component)


def test_what_the_fmu_declares_that_it_cannot_do(toy: Any) -> None:
    component = toy.initialized()
    one = c_size_t(1)
    assert toy.call("SetRealInputDerivatives", component, None, one, None, None) == ERROR
    assert toy.call("GetRealOutputDerivatives", component, None, one, None, None) == ERROR
    assert toy.call("GetDirectionalDerivative", component, None, one, None, one, None, None) == ERROR
    assert toy.call("GetStatus", component, 0, byref(c_int())) == DISCARD
    assert toy.call("GetStringStatus", component, 1, byref(c_void_p())) == DISCARD
    assert toy.call("GetStatus", component, 0, None) == ERROR
    time, over = c_double(), c_int(7)
    toy.step(component, 0.0)
    assert toy.call("GetRealStatus", component, 2, byref(time)) == OK
    assert toy.call("GetBooleanStatus", component, 3, byref(over)) == OK
    assert (time.value, over.value) == (0.01, 0)
    toy.free(component)


def test_log_categories(toy: Any) -> None:
    component = toy.instantiate(logging=0)
    categories = (ctypes.c_char_p * 1)(b"logStatusWarning")
    assert toy.call("SetDebugLogging", component, 1, c_size_t(1), categories) == OK
    assert toy.call("SetDebugLogging", component, 1, c_size_t(1), (ctypes.c_char_p * 1)(b"nonsense")) == ERROR
    assert toy.messages[-1][2] == "no log category nonsense"
    toy.free(component)


def test_reset_starts_afresh(toy: Any) -> None:
    component = toy.initialized(mass=3.0)
    first = [toy.step(component, 0.01 * k) for k in range(20)] and toy.outputs(component)
    assert toy.call("Reset", component) == OK
    toy.setup(component)
    toy.call("EnterInitializationMode", component)
    assert toy.get(component, "mass") == 2.0
    assert toy.set(component, "mass", 3.0) == OK
    toy.call("ExitInitializationMode", component)
    assert [toy.step(component, 0.01 * k) for k in range(20)] == [OK] * 20
    assert toy.outputs(component) == first
    toy.free(component)


def test_a_parameter_set_in_initialization_mode_counts(toy: Any) -> None:
    component = toy.instantiate()
    toy.setup(component)
    toy.call("EnterInitializationMode", component)
    assert toy.get(component, "oscillators[1].position") == 0.1
    assert toy.set(component, "start[1].position", 0.5) == OK
    assert toy.get(component, "oscillators[1].position") == 0.5
    toy.free(component)


def save(toy: Any, component: Any) -> Any:
    state = state_pointer()
    assert toy.call("GetFMUstate", component, byref(state)) == OK
    return state


def run_on(toy: Any, component: Any, count: Any, first: Any = 0) -> Any:
    for k in range(first, first + count):
        toy.set(component, "force[1]", math.sin(0.3 * k))
        assert toy.step(component, 0.01 * k) == OK
    return toy.outputs(component)


def test_a_restored_state_goes_on_to_the_same_bits(toy: Any) -> None:
    component = toy.initialized()
    run_on(toy, component, 30)
    state = save(toy, component)
    expected = run_on(toy, component, 30, first=30)
    assert toy.call("SetFMUstate", component, state) == OK
    assert run_on(toy, component, 30, first=30) == expected
    again = c_void_p(state.value)
    assert toy.call("GetFMUstate", component, byref(again)) == OK
    assert again.value == state.value
    assert toy.call("FreeFMUstate", component, byref(state)) == OK
    assert state.value is None
    assert toy.call("FreeFMUstate", component, byref(state)) == OK
    toy.free(component)


def test_a_serialized_state_goes_on_in_another_instance(toy: Any) -> None:
    component, other = toy.initialized(), toy.instantiate(b"other")
    run_on(toy, component, 30)
    state, size = save(toy, component), c_size_t()
    assert toy.call("SerializedFMUstateSize", component, state, byref(size)) == OK
    content = ctypes.create_string_buffer(size.value)
    assert toy.call("SerializeFMUstate", component, state, content, size) == OK
    restored = state_pointer()
    assert toy.call("DeSerializeFMUstate", other, content, size, byref(restored)) == OK
    assert toy.call("SetFMUstate", other, restored) == OK
    assert run_on(toy, other, 30, first=30) == run_on(toy, component, 30, first=30)
    for instance, pointer in ((component, state), (other, restored)):
        toy.call("FreeFMUstate", instance, byref(pointer))
        toy.free(instance)


def test_damaged_or_foreign_bytes_are_no_state(toy: Any) -> None:
    component = toy.initialized()
    state, size, nothing = save(toy, component), c_size_t(), state_pointer()
    toy.call("SerializedFMUstateSize", component, state, byref(size))
    content = ctypes.create_string_buffer(size.value)
    assert toy.call("SerializeFMUstate", component, state, content, c_size_t(size.value - 1)) == ERROR
    toy.call("SerializeFMUstate", component, state, content, size)
    source = random.Random(4)
    for _ in range(200):
        damaged = bytearray(content.raw)
        damaged[source.randrange(len(damaged))] ^= 1 << source.randrange(8)
        buffer = ctypes.create_string_buffer(bytes(damaged), len(damaged))
        assert toy.call("DeSerializeFMUstate", component, buffer, size, byref(nothing)) == ERROR
    assert toy.call("DeSerializeFMUstate", component, content, c_size_t(10), byref(nothing)) == ERROR
    assert nothing.value is None
    assert toy.call("SetFMUstate", component, None) == ERROR
    assert toy.call("SetFMUstate", component, state) == OK
    toy.call("FreeFMUstate", component, byref(state))
    toy.free(component)
