"""What driver-adaptive parking tells."""

from typing import Annotated, NamedTuple

from controller_fmu.adaptive.phases import AdaptivePhase
from controller_fmu.adaptive.route import MAX_PIECES
from controller_fmu.interface import (
    STATE_OF_THE_CHART,
    HeadingError,
    LateralError,
    PlannedPiece,
    ReasonTold,
    ReferencePose,
    Shifts,
)
from modelkit.signal import Group, Role, Signal
from modelkit.vocabulary import (
    AdvisedSpeed,
    BrakeRequest,
    ForceControlActive,
    ForceRequest,
    Pose,
    PromptShown,
    SpeedControlActive,
    SpeedRequest,
    SteeringActive,
    SteeringWheelRequest,
)


class AdaptiveMove(NamedTuple):
    """The move being driven."""

    start: Annotated[Pose, Group("where the move starts, in the world")] = Pose()
    direction: Annotated[int, Signal("1", "1 forward, -1 in reverse, 0 none")] = 0
    pieces: tuple[PlannedPiece, ...] = (PlannedPiece(),) * MAX_PIECES
    end: Annotated[float, Signal("m", "way along the move at which the car is to stand", 0.0)] = 0.0


class AdaptiveSignals(NamedTuple):
    """What the system has in mind."""

    move: AdaptiveMove = AdaptiveMove()


class AdaptiveOutput(NamedTuple):
    """To the vehicle, the driver, the log and the judge."""

    steering_wheel_request: SteeringWheelRequest = 0.0
    steering_active: SteeringActive = False
    prompt: PromptShown = 0
    advised_speed: AdvisedSpeed = 0.0
    speed_control_active: SpeedControlActive = False
    speed_request: SpeedRequest = 0.0
    force_control_active: ForceControlActive = False
    force_request: ForceRequest = 0.0
    brake_request: BrakeRequest = False
    phase: Annotated[int, Signal("1", STATE_OF_THE_CHART, states=AdaptivePhase)] = 0
    reason: ReasonTold = 0
    manoeuvres: Shifts = 0
    reference: ReferencePose = Pose()
    lateral_error: LateralError = 0.0
    heading_error: HeadingError = 0.0
    adaptive: Annotated[AdaptiveSignals, Role.LOCAL] = AdaptiveSignals()
