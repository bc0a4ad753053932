"""The car without tyre slip: Guo 2015, eq. (1), for the rear-axle midpoint.

    x' = v cos(heading)    y' = v sin(heading)    heading' = v tan(phi) / L

Print gives R = tan(phi) / L; the turning radius is R = L / tan(phi). Valid for |phi| < pi/2.
"""

import math
from typing import NamedTuple

from modelkit.vocabulary import Pose


class KinematicInput(NamedTuple):
    """What moves the car at an instant."""

    speed: float
    """v [m/s]."""
    angle: float
    """phi, of the front wheels [rad]."""


class KinematicState(NamedTuple):
    """Where the car is, with the direction that the next step begins with."""

    pose: Pose = Pose()
    cos: float = 1.0
    """Of the heading, as ``sin``."""
    sin: float = 0.0


def resting_at(pose: Pose) -> KinematicState:
    """Return the car at rest at ``pose``, wheel straight."""
    return KinematicState(pose, math.cos(pose.heading), math.sin(pose.heading))


def move(
    state: KinematicState, now: KinematicInput, then: KinematicInput, wheelbase: float, h: float
) -> KinematicState:
    """Return the car ``h`` [s] later, speed and front-wheel angle going linearly from those ``now`` to those ``then``.

    Both are known functions of time, so heading, then position, are integrals: Simpson's rule,
    with the heading halfway from the parabola through the three rates. Fourth order in ``h``.
    """
    speed = now.speed
    next_speed = then.speed
    if speed == 0.0 and next_speed == 0.0:
        return state
    pose = state.pose
    heading = pose.heading
    tan = math.tan(now.angle)
    middle_tan = tan
    next_tan = tan
    if then.angle != now.angle:
        middle_tan = math.tan(0.5 * (now.angle + then.angle))
        next_tan = math.tan(then.angle)
    middle_speed = 0.5 * (speed + next_speed)
    rate = speed * tan / wheelbase
    middle_rate = middle_speed * middle_tan / wheelbase
    next_rate = next_speed * next_tan / wheelbase
    middle_heading = heading + h * (5.0 * rate + 8.0 * middle_rate - next_rate) / 24.0
    next_heading = heading + h * (rate + 4.0 * middle_rate + next_rate) / 6.0
    next_cos = math.cos(next_heading)
    next_sin = math.sin(next_heading)
    x_rate = speed * state.cos + 4.0 * middle_speed * math.cos(middle_heading) + next_speed * next_cos
    y_rate = speed * state.sin + 4.0 * middle_speed * math.sin(middle_heading) + next_speed * next_sin
    moved = Pose(pose.x + h * x_rate / 6.0, pose.y + h * y_rate / 6.0, next_heading)
    return KinematicState(moved, next_cos, next_sin)
