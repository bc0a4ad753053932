"""What driver-adaptive parking puts out."""

from controller_fmu.adaptive.params import AdaptiveSystemParams
from controller_fmu.adaptive.phases import AdaptivePhase, direction_of
from controller_fmu.adaptive.signals import AdaptiveOutput
from controller_fmu.adaptive.system import AdaptiveState
from controller_fmu.common.phases import is_parking
from controller_fmu.common.slot_frame import to_world
from modelkit.vocabulary import Prompt


def adaptive_outputs(state: AdaptiveState, params: AdaptiveSystemParams) -> AdaptiveOutput:
    """Return the outputs that hold until the next sample."""
    return AdaptiveOutput(
        steering_wheel_request=state.request,
        steering_active=is_parking(state.phase),
        prompt=prompt_of(state, params),
        advised_speed=state.advice,
        brake_request=state.phase == AdaptivePhase.FAILED and not state.takeover,
        phase=state.phase,
        reason=state.reason,
        shifts=state.shifts,
        reference=to_world(state.foot.reference, state.frame),
        lateral_error=state.foot.lateral_error,
        heading_error=state.foot.heading_error,
    )


def prompt_of(state: AdaptiveState, params: AdaptiveSystemParams) -> int:
    """Return the prompt: to slow down where the advice asks for it and the car is on its way."""
    if state.phase in (AdaptivePhase.STANDBY, AdaptivePhase.TAKEOVER):
        return Prompt.NONE
    direction = direction_of(state.phase)
    if direction == 0:
        return Prompt.STOP
    if state.moving and state.advice < params.adaptive.belief.speed_limit:
        return Prompt.SLOW_DOWN
    return Prompt.FORWARD if direction > 0 else Prompt.REVERSE
