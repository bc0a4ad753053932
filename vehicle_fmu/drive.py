"""Speed of the car as its driver or the controller asks for it, within acceleration limits."""

from modelkit.maths import move_towards
from vehicle_fmu.interface import DriveParams


def change_speed(speed: float, target: float, params: DriveParams, h: float) -> float:
    """Return the speed [m/s] ``h`` [s] later; a change of direction passes through standstill."""
    if speed * target < 0.0:
        return move_towards(speed, 0.0, params.deceleration_limit * h)
    faster = (target - speed) * (target + speed) > 0.0
    limit = params.acceleration_limit if faster else params.deceleration_limit
    return move_towards(speed, target, limit * h)


def push_speed(speed: float, force: float, mass: float, along: float, h: float) -> float:
    """Return the speed [m/s] ``h`` [s] later of a car without resistance under a ``force`` [N].

    ``along`` is the gear's direction (1 or -1): a force against it brakes, to standstill and no further.
    """
    change = h * force / mass
    if force * along >= 0.0:
        return speed + change
    return move_towards(speed, 0.0, abs(change))
