"""The steering: request -> dead time -> lag -> angle and rate limits -> steering wheel -> backlash -> front wheels.

Angle and rate limits are Guo 2015, Table 1; everything else is off by default. The dead time is
a line of ``DELAY_CELLS`` requests, so it is met to a 16th of itself whatever the step. At standstill
the tyres scrub and the wheel may turn slower.
"""

import math
from typing import NamedTuple

from modelkit.car import CarSteering
from modelkit.maths import clamp, move_towards
from vehicle_fmu.interface import SteeringParams

DELAY_CELLS = 16
STANDSTILL_SPEED = 0.05
"""Speed [m/s] below which the car counts as standing for the steering."""


class SteeringState(NamedTuple):
    """What the steering remembers besides the angle of the wheel."""

    lagged: float = 0.0
    """Request after dead time and lag [rad]."""
    play: float = 0.0
    """Steering-wheel angle [rad] that the front wheels follow: the wheel's, less the backlash."""
    late: float = 0.0
    """The same a quarter of a step ago, of a body with mass."""


def turn_steering_wheel(
    angle: float, request: float, car: CarSteering, standstill_rate: float, h: float, speed: float
) -> float:
    """Return the steering-wheel angle [rad] ``h`` [s] later, on its way to ``request``; the car's ``speed`` [m/s]."""
    target = clamp(request, -car.angle_limit, car.angle_limit)
    rate = car.rate_limit
    if standstill_rate > 0.0 and abs(speed) < STANDSTILL_SPEED:
        rate = standstill_rate
    return move_towards(angle, target, rate * h)


def delay_request(
    line: tuple[float, ...], request: float, dead_time: float, start_ns: int, end_ns: int
) -> tuple[float, ...]:
    """Return the requests [rad] of the dead time [s] at ``end_ns``, ``request`` held since ``start_ns``."""
    cell_ns = int(dead_time * 1e9 / DELAY_CELLS + 0.5)
    for _ in range(min(DELAY_CELLS, end_ns // cell_ns - start_ns // cell_ns)):
        line = line[1:] + (request,)
    return line


def pass_request(
    state: SteeringState, request: float, params: SteeringParams, start_ns: int, end_ns: int
) -> SteeringState:
    """Return the steering with ``request`` [rad], which comes after the dead time, from ``start_ns`` to ``end_ns``."""
    share = 1.0
    if params.lag > 0.0:
        share = 1.0 - math.exp(-(end_ns - start_ns) * 1e-9 / params.lag)
    lagged = state.lagged + share * (request - state.lagged) if share < 1.0 else request
    return state._replace(lagged=lagged)


def take_up_play(play: float, angle: float, backlash: float) -> float:
    """Return the steering-wheel angle [rad] the front wheels follow when the wheel is at ``angle``."""
    return clamp(play, angle - 0.5 * backlash, angle + 0.5 * backlash)
