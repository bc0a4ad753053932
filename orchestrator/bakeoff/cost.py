"""Cost of one control step of each controller, in CPython, over a whole drive in closed loop."""

import statistics
import time
from typing import Any, NamedTuple

from modelkit.variables import with_values
from orchestrator.bakeoff.entries import CONTROLLERS, scenario_of
from orchestrator.cosim.recording import inputs_seen
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario

TIMES = 2
"""Every drive is the same: of each step the shortest time counts, so that interruptions do not."""


class Cost(NamedTuple):
    """Time one control step takes [us]."""

    mean: float
    slowest: float
    """Of the drive: where the MPC solves, or the assist plans."""
    steps: int


def costs() -> dict[str, Cost]:
    """Return the cost of one control step of each controller."""
    return {controller: cost(controller) for controller in CONTROLLERS}


def cost(controller: str) -> Cost:
    """Return the cost of one control step, from the first to the one that says parked."""
    scenario = scenario_of(controller, 7.7, "zhang2022", "kinematic", "far", "none")
    seen = inputs_seen(run_scenario(scenario).recording, "controller", MODELS["controller"])
    best = [1e6 * min(each) for each in zip(*(_times(scenario, seen) for _ in range(TIMES)), strict=True)]
    return Cost(statistics.fmean(best), max(best), len(best))


def _times(scenario: Scenario, seen: list[Any]) -> list[float]:
    """Return how long [s] each control step takes with the inputs that were ``seen`` in closed loop."""
    model = MODELS["controller"]
    params = with_values(model.params, dict(scenario.controller))
    state, outputs = model.initialize(params)
    spent, final = [], scenario.ending.final()
    for inputs in seen:
        begun = time.perf_counter()
        state, outputs = model.step(state, inputs, params, scenario.step_ns)
        spent.append(time.perf_counter() - begun)
        if outputs.phase in final:
            break
    return spent
