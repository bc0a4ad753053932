"""The preview system inside the controller: drives the road to its end, then brakes."""

from typing import NamedTuple

from controller_fmu.common.monitor import is_usable_input
from controller_fmu.common.phases import is_over
from controller_fmu.common.steering_wheel import wheel_request
from controller_fmu.interface import Reason, SystemInput
from controller_fmu.preview.params import Camera, PreviewSystemParams
from controller_fmu.preview.phases import PreviewPhase
from controller_fmu.preview.road import road_at
from controller_fmu.preview.signals import PreviewOutput
from controller_fmu.preview.system import PreviewState, preview_step

LONGEST_WAY = 0.022
"""Way between two samples [m] beyond which the loop of equation (2) leaves its road: 2 ms at 11 m/s."""


class DrivingState(NamedTuple):
    """Everything the system remembers."""

    phase: int = PreviewPhase.STANDBY
    reason: int = Reason.NONE
    preview: PreviewState = PreviewState()
    angle: float = 0.0
    """Front-wheel angle asked for [rad]."""
    force: float = 0.0


def driving_start(params: PreviewSystemParams) -> DrivingState:
    """Return the system at the start of the road."""
    return DrivingState()


def driving_sample(state: DrivingState, inputs: SystemInput, params: PreviewSystemParams, dt_ns: int) -> DrivingState:
    """Return the system one sample of ``dt_ns`` later."""
    if is_over(state.phase):
        return state
    if not is_usable_input(inputs):
        return DrivingState(PreviewPhase.FAILED, Reason.BAD_INPUT, state.preview)
    if inputs.driver_takeover:
        return DrivingState(PreviewPhase.TAKEOVER, Reason.NONE, state.preview)
    is_too_fast = params.preview.set_speed * dt_ns > LONGEST_WAY * 1e9  # in this order 11 m/s at 2 ms is exact
    if state.phase == PreviewPhase.STANDBY and params.preview.camera == Camera.KINEMATICS and is_too_fast:
        return DrivingState(PreviewPhase.FAILED, Reason.BAD_PARAMETER, state.preview)
    if state.phase == PreviewPhase.STRAIGHTEN:
        still = abs(inputs.measured_speed) <= params.threshold.standstill
        return DrivingState(PreviewPhase.PARKED if still else PreviewPhase.STRAIGHTEN, Reason.NONE, state.preview)
    preview, command = preview_step(
        state.preview, inputs.odometry, inputs.measured_speed, params.car.cg_to_rear, params.preview, dt_ns * 1e-9
    )
    if abs(preview.sight.y_l) > params.threshold.abort_lateral_error:
        return DrivingState(PreviewPhase.FAILED, Reason.LEFT_PATH, preview)
    phase = PreviewPhase.STRAIGHTEN if command.finished else PreviewPhase.PATH_TRACKING
    return DrivingState(phase, Reason.NONE, preview, command.front_wheel_angle, command.force)


def driving_outputs(state: DrivingState, params: PreviewSystemParams) -> PreviewOutput:
    """Return the outputs that hold until the next sample."""
    driving = state.phase == PreviewPhase.PATH_TRACKING
    signals = state.preview.signals
    active = driving or state.phase == PreviewPhase.STRAIGHTEN
    brake = not driving and state.phase != PreviewPhase.TAKEOVER
    speed = signals.wanted_speed if driving else 0.0
    force = state.force if driving else 0.0
    return PreviewOutput(
        steering_wheel_request=wheel_request(state.angle, 1.0, params),
        steering_active=active,
        speed_control_active=active,
        speed_request=speed,
        force_control_active=driving,
        force_request=force,
        brake_request=brake,
        phase=state.phase,
        reason=state.reason,
        reference=road_at(params.preview.road, signals.s).pose,
        lateral_error=signals.y_l,
        heading_error=signals.eps_l,
        preview=signals,
    )
