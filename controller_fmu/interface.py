"""What systems share: inputs, outputs, and their model of the car. Imports none of them.

Each system has types of its own, made of what stands here and of what it alone has; ``controller_fmu.registry`` makes
the controller of all of them.
"""

from enum import IntEnum
from typing import Annotated, NamedTuple, Protocol

from controller_fmu.common.params import LimitParams, ThresholdParams
from controller_fmu.common.phases import CommonPhase
from modelkit.car import Car, CarSteering
from modelkit.signal import Group, Role, Signal
from modelkit.vocabulary import (
    ANYWHERE,
    BrakeRequest,
    DriverTakeover,
    MeasuredSpeed,
    Pose,
    PromptShown,
    SteeringWheelAngle,
    VehicleFaultShown,
)

HOUSE = "project default; the source states none"


class Reason(IntEnum):
    """Why the controller failed."""

    NONE = 0
    BAD_INPUT = 1
    """An input is NaN or infinite."""
    BAD_PARAMETER = 2
    """A parameter has no meaning (not finite, not positive)."""
    NO_PATH = 3
    """No path of this kind leads from the start pose to the target."""
    TOO_MANY_SHIFTS = 4
    TIMEOUT = 5
    NOT_MOVING = 6
    """The driver was asked to move and did not."""
    NOT_STOPPING = 7
    """The driver was asked to stop and did not."""
    WRONG_DIRECTION = 8
    POSE_FROZEN = 9
    """The pose does not change although the car moves."""
    STEERING_FAULT = 10
    """The steering wheel does not follow its request."""
    MISSED_TARGET = 11
    """The end of the path was reached too far from the target pose."""
    LEFT_PATH = 12
    """The car is so far off that the path no longer helps."""
    VEHICLE_FAULT = 13
    """The vehicle reports that it brakes by itself."""
    OVER_SPEED = 20
    """The driver drives faster than the assist may be driven."""
    SENSOR_LOSS = 21
    """A distance sensor tells nothing usable."""
    BLOCKED = 22
    """Something stands in the way and stays."""
    NO_SLOT = 23
    """The search came to its end without a slot."""
    SLOT_TOO_SHORT = 24
    """The search came to its end with slots that the car does not fit into."""
    SLOT_TOO_SHALLOW = 25
    """The search came to its end with slots that end before the car does."""
    SLOT_CONTRADICTED = 26
    """An echo came from where an external slot is said to be."""
    SLOT_NOT_SUPPORTED = 27
    """A slot from outside of a kind that this system does not park in: at an angle, or nose first."""


Odometry = Annotated[Pose, Group("rear-axle midpoint estimated by dead reckoning")]


class SystemInput(NamedTuple):
    """What every system reads from the vehicle."""

    odometry: Odometry = Pose()
    measured_speed: MeasuredSpeed = 0.0
    steering_wheel_angle: SteeringWheelAngle = 0.0
    driver_takeover: DriverTakeover = False


class ParkingInput(NamedTuple):
    """What a system that parks reads."""

    odometry: Odometry = Pose()
    measured_speed: MeasuredSpeed = 0.0
    steering_wheel_angle: SteeringWheelAngle = 0.0
    driver_takeover: DriverTakeover = False
    vehicle_fault: VehicleFaultShown = 0


class Segment(NamedTuple):
    """A piece of path of constant curvature."""

    length: Annotated[float, Signal("m", "length along the path, >= 0; 0: unused")] = 0.0
    curvature: Annotated[float, Signal("1/m", "curvature of the path seen with x along the heading, left positive")] = (
        0.0
    )


class PlannedPiece(NamedTuple):
    """A piece of the move being driven, seen in the world."""

    length: Annotated[float, Signal("m", "length, >= 0; 0: unused")] = 0.0
    start_curvature: Annotated[float, Signal("1/m", "curvature at its start, left positive")] = 0.0
    end_curvature: Annotated[float, Signal("1/m", "curvature at its end, left positive")] = 0.0


class Path(NamedTuple):
    """The planned path: a start pose and pieces driven in reverse from it."""

    start: Annotated[Pose, Group("start pose of the path")] = Pose()
    segments: tuple[Segment, ...] = (Segment(),) * 3


ReasonTold = Annotated[int, Signal("1", "why the controller failed", states=Reason)]
Shifts = Annotated[int, Signal("1", "number of manoeuvres so far; the first reverse motion counts as one"), Role.LOCAL]
ReferencePose = Annotated[Pose, Role.LOCAL, Group("reference point of the path beside the rear-axle midpoint")]
LateralError = Annotated[float, Signal("m", "y of the car minus y of the reference, in the slot's frame"), Role.LOCAL]
HeadingError = Annotated[float, Signal("rad", "heading of the car minus heading of the reference"), Role.LOCAL]
PlannedPath = Annotated[Path, Role.LOCAL]
STATE_OF_THE_CHART = "state of the manoeuvre chart"


class RefusedOutput(NamedTuple):
    """The outputs where no system acts."""

    prompt: PromptShown = 0
    brake_request: BrakeRequest = False
    phase: Annotated[int, Signal("1", STATE_OF_THE_CHART, states=CommonPhase)] = CommonPhase.STANDBY
    reason: ReasonTold = 0


SampleTime = Annotated[float, Signal("s", "controller's sample time, whole nanoseconds", 1e-4, 1.0, HOUSE)]
AssumedCar = Annotated[Car, Group("vehicle model used by the controller")]
Target = Annotated[Pose, Group("pose of the rear-axle midpoint to park at", ANYWHERE)]
Thresholds = Annotated[ThresholdParams, Role.TUNABLE]
Limits = Annotated[LimitParams, Role.TUNABLE]
TARGET = Pose(-7.608, -3.056, 0.0)
"""The pose that is parked at where no other is set: the end of case 4 of Guo 2015."""


class SteeredCar(Protocol):
    """What steers: every system has this of the car."""

    wheelbase: float
    steering: CarSteering


class OutlinedCar(SteeredCar, Protocol):
    """What steers, and the outline."""

    front_overhang: float
    rear_overhang: float
    width: float


class HasCar(Protocol):
    """Parameters with the car."""

    @property
    def car(self) -> Car:
        """The car."""


class Monitored(HasCar, Protocol):
    """Parameters of a system that is watched while it parks."""

    @property
    def threshold(self) -> ThresholdParams:
        """When the car stands."""

    @property
    def limit(self) -> LimitParams:
        """How long anything may last."""


class Clocked(HasCar, Protocol):
    """Parameters that say when a system acts, and with which car."""

    @property
    def sample_time(self) -> float:
        """Time between two samples [s]."""

    @property
    def target(self) -> Pose:
        """Pose to park at."""


class Sensed(Protocol):
    """Inputs that say where the car is."""

    @property
    def odometry(self) -> Pose:
        """Pose of the rear-axle midpoint."""

    @property
    def measured_speed(self) -> float:
        """Speed [m/s]."""

    @property
    def steering_wheel_angle(self) -> float:
        """Angle of the steering wheel [rad]."""


class SensedWithFault(Sensed, Protocol):
    """Inputs that say where the car is, and whether the vehicle brakes by itself."""

    @property
    def vehicle_fault(self) -> int:
        """Why the vehicle brakes; 0: it does not."""
