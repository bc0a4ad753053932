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

    line: tuple[float, ...] = (0.0,) * DELAY_CELLS
    """Requests [rad] of the dead time, oldest first."""
    lagged: float = 0.0
    """Request after dead time and lag [rad]."""
    play: float = 0.0
    """Steering-wheel angle [rad] that the front wheels follow: the wheel's, less the backlash."""


def turn_steering_wheel(
    angle: float, request: float, car: CarSteering, standstill_rate: float, h: float, speed: float
) -> float:
    """Return the steering-wheel angle [rad] ``h`` [s] later, on its way to ``request``; the car's ``speed`` [m/s]."""
    target = clamp(request, -car.angle_limit, car.angle_limit)
    rate = car.rate_limit
    if standstill_rate > 0.0 and abs(speed) < STANDSTILL_SPEED:
        rate = standstill_rate
    return move_towards(angle, target, rate * h)


def pass_request(
    state: SteeringState, request: float, params: SteeringParams, start_ns: int, end_ns: int
) -> SteeringState:
    """Return the steering with ``request`` [rad] held from ``start_ns`` to ``end_ns`` at the head of its line."""
    line = state.line
    late = request
    if params.dead_time > 0.0:
        cell_ns = int(params.dead_time * 1e9 / DELAY_CELLS + 0.5)
        for _ in range(min(DELAY_CELLS, end_ns // cell_ns - start_ns // cell_ns)):
            line = line[1:] + (request,)
        late = line[0]
    share = 1.0
    if params.lag > 0.0:
        share = 1.0 - math.exp(-(end_ns - start_ns) * 1e-9 / params.lag)
    lagged = state.lagged + share * (late - state.lagged) if share < 1.0 else late
    return SteeringState(line, lagged, state.play)


def hold_request(angle: float, play: float) -> SteeringState:
    """Return the steering with nothing on its way: every request is the wheel's own ``angle`` [rad]."""
    return SteeringState((angle,) * DELAY_CELLS, angle, play)


def take_up_play(play: float, angle: float, backlash: float) -> float:
    """Return the steering-wheel angle [rad] the front wheels follow when the wheel is at ``angle``."""
    return clamp(play, angle - 0.5 * backlash, angle + 0.5 * backlash)
