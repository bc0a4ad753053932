"""The controller as one step: sample, let the chosen system act, hold its outputs.

A sampled system: it acts at the instants k * sample_time with the inputs that hold then, whatever
the communication step, and holds its outputs in between.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.outputs import apa_outputs
from controller_fmu.apa.system import AT_START, ApaState, apa_sample
from controller_fmu.guo2015.parking import AT_REST, ParkingState, failed, outputs, sample
from controller_fmu.hsic.outputs import hsic_outputs
from controller_fmu.hsic.system import HsicState, hsic_sample
from controller_fmu.interface import ControllerInput, ControllerOutput, ControllerParams, Reason, System
from controller_fmu.preview.driving import DrivingState, driving_outputs, driving_sample
from controller_fmu.zhang2022.outputs import zhang_outputs
from controller_fmu.zhang2022.system import ZhangState, zhang_sample
from modelkit.maths import is_finite

BAD_PARAMETER = int(Reason.BAD_PARAMETER)
ZHANG2022 = int(System.ZHANG2022)
HSIC = int(System.HSIC)
PREVIEW = int(System.PREVIEW)
APA = int(System.APA)


class ControllerState(NamedTuple):
    """Everything the controller remembers."""

    time_ns: int = 0
    next_sample_ns: int = 0
    parking: ParkingState = ParkingState()
    zhang2022: ZhangState = ZhangState()
    hsic: HsicState = HsicState()
    preview: DrivingState = DrivingState()
    apa: ApaState = AT_START


def initialize(params: ControllerParams) -> tuple[ControllerState, ControllerOutput]:
    """Return the controller in standby; with unusable parameters, failed."""
    parking = AT_REST if _is_usable(params) else failed(BAD_PARAMETER)
    state = ControllerState(0, 0, parking, ZhangState(), HsicState(), DrivingState(), AT_START)
    return state, _outputs(state, params)


def step(
    state: ControllerState, inputs: ControllerInput, params: ControllerParams, dt_ns: int
) -> tuple[ControllerState, ControllerOutput]:
    """Return the controller ``dt_ns`` later, its inputs held."""
    end_ns = state.time_ns + dt_ns
    next_ns = state.next_sample_ns
    period_ns = 0
    count = 0
    if state.parking.reason != BAD_PARAMETER:
        period_ns = math.floor(params.sample_time * 1e9 + 0.5)
        while next_ns < end_ns:
            next_ns += period_ns
            count += 1
    parking, zhang2022, hsic, preview = state.parking, state.zhang2022, state.hsic, state.preview
    apa = state.apa
    for _ in range(count):
        if params.system == ZHANG2022:
            zhang2022 = zhang_sample(zhang2022, inputs, params, period_ns)
        elif params.system == HSIC:
            hsic = hsic_sample(hsic, inputs, params, period_ns)
        elif params.system == PREVIEW:
            preview = driving_sample(preview, inputs, params, period_ns)
        elif params.system == APA:
            apa = apa_sample(apa, inputs, params, period_ns)
        else:
            parking = sample(parking, inputs, params, period_ns)
    after = ControllerState(end_ns, next_ns, parking, zhang2022, hsic, preview, apa)
    return after, _outputs(after, params)


def _outputs(state: ControllerState, params: ControllerParams) -> ControllerOutput:
    """Return the outputs of the chosen system."""
    if state.parking.reason == BAD_PARAMETER:
        return outputs(state.parking, params)
    if params.system == ZHANG2022:
        return zhang_outputs(state.zhang2022, params)
    if params.system == HSIC:
        return hsic_outputs(state.hsic, params)
    if params.system == PREVIEW:
        return driving_outputs(state.preview, params)
    if params.system == APA:
        return apa_outputs(state.apa, params)
    return outputs(state.parking, params)


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
