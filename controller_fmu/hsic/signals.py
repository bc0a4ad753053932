"""What the system recognised and which rule it followed, for the log."""

from typing import Annotated, NamedTuple

from controller_fmu.hsic.characteristic_states import Characteristic, HsicStage
from controller_fmu.hsic.phases import HsicPhase
from controller_fmu.hsic.rules import SpeedMode, SteerMode
from controller_fmu.interface import (
    STATE_OF_THE_CHART,
    HeadingError,
    LateralError,
    Path,
    PlannedPath,
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


class HsicSignals(NamedTuple):
    """What the system recognised and which rule it followed."""

    characteristic: Annotated[int, Signal("1", "characteristic state", states=Characteristic)] = 0
    stage: Annotated[int, Signal("1", "stage of the parking manoeuvre", states=HsicStage)] = 0
    speed_mode: Annotated[int, Signal("1", "control mode of the speed", states=SpeedMode)] = 0
    steer_mode: Annotated[int, Signal("1", "control mode of the steering", states=SteerMode)] = 0
    distance: Annotated[float, Signal("m", "distance to the key point")] = 0.0
    tangent_error: Annotated[float, Signal("m", "distance to the left of the common tangent P2 P3, slot frame")] = 0.0
    p1: Annotated[Pose, Group("ready point, in the world")] = Pose()
    p2: Annotated[Pose, Group("end of the first arc, in the world")] = Pose()
    p3: Annotated[Pose, Group("start of the second arc, in the world")] = Pose()
    p4: Annotated[Pose, Group("where the car is to park, in the world")] = Pose()


class HsicOutput(NamedTuple):
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
    phase: Annotated[int, Signal("1", STATE_OF_THE_CHART, states=HsicPhase)] = 0
    reason: ReasonTold = 0
    manoeuvres: Shifts = 0
    reference: ReferencePose = Pose()
    lateral_error: LateralError = 0.0
    heading_error: HeadingError = 0.0
    path: PlannedPath = Path()
    hsic: Annotated[HsicSignals, Role.LOCAL] = HsicSignals()
