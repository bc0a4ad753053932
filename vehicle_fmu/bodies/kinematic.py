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


def move(pose: Pose, now: KinematicInput, then: KinematicInput, wheelbase: float, h: float) -> Pose:
    """Return the pose ``h`` [s] later, speed and front-wheel angle going linearly from those ``now`` to those ``then``.

    Both are known functions of time, so heading, then position, are integrals: Simpson's rule,
    with the heading halfway from the parabola through the three rates. Fourth order in ``h``.
    """
    speed = now.speed
    next_speed = then.speed
    if speed == 0.0 and next_speed == 0.0:
        return pose
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
    heading = pose.heading
    middle_heading = heading + h * (5.0 * rate + 8.0 * middle_rate - next_rate) / 24.0
    next_heading = heading + h * (rate + 4.0 * middle_rate + next_rate) / 6.0
    x_rate = speed * math.cos(heading) + 4.0 * middle_speed * math.cos(middle_heading)
    y_rate = speed * math.sin(heading) + 4.0 * middle_speed * math.sin(middle_heading)
    return Pose(
        pose.x + h * (x_rate + next_speed * math.cos(next_heading)) / 6.0,
        pose.y + h * (y_rate + next_speed * math.sin(next_heading)) / 6.0,
        next_heading,
    )
