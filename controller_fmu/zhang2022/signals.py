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
from modelkit.signal import Role, Signal
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
    shifts: Shifts = 0
    reference: ReferencePose = Pose()
    lateral_error: LateralError = 0.0
    heading_error: HeadingError = 0.0
    path: PlannedPath = Path()
    zhang2022: Annotated[ZhangSignals, Role.LOCAL] = ZhangSignals()
