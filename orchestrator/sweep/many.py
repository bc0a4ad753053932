"""Runs of which only a few numbers are kept, as compiled code where that is possible."""

import os
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from modelkit.variables import variables, with_values
from orchestrator.cosim.slave import Array
from orchestrator.scenario.end_condition import EndCondition
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.scenario import Scenario
from orchestrator.sweep.batch import compiled
from orchestrator.sweep.rows import FIRST_MEASURE
from orchestrator.verdict.measures import Measure
from orchestrator.verdict.truth import Truth, joined, truth_of


def parameter_row(scenario: Scenario) -> tuple[Array, dict[str, int], Array]:
    """Return all parameters as doubles, where each stands by name, and step, stop [ns] and decimations."""
    numbers: list[float] = []
    places: dict[str, int] = {}
    for owner, model in MODELS.items():
        values = with_values(model.params, dict(getattr(scenario, owner)))
        for variable in variables(model.params, values):
            places[f"{owner}.{variable.name}"] = len(numbers)
            numbers.append(float(variable.start))
    times = [scenario.step_ns, scenario.stop_ns, *(scenario.every.get(name, 1) for name in MODELS)]
    return np.array(numbers), places, np.array(times, dtype=np.int64)


def rows_of(parameters: Array, times: Array, kept: Sequence[Measure], ending: EndCondition) -> Array:
    """Return for each run how it ended, when [ns], and the ``kept`` numbers. Compiles the models first."""
    out = np.empty((len(parameters), FIRST_MEASURE + len(kept)))
    shares = np.array_split(np.arange(len(parameters)), os.cpu_count() or 1)
    rows = compiled(tuple(kept), ending)

    def work(share: Array) -> None:
        part = np.empty((len(share), out.shape[1]))
        rows(np.ascontiguousarray(parameters[share]), np.ascontiguousarray(times[share]), part)
        out[share] = part

    with ThreadPoolExecutor() as pool:
        list(pool.map(work, [share for share in shares if len(share)]))
    return out


def run_all(scenarios: Sequence[Scenario], kept: Sequence[Measure]) -> Array:
    """Return for each scenario how it ended, when [ns], and the ``kept`` numbers. All must end in the same way."""
    rows = [parameter_row(scenario) for scenario in scenarios]
    parameters, times = np.array([row for row, _, _ in rows]), np.array([times for _, _, times in rows])
    return rows_of(parameters, times, kept, scenarios[0].ending)


def truths_of(scenarios: Iterable[Scenario]) -> Truth:
    """Return what is true in each scenario."""
    starts = {item.name: float(item.start) for item in variables(MODELS["vehicle"].params)}
    return joined([truth_of(scenario, {**starts, **scenario.vehicle}) for scenario in scenarios])


def measure(scenarios: Sequence[Scenario], kept: Sequence[Measure]) -> Array:
    """Return one row of ``kept`` numbers per scenario."""
    return run_all(scenarios, kept)[:, FIRST_MEASURE:]
