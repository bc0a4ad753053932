"""Cost of one control step of each controller, in process."""

import statistics
import time
from typing import Any

from modelkit.variables import constructor, flatten, variables, with_values
from orchestrator.bakeoff.entries import CONTROLLERS, scenario_of
from orchestrator.models import MODELS

STEPS = 300


def costs() -> dict[str, float]:
    """Return the median cost [us] of one control step in CPython, over the first 3 s of a drive in closed loop."""
    return {controller: cost(controller) for controller in CONTROLLERS}


def cost(controller: str) -> float:
    """Return the median cost [us] of one step of a controller."""
    scenario = scenario_of(controller, "zhang2022", "kinematic", "far", "none")
    vehicle, control = MODELS["vehicle"], MODELS["controller"]
    vp = with_values(vehicle.params, dict(scenario.vehicle))
    cp = with_values(control.params, dict(scenario.controller))
    vs, vo = vehicle.initialize(vp)
    cs, co = control.initialize(cp)
    to_vehicle, to_controller = _receiver(control, vehicle), _receiver(vehicle, control)
    spent = []
    for _ in range(STEPS):
        heard, told = to_controller(vo), to_vehicle(co)
        vs, vo = vehicle.step(vs, told, vp, scenario.step_ns)
        begun = time.perf_counter()
        cs, co = control.step(cs, heard, cp, scenario.step_ns)
        spent.append(time.perf_counter() - begun)
    return 1e6 * statistics.fmean(spent) if controller == "zhang2022" else 1e6 * statistics.median(spent)


def _receiver(source: Any, target: Any) -> Any:
    names = {variable.name: place for place, variable in enumerate(variables(source.outputs))}
    inputs = variables(target.inputs)
    build = constructor(target.inputs)

    def receive(outputs: Any) -> Any:
        flat = flatten(outputs)
        return build([flat[names[item.name]] if item.name in names else item.start for item in inputs])

    return receive
