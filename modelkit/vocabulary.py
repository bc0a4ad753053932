"""The words both FMUs speak: a pose, the prompts to the driver, the gears, where the sensors sit.

Frame: ISO 8855. x forward, y left, heading counter-clockwise from x; the reference point of a
car is the midpoint of its rear axle.
"""

from enum import IntEnum
from math import pi
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


class SensorMount(NamedTuple):
    """Where a sensor sits on the car and where it looks."""

    x: Annotated[float, Signal("m", "ahead of the rear axle", -30.0, 30.0)] = 0.0
    y: Annotated[float, Signal("m", "to the left of the car's middle", -10.0, 10.0)] = 0.0
    yaw: Annotated[float, Signal("rad", "direction of its axis, left positive", -10.0, 10.0)] = 0.0


SENSOR_MOUNTS = (
    SensorMount(3.10, 0.68, pi / 6.0),
    SensorMount(3.205, 0.25, 0.0),
    SensorMount(3.205, -0.25, 0.0),
    SensorMount(3.10, -0.68, -pi / 6.0),
    SensorMount(-0.50, 0.68, pi * 5.0 / 6.0),
    SensorMount(-0.60, 0.25, pi),
    SensorMount(-0.60, -0.25, pi),
    SensorMount(-0.50, -0.68, -pi * 5.0 / 6.0),
    SensorMount(2.80, 0.825, pi / 2.0),
    SensorMount(-0.20, 0.825, pi / 2.0),
    SensorMount(2.80, -0.825, -pi / 2.0),
    SensorMount(-0.20, -0.825, -pi / 2.0),
)
"""Twelve ultrasonic sensors on the car of Guo 2015: 3.205 m ahead, 0.6 m behind, 0.825 m to each side."""
