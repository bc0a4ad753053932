"""Non-time-based path tracking, NTBPT: Guo 2015, eq. (6), both feedback signs corrected.

    phi = atan( L cos^3(h) [ rho_r / cos^3(h_r) + k1 (y_r - y) - k2 (tan h_r - tan h) ] )

With x1 = y_r - y and x2 = -(tan h_r - tan h) the errors go as x1' = x2, x2' = -k1 x1 - k2 x2 over
s = -x: time and speed do not appear. Print has -k1 and +k2 (the slip starts in eq. (5)), which
leads the car 8 m off the path. Slot's frame, x along the parked direction; |h|, |h_r| < pi/2.
"""

import math

from controller_fmu.guo2015.path import Reference
from modelkit.maths import clamp
from modelkit.vocabulary import Pose

MAX_TRACKING_HEADING = 89.0 * math.pi / 180.0


def path_tracking_angle(pose: Pose, reference: Reference, k1: float, k2: float, wheelbase: float) -> float:
    """Return the front-wheel angle [rad] that leads ``pose`` to the path; not yet limited."""
    heading = clamp(pose.heading, -MAX_TRACKING_HEADING, MAX_TRACKING_HEADING)
    c = math.cos(heading)
    c_r = math.cos(reference.heading)
    feedforward = reference.curvature / (c_r * c_r * c_r)
    distance = reference.y - pose.y
    slope = math.tan(reference.heading) - math.tan(heading)
    return math.atan(wheelbase * c * c * c * (feedforward + k1 * distance - k2 * slope))
