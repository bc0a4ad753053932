"""Measures, conditions and summary numbers: one table each, the same for one run and for many."""

import math
from typing import Any, cast, get_args

import numpy as np
import pytest

from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.evaluation.verdict.conditions import CONDITIONS, share
from orchestrator.evaluation.verdict.measures import Instants, Measure, measure_recording
from orchestrator.evaluation.verdict.numbers import MEASURES, NUMBERS, OF_WHOLE_RUNS, POSE, facts_of, numbers
from orchestrator.evaluation.verdict.truth import GroundTruth, truth_of
from orchestrator.inputs.scenario.requirements import Condition
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.simulation.cosim.recording import Recording

VALUES = np.array([1.0, -3.0, 2.0])


def recording(values: np.ndarray, name: str = "vehicle.speed") -> Recording:
    t = np.arange(len(values)) * 1_000_000_000
    return Recording(t, {name: values}, {}, {name: Variable(name, float, Signal("m/s", ""), 0.0)})


@pytest.mark.parametrize(
    ("how", "value"),
    [("last", 2.0), ("largest", -3.0), ("greatest", 2.0), ("smallest", -3.0), ("travel", 9.0), ("first", 1.0)],
)
def test_measures(how: str, value: float) -> None:
    measure = Measure(how, "vehicle.speed")  # type: ignore[arg-type]
    assert measure_recording(measure, recording(VALUES)) == value
    assert measure_recording(Measure(how, "vehicle.mass"), recording(VALUES), 7.0) == 7.0  # type: ignore[arg-type]
    assert math.isnan(measure_recording(measure, recording(VALUES[:0])))


@pytest.mark.parametrize("how", ["largest", "greatest", "smallest", "travel"])
def test_not_a_number_is_the_worst_there_is(how: str) -> None:
    assert math.isnan(measure_recording(Measure(how, "vehicle.speed"), recording(np.array([1.0, math.nan, 5.0]))))  # type: ignore[arg-type]


def test_every_condition_is_in_the_table() -> None:
    assert tuple(CONDITIONS) == get_args(Condition)


@pytest.mark.parametrize(("condition", "limit"), [("max", 1.5), ("min", -1.0), ("max_abs", 2.5)])
def test_the_measure_of_a_condition_is_its_worst_value(condition: Condition, limit: float) -> None:
    rule = CONDITIONS[condition]
    assert rule.worst is not None
    worst = measure_recording(Measure(rule.worst, "vehicle.speed"), recording(VALUES))
    assert rule.margin(np.array([worst]), limit)[0] == rule.margin(VALUES, limit).min()


def test_share_of_a_limit_that_is_used() -> None:
    assert share("max_abs", np.array([-1.0, math.nan]), 2.0).tolist() == [0.5, math.inf]
    assert share("min", np.array([9.0]), 2.0).tolist() == [0.0]
    assert share("max", np.array([9.0]), 0.0).tolist() == [0.0]


def test_numbers_of_many_runs_are_those_of_each() -> None:
    rng = np.random.default_rng(1)
    found = {measure: rng.normal(size=5) for measure in MEASURES}
    true = GroundTruth(
        rng.normal(size=(5, 3)), rng.normal(size=(5, 5)), rng.normal(size=(5, 2, 4)), rng.normal(size=(5, 4))
    )
    whole = numbers(np.arange(5.0), found, true)
    assert list(whole) == list(NUMBERS)
    for row in range(5):
        own = {key: values[row : row + 1] for key, values in found.items()}
        alone = numbers(np.array([float(row)]), own, GroundTruth(*(part[row : row + 1] for part in true)))
        kept = [name for name in NUMBERS if name not in OF_WHOLE_RUNS]
        assert {name: alone[name][0] for name in kept} == {name: whole[name][row] for name in kept}
        assert all(np.isnan(alone[name]).all() for name in OF_WHOLE_RUNS)


def test_errors_are_seen_from_the_target() -> None:
    found = {measure: np.array([value]) for measure, value in zip(POSE, (1.0, 3.0, 0.5 * math.pi), strict=True)}
    there = Scenario(name="there", target={"x": 1.0, "y": 1.0, "heading": "90 deg"})  # type: ignore[arg-type]
    made = numbers(np.zeros(1), found, truth_of(there, {}))
    assert made["final.longitudinal_error"][0] == pytest.approx(2.0)
    assert made["final.lateral_error"][0] == pytest.approx(0.0)
    assert made["final.heading_error"][0] == 0.0


def test_what_the_models_do_not_have() -> None:
    made = facts_of(recording(VALUES), Scenario(name="here")).numbers
    assert made["max_speed"] == 3.0
    assert made["duration"] == 2.0
    assert math.isnan(made["manoeuvres"])
    assert math.isnan(made["min_clearance"])


def test_only_the_instants_that_count() -> None:
    run = recording(np.array([5.0, 1.0, -3.0, 2.0]))
    cast("dict[str, Any]", run.signals)["controller.phase"] = np.array([0.0, 2.0, 2.0, 3.0])
    meant = {"last": -3.0, "first": 1.0, "largest": -3.0, "greatest": 1.0, "smallest": -3.0, "travel": 4.0}
    for how, value in meant.items():
        assert measure_recording(Measure(how, "vehicle.speed", Instants("controller.phase", (2, 7))), run) == value  # type: ignore[arg-type]
        assert math.isnan(measure_recording(Measure(how, "vehicle.speed", Instants("controller.phase", (5,))), run))  # type: ignore[arg-type]
