"""The summary of many runs at once: the same numbers and verdicts as ``orchestrator.verdict.summary``, as columns."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from modelkit.variables import variables
from orchestrator.cosim.endings import FINAL_PHASES
from orchestrator.cosim.slave import Array
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.requirements import Requirement
from orchestrator.scenario.scenario import Scenario
from orchestrator.sweep.job import Chunk, Job
from orchestrator.sweep.rows import ABORTED, FIRST_MEASURE, PHASE, REASON, measure_of, recorded_limits
from orchestrator.verdict.conditions import CONDITIONS, share
from orchestrator.verdict.measures import Measure
from orchestrator.verdict.numbers import NUMBERS, Number, PoseTuple, numbers

OUTCOMES = ("parked", "not_parked", "failed", "aborted")
PARKED, NOT_PARKED, FAILED, ABORT = range(4)


RESULTS = {
    **NUMBERS,
    "limit_share": Number("1", "largest value over its limit among the required checks; above 1: beyond it"),
}
"""Columns of results."""


class Verdict(NamedTuple):
    """Results of a chunk."""

    outcome: NDArray[np.int8]
    """Places in ``OUTCOMES``."""
    reason: list[str]
    numbers: dict[str, Array]
    """By the names of ``RESULTS``, those that this vehicle has."""


def judge(job: Job, chunk: Chunk, rows: Array) -> Verdict:
    """Return the results of the runs of ``chunk`` from what was kept of them."""
    scenario = Scenario(**job.scenario)
    columns = rows[:, FIRST_MEASURE:].T
    found = dict(zip(job.measures, columns, strict=False))
    recorded = dict(zip(recorded_limits(scenario), columns[len(job.measures) :], strict=True))
    results = numbers(rows[:, 1] / 1e9, found, _targets(job, chunk, scenario))
    shares = np.zeros(len(rows))
    missed: list[tuple[str, NDArray[np.bool_]]] = []
    for place, limit in enumerate(scenario.limits):
        if limit.required:
            values = results[limit.signal] if limit.signal in results else _values(limit, place, found, recorded)
            bound = limit_value(limit)
            missed.append((limit.id, ~(CONDITIONS[limit.condition].margin(values, bound) >= 0.0)))
            shares = np.maximum(shares, share(limit.condition, values, bound))
    outcome, reason = _outcomes(rows[:, 0], found, missed)
    return Verdict(outcome, reason, {**results, "limit_share": shares})


def _values(limit: Requirement, place: int, found: dict[Measure, Array], recorded: dict[int, Array]) -> Array:
    measure = measure_of(limit)
    return recorded[place] if measure is None else found[measure]


def _targets(job: Job, chunk: Chunk, scenario: Scenario) -> list[PoseTuple]:
    """Return the target pose of every run."""
    starts = {item.name: float(item.start) for item in variables(MODELS["controller"].params)}
    given = {**starts, **scenario.controller}
    columns = []
    for axis in ("x", "y", "heading"):
        key = f"controller.target.{axis}"
        same = [float(given[f"target.{axis}"])] * len(chunk.seeds)
        columns.append(chunk.values[:, job.keys.index(key)].tolist() if key in job.keys else same)
    return list(zip(*columns, strict=True))


def limit_value(limit: Requirement) -> float:
    """Return the limit as a number, also where it is the name of a state."""
    if not isinstance(limit.limit, str):
        return limit.limit
    word = limit.limit.upper().replace(" ", "_").replace("-", "_")
    return float({name: value for value, name in _states(limit.signal).items()}[word])


def _outcomes(
    ends: Array, found: dict[Measure, Array], missed: list[tuple[str, NDArray[np.bool_]]]
) -> tuple[NDArray[np.int8], list[str]]:
    names, reasons = (_states(item.signal) for item in (PHASE, REASON))
    failing = np.any([miss for _, miss in missed], axis=0) if missed else np.zeros(len(ends), dtype=bool)
    outcome = np.full(len(ends), NOT_PARKED, dtype=np.int8)
    texts = []
    for row, (end, phase) in enumerate(zip(ends.tolist(), found[PHASE].tolist(), strict=True)):
        name = names.get(int(phase), f"{phase:g}") if phase == phase else "nan"
        if end == ABORTED:
            outcome[row], text = ABORT, "error"
        elif name == "FAILED":
            outcome[row], text = FAILED, reasons[int(found[REASON][row])].lower()
        elif name == "PARKED" and failing[row]:
            text = "beyond its limit: " + ", ".join(limit for limit, miss in missed if miss[row])
        elif name == "PARKED":
            outcome[row], text = PARKED, "all checks passed"
        else:
            text = name.lower() if name in FINAL_PHASES else f"stop time reached in {name.lower()}"
        texts.append(text)
    return outcome, texts


def _states(signal: str) -> dict[int, str]:
    owner, _, name = signal.partition(".")
    variable: Any = next(item for item in variables(MODELS[owner].outputs) if item.name == name)
    return {int(state): state.name for state in variable.signal.states}
