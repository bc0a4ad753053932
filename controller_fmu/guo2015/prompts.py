"""What is displayed to the driver: the prompt of each state, and the speed advised ahead of trouble.

A wheel that has to swing to the path's curvature, dk away, does so late by D and for T = |d phi| / rate,
while the car drives on at v. The steering error holds for v D and then falls linearly over v T, which
leaves the car dk v^2 (T^2 / 3 + D T + D^2 / 2) beside the path. The speed that keeps this under e is

    v = sqrt(e / (dk (T^2 / 3 + D T + D^2 / 2)))

It is advised before a jump of the path's curvature, and held until the wheel has arrived.
"""

import math

from controller_fmu.common.steering_monitor import Steering, delay_of, rate_of
from controller_fmu.guo2015.params import GuoPrompts, GuoSystemParams
from controller_fmu.guo2015.path import Reference, curvature_after, distance_to_end, distance_to_jump
from controller_fmu.guo2015.planner import TwoArcPath
from modelkit.vocabulary import Prompt

PROMPT_OF_PHASE = (
    Prompt.NONE,
    Prompt.STOP,
    Prompt.REVERSE,
    Prompt.STOP,
    Prompt.FORWARD,
    Prompt.REVERSE,
    Prompt.FORWARD,
    Prompt.REVERSE,
    Prompt.STOP,
    Prompt.STOP,
    Prompt.STOP,
    Prompt.NONE,
)
"""One for each member of GuoPhase, in its order."""
USED_RATE_FRACTION = 0.8
"""Share of the wheel's rate that is used on a path without jumps of curvature."""
MOVING_SPEED = 0.05
"""A car faster than this [m/s] has set out."""


def path_speed(
    path: TwoArcPath, reference: Reference, speed: float, steering: Steering, params: GuoSystemParams
) -> float:
    """Return the speed [m/s] that lets the steering follow the path from here on."""
    prompting = params.guo2015.prompting
    advice = prompting.speed_limit
    if path.curve.swing > 0.0:
        rate = USED_RATE_FRACTION * rate_of(steering, params.car.steering.rate_limit) / params.car.steering.ratio
        advice = min(rate / path.curve.swing, advice)
    k = reference.curvature
    k_next = curvature_after(path, reference.piece)
    to_end = distance_to_end(path, reference)
    if to_end > 0.0:
        advice = min(_speed_before(prompting.creep_speed, to_end, speed, prompting), advice)
    if k_next * k <= 0.0 and k_next != 0.0:
        at_jump = swing_speed(
            math.atan(params.car.wheelbase * k), math.atan(params.car.wheelbase * k_next), steering, params
        )
        advice = min(_speed_before(at_jump, distance_to_jump(path, reference), speed, prompting), advice)
    return advice


def point_speed(distance: float, speed: float, params: GuoPrompts) -> float:
    """Return the speed [m/s] for point tracking, ``distance`` [m] before the point: slow (Guo 2015, Fig. 9)."""
    return min(_speed_before(params.creep_speed, distance, speed, params), params.point_speed)


def swing_speed(angle: float, wanted: float, steering: Steering, params: GuoSystemParams) -> float:
    """Return the speed [m/s] at which the front wheels may swing from ``angle`` to ``wanted`` [rad] on the move."""
    swing = abs(wanted - angle) * params.car.steering.ratio / rate_of(steering, params.car.steering.rate_limit)
    late = delay_of(steering)
    jump = abs(math.tan(wanted) - math.tan(angle)) / params.car.wheelbase
    moment = jump * (swing * swing / 3.0 + late * swing + 0.5 * late * late)
    limit = params.guo2015.prompting.speed_limit
    if moment * limit * limit <= params.guo2015.prompting.jump_deviation:
        return limit
    return math.sqrt(params.guo2015.prompting.jump_deviation / moment)


def stopping_distance(speed: float, params: GuoPrompts) -> float:
    """Return the way [m] the car is assumed to go on after the prompt to stop."""
    v = abs(speed)
    return v * params.reaction + 0.5 * v * v / params.deceleration


def prompt_of(phase: int, moving: bool, advice: float, params: GuoPrompts) -> int:
    """Return the prompt for ``phase``: to slow down where the advice asks for it and the car is moving."""
    if moving and advice < params.speed_limit:
        return Prompt.SLOW_DOWN
    return PROMPT_OF_PHASE[phase]


def is_moving(before: bool, speed: float, direction: int, standstill: float) -> bool:
    """Return whether the car moves in ``direction``; one that has set out does until it stands."""
    along = direction * speed
    return along > MOVING_SPEED or (before and along > standstill)


def _speed_before(speed_there: float, distance: float, speed: float, params: GuoPrompts) -> float:
    left = max(0.0, distance - abs(speed) * params.reaction)
    return math.sqrt(speed_there * speed_there + params.deceleration * left)
