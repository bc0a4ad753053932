"""What the controller that carries out a policy receives, and what it puts out: observation, requests, phase."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from controller_fmu.common.phases import CommonPhase
from controller_fmu.interface import Odometry, ReasonTold
from modelkit.signal import Role, Signal
from modelkit.vocabulary import (
    BrakeRequest,
    DriverTakeover,
    Gear,
    MeasuredSpeed,
    Pose,
    PromptShown,
    SpeedControlActive,
    SpeedRequest,
    SteeringActive,
    SteeringWheelAngle,
    SteeringWheelRequest,
    VehicleFaultShown,
)

ACTION_COUNT = 3
OBSERVATION_COUNT = 24
SENSOR_COUNT = 12


class PolicyPhase(IntEnum):
    """What the policy is at."""

    STANDBY = CommonPhase.STANDBY
    POLICY_DRIVES = 12
    """It acts on what the policy requests."""
    PARKED = CommonPhase.PARKED
    FAILED = CommonPhase.FAILED
    TAKEOVER = CommonPhase.TAKEOVER


class PolicyInput(NamedTuple):
    """From the vehicle, and the actions of the policy."""

    odometry: Odometry = Pose()
    measured_speed: MeasuredSpeed = 0.0
    steering_wheel_angle: SteeringWheelAngle = 0.0
    driver_takeover: DriverTakeover = False
    vehicle_fault: VehicleFaultShown = 0
    ultrasonic: tuple[
        Annotated[float, Signal("m", "measured range: 1-4 front, 5-8 rear, 9-10 left, 11-12 right"), Role.SAMPLED], ...
    ] = (5.0,) * SENSOR_COUNT
    action: tuple[
        Annotated[float, Signal("1", "1 speed or accelerator, 2 steering wheel, 3 brake; from -1 to 1"), Role.SAMPLED],
        ...,
    ] = (0.0,) * ACTION_COUNT


class ManualRequest(NamedTuple):
    """Pedals and lever, as a person's."""

    active: Annotated[bool, Signal("1", "manual driving: pedals and lever replace the driver model")] = False
    accelerator: Annotated[float, Signal("1", "accelerator pedal, 0 released to 1 full", 0.0, 1.0)] = 0.0
    brake: Annotated[float, Signal("1", "brake pedal, 0 released to 1 full", 0.0, 1.0)] = 0.0
    lever: Annotated[int, Signal("1", "selector lever; the gear follows it at standstill", states=Gear)] = Gear.PARK


class PolicyOutput(NamedTuple):
    """To the vehicle, the policy, the log and the judge."""

    steering_wheel_request: SteeringWheelRequest = 0.0
    steering_active: SteeringActive = False
    prompt: PromptShown = 0
    speed_control_active: SpeedControlActive = False
    speed_request: SpeedRequest = 0.0
    brake_request: BrakeRequest = False
    manual: ManualRequest = ManualRequest()
    phase: Annotated[int, Signal("1", "state of the policy's controller", states=PolicyPhase)] = PolicyPhase.STANDBY
    reason: ReasonTold = 0
    manoeuvres: Annotated[
        int, Signal("1", "number of manoeuvres so far; the first reverse motion counts as one"), Role.LOCAL
    ] = 0
    cost_to_go: Annotated[
        float, Signal("m", "distance to the target, and wheelbase times its heading error"), Role.LOCAL
    ] = 0.0
    observation: tuple[Annotated[float, Signal("1", "what the policy sees, scaled to about 1"), Role.LOCAL], ...] = (
        0.0,
    ) * OBSERVATION_COUNT
