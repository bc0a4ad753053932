"""What driver-adaptive parking puts out."""

from controller_fmu.adaptive.params import AdaptiveSystemParams
from controller_fmu.adaptive.phases import AdaptivePhase, direction_of
from controller_fmu.adaptive.route import Piece
from controller_fmu.adaptive.signals import AdaptiveMove, AdaptiveOutput, AdaptiveSignals
from controller_fmu.adaptive.system import AdaptiveState
from controller_fmu.common.phases import is_parking
from controller_fmu.common.slot_frame import to_world
from controller_fmu.interface import PlannedPiece
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
        manoeuvres=state.manoeuvres,
        reference=to_world(state.foot.reference, state.frame),
        lateral_error=state.foot.lateral_error,
        heading_error=state.foot.heading_error,
        adaptive=AdaptiveSignals(move_plan(state)),
    )


def move_plan(state: AdaptiveState) -> AdaptiveMove:
    """Return the move being driven, its curvature seen in the world with x along the car's heading; or none."""
    route = state.plan.route
    if route.direction == 0:
        return AdaptiveMove()
    pieces = tuple(piece_plan(piece, state.frame.mirror) for piece in route.pieces)
    return AdaptiveMove(to_world(route.start, state.frame), route.direction, pieces, state.end)


def piece_plan(piece: Piece, mirror: float) -> PlannedPiece:
    """Return a piece of a route as it is seen in the world."""
    return PlannedPiece(piece.length, mirror * piece.k0, mirror * piece.k1)


def prompt_of(state: AdaptiveState, params: AdaptiveSystemParams) -> int:
    """Return the prompt: to slow down where the advice asks for it and the car is moving."""
    if state.phase in (AdaptivePhase.STANDBY, AdaptivePhase.TAKEOVER):
        return Prompt.NONE
    direction = direction_of(state.phase)
    if direction == 0:
        return Prompt.STOP
    if state.moving and state.advice < params.adaptive.belief.speed_limit:
        return Prompt.SLOW_DOWN
    return Prompt.FORWARD if direction > 0 else Prompt.REVERSE
