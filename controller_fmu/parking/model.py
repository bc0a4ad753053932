"""The parking system as a model: its clock, its memory, and the planner's work arrays."""

import math
from typing import NamedTuple

from controller_fmu.interface import Reason
from controller_fmu.parking.chart import ParkingPhase
from controller_fmu.parking.outputs import parking_outputs
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.planning.work import PlanningWork
from controller_fmu.parking.signals import ParkingOutput, ParkingSystemInput
from controller_fmu.parking.state import ParkingMemory
from controller_fmu.parking.system import parking_sample
from modelkit.maths import is_finite
from modelkit.vocabulary import Prompt


class ParkingModelState(NamedTuple):
    """When the system acts next, and what it remembers."""

    time_ns: int = 0
    next_sample_ns: int = 0
    memory: ParkingMemory = ParkingMemory()


def parking_initialize(params: ParkingParams) -> tuple[ParkingModelState, ParkingOutput]:
    """Return the state and the outputs at time zero."""
    state = ParkingModelState()
    return state, parking_outputs(state.memory, params)


def parking_step(
    work: PlanningWork, state: ParkingModelState, inputs: ParkingSystemInput, params: ParkingParams, dt_ns: int
) -> tuple[ParkingModelState, ParkingOutput]:
    """Return (state, outputs) ``dt_ns`` later: the system acts at the instants k * sample_time."""
    end_ns = state.time_ns + dt_ns
    if not is_usable(params):
        refused = ParkingOutput(
            prompt=Prompt.STOP, brake_request=True, phase=ParkingPhase.FAILED, reason=Reason.BAD_PARAMETER
        )
        return ParkingModelState(end_ns, state.next_sample_ns, state.memory), refused
    period_ns = math.floor(params.sample_time * 1e9 + 0.5)
    samples = 0
    if state.next_sample_ns < end_ns:
        samples = (end_ns - state.next_sample_ns + period_ns - 1) // period_ns
    memory = state.memory
    for _ in range(samples):
        memory = parking_sample(work, memory, inputs, params, period_ns)
    state = ParkingModelState(end_ns, state.next_sample_ns + samples * period_ns, memory)
    return state, parking_outputs(state.memory, params)


def is_usable(params: ParkingParams) -> bool:
    """Return whether the car's dimensions and steering and the sample time are usable; else the system fails."""
    car = params.car
    lock = car.steering.angle_limit / car.steering.ratio if car.steering.ratio > 0.0 else 0.0
    return (
        is_finite(car.wheelbase + car.front_overhang + car.rear_overhang + car.width + car.steering.rate_limit)
        and car.wheelbase > 0.0
        and car.width > 0.0
        and car.steering.rate_limit > 0.0
        and params.sample_time >= 1e-4
        and 0.0 < lock < 1.5
    )
