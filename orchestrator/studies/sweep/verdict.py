"""The summary of many runs as columns: the numbers and verdicts of ``orchestrator.evaluation.verdict.summary``."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orchestrator.evaluation.verdict.conditions import CONDITIONS, share
from orchestrator.evaluation.verdict.measures import Measure
from orchestrator.evaluation.verdict.numbers import NUMBERS, SPEED, Metric, numbers, quantities_of
from orchestrator.evaluation.verdict.outcome import Ends, RequiredCheck, outcomes
from orchestrator.evaluation.verdict.truth import Bools, GroundTruth
from orchestrator.inputs.scenario.end_condition import state_word, states_of
from orchestrator.inputs.scenario.requirements import Requirement
from orchestrator.inputs.scenario.scenario import PENETRATION, Outcome, Scenario
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.job import Job
from orchestrator.studies.sweep.rows import (
    ABORTED,
    CLEARANCE_NUMBER,
    FIRST_MEASURE,
    last_words,
    limits_of_whole_runs,
    values_of,
)
from orchestrator.studies.sweep.study.imported_fmu import declare_signals

OUTCOMES: tuple[Outcome, ...] = ("parked", "not_parked", "failed", "aborted", "finished", "not_finished")


RESULTS = {
    **NUMBERS,
    "limit_share": Metric("1", "largest ratio of value to limit among the required checks; above 1: violated"),
}
"""Columns of results."""


class Verdict(NamedTuple):
    """Results of a chunk."""

    outcome: NDArray[np.int8]
    """Places in ``OUTCOMES``."""
    reason: list[str]
    numbers: dict[str, Array]
    """By the names of ``RESULTS``, those that this vehicle has."""

    def words(self) -> NDArray[Any]:
        """Return the outcomes as words."""
        return np.array(OUTCOMES)[self.outcome]


def judge(job: Job, truth: GroundTruth, rows: Array) -> Verdict:
    """Return the results of runs of ``job`` from what was kept of them; ``truth``: what is true in each."""
    return judge_rows(Scenario(**job.scenario), truth, job.measures, rows)


def judge_rows(scenario: Scenario, truth: GroundTruth, measures: Sequence[Measure], rows: Array) -> Verdict:
    """Return the results of runs that share a scenario's limits, from rows of ``measures``."""
    columns = rows[:, FIRST_MEASURE:].T
    found = dict(zip(measures, columns, strict=False))
    recorded = dict(zip(limits_of_whole_runs(scenario), columns[len(measures) :], strict=True))
    results = numbers(rows[:, 1] / 1e9, found, truth)
    for place, values in recorded.items():
        if scenario.requirements[place].signal in (PENETRATION, CLEARANCE_NUMBER):
            results[scenario.requirements[place].signal] = values
    has = truth.has() | quantities(scenario, results)
    shares = np.zeros(len(rows))
    asked: list[RequiredCheck] = []
    for place, limit in enumerate(scenario.requirements):
        if limit.required:
            values = recorded[place] if place in recorded else values_in(limit, results, found)
            is_asked = has[limit.where] if limit.where is not None else np.ones(len(rows), dtype=bool)
            bound = limit_value(limit)
            missed = is_asked & ~(CONDITIONS[limit.condition].margin(values, bound) >= 0.0)
            asked.append(RequiredCheck(limit.id, missed, np.isnan(values)))
            shares = np.maximum(shares, np.where(is_asked, share(limit.condition, values, bound), 0.0))
    mode, reason = (found[item] for item in last_words(scenario))
    broken = ["error" if end == ABORTED else "" for end in rows[:, 0].tolist()]
    named = declare_signals(scenario, scenario.stop_condition.signal, scenario.stop_condition.reason)
    judged = outcomes(scenario, Ends(broken, mode, reason, found[SPEED]), asked, *named)
    codes = np.array([OUTCOMES.index(outcome) for outcome, _ in judged], dtype=np.int8)
    return Verdict(codes, [why for _, why in judged], {**results, "limit_share": shares})


def quantities(scenario: Scenario, results: Mapping[str, Array]) -> dict[str, Bools]:
    """Return for each run whether its scenario has polygons, and anything in the scene at all."""
    nearest = results[CLEARANCE_NUMBER]
    there = quantities_of(scenario, {})
    scene = np.isfinite(nearest) | ("scene" in there)
    return {"obstacles": np.full(len(nearest), "obstacles" in there), "scene": scene}


def values_in(limit: Requirement, results: Mapping[str, Array], found: Mapping[Measure, Array]) -> Array:
    """Return the values that decide about a limit: a number of the summary, or the worst of a signal."""
    return results[limit.signal] if limit.signal in results else values_of(limit, found)


def limit_value(limit: Requirement) -> float:
    """Return the limit as a number, also where it is the name of a state."""
    if not isinstance(limit.limit, str):
        return limit.limit
    return float({name: value for value, name in states_of(limit.signal).items()}[state_word(limit.limit)])
