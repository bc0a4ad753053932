"""From front-wheel angles in the slot's frame to the steering wheel of the car the controller thinks it drives."""

from controller_fmu.interface import HasCar
from modelkit.maths import clamp


def steering_wheel_angle(front_wheel_angle: float, mirror: float, params: HasCar) -> float:
    """Return the steering-wheel angle [rad] that belongs to a front-wheel angle [rad]; ``mirror``: see SlotFrame."""
    return mirror * params.car.steering.ratio * front_wheel_angle


def wheel_request(front_wheel_angle: float, mirror: float, params: HasCar) -> float:
    """Return the steering-wheel angle [rad] to ask for, held to the wheel's limit."""
    limit = params.car.steering.angle_limit
    return clamp(steering_wheel_angle(front_wheel_angle, mirror, params), -limit, limit)
