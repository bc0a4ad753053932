"""How fast to drive a move: slower towards a standstill, and where the wheel has to turn."""

import math

from controller_fmu.apa.params import ApaDriveParams


def planned_speed(to_stop: float, slope: float, wheelbase: float, wheel_rate: float, drive: ApaDriveParams) -> float:
    """Return the speed [m/s], >= ``creep``, at ``to_stop`` [m] before a standstill.

    On a ramp of curvature slope c' [1/m2] the front wheels turn by L c' v at most, which must stay under
    their rate ``wheel_rate`` [rad/s].
    """
    fast = math.sqrt(drive.creep * drive.creep + 2.0 * drive.deceleration * max(0.0, to_stop))
    speed = min(fast, drive.speed)
    turning = abs(slope) * wheelbase
    if turning * speed > drive.steering_reserve * wheel_rate:
        speed = drive.steering_reserve * wheel_rate / turning
    return max(drive.creep, speed)


def stopping_way(speed: float, drive: ApaDriveParams, reaction: float) -> float:
    """Return the way [m] from the moment a stop is asked for until the car stands."""
    v = abs(speed)
    return v * reaction + 0.5 * v * v / drive.brake
