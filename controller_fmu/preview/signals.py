"""What the preview system saw and chose, for the log."""

from typing import Annotated, NamedTuple

from controller_fmu.interface import (
    STATE_OF_THE_CHART,
    HeadingError,
    LateralError,
    ReasonTold,
    ReferencePose,
)
from controller_fmu.preview.phases import PreviewPhase
from controller_fmu.preview.stage import PreviewStage
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


class PreviewSignals(NamedTuple):
    """What the preview system saw and chose."""

    s: Annotated[float, Signal("m", "arc length of the car along the road")] = 0.0
    stage: Annotated[int, Signal("1", "stage of the preview sequence", states=PreviewStage)] = 0
    l1: Annotated[float, Signal("m", "first preview distance")] = 0.0
    l2: Annotated[float, Signal("m", "second preview distance")] = 0.0
    kappa1: Annotated[float, Signal("1/m", "road curvature at the first preview point")] = 0.0
    kappa2: Annotated[float, Signal("1/m", "road curvature at the second preview point")] = 0.0
    y_l: Annotated[float, Signal("m", "lateral error at the first preview point, road to the left positive")] = 0.0
    eps_l: Annotated[float, Signal("rad", "heading error at the first preview point, road turning left positive")] = 0.0
    wanted_speed: Annotated[float, Signal("m/s", "target speed of the sequence")] = 0.0
    la1: Annotated[Pose, Group("point of the road L1 ahead of the car")] = Pose()
    la2: Annotated[Pose, Group("point of the road L2 ahead of the car")] = Pose()


class PreviewOutput(NamedTuple):
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
    phase: Annotated[int, Signal("1", STATE_OF_THE_CHART, states=PreviewPhase)] = 0
    reason: ReasonTold = 0
    reference: ReferencePose = Pose()
    lateral_error: LateralError = 0.0
    heading_error: HeadingError = 0.0
    preview: Annotated[PreviewSignals, Role.LOCAL] = PreviewSignals()
