"""Stopping distance: with delay d and deceleration b a vehicle at speed v stops within v d + v2 / 2 b.

So the largest speed that keeps a free distance f is the positive root of v d + v2 / 2 b = f:

    v = b (sqrt(d2 + 2 f / b) - d)
"""

import math


def stopping_distance(speed: float, delay: float, deceleration: float) -> float:
    """Return the distance [m] in which a vehicle at ``speed`` [m/s] >= 0 stops."""
    return speed * delay + 0.5 * speed * speed / deceleration


def speed_for_distance(distance: float, delay: float, deceleration: float) -> float:
    """Return the largest speed [m/s] from which a vehicle stops within ``distance`` [m]; 0 for none."""
    if distance <= 0.0:
        return 0.0
    return max(0.0, deceleration * (math.sqrt(delay * delay + 2.0 * distance / deceleration) - delay))
