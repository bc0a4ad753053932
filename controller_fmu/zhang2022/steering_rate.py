"""The front-wheel rate that a path asks for at the planned speed."""

import math
from typing import NamedTuple

from controller_fmu.zhang2022.path import QuinticPath
from controller_fmu.zhang2022.quintic import Quintic, shape

RATE_SAMPLES = 32
"""Places looked at along each quintic."""
SHORTEST_STEP = 1e-6
"""Shorter steps [m] are of pieces that only join others."""
STOPPING_SHARE = 0.7
"""Share of the ramp planned for stopping: what is left makes up for the lag of the speed."""
FINAL_SPEED = 0.03
"""Speed [m/s] left at the target, so that it is reached."""


class PlannedMotion(NamedTuple):
    """What bounds the front-wheel rate along a path."""

    wheelbase: float
    """[m]."""
    speed: float
    """Set speed between the ramps [m/s]."""
    ramp: float
    """Acceleration of the set speed [m/s2]."""
    rate_limit: float
    """Front-wheel rate that the path may use [rad/s]."""


class Turning(NamedTuple):
    """Largest front-wheel rate [rad/s] so far, and where on the path that is."""

    rate: float
    distance: float
    """From the start [m]."""
    angle: float
    """Front-wheel angle [rad]."""


def speed_before_target(x: float, speed: float, ramp: float) -> float:
    """Return the speed [m/s] at ``x`` [m] ahead of the target from which the car stops there."""
    return min(speed, math.sqrt(2.0 * STOPPING_SHARE * ramp * max(0.0, x)) + FINAL_SPEED)


def largest_wheel_rate(path: QuinticPath, motion: PlannedMotion) -> float:
    """Return the largest front-wheel rate [rad/s] along a path driven from rest, with ramps at both ends."""
    start = shape(path.first, path.first.x0 + path.first.length).curvature
    turning = Turning(0.0, 0.0, math.atan(motion.wheelbase * start))
    turning = _along(path.first, turning, motion)
    turning = _along(path.line, turning, motion)
    return _along(path.last, turning, motion).rate


def _along(piece: Quintic, before: Turning, motion: PlannedMotion) -> Turning:
    """Return what is known after one more quintic, driven towards falling x."""
    rate = before.rate
    distance = before.distance
    angle = before.angle
    dx = piece.length / RATE_SAMPLES
    for number in range(RATE_SAMPLES):
        middle = piece.x0 + piece.length - (number + 0.5) * dx
        point = shape(piece, middle - 0.5 * dx)
        slope = shape(piece, middle).slope
        step = dx * math.sqrt(1.0 + slope * slope)
        from_start = math.sqrt(2.0 * motion.ramp * (distance + 0.5 * step))
        speed = min(from_start, speed_before_target(middle, motion.speed, motion.ramp))
        turned = math.atan(motion.wheelbase * point.curvature)
        if step > SHORTEST_STEP:
            rate = max(rate, abs(turned - angle) / step * speed)
        angle = turned
        distance = distance + step
    return Turning(rate, distance, angle)
