"""What NTBPTcwPT tells."""

from typing import Annotated, NamedTuple

from controller_fmu.guo2015.phases import GuoPhase
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

PLANNED_POINT_COUNT = 17


class PlannedPoint(NamedTuple):
    """A point of the planned path."""

    x: Annotated[float, Signal("m", "x in the world")] = 0.0
    y: Annotated[float, Signal("m", "y in the world")] = 0.0


NO_POINTS = (PlannedPoint(),) * PLANNED_POINT_COUNT


class GuoSignals(NamedTuple):
    """The points that are tracked, and the path where it is not made of arcs."""

    q1: Annotated[Pose, Group("Q1, where the second arc begins, in the world")] = Pose()
    q2: Annotated[Pose, Group("Q2, ahead of Q1 on the tangent, in the world")] = Pose()
    q3: Annotated[Pose, Group("Q3, where the car is to park, in the world")] = Pose()
    q4: Annotated[Pose, Group("Q4, straight ahead of Q3, in the world")] = Pose()
    points: tuple[PlannedPoint, ...] = NO_POINTS
    """From start to target; all zero where ``path`` has the arcs."""


class GuoOutput(NamedTuple):
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
    phase: Annotated[int, Signal("1", STATE_OF_THE_CHART, states=GuoPhase)] = 0
    reason: ReasonTold = 0
    manoeuvres: Shifts = 0
    reference: ReferencePose = Pose()
    lateral_error: LateralError = 0.0
    heading_error: HeadingError = 0.0
    path: PlannedPath = Path()
    guo2015: Annotated[GuoSignals, Role.LOCAL] = GuoSignals()
