"""The steering wheel: angle and rate limits (Guo 2015, Table 1)."""

from modelkit.maths import clamp, move_towards
from vehicle_fmu.interface import SteeringParams


def turn_steering_wheel(angle: float, request: float, params: SteeringParams, h: float) -> float:
    """Return the steering-wheel angle [rad] ``h`` [s] later, on its way from ``angle`` to ``request``."""
    target = clamp(request, -params.angle_limit, params.angle_limit)
    return move_towards(angle, target, params.rate_limit * h)
