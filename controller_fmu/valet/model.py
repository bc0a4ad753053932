"""The valet as a model of its own, with a clock, a map among its parameters, and the planner's store."""

import math
from typing import NamedTuple

from controller_fmu.interface import Reason
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.valet.chart import Step
from controller_fmu.valet.outputs import valet_outputs
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.phases import ValetPhase
from controller_fmu.valet.signals import ValetInput, ValetOutput
from controller_fmu.valet.state import ValetState
from controller_fmu.valet.system import valet_sample
from modelkit.maths import is_finite
from modelkit.vocabulary import Prompt


class ValetModelState(NamedTuple):
    """When the valet acts next, and what it remembers."""

    time_ns: int = 0
    next_sample_ns: int = 0
    valet: ValetState = ValetState()


def valet_initialize(params: ValetParams) -> tuple[ValetModelState, ValetOutput]:
    """Return the valet about to plan, and the outputs at time zero."""
    seeks = params.search.active
    state = ValetModelState(valet=ValetState(step=Step.OFF if seeks else Step.PLAN))
    return state, valet_outputs(state.valet, params)


def valet_step(
    store: PlanStore, state: ValetModelState, inputs: ValetInput, params: ValetParams, dt_ns: int
) -> tuple[ValetModelState, ValetOutput]:
    """Return (state, outputs) ``dt_ns`` later: the valet acts at the instants k * sample_time."""
    end_ns = state.time_ns + dt_ns
    if not is_usable(params):
        refused = ValetOutput(
            prompt=Prompt.STOP, brake_request=True, phase=ValetPhase.FAILED, reason=Reason.BAD_PARAMETER
        )
        return ValetModelState(end_ns, state.next_sample_ns, state.valet), refused
    period_ns = math.floor(params.sample_time * 1e9 + 0.5)
    samples = 0
    if state.next_sample_ns < end_ns:
        samples = (end_ns - state.next_sample_ns + period_ns - 1) // period_ns
    valet = state.valet._replace(told=inputs.external_slot)
    for _ in range(samples):
        valet = valet_sample(store, valet, inputs, params, period_ns)
    return ValetModelState(end_ns, state.next_sample_ns + samples * period_ns, valet), valet_outputs(valet, params)


def is_usable(params: ValetParams) -> bool:
    """Return whether the parameters make sense."""
    car = params.car
    target = params.target
    lock = car.steering.angle_limit / car.steering.ratio if car.steering.ratio > 0.0 else 0.0
    return (
        is_finite(target.x + target.y + target.heading)
        and is_finite(car.wheelbase + car.front_overhang + car.rear_overhang + car.width + car.steering.rate_limit)
        and car.wheelbase > 0.0
        and car.width > 0.0
        and car.steering.rate_limit > 0.0
        and params.sample_time >= 1e-4
        and 0.0 < lock < 1.5
    )
