"""The PythonFMU behaves like its model, to the bit, and keeps to FMI 2.0."""

import random
import struct
from pathlib import Path
from typing import Any

import fmpy
import pytest

from fmus.contents.variables import fmi_variables
from modelkit.variables import constructor, flatten, variables
from tests.fmi.host import DISCARD, OK, Host, random_inputs

STEPS = [0.01] * 40 + [0.001, 0.02, 0.0133, 0.005] * 10


def bits(values: Any) -> Any:
    return [struct.pack("d", value) if isinstance(value, float) else value for value in values]


def in_process(model: Any, inputs: Any, steps: Any) -> Any:
    """Return the outputs of the model's own functions at every communication point."""
    make = constructor(model.inputs)
    params = model.params()
    state, outputs = model.initialize(params)
    found, time = [flatten(outputs)], 0.0
    names = [variable.name for variable in variables(model.inputs)]
    for size, values in zip(steps, inputs, strict=True):
        dt_ns = round((time + size) * 1e9) - round(time * 1e9)
        state, outputs = model.step(state, make([values[name] for name in names]), params, dt_ns)
        found.append(flatten(outputs))
        time += size
    return found


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.release)])
def test_equals_the_model_in_process_to_the_bit(python_fmus: Any, model: Any, seed: int) -> None:
    inputs = random_inputs(fmi_variables(model), seed, len(STEPS))
    expected = in_process(model, inputs, STEPS)
    with Host(python_fmus[model.name]) as host:
        host.initialize()
        assert bits(host.outputs()) == bits(expected[0])
        time = 0.0
        for number, (size, values) in enumerate(zip(STEPS, inputs, strict=True), start=1):
            host.set(values)
            assert host.step(time, size) == OK
            time += size
            assert bits(host.outputs()) == bits(expected[number])
        assert host.get(["time"]) == [time]
        assert host.log == []


def test_values_read_one_by_one_equal_values_read_at_once(python_fmus: Any, model: Any) -> None:
    with Host(python_fmus[model.name]) as host:
        host.initialize()
        host.step(0.0, 0.01)
        names = list(host.refs)
        assert bits(host.get(names)) == bits([host.get([name])[0] for name in names])


def test_start_values_are_those_of_the_description(python_fmus: Any, model: Any) -> None:
    with Host(python_fmus[model.name]) as host:
        known = [v for v in host.description.modelVariables if v.start is not None]
        convert: dict[str, Any] = {"Real": float, "Integer": int, "Boolean": lambda text: text == "true"}
        expected = [convert[v.type](v.start) for v in known]
        assert host.get([v.name for v in known]) == expected


def test_simulates_alone_and_gives_the_reference_result(python_fmus: Any, model: Any, tmp_path: Path) -> None:
    fmpy.extract(str(python_fmus[model.name]), str(tmp_path))
    reference = fmpy.util.read_csv(tmp_path / f"extra/org.fmi-standard.fmi-ls-ref/{model.name}_out.csv")
    stop, interval = reference["time"][-1], reference["time"][1]
    names = list(reference.dtype.names[1:])
    result = fmpy.simulate_fmu(
        str(python_fmus[model.name]), stop_time=stop, step_size=model.step_size, output_interval=interval, output=names
    )
    assert len(result) == len(reference) > 50
    for name in names:
        assert result[name] == pytest.approx(reference[name], rel=1e-9, abs=1e-9), name


def test_outputs_follow_parameters_in_initialization_mode(python_fmus: Any) -> None:
    with Host(python_fmus["Toy"]) as host:
        host.fmu.setupExperiment()
        host.fmu.enterInitializationMode()
        assert host.get(["oscillators[1].position"]) == [0.1]
        host.set({"start[1].position": 0.7})
        assert host.get(["oscillators[1].position"]) == [0.7]
        host.set({"start[1].position": 0.9})
        host.fmu.exitInitializationMode()
        assert host.get(["oscillators[1].position"]) == [0.9]
        assert host.step(0.0, 1e-9) == OK
        assert host.get(["oscillators[1].position"])[0] == pytest.approx(0.9)


def test_reset_gives_a_new_instance(python_fmus: Any, model: Any) -> None:
    inputs = random_inputs(fmi_variables(model), 3, 20)
    with Host(python_fmus[model.name]) as host:
        runs = []
        for _ in range(3):
            host.initialize()
            for number, values in enumerate(inputs):
                host.set(values)
                assert host.step(number * 0.01, 0.01) == OK
            runs.append(bits(host.outputs()))
            host.fmu.terminate()
            host.fmu.reset()
        assert runs[0] == runs[1] == runs[2]


def test_a_long_step_is_honoured_and_a_bad_one_refused(python_fmus: Any) -> None:
    with Host(python_fmus["Toy"]) as host:
        host.initialize()
        assert host.step(0.0, 1.5) == OK
        assert host.get(["time"]) == [1.5]
        before = host.outputs()
        for size in (-0.01, float("nan"), float("inf")):
            assert host.step(1.5, size) == DISCARD
        assert host.outputs() == before
        assert host.step(1.5, 0.01) == OK


@pytest.mark.parametrize("start", [0.0, 7.5])
def test_a_step_beyond_the_stop_time_is_refused(python_fmus: Any, start: float) -> None:
    with Host(python_fmus["Toy"]) as host:
        host.initialize(start, stop=start + 0.02)
        assert host.step(start, 0.01) == OK
        before = host.outputs()
        assert host.step(start + 0.01, 0.02) == DISCARD
        assert "beyond the stop time" in host.log[-1][2]
        assert host.outputs() == before
        assert host.step(start + 0.01, 0.01 + 9e-7) == OK
        assert host.step(start + 0.02, 0.01) == DISCARD
        host.fmu.terminate()
        host.fmu.reset()
        host.initialize(start)
        assert host.step(start, 1.0) == OK


@pytest.mark.parametrize(("start", "stop"), [(float("nan"), None), (1.0, 0.5), (0.0, float("nan")), (1e300, None)])
def test_times_of_the_experiment_are_checked(python_fmus: Any, start: float, stop: float | None) -> None:
    with Host(python_fmus["Toy"]) as host:
        host.initialize(start, stop=stop)
        assert host.step(0.0, 0.01) == DISCARD
        assert host.log


@pytest.mark.parametrize("size", [1e-12, 4e-10, 5e-324])
def test_a_last_step_under_half_a_nanosecond_is_ok_and_does_nothing(python_fmus: Any, size: float) -> None:
    """A master that adds up t += h makes one at the end."""
    with Host(python_fmus["Toy"]) as host:
        host.initialize()
        for k in range(3):
            assert host.step(k * 0.01, 0.01) == OK
        before = host.outputs()
        assert host.step(0.03, size) == OK
        assert host.outputs() == before
        assert host.log == []
        assert host.step(0.03, 0.01) == OK


@pytest.mark.parametrize("form", ["memory", "bytes", "other instance"])
def test_a_restored_state_continues_to_the_same_bits(python_fmus: Any, model: Any, form: str) -> None:
    inputs = random_inputs(fmi_variables(model), 4, 60)

    def run(host: Any, begin: Any, end: Any) -> Any:
        found = []
        for number in range(begin, end):
            host.set(inputs[number])
            assert host.step(number * 0.01, 0.01) == OK
            found.append(bits(host.outputs()) + bits(host.get(["time"])))
        return found

    with Host(python_fmus[model.name]) as host, Host(python_fmus[model.name], "other") as other:
        host.initialize()
        run(host, 0, 30)
        state = host.fmu.getFMUstate()
        content = host.fmu.serializeFMUstate(state)
        expected = run(host, 30, 60)
        if form == "memory":
            host.fmu.setFMUstate(state)
            assert run(host, 30, 60) == expected
        else:
            target = host if form == "bytes" else other
            copy = target.fmu.deSerializeFMUstate(content)
            target.fmu.setFMUstate(copy)
            target.fmu.freeFMUstate(copy)
            assert run(target, 30, 60) == expected
            state_again = target.fmu.getFMUstate()
            assert len(target.fmu.serializeFMUstate(state_again)) > 0
            target.fmu.freeFMUstate(state_again)
        host.fmu.freeFMUstate(state)


def test_a_state_saved_before_initialization_takes_parameters_again(python_fmus: Any) -> None:
    with Host(python_fmus["Toy"]) as host:
        fresh = host.fmu.getFMUstate()
        host.initialize(**{"start[1].position": 0.5})
        host.step(0.0, 0.01)
        host.fmu.setFMUstate(fresh)
        host.fmu.freeFMUstate(fresh)
        host.initialize(**{"start[1].position": 0.6})
        assert host.get(["oscillators[1].position"]) == [0.6]
        assert host.step(0.0, 0.01) == OK


def test_instances_do_not_touch_each_other(python_fmus: Any) -> None:
    path = python_fmus["Toy"]
    source = random.Random(5)
    with Host(path, "a") as a, Host(path, "b") as b:
        a.initialize()
        b.initialize(seed=8)
        for number in range(30):
            a.set({"force[1]": source.uniform(-1.0, 1.0)})
            assert a.step(number * 0.01, 0.01) == OK
            if number % 3 == 0:
                assert b.step(number // 3 * 0.01, 0.01) == OK
        assert a.get(["count"]) == [30]
        assert b.get(["count"]) == [10]
        assert b.get(["oscillators[1].position"]) != a.get(["oscillators[1].position"])
