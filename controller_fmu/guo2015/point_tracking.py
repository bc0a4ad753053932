"""Point tracking: Guo 2015, eq. (14), (16), (17), the k3 term's sign corrected.

    x_e = (x - xQ) cos hQ + (y - yQ) sin hQ     y_e = (y - yQ) cos hQ - (x - xQ) sin hQ     h_e = h - hQ
    phi = atan( L cos^3(h_e) [ -k3 y_e - direction k4 tan h_e ] )

direction is 1 driving forward (x_e < 0 at first) and -1 in reverse. Over x_e (forward) or -x_e
(reverse) y_e'' = -k3 y_e - k4 y_e'. Print has y_e with the opposite sign. Valid for |h_e| < pi/2.
"""

import math
from typing import NamedTuple

from modelkit.maths import clamp, wrap_angle
from modelkit.vocabulary import Pose

MAX_TRACKING_HEADING = 89.0 * math.pi / 180.0


class PointError(NamedTuple):
    """The pose seen from the point tracked."""

    x: float
    y: float
    heading: float


def point_error(pose: Pose, point: Pose) -> PointError:
    """Return (x_e, y_e, h_e), eq. (10)."""
    c = math.cos(point.heading)
    s = math.sin(point.heading)
    dx = pose.x - point.x
    dy = pose.y - point.y
    return PointError(dx * c + dy * s, dy * c - dx * s, wrap_angle(pose.heading - point.heading))


def point_tracking_angle(error: PointError, direction: float, k3: float, k4: float, wheelbase: float) -> float:
    """Return the front-wheel angle [rad] that leads to the point; not yet limited."""
    heading = clamp(error.heading, -MAX_TRACKING_HEADING, MAX_TRACKING_HEADING)
    c = math.cos(heading)
    return math.atan(wheelbase * c * c * c * (-k3 * error.y - direction * k4 * math.tan(heading)))
