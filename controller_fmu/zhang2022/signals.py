"""What the quintic, MPC and PID system found, for the log."""

from typing import Annotated, NamedTuple

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
from controller_fmu.zhang2022.path import PathStatus
from controller_fmu.zhang2022.phases import ZhangPhase
from controller_fmu.zhang2022.qp import Status
from controller_fmu.zhang2022.quintic import Quintic
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


class QuinticPlan(NamedTuple):
    """The planned path y(x) in the slot's frame, driven in reverse from the first quintic to the last."""

    side: Annotated[int, Signal("1", "the slot lies to the right (1), left (-1): y changes sign; 0: no path")] = 0
    origin: Annotated[Pose, Group("the slot's frame in the world: the target")] = Pose()
    quintics: tuple[Quintic, ...] = (Quintic(),) * 3
    length: Annotated[float, Signal("m", "length of the path")] = 0.0
    final_time: Annotated[float, Signal("s", "planned from start to target, with both ramps of the set speed")] = 0.0


class ZhangSignals(NamedTuple):
    """What the system found."""

    path_status: Annotated[int, Signal("1", "a quintic path exists", states=PathStatus)] = 0
    largest_curvature: Annotated[
        float, Signal("1/m", "largest curvature of the path, or of the best rejected candidate")
    ] = 0.0
    solver_status: Annotated[int, Signal("1", "exit status of the QP solver", states=Status)] = 0
    iterations: Annotated[int, Signal("1", "iterations of the QP solver")] = 0
    reference_angle: Annotated[float, Signal("rad", "front-wheel angle of the path's curvature, left positive")] = 0.0
    set_speed: Annotated[float, Signal("m/s", "speed the PID holds, reverse negative")] = 0.0
    plan: QuinticPlan = QuinticPlan()


class ZhangOutput(NamedTuple):
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
    phase: Annotated[int, Signal("1", STATE_OF_THE_CHART, states=ZhangPhase)] = 0
    reason: ReasonTold = 0
    manoeuvres: Shifts = 0
    reference: ReferencePose = Pose()
    lateral_error: LateralError = 0.0
    heading_error: HeadingError = 0.0
    path: PlannedPath = Path()
    zhang2022: Annotated[ZhangSignals, Role.LOCAL] = ZhangSignals()
