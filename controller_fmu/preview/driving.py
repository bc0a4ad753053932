"""The preview system inside the controller: drives the road to its end, then brakes."""

from typing import NamedTuple

from controller_fmu.guo2015.monitor import is_usable_input
from controller_fmu.interface import ControllerInput, ControllerOutput, ControllerParams, Path, Phase, Reason, Segment
from controller_fmu.preview.road import road_at
from controller_fmu.preview.system import PreviewCommand, PreviewState, preview_step
from modelkit.maths import clamp
from modelkit.vocabulary import Pose, Prompt

STANDBY = int(Phase.STANDBY)
PATH_TRACKING = int(Phase.PATH_TRACKING)
STRAIGHTEN = int(Phase.STRAIGHTEN)
PARKED = int(Phase.PARKED)
FAILED = int(Phase.FAILED)
TAKEOVER = int(Phase.TAKEOVER)
NO_REASON = int(Reason.NONE)
BAD_INPUT = int(Reason.BAD_INPUT)
LEFT_PATH = int(Reason.LEFT_PATH)
NO_PROMPT = int(Prompt.NONE)


class DrivingState(NamedTuple):
    """Everything the system remembers."""

    phase: int = STANDBY
    reason: int = NO_REASON
    preview: PreviewState = PreviewState()
    angle: float = 0.0
    """Front-wheel angle asked for [rad]."""
    force: float = 0.0


def driving_sample(state: DrivingState, inputs: ControllerInput, params: ControllerParams, dt_ns: int) -> DrivingState:
    """Return the system one sample of ``dt_ns`` later."""
    if state.phase >= PARKED:
        return state
    if not is_usable_input(inputs):
        return DrivingState(FAILED, BAD_INPUT, state.preview, 0.0, 0.0)
    if inputs.driver_takeover:
        return DrivingState(TAKEOVER, NO_REASON, state.preview, 0.0, 0.0)
    if state.phase == STRAIGHTEN:
        still = abs(inputs.measured_speed) <= params.threshold.standstill
        return DrivingState(PARKED if still else STRAIGHTEN, NO_REASON, state.preview, 0.0, 0.0)
    preview, command = preview_step(state.preview, inputs.odometry, inputs.measured_speed, params.preview, dt_ns * 1e-9)
    if abs(preview.sight.y_l) > params.threshold.lost_lateral:
        return DrivingState(FAILED, LEFT_PATH, preview, 0.0, 0.0)
    return _commanded(preview, command)


def _commanded(preview: PreviewState, command: PreviewCommand) -> DrivingState:
    phase = STRAIGHTEN if command.finished else PATH_TRACKING
    return DrivingState(phase, NO_REASON, preview, command.front_wheel_angle, command.force)


def driving_outputs(state: DrivingState, params: ControllerParams) -> ControllerOutput:
    """Return the outputs that hold until the next sample."""
    driving = state.phase == PATH_TRACKING
    signals = state.preview.signals
    limit = params.steering_wheel_limit
    nothing = Segment(0.0, 0.0)
    active = driving or state.phase == STRAIGHTEN
    brake = not driving and state.phase != TAKEOVER
    speed = signals.wanted_speed if driving else 0.0
    force = state.force if driving else 0.0
    return ControllerOutput(
        steering_wheel_request=clamp(params.steering_ratio * state.angle, -limit, limit),
        steering_active=active,
        prompt=NO_PROMPT,
        advised_speed=0.0,
        speed_control_active=active,
        speed_request=speed,
        force_control_active=driving,
        force_request=force,
        brake_request=brake,
        phase=state.phase,
        reason=state.reason,
        shifts=0,
        reference=road_at(params.preview.road, signals.s).pose,
        lateral_error=signals.y_l,
        heading_error=signals.eps_l,
        path=Path(Pose(0.0, 0.0, 0.0), (nothing, nothing, nothing)),
        preview=signals,
    )
