"""The words both FMUs speak: a pose, the prompts to the driver, the gears.

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
