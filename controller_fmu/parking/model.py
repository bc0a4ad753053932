"""The parking system as a model: its clock, its memory, and the planner's work arrays."""

from typing import NamedTuple

from controller_fmu.common.clock import Clock, begin, tick
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

    clock: Clock = Clock()
    memory: ParkingMemory = ParkingMemory()


def parking_initialize(params: ParkingParams) -> tuple[ParkingModelState, ParkingOutput]:
    """Return the state and the outputs at time zero."""
    clock = begin(params)
    car = params.car
    has_outline = is_finite(car.front_overhang + car.rear_overhang + car.width) and car.width > 0.0
    state = ParkingModelState(clock._replace(usable=clock.usable and has_outline))
    return state, parking_outputs(state.memory, params)


def parking_step(
    work: PlanningWork, state: ParkingModelState, inputs: ParkingSystemInput, params: ParkingParams, dt_ns: int
) -> tuple[ParkingModelState, ParkingOutput]:
    """Return (state, outputs) ``dt_ns`` later: the system acts at the instants k * sample_time.

    With a car whose dimensions or steering make no sense, or such a sample time, it fails.
    """
    clock, samples, period_ns = tick(state.clock, params, dt_ns)
    if not clock.usable:
        refused = ParkingOutput(
            prompt=Prompt.STOP, brake_request=True, phase=ParkingPhase.FAILED, reason=Reason.BAD_PARAMETER
        )
        return ParkingModelState(clock, state.memory), refused
    memory = state.memory
    for _ in range(samples):
        memory = parking_sample(work, memory, inputs, params, period_ns)
    state = ParkingModelState(clock, memory)
    return state, parking_outputs(state.memory, params)
