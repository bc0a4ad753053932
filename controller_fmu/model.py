"""The controller as one step: sample, let the chosen system act, hold its outputs.

A sampled system: it acts at the instants k * sample_time with the inputs that hold then, whatever
the communication step, and holds its outputs in between.
"""

import math
from typing import NamedTuple

from controller_fmu.guo2015.parking import AT_REST, ParkingState, failed, outputs, sample
from controller_fmu.interface import ControllerInput, ControllerOutput, ControllerParams, Reason
from modelkit.maths import is_finite

BAD_PARAMETER = int(Reason.BAD_PARAMETER)


class ControllerState(NamedTuple):
    """Everything the controller remembers."""

    time_ns: int = 0
    next_sample_ns: int = 0
    parking: ParkingState = ParkingState()


def initialize(params: ControllerParams) -> tuple[ControllerState, ControllerOutput]:
    """Return the controller in standby; with unusable parameters, failed."""
    parking = AT_REST if _is_usable(params) else failed(BAD_PARAMETER)
    return ControllerState(0, 0, parking), outputs(parking, params)


def step(
    state: ControllerState, inputs: ControllerInput, params: ControllerParams, dt_ns: int
) -> tuple[ControllerState, ControllerOutput]:
    """Return the controller ``dt_ns`` later, its inputs held."""
    parking = state.parking
    end_ns = state.time_ns + dt_ns
    next_ns = state.next_sample_ns
    if parking.reason != BAD_PARAMETER:
        period_ns = math.floor(params.sample_time * 1e9 + 0.5)
        while next_ns < end_ns:
            parking = sample(parking, inputs, params, period_ns)
            next_ns += period_ns
    return ControllerState(end_ns, next_ns, parking), outputs(parking, params)


def _is_usable(params: ControllerParams) -> bool:
    target = params.target
    lock = params.steering_wheel_limit / params.steering_ratio if params.steering_ratio > 0.0 else 0.0
    return (
        is_finite(target.x + target.y + target.heading)
        and is_finite(params.wheelbase + params.sample_time + params.steering_wheel_rate)
        and params.wheelbase > 0.0
        and params.sample_time >= 1e-4
        and params.steering_wheel_rate > 0.0
        and params.prompting.deceleration > 0.0
        and 0.0 < lock < 1.5
    )
