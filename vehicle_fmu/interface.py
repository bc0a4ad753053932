"""What goes into the vehicle, what comes out, and what can be set: every signal and its unit."""

from enum import IntEnum
from math import pi
from typing import Annotated, NamedTuple

from modelkit.signal import Signal
from modelkit.vocabulary import Gear, Pose, Prompt

GUO = "Guo 2015, Table 1"
HOUSE = "chosen; the source states none"
NEVER = 1e9
"""A time or distance that is not reached (FMI 2.0 has no portable infinity)."""


class Body(IntEnum):
    """Which equations move the car."""

    KINEMATIC = 0


class VehicleFault(IntEnum):
    """Why the vehicle brakes by itself."""

    NONE = 0
    BAD_INPUT = 1
    """An input is NaN or infinite."""
    BAD_PARAMETER = 2
    """A parameter is NaN, infinite or without meaning."""


class VehicleInput(NamedTuple):
    """From the controller."""

    steering_wheel_request: Annotated[float, Signal("rad", "steering-wheel angle asked for, left positive")] = 0.0
    steering_active: Annotated[bool, Signal("1", "the controller holds the steering wheel")] = False
    prompt: Annotated[int, Signal("1", "prompt shown to the driver", states=Prompt)] = 0
    advised_speed: Annotated[float, Signal("m/s", "largest speed advised with the prompt, >= 0")] = 0.0
    speed_control_active: Annotated[bool, Signal("1", "the controller drives: speed_request holds")] = False
    speed_request: Annotated[float, Signal("m/s", "speed asked for, reverse negative")] = 0.0
    brake_request: Annotated[bool, Signal("1", "the controller brakes to standstill and holds")] = False


class VehicleOutput(NamedTuple):
    """To the controller, the log and the judge."""

    pose: Pose = Pose()
    odometry: Pose = Pose()
    speed: Annotated[float, Signal("m/s", "speed of the rear-axle midpoint, reverse negative")] = 0.0
    measured_speed: Annotated[float, Signal("m/s", "speed as the wheel sensors tell it, reverse negative")] = 0.0
    steering_wheel_angle: Annotated[float, Signal("rad", "steering-wheel angle, left positive")] = 0.0
    front_wheel_angle: Annotated[float, Signal("rad", "equivalent front-wheel angle, left positive")] = 0.0
    gear: Annotated[int, Signal("1", "selector position", states=Gear)] = int(Gear.PARK)
    brake_pedal: Annotated[float, Signal("1", "brake pedal, 0 released to 1 full", 0.0, 1.0)] = 0.0
    driver_takeover: Annotated[bool, Signal("1", "the driver has taken over")] = False
    vehicle_fault: Annotated[int, Signal("1", "why the vehicle brakes by itself", states=VehicleFault)] = 0
    distance: Annotated[float, Signal("m", "distance driven, both directions counted")] = 0.0


class SteeringParams(NamedTuple):
    """Steering wheel, column and actuator."""

    ratio: Annotated[float, Signal("1", "steering-wheel angle over front-wheel angle", 1.0, 60.0, GUO)] = 19.0
    angle_limit: Annotated[float, Signal("rad", "largest steering-wheel angle", 0.1, 20.0, GUO)] = 570.0 * pi / 180.0
    rate_limit: Annotated[float, Signal("rad/s", "largest steering-wheel rate", 0.01, 100.0, GUO)] = 570.0 * pi / 180.0


class DriveParams(NamedTuple):
    """Drive and brake as the driver feels them."""

    acceleration_limit: Annotated[float, Signal("m/s2", "largest acceleration", 0.01, 20.0, HOUSE)] = 1.5
    deceleration_limit: Annotated[float, Signal("m/s2", "largest deceleration", 0.01, 20.0, HOUSE)] = 3.0


class ProfilePoint(NamedTuple):
    """One corner of the driver's speed profile."""

    at: Annotated[
        float, Signal("1", "time [s] or driven distance [m] from which the speed holds; 1e9: unused", 0.0)
    ] = NEVER
    speed: Annotated[float, Signal("m/s", "speed the driver wants, >= 0", 0.0, 50.0)] = 0.0


class DriverParams(NamedTuple):
    """The person behind the wheel: speed is theirs, the steering is the controller's."""

    profile: tuple[ProfilePoint, ...] = (ProfilePoint(0.0, 0.5),) + (ProfilePoint(),) * 7
    profile_over_distance: Annotated[bool, Signal("1", "profile points are distances, not times")] = False
    reaction_delay: Annotated[float, Signal("s", "from a prompt to its obedience", 0.0, 10.0, HOUSE)] = 0.3
    obeys_stop: Annotated[bool, Signal("1", "stops when prompted")] = True
    obeys_direction: Annotated[bool, Signal("1", "changes direction when prompted")] = True
    obeys_slow_down: Annotated[bool, Signal("1", "slows down when prompted")] = True
    takeover_time: Annotated[float, Signal("s", "takes over at this time; 1e9: never", 0.0)] = NEVER


class VehicleParams(NamedTuple):
    """The car, its driver and where it stands at first."""

    body: Annotated[int, Signal("1", "equations of motion", states=Body)] = int(Body.KINEMATIC)
    wheelbase: Annotated[float, Signal("m", "front to rear axle", 0.1, 20.0, GUO)] = 2.405
    front_overhang: Annotated[float, Signal("m", "front axle to bumper", 0.0, 5.0, HOUSE)] = 0.80
    rear_overhang: Annotated[float, Signal("m", "rear axle to bumper", 0.0, 5.0, HOUSE)] = 0.60
    width: Annotated[float, Signal("m", "body width", 0.1, 5.0, HOUSE)] = 1.65
    start: Pose = Pose()
    steering: SteeringParams = SteeringParams()
    drive: DriveParams = DriveParams()
    driver: DriverParams = DriverParams()
    largest_step: Annotated[float, Signal("s", "longest internal integration step", 1e-4, 0.1, HOUSE)] = 0.005
