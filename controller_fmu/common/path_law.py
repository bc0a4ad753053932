"""NTBPT along any path: Guo 2015, eq. (6), both signs corrected, in the frame of the reference point.

The law needs |heading| < pi/2 in its frame, which one fixed frame cannot give on a path that turns by
90 deg. So its x axis is the path's tangent at the reference point, where the reference heading is 0 and
the point of equal x is the foot of the car on the tangent. With e the car's offset to the left of the
path and h_e its heading against it

    phi = atan( L cos^3(h_e) [ k_r - k1 e - direction k2 tan(h_e) ] )

Driving forward, arc length runs with x, not against it: e' = direction tan(h_e) over arc length, hence the
factor in the k2 term; e'' = k - k_r in both directions. So e'' = -k1 e - k2 e' in both.
"""

import math
from typing import NamedTuple

from modelkit.maths import clamp, wrap_angle
from modelkit.vocabulary import Pose

MAX_TRACKING_HEADING = 1.3


class TrackingError(NamedTuple):
    """Tracking error at a point of the path: left [m], turned left [rad], at most ``MAX_TRACKING_HEADING``."""

    lateral: float
    heading: float


def deviation(pose: Pose, at: Pose) -> TrackingError:
    """Return how far ``pose`` is off the path's point ``at``."""
    e = (pose.y - at.y) * math.cos(at.heading) - (pose.x - at.x) * math.sin(at.heading)
    return TrackingError(e, clamp(wrap_angle(pose.heading - at.heading), -MAX_TRACKING_HEADING, MAX_TRACKING_HEADING))


def angle_back(off: TrackingError, curvature: float, direction: float, k1: float, k2: float, wheelbase: float) -> float:
    """Return the front-wheel angle [rad] that leads back to a path of ``curvature`` [1/m]."""
    c = math.cos(off.heading)
    return math.atan(wheelbase * c * c * c * (curvature - k1 * off.lateral - direction * k2 * math.tan(off.heading)))
