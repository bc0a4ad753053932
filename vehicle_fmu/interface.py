"""What goes into the vehicle, what comes out, and what can be set: every signal and its unit."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from modelkit.car import Car
from modelkit.signal import Group, Role, Signal
from modelkit.vocabulary import (
    ANYWHERE,
    AdvisedSpeed,
    BrakePedal,
    BrakeRequest,
    DriverConfirm,
    DriverTakeover,
    ForceControlActive,
    ForceRequest,
    Gear,
    GearShown,
    MeasuredSpeed,
    ParkingSwitch,
    Pose,
    PromptShown,
    SpeedControlActive,
    SpeedRequest,
    SteeringActive,
    SteeringWheelAngle,
    SteeringWheelRequest,
    VehicleFaultShown,
)
from vehicle_fmu.bodies.chassis import ChassisParams, RoadParams
from vehicle_fmu.bodies.double_track import DoubleTrackParams
from vehicle_fmu.bodies.single_track import SingleTrackParams
from vehicle_fmu.odometry import OdometryParams
from vehicle_fmu.scene import SceneParams
from vehicle_fmu.ultrasonic import UltrasonicParams

HOUSE = "project default; the source states none"
NEVER_VALUE = 1e9
"""A time or distance that is not reached (FMI 2.0 has no portable infinity)."""


class Body(IntEnum):
    """Which equations move the car."""

    KINEMATIC = 0
    """Without tyre slip."""
    SINGLE_TRACK = 1
    """Three degrees of freedom, linear tyres."""
    DOUBLE_TRACK = 2
    """Four wheels, Magic Formula, load transfer."""


class ManualInput(NamedTuple):
    """A person at pedals and lever in place of the driver modelled: in a driving simulator, or a page."""

    active: Annotated[bool, Signal("1", "manual driving: pedals and lever replace the driver model")] = False
    accelerator: Annotated[float, Signal("1", "accelerator pedal, 0 released to 1 full", 0.0, 1.0)] = 0.0
    brake: Annotated[float, Signal("1", "brake pedal, 0 released to 1 full", 0.0, 1.0)] = 0.0
    lever: Annotated[int, Signal("1", "selector lever; the gear follows it at standstill", states=Gear)] = Gear.PARK
    confirm: Annotated[bool, Signal("1", "confirm button pressed")] = False


class VehicleInput(NamedTuple):
    """From the controller, and from a person if there is one."""

    steering_wheel_request: SteeringWheelRequest = 0.0
    steering_active: SteeringActive = False
    prompt: PromptShown = 0
    advised_speed: AdvisedSpeed = 0.0
    speed_control_active: SpeedControlActive = False
    speed_request: SpeedRequest = 0.0
    force_control_active: ForceControlActive = False
    force_request: ForceRequest = 0.0
    brake_request: BrakeRequest = False
    manual: ManualInput = ManualInput()


class VehicleOutput(NamedTuple):
    """To the controller, the log and the judge."""

    pose: Annotated[Pose, Group("rear-axle midpoint")] = Pose()
    odometry: Annotated[Pose, Group("rear-axle midpoint estimated by dead reckoning")] = Pose()
    speed: Annotated[float, Signal("m/s", "speed of the rear-axle midpoint, reverse negative")] = 0.0
    measured_speed: MeasuredSpeed = 0.0
    steering_wheel_angle: SteeringWheelAngle = 0.0
    front_wheel_angle: Annotated[float, Signal("rad", "equivalent front-wheel angle, left positive")] = 0.0
    gear: GearShown = Gear.PARK
    brake_pedal: BrakePedal = 0.0
    driver_takeover: DriverTakeover = False
    vehicle_fault: VehicleFaultShown = 0
    distance: Annotated[float, Signal("m", "distance driven, both directions counted")] = 0.0
    ultrasonic: tuple[
        Annotated[float, Signal("m", "measured range: 1-4 front, 5-8 rear, 9-10 left, 11-12 right"), Role.SAMPLED], ...
    ] = (0.0,) * 12
    clearance: Annotated[
        float,
        Signal(
            "m",
            "clearance between outline and nearest obstacle; in contact minus the penetration depth; 1e9: no obstacle",
        ),
    ] = NEVER_VALUE
    contact: Annotated[bool, Signal("1", "the outline touches an obstacle")] = False
    apa_switch: ParkingSwitch = False
    driver_confirm: DriverConfirm = False


class SteeringParams(NamedTuple):
    """How the steering obeys: what is not said of it in ``car.steering``."""

    dead_time: Annotated[float, Signal("s", "dead time", 0.0, 1.0, HOUSE)] = 0.0
    lag: Annotated[float, Signal("s", "first-order lag (time constant)", 0.0, 2.0, HOUSE), Role.TUNABLE] = 0.0
    backlash: Annotated[float, Signal("rad", "backlash (total free play at the steering wheel)", 0.0, 1.0, HOUSE)] = 0.0
    standstill_rate: Annotated[
        float,
        Signal("rad/s", "largest steering-wheel rate at standstill; 0: as when moving", 0.0, 100.0, HOUSE),
        Role.TUNABLE,
    ] = 0.0
    fault_time: Annotated[float, Signal("s", "actuator stuck from this time on; 1e9: never", 0.0, 1e9, HOUSE)] = 1e9


class DriveParams(NamedTuple):
    """Drive and brake as the driver feels them."""

    acceleration_limit: Annotated[float, Signal("m/s2", "largest acceleration", 0.01, 20.0, HOUSE)] = 1.5
    deceleration_limit: Annotated[float, Signal("m/s2", "largest deceleration", 0.01, 20.0, HOUSE)] = 3.0
    shift_time: Annotated[
        float, Signal("s", "duration of a gear change at standstill; 0: immediate", 0.0, 10.0, HOUSE)
    ] = 0.0
    speed_gain: Annotated[
        float, Signal("1/s", "driver model: proportional gain of the speed error", 0.0, 100.0, HOUSE)
    ] = 5.0
    speed_integral: Annotated[
        float, Signal("1/s2", "driver model: integral gain of the speed error", 0.0, 100.0, HOUSE)
    ] = 5.0
    integral_limit: Annotated[
        float, Signal("m", "driver model: anti-windup limit of the speed-error integral", 0.0, 100.0, HOUSE)
    ] = 0.5
    drive_force_limit: Annotated[float, Signal("N", "largest drive force, all wheels", 0.0, 1e5, HOUSE)] = 4000.0
    brake_force_limit: Annotated[float, Signal("N", "largest brake force, all wheels", 0.0, 1e5, HOUSE)] = 12000.0
    drive_lag: Annotated[float, Signal("s", "lag of the drive force", 0.0, 2.0, HOUSE)] = 0.10
    brake_lag: Annotated[float, Signal("s", "lag of the brake force", 0.0, 2.0, HOUSE)] = 0.05
    hold_deceleration: Annotated[
        float, Signal("m/s2", "brake force over mass while standing", 0.0, 20.0, HOUSE), Role.FIXED
    ] = 4.0
    creep_force: Annotated[float, Signal("N", "force at idle in D and R at rest; 0: none", 0.0, 5000.0, HOUSE)] = 0.0
    creep_speed: Annotated[float, Signal("m/s", "speed at which the creep force is zero", 0.1, 10.0, HOUSE)] = 2.0


class ProfilePoint(NamedTuple):
    """One corner of the driver's speed profile."""

    at: Annotated[
        float,
        Signal("1", "time [s] or driven distance [m] from which the speed applies; 1e9: unused", 0.0, NEVER_VALUE),
    ] = NEVER_VALUE
    speed: Annotated[float, Signal("m/s", "target speed of the driver, >= 0", 0.0, 50.0)] = 0.0


class DriverParams(NamedTuple):
    """The person behind the wheel: speed is theirs, the steering is the controller's."""

    profile: Annotated[tuple[ProfilePoint, ...], Role.FIXED] = (ProfilePoint(0.0, 0.5),) + (ProfilePoint(),) * 7
    profile_over_distance: Annotated[bool, Signal("1", "profile points are distances, not times"), Role.FIXED] = False
    reaction_delay: Annotated[float, Signal("s", "reaction time to a prompt", 0.0, 10.0, HOUSE)] = 0.3
    complies_with_stop: Annotated[bool, Signal("1", "stops when prompted")] = True
    complies_with_direction: Annotated[bool, Signal("1", "changes direction when prompted")] = True
    complies_with_slow_down: Annotated[bool, Signal("1", "slows down when prompted")] = True
    takeover_time: Annotated[float, Signal("s", "takes over at this time; 1e9: never", 0.0, NEVER_VALUE)] = NEVER_VALUE
    brake_time: Annotated[
        float, Signal("s", "brakes to standstill from this time on; 1e9: never", 0.0, NEVER_VALUE)
    ] = NEVER_VALUE
    steering_override_time: Annotated[
        float, Signal("s", "overrides the steering wheel from this time on; 1e9: never", 0.0, NEVER_VALUE)
    ] = NEVER_VALUE
    steering_override_angle: Annotated[
        float, Signal("rad", "steering-wheel angle held by the override", -20.0, 20.0)
    ] = 0.0
    road_curvature: Annotated[
        float, Signal("1/m", "of the arc that the driver follows from the start; 0: holds the wheel", -0.1, 0.1)
    ] = 0.0
    speed_error: Annotated[float, Signal("1", "relative speed error of the driver", -1.0, 5.0)] = 0.0
    speed_oscillation_amplitude: Annotated[
        float, Signal("m/s", "amplitude of the speed oscillation about the target speed", 0.0, 10.0)
    ] = 0.0
    speed_oscillation_period: Annotated[float, Signal("s", "period of the speed oscillation", 0.1, 1000.0)] = 3.0
    apa_switch_time: Annotated[float, Signal("s", "switches the parking assist on; 1e9: never", 0.0, NEVER_VALUE)] = (
        NEVER_VALUE
    )
    apa_switch_off_time: Annotated[float, Signal("s", "switches it off again; 1e9: never", 0.0, NEVER_VALUE)] = (
        NEVER_VALUE
    )
    confirm_time: Annotated[
        float, Signal("s", "presses the confirm button for half a second; 1e9: never", 0.0, NEVER_VALUE)
    ] = NEVER_VALUE
    confirms_when_asked: Annotated[bool, Signal("1", "presses the confirm button when prompted")] = True


class VehicleParams(NamedTuple):
    """The car as built, how it obeys, its driver, what is around, and where it stands at first."""

    body: Annotated[int, Signal("1", "equations of motion", states=Body)] = Body.KINEMATIC
    car: Car = Car()
    start: Annotated[Pose, Group("rear-axle midpoint at time zero", ANYWHERE)] = Pose()
    steering: SteeringParams = SteeringParams()
    drive: Annotated[DriveParams, Role.TUNABLE] = DriveParams()
    driver: Annotated[DriverParams, Role.TUNABLE] = DriverParams()
    chassis: ChassisParams = ChassisParams()
    single_track: SingleTrackParams = SingleTrackParams()
    double_track: DoubleTrackParams = DoubleTrackParams()
    road: RoadParams = RoadParams()
    scene: SceneParams = SceneParams()
    ultrasonic: UltrasonicParams = UltrasonicParams()
    odometry: OdometryParams = OdometryParams()
    largest_step: Annotated[float, Signal("s", "longest internal integration step", 1e-4, 0.1, HOUSE)] = 0.005
    body_step: Annotated[float, Signal("s", "longest internal step of the bodies with mass", 1e-5, 0.02, HOUSE)] = 0.005
