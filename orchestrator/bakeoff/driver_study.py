"""NTBPTcwPT against plain NTBPT under driver speed errors: the claim of Guo 2015 as a success rate."""

from typing import NamedTuple

import numpy as np

from orchestrator.cosim.slave import Array
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.scenario.scenario import Scenario
from orchestrator.sweep.many import parameter_row, rows_of, truths_of
from orchestrator.sweep.rows import measures_for
from orchestrator.sweep.verdict import judge_rows
from orchestrator.verdict.confidence import wilson

SPEED = 0.8
"""Speed the driver means [m/s]."""
FASTEST, SLOWEST = 1.0, -0.5
"""Uniform relative error of the speed driven."""
WOBBLE = 0.3
"""Largest amplitude of its swing [m/s], uniform from 0."""
SYSTEMS = ("ntbptcwpt", "ntbpt")
STEERING = {"30 deg/s": "guo2015-case4", "105 deg/s": "guo2015-case4-105"}
"""Rate of the front wheels, of Table 1 and of Fig. 12, and the scenario that has it."""
LIMITS = {"Guo 2015": "guo2015", "GB/T 41630": "gbt41630"}
"""The sets of limits that a success is judged by."""


class Group(NamedTuple):
    """One system at one steering rate, judged by one limit."""

    system: str
    steering: str
    limit: str


class Rate(NamedTuple):
    """A success rate and its 95 % confidence interval (Wilson)."""

    group: Group
    runs: int
    successes: int
    low: float
    high: float

    @property
    def rate(self) -> float:
        """Successes over runs."""
        return self.successes / self.runs


class Study(NamedTuple):
    """Both systems at both steering rates under the same driver errors."""

    speed: Array
    """Mean speed driven in each run [m/s]."""
    success: dict[Group, "np.ndarray[tuple[int], np.dtype[np.bool_]]"]
    rates: list[Rate]


def study(runs: int, seed: int) -> Study:
    """Return the success of both systems in ``runs`` drives each, the same drivers for all.

    A drive succeeds if it is parked, as everywhere, by a set of limits. The driver obeys stop and direction
    prompts after 0.1 to 0.6 s, but no slow-down prompts.
    """
    rng = np.random.default_rng(seed)
    error, wobble = rng.uniform(SLOWEST, FASTEST, runs), rng.uniform(0.0, WOBBLE, runs)
    period, delay = rng.uniform(1.0, 6.0, runs), rng.uniform(0.1, 0.6, runs)
    success = {}
    for steering, scenario in STEERING.items():
        for system in SYSTEMS:
            judged = {limit: _scenario(scenario, system, name) for limit, name in LIMITS.items()}
            measures = list(dict.fromkeys(item for each in judged.values() for item in measures_for(each)))
            base = next(iter(judged.values()))
            ends = rows_of(*_rows(base, error, wobble, period, delay), measures, base.ending)
            truth = truths_of([base]).repeated(runs)
            for limit, each in judged.items():
                success[Group(system, steering, limit)] = judge_rows(each, truth, measures, ends).succeeded()
    rates = [rate_of(group, runs, int(won.sum())) for group, won in success.items()]
    return Study(SPEED * (1.0 + error), success, rates)


def rate_of(group: Group, runs: int, successes: int) -> Rate:
    """Return the rate with Wilson's 95 % interval."""
    return Rate(group, runs, successes, *wilson(successes, runs))


def _scenario(name: str, system: str, limits: str) -> Scenario:
    sets = [f"vehicle.driver.profile[1].speed={SPEED}", "vehicle.driver.profile[2].at=1e9"]
    return load_scenario(name, [*sets, f"controller.system={system}", f"limits=[{limits}]", "stop_time=120"])


def _rows(scenario: Scenario, error: Array, wobble: Array, period: Array, delay: Array) -> tuple[Array, Array]:
    """Return parameters and times of one run per driver."""
    row, places, times = parameter_row(scenario)
    rows = np.tile(row, (len(error), 1))
    for name, values in (
        ("speed_error", error),
        ("wobble", wobble),
        ("wobble_period", period),
        ("reaction_delay", delay),
    ):
        rows[:, places[f"vehicle.driver.{name}"]] = values
    return rows, np.tile(times, (len(error), 1))
