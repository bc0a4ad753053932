"""Step tests from file to verdict: stimuli, expectations, back-to-back, their place in ``apa test``."""

import math
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.read_log import read_log
from orchestrator.session.session import run_scenario
from orchestrator.testing.steptest.run import run_step_test
from orchestrator.testing.steptest.step_test import is_step_test, load_step_test
from orchestrator.testing.steptest.stimuli import StimulatedInput, stimulus
from tests.report.test_page import data_of
from vehicle_fmu.interface import VehicleInput

T = np.arange(0.0, 5.0, 0.5)
STEERING = """
title: The steering follows a step
model: vehicle
stop_time: 3 s
inputs:
  steering_active: true
  steering_wheel_request: {step: {at: 1 s, to: 180 deg}}
expect:
"""


@pytest.fixture
def write(tmp_path: Path) -> Any:
    def write(expect: Any, head: Any = STEERING, name: str = "steering.yaml") -> Any:
        path = tmp_path / name
        path.write_text(head + "".join(f"  - {line}\n" for line in expect), encoding="utf-8")
        return path

    return write


def place(tmp_path: Path, kind: Any = float, unit: str = "rad") -> Any:
    return StimulatedInput(Variable("angle", kind, Signal(unit, "angle"), 0), tmp_path / "test.yaml", "inputs.angle")


@pytest.mark.parametrize(
    ("given", "values"),
    [
        ("180 deg", [math.pi] * 10),
        ({"step": {"at": "2 s", "to": 1}}, [0] * 4 + [1] * 6),
        ({"ramp": {"begin": 1, "end": 3, "from": 1, "to": 5}}, [1, 1, 1, 2, 3, 4, 5, 5, 5, 5]),
        ({"pulse": {"at": 1, "width": 0.5, "to": 2}}, [0, 0, 2, 0, 0, 0, 0, 0, 0, 0]),
        ({"pulse": {"at": 1, "width": 0.5, "period": 1.5, "to": 2}}, [0, 0, 2, 0, 0, 2, 0, 0, 2, 0]),
        ({"sine": {"amplitude": 1, "frequency": "0.5 Hz", "begin": 1, "offset": 2}}, [2, 2, 2, 3, 2, 1, 2, 3, 2, 1]),
        ({"table": [[1, 0], [2, 4]]}, [0, 0, 0, 2, 4, 4, 4, 4, 4, 4]),
    ],
)
def test_shapes(tmp_path: Path, given: Any, values: Any) -> None:
    np.testing.assert_allclose(stimulus(given, place(tmp_path), T), values, atol=1e-12)


def test_truth_values_of_a_table_are_held(tmp_path: Path) -> None:
    found = stimulus({"table": [[0, False], [1.2, True], [3, False]]}, place(tmp_path, bool, "1"), T)
    assert found.tolist() == [0, 0, 0, 1, 1, 1, 0, 0, 0, 0]


def test_a_column_of_a_csv_file_with_a_row_of_units(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("time,a\ns,rad\n0,0\n2,4\n")
    found = stimulus({"csv": {"file": "in.csv", "column": "a"}}, place(tmp_path), T)
    np.testing.assert_allclose(found[:6], [0, 1, 2, 3, 4, 4])


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"stp": {"at": 1, "to": 1}}, "did you mean step"),
        ({"step": {"at": 1}}, "step: to is missing"),
        ({"step": {"at": 1, "too": 1}}, "did you mean to"),
        ({"step": {"at": "1 m", "to": 1}}, "is in 'm'"),
        ({"ramp": {"begin": 2, "end": 1, "to": 1}}, "begin is not before end"),
        ({"pulse": {"at": 1, "width": 2, "period": 1, "to": 1}}, "0 < width < period"),
        ({"table": [[2, 0], [1, 1]]}, "rise from row to row"),
        ({"table": 3}, "expected [[time, value], ...]"),
        ({"csv": {"file": "no.csv", "column": "a"}}, "no.csv: cannot be read"),
        ("3 m", "is in 'm'"),
    ],
)
def test_a_wrong_shape_says_what_would_be_right(tmp_path: Path, given: Any, said: str) -> None:
    with pytest.raises(BadInput) as error:
        stimulus(given, place(tmp_path), T)
    assert said in str(error.value)
    assert "inputs.angle" in str(error.value)


EXPECTATIONS = [
    ("{id: a, signal: steering_wheel_angle, always: {max_abs: 0.1 deg}, to: 1 s}", True, None),
    ("{id: a, signal: steering_wheel_angle, always: {max_abs: 0.1 deg}, to: 1.1 s}", False, 1.1),
    ("{id: a, signal: steering_wheel_angle, eventually: {min: 179 deg}}", True, None),
    (
        "{id: a, signal: steering_wheel_angle, eventually: {min: 179 deg}, within: 0.2 s, "
        "after: {signal: steering_wheel_request, min: 1 deg}}",
        False,
        1.2,
    ),
    (
        "{id: a, signal: steering_wheel_angle, hold: {max: 90 deg}, until: {signal: steering_wheel_request, min: 1}}",
        True,
        None,
    ),
    ("{id: a, signal: steering_wheel_angle, response: {rise_time: {max: 0.3 s}, to: 180 deg, at: 1 s}}", True, None),
    ("{id: a, signal: steering_wheel_angle, response: {rise_time: {max: 0.2 s}, to: 180 deg, at: 1 s}}", False, 1.0),
    ("{id: a, signal: steering_wheel_angle, response: {overshoot: {max: 1 %}, to: 180 deg, at: 1 s}}", True, None),
    ("{id: a, signal: gear, always: {equals: DRIVE}, after: {signal: prompt, equals: FORWARD}}", False, None),
    (
        "{id: a, signal: gear, always: {equals: DRIVE}, after: {signal: prompt, equals: FORWARD}, if_never: pass}",
        True,
        None,
    ),
]


@pytest.mark.parametrize(("expected", "passed", "t"), EXPECTATIONS)
def test_expectations(write: Any, expected: Any, passed: Any, t: Any) -> None:
    _, (check,) = run_step_test(load_step_test(write([expected])), "none")
    assert check.passed == passed
    if t is not None:
        assert check.t == pytest.approx(t)


def test_the_rise_is_that_of_the_rate_limit(write: Any) -> None:
    expected = "{id: a, signal: steering_wheel_angle, response: {rise_time: {max: 1 s}, to: 180 deg, at: 1 s}}"
    _, (check,) = run_step_test(load_step_test(write([expected])), "none")
    assert check.value == pytest.approx(0.8 * 180.0 / 570.0, abs=1e-3)


@pytest.mark.parametrize(
    ("expected", "said"),
    [
        ("{id: a, signal: steering_weel_angle, always: {max: 1}}", "did you mean steering_wheel_angle"),
        ("{id: a, signal: speed, always: {max: 1 deg}}", "is in 'deg'"),
        ("{id: a, signal: speed}", "exactly one of always, eventually, until, response"),
        ("{id: a, signal: speed, always: {max: 1, min: 0}}", "exactly one of max"),
        ("{id: a, signal: speed, until: {max: 1}}", "hold belong together"),
        ("{id: a, signal: speed, response: {rise: {max: 1}, to: 1}}", "exactly one of rise_time"),
        ("{id: a, signal: gear, always: {equals: DRIV}}", "did you mean"),
        ("{id: a, signal: speed, alway: {max: 1}}", "did you mean always"),
    ],
)
def test_a_wrong_expectation_says_what_would_be_right(write: Any, expected: str, said: str) -> None:
    with pytest.raises(BadInput) as error:
        run_step_test(load_step_test(write([expected])), "none")
    assert said in str(error.value)


def test_what_a_run_gave_the_controller_gives_the_same_outputs(write: Any, tmp_path: Path) -> None:
    scenario = load_scenario("guo2015-case4", ["stop_time=6"])
    run_scenario(scenario, log=tmp_path / "run.mcap")
    head = "model: controller\nstop_time: 6 s\nreplay: run.mcap\nreference: {log: run.mcap, abs: 0, rel: 0}\n"
    path = write([], head)
    _, checks = run_step_test(load_step_test(path), "none")
    assert len(checks) > 20
    assert [check.id for check in checks if not check.passed] == []
    _, checks = run_step_test(load_step_test(write([], head.replace("stop_time: 6 s", "stop_time: 3 s"))), "none")
    assert [check.id for check in checks if not check.passed] == []
    path = write([], head + "inputs: {measured_speed: 0}\n")
    _, checks = run_step_test(load_step_test(path), "none")
    assert any(not check.passed for check in checks)
    assert read_log(tmp_path / "run.mcap").signals["controller.phase"][-1] > 0


def test_back_to_back_with_another_implementation(write: Any) -> None:
    head = STEERING.replace("expect:", "reference: {model: vehicle, abs: 0, rel: 0}\nexpect:")
    _, checks = run_step_test(load_step_test(write(["{id: a, signal: speed, always: {max: 1}}"], head)), "native")
    assert all(check.passed for check in checks)
    assert len(checks) > len(VehicleInput._fields)


def test_a_model_of_ones_own(write: Any, tmp_path: Path) -> None:
    (tmp_path / "lag.py").write_text(
        '''"""A lag."""

import sys
from typing import Annotated, NamedTuple

from modelkit.model import Model
from modelkit.signal import Signal


class Params(NamedTuple):
    """What can be set."""

    lag: Annotated[float, Signal("s", "time constant", 0.01, 10.0)] = 0.5


class Input(NamedTuple):
    """What comes in."""

    u: Annotated[float, Signal("1", "wanted")] = 0.0


class Output(NamedTuple):
    """What goes out."""

    y: Annotated[float, Signal("1", "reached")] = 0.0


class State(NamedTuple):
    """What is remembered."""

    y: float = 0.0


def initialize(params: Params) -> tuple[State, Output]:
    """Return the start."""
    return State(), Output()


def step(state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    """Return one step later."""
    y = state.y + (inputs.u - state.y) * (dt_ns * 1e-9) / params.lag
    return State(y), Output(y)


MODEL = Model(
    name="Lag", description="A lag", package=sys.modules[__name__], state=State, params=Params, inputs=Input,
    outputs=Output, initialize=initialize, step=step, step_size=0.001, stop_time=5.0,
)
'''
    )
    head = "model: lag.py:MODEL\nstep: 1 ms\nstop_time: 5 s\nparameters: {lag: 0.4 s}\n"
    head += "inputs: {u: {step: {at: 1 s, to: 1}}}\nexpect:\n"
    line = "{id: a, signal: y, response: {rise_time: {max: 1 s}, to: 1, at: 1 s}}"
    _, (check,) = run_step_test(load_step_test(write([line], head)), "none")
    assert check.value == pytest.approx(0.4 * math.log(9.0), rel=2e-3)


def test_scenarios_are_no_step_tests(write: Any, tmp_path: Path) -> None:
    assert is_step_test(str(write(["{id: a, signal: speed, always: {max: 1}}"])))
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text("extends: guo2015-case4\n")
    assert not is_step_test(str(scenario))
    assert not is_step_test("guo2015-case4")


def test_apa_test_takes_them_beside_scenarios(write: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good = "{id: at rest before, signal: steering_wheel_angle, always: {max_abs: 0.1 deg}, to: 1 s}"
    bad = "{id: too fast, signal: steering_wheel_angle, response: {rise_time: {max: 0.2 s}, to: 180 deg, at: 1 s}}"
    out = tmp_path / "out"
    assert main(["test", str(write([good, bad])), "guo2015-case4", "--fmus", "none", "--out", str(out)]) == 1
    said = capsys.readouterr().out
    assert "0.253 s at 1.000 s, required" in said
    assert "1 of 2 scenarios passed" in said
    suites = {suite.get("name"): suite for suite in ElementTree.parse(out / "junit.xml").getroot()}
    assert (suites["steering"].get("tests"), suites["steering"].get("failures")) == ("2", "1")
    header, _ = data_of((out / "steering" / "report.html").read_text(encoding="utf-8"))
    assert header["verdict"] == {"text": "1 of 2 met", "kind": "bad"}
    assert [check["id"] for check in header["runs"][0]["checks"]] == ["too fast", "at rest before"]
    judged, request, *_ = header["plots"]
    assert judged["signals"] == ["vehicle.steering_wheel_angle"]
    assert judged["limits"] == pytest.approx([-math.radians(0.1), math.radians(0.1)]), "the rise time is no angle"
    assert request["signals"] == ["vehicle.steering_wheel_request"]
    assert "too fast" in (out / "index.html").read_text(encoding="utf-8")


def test_a_wrong_step_test_is_bad_input_of_its_own(
    write: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(["{id: a, signal: spee, always: {max: 1}}"])
    assert main(["test", str(path), "--fmus", "none", "--out", str(tmp_path / "out")]) == 2
    assert "did you mean speed" in capsys.readouterr().out
