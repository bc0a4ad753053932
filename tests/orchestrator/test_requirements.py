"""Requirements as data: what a file may say, and what a run must do to meet it."""

import math
from enum import IntEnum
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.evaluation.verdict.judge import NEVER, _signal_names, judge
from orchestrator.evaluation.verdict.numbers import facts_of
from orchestrator.inputs.scenario.files import LIBRARY
from orchestrator.inputs.scenario.requirements import Requirement, read_requirements
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.recording import Recording

Phase = IntEnum("Phase", {"STANDBY": 0, "DRIVE": 1, "PARKED": 2})
T = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
SPEED = np.array([0.0, -1.0, -2.0, 0.5, 0.0])


def recording(speed: Any = SPEED, phase: Any = (0, 1, 1, 1, 2)) -> Recording:
    variables = {
        "vehicle.speed": Variable("speed", float, Signal("m/s", ""), 0.0),
        "controller.phase": Variable("phase", int, Signal("1", "", states=Phase), 0),
    }
    signals = {"vehicle.speed": np.asarray(speed, dtype=float), "controller.phase": np.asarray(phase, dtype=float)}
    return Recording((T * 1e9).astype(np.int64), signals, {}, variables)


def check(run: Any = None, **entry: Any) -> Any:
    run = recording() if run is None else run
    requirement = Requirement.model_validate({"id": "r", "signal": "vehicle.speed", "source": "test", **entry})
    return judge([requirement], run, facts_of(run, Scenario(name="here")), "file")[0]


@pytest.mark.parametrize(
    ("entry", "value", "t", "margin"),
    [
        ({"max": 1}, 0.5, 3.0, 0.5),
        ({"max": "1.8 km/h"}, 0.5, 3.0, 0.0),
        ({"max": 0.4}, 0.5, 3.0, -0.1),
        ({"min": -3}, -2.0, 2.0, 1.0),
        ({"min": "-1 m/s"}, -2.0, 2.0, -1.0),
        ({"max_abs": 2.5}, -2.0, 2.0, 0.5),
        ({"max_abs": 1.5}, -2.0, 2.0, -0.5),
        ({"max_abs": 0.6, "window": {"from": 3}}, 0.5, 3.0, 0.1),
        ({"max_abs": 0.6, "window": {"from": "2500 ms", "to": "4 s"}}, 0.5, 3.0, 0.1),
        ({"max_abs": 1.5, "window": {"to": 1}}, -1.0, 1.0, 0.5),
        ({"equals": 0, "window": {"at": "end"}}, 0.0, 4.0, 0.0),
        ({"equals": 0}, -2.0, 2.0, -2.0),
        ({"max_abs": 0.1, "window": {"phase": "STANDBY"}}, 0.0, 0.0, 0.1),
        ({"max_abs": 0.1, "window": {"phase": ["standby", "parked"]}}, 0.0, 0.0, 0.1),
        ({"min": -1.5, "window": {"phase": "drive", "from": 3}}, 0.5, 3.0, 2.0),
    ],
)
def test_worst_value_its_moment_and_margin(entry: Any, value: float, t: float, margin: float) -> None:
    found = check(**entry)
    assert (found.value, found.t) == (value, t)
    assert found.margin == pytest.approx(margin)
    assert found.passed == (margin >= 0.0)


AFTER = {"after": {"signal": "controller.phase", "equals": "DRIVE"}}


@pytest.mark.parametrize(
    ("entry", "value", "t"),
    [
        ({"max": 0.0, "window": AFTER}, 0.5, 3.0),
        ({"min": -1.5, "window": {**AFTER, "delay": "1 s"}}, -2.0, 2.0),
        ({"min": -1.5, "window": {**AFTER, "delay": "2.5 s"}}, 0.0, 4.0),
        ({"min": -1.5, "window": {**AFTER, "lasting": "0 s"}}, -1.0, 1.0),
        ({"max": -1.5, "ever": True}, -2.0, 2.0),
        ({"max": -1.5, "ever": True, "window": {"from": 3}}, 0.0, 4.0),
    ],
)
def test_windows_after_a_moment_and_once(entry: Any, value: Any, t: Any) -> None:
    found = check(**entry)
    assert (found.value, found.t) == (value, t)


def test_a_window_opens_each_time_a_moment_comes() -> None:
    run = recording(phase=(1, 0, 0, 1, 0))
    assert check(run, max_abs=1.0, window={**AFTER, "lasting": 0}).passed
    assert not check(run, max_abs=1.0, window={**AFTER, "lasting": "2 s"}).passed
    assert check(run, max_abs=1.0, window={"after": {"signal": "vehicle.speed", "min": "10 m/s"}}).note == NEVER
    with pytest.raises(BadInput, match=r"window\.after: vehicle\.sped: no signal of this name"):
        check(run, max_abs=1.0, window={"after": {"signal": "vehicle.sped", "min": 1}})
    with pytest.raises(BadInput, match="the limit is in m"):
        check(run, max_abs=1.0, window={"after": {"signal": "vehicle.speed", "min": "1 m"}})


@pytest.mark.parametrize(
    "window", [{"delay": 1}, {"lasting": 1}, {"after": {"signal": "x"}}, {"after": {"signal": "x", "max": 1, "min": 0}}]
)
def test_windows_that_mean_nothing_are_refused(window: Any) -> None:
    with pytest.raises(ValueError, match=r"count from after|exactly one of"):
        Requirement.model_validate({"id": "r", "signal": "s", "source": "t", "max": 1, "window": window})


def test_what_another_controller_does_not_put_out_opens_no_window() -> None:
    run = recording()
    assert not check(
        run, max_abs=9.0, window={"after": {"signal": "vehicle.driver_takeover", "equals": True}}
    ).evaluated


def test_states_by_name() -> None:
    at_end = {"signal": "controller.phase", "window": {"at": "end"}}
    parked = check(equals="PARKED", **at_end)
    assert parked.passed
    assert parked.note == "PARKED"
    assert not check(equals="drive", **at_end).passed
    with pytest.raises(BadInput, match="did you mean parked"):
        check(equals="Parkd", **at_end)


def test_numbers_of_the_summary() -> None:
    assert check(signal="duration", max="4 s").passed
    assert not check(signal="duration", max="3999 ms").passed
    assert check(signal="max_speed", max="7.2 km/h").margin == pytest.approx(0.0)
    with pytest.raises(BadInput, match="no window"):
        check(signal="duration", max=1, window={"at": "end"})


def test_a_number_of_the_summary_is_sought_in_no_model(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("orchestrator.evaluation.verdict.judge.apart_models", lambda: pytest.fail("imports all"))
    _signal_names.cache_clear()
    assert check(signal="duration", max=5.0).passed


def test_not_a_number_passes_nothing() -> None:
    broken = recording(speed=[0.0, math.nan, 0.0, 0.0, 0.0])
    found = check(broken, max=100)
    assert not found.passed
    assert found.t == 1.0
    assert found.note == "not a number"


def test_a_window_that_never_comes_fails_unless_told_otherwise() -> None:
    entry = {"max": 1, "window": {"from": 10}}
    assert not check(**entry).passed
    assert check(**entry).note == "the window never comes"
    assert check(max=1, window={"from": 10, "if_never": "pass"}).passed


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ({"max": "3 deg"}, "limit is in rad, the signal in m/s"),
        ({"max": "fast"}, "not a number"),
        ({"max": 1, "min": 0}, "exactly one of"),
        ({}, "exactly one of"),
        ({"max": 1, "window": {"from": 2, "to": 1}}, "is after"),
        ({"max": 1, "window": {"phase": "FLYING"}}, "expected one of"),
        ({"max": 1, "signal": "vehicle.sped"}, "did you mean vehicle.speed"),
        ({"max": "3 deg", "unit": "m"}, "not in m"),
    ],
)
def test_mistakes_are_named(entry: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        check(**entry)


def test_a_file_names_its_faulty_entry(tmp_path: Path) -> None:
    file = tmp_path / "r.yaml"
    file.write_text("- {id: a, signal: duration, max: 1 s, source: me}\n- {id: b, signal: duration, source: me}\n")
    with pytest.raises(BadInput, match=r"r\.yaml: requirement 2: b: exactly one of|requirement 2: .*exactly one of"):
        read_requirements(file)
    file.write_text("\n- {id: a, signal: duration, maximum: 1 s, source: me}\n")
    with pytest.raises(BadInput, match=r"r\.yaml:2: requirement 1: maximum: unknown; did you mean max"):
        read_requirements(file)
    file.write_text("a: 1\n")
    with pytest.raises(BadInput, match="expected a list"):
        read_requirements(file)


@pytest.mark.parametrize("file", sorted((LIBRARY / "requirements").glob("*.yaml")), ids=lambda path: path.stem)
def test_shipped_sets_can_be_read_and_survive_a_log(file: Any) -> None:
    for requirement in read_requirements(file):
        assert Requirement.model_validate(requirement.model_dump(mode="json")) == requirement
