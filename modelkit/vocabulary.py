"""The words both FMUs speak: a pose, the prompts to the driver, the gears, what a controller asks of a car.

Frame: ISO 8855. x forward, y left, heading counter-clockwise from x; the reference point of a
car is the midpoint of its rear axle.
"""

from enum import IntEnum
from typing import Annotated, NamedTuple

from modelkit.signal import Signal


class Pose(NamedTuple):
    """Position and heading in the plane."""

    x: Annotated[float, Signal("m", "x")] = 0.0
    y: Annotated[float, Signal("m", "y")] = 0.0
    heading: Annotated[float, Signal("rad", "heading, counter-clockwise from the x axis")] = 0.0


ANYWHERE = (("m", 1e8), ("rad", 100.0))
"""Limits of a pose that is a parameter: coordinates of a map will do, a heading of many turns will not."""


class Prompt(IntEnum):
    """What the controller asks of the driver."""

    NONE = 0
    STOP = 1
    FORWARD = 2
    REVERSE = 3
    SLOW_DOWN = 4
    """Keep the direction, drive no faster than the advised speed."""
    TAKE_OVER = 5
    CONFIRM = 6
    """Press the confirm button, if that is wished."""


class Gear(IntEnum):
    """Selector position."""

    PARK = 0
    REVERSE = 1
    NEUTRAL = 2
    DRIVE = 3


class VehicleFault(IntEnum):
    """Why the vehicle brakes by itself."""

    NONE = 0
    BAD_INPUT = 1
    """An input is NaN or infinite."""
    BAD_PARAMETER = 2
    """A parameter is NaN, infinite or without meaning."""


SteeringWheelRequest = Annotated[float, Signal("rad", "requested steering-wheel angle, left positive")]
SteeringActive = Annotated[bool, Signal("1", "the controller holds the steering wheel")]
PromptShown = Annotated[int, Signal("1", "prompt shown to the driver", states=Prompt)]
AdvisedSpeed = Annotated[float, Signal("m/s", "largest speed advised with the prompt, >= 0")]
SpeedControlActive = Annotated[bool, Signal("1", "the controller controls the speed: speed_request applies")]
SpeedRequest = Annotated[float, Signal("m/s", "requested speed, reverse negative")]
ForceControlActive = Annotated[bool, Signal("1", "force_request applies instead of speed_request")]
ForceRequest = Annotated[float, Signal("N", "requested drive and brake force, forward positive")]
BrakeRequest = Annotated[bool, Signal("1", "the controller brakes to standstill and holds")]
"""What every controller asks of a car: an output of each controller, an input of the car."""

MeasuredSpeed = Annotated[float, Signal("m/s", "speed as the wheel sensors measure it, reverse negative")]
SteeringWheelAngle = Annotated[float, Signal("rad", "steering-wheel angle, left positive")]
GearShown = Annotated[int, Signal("1", "selector position", states=Gear)]
BrakePedal = Annotated[float, Signal("1", "brake pedal, 0 released to 1 full", 0.0, 1.0)]
DriverTakeover = Annotated[bool, Signal("1", "the driver has taken over")]
VehicleFaultShown = Annotated[int, Signal("1", "reason for which the vehicle brakes by itself", states=VehicleFault)]
ParkingSwitch = Annotated[bool, Signal("1", "the driver has switched the parking assist on")]
DriverConfirm = Annotated[bool, Signal("1", "the driver presses the confirm button")]
"""What a car tells every controller: an output of the car, an input of the controllers."""
