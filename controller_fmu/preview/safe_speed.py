"""The speed at which a curve may be entered."""

import math


def safe_speed(curvature: float, acceleration: float, highest: float) -> float:
    """Return min(sqrt(a / |kappa|), highest) [m/s]; ``highest`` on a straight.

    (3) of the preview paper is lost. a = 0.578 m/s^2 gives its 7.6, 5.4 and 3.8 m/s for 0.01, 0.02
    and 0.04 1/m; for 0.05 it gives 3.4 where 3.2 is printed.
    """
    if curvature == 0.0:
        return highest
    speed = math.sqrt(abs(acceleration / curvature))
    return speed if speed < highest else highest
