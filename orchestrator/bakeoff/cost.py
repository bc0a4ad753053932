"""Cost of one control step of each controller, in CPython, over a whole drive in closed loop."""

import statistics
import time
from typing import Any, NamedTuple

from controller_fmu.interface import Phase
from modelkit.variables import constructor, flatten, variables, with_values
from orchestrator.bakeoff.entries import CONTROLLERS, scenario_of
from orchestrator.scenario.models import MODELS

FINAL = (int(Phase.PARKED), int(Phase.FAILED), int(Phase.TAKEOVER))
DRIVES = 2
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
    drives = [_times(controller) for _ in range(DRIVES)]
    best = [1e6 * min(each) for each in zip(*drives, strict=True)]
    return Cost(statistics.fmean(best), max(best), len(best))


def _times(controller: str) -> list[float]:
    """Return how long [s] each control step of a drive took."""
    scenario = scenario_of(controller, 7.7, "zhang2022", "kinematic", "far", "none")
    vehicle, control = MODELS["vehicle"], MODELS["controller"]
    vp = with_values(vehicle.params, dict(scenario.vehicle))
    cp = with_values(control.params, dict(scenario.controller))
    vs, vo = vehicle.initialize(vp)
    cs, co = control.initialize(cp)
    to_vehicle, to_controller = _receiver(control, vehicle), _receiver(vehicle, control)
    spent = []
    for _ in range(scenario.stop_ns // scenario.step_ns):
        heard, told = to_controller(vo), to_vehicle(co)
        vs, vo = vehicle.step(vs, told, vp, scenario.step_ns)
        begun = time.perf_counter()
        cs, co = control.step(cs, heard, cp, scenario.step_ns)
        spent.append(time.perf_counter() - begun)
        if co.phase in FINAL:
            break
    return spent


def _receiver(source: Any, target: Any) -> Any:
    names = {variable.name: place for place, variable in enumerate(variables(source.outputs))}
    inputs = variables(target.inputs)
    build = constructor(target.inputs)

    def receive(outputs: Any) -> Any:
        flat = flatten(outputs)
        return build([flat[names[item.name]] if item.name in names else item.start for item in inputs])

    return receive
