"""The last echoes of one sensor along its path, as far as they can come from one object.

The distance to a body that stands still changes by at most the distance that the sensor moves (it is 1-Lipschitz). An
echo that differs from the last one by more comes from another body and begins a new window.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.measurement.sensor import SensorPose

WINDOW = 9
"""Echoes of a window; the feature belongs to the middle one."""
MIDDLE = WINDOW // 2
SPACING = 0.05
"""Least distance [m] between the sensor positions of two echoes: a window spans 0.4 m when driven slowly. Over that a
corner at 1 m bends the range by 2 cm, twice the noise."""
MAX_SPACING = 0.25
"""Echoes farther apart [m] than this are of two windows: at 10 km/h two in a row were lost."""
JUMP_SIGMA = 4.0
"""Standard deviations of the difference of two echoes that noise may explain."""


class EchoSample(NamedTuple):
    """One echo: where the sensor was, the unit vector of its axis, and the range; SI units."""

    x: float = 0.0
    y: float = 0.0
    axis_x: float = 1.0
    axis_y: float = 0.0
    range: float = 0.0


class EchoWindow(NamedTuple):
    """The last echoes, oldest first; the last ``used`` are valid. ``is_new``: the last one came in this cycle."""

    used: int = 0
    is_new: bool = False
    samples: tuple[EchoSample, ...] = (EchoSample(),) * WINDOW


def push_echo(window: EchoWindow, sensor: SensorPose, measured: float, variance: float) -> EchoWindow:
    """Return the window with one more echo at ``measured`` [m], of ``variance`` [m2], if the sensor has moved."""
    last = window.samples[WINDOW - 1]
    dx = sensor.x - last.x
    dy = sensor.y - last.y
    moved = math.sqrt(dx * dx + dy * dy)
    sample = EchoSample(sensor.x, sensor.y, sensor.axis_x, sensor.axis_y, measured)
    jump = abs(measured - last.range) - moved
    if window.used == 0 or moved > MAX_SPACING or jump > JUMP_SIGMA * math.sqrt(2.0 * variance):
        return EchoWindow(1, True, window.samples[1:] + (sample,))
    if moved < SPACING:
        return window._replace(is_new=False)
    return EchoWindow(min(window.used + 1, WINDOW), True, window.samples[1:] + (sample,))
