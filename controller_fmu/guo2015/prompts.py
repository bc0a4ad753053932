"""What the driver is told: the prompt of each state, and the speed advised ahead of trouble.

At a curvature jump dk the wheel swings for T = |d phi| / rate while the car drives v T; the error
left after the swing is dk (v T)^2 / 3. So the speed that keeps it under e is sqrt(3 e / |dk|) / T.
"""

import math

from controller_fmu.guo2015.path import Reference, curvature_after, distance_to_end, distance_to_jump
from controller_fmu.guo2015.planner import TwoArcPath
from controller_fmu.interface import ControllerParams, Phase, PromptParams
from modelkit.vocabulary import Prompt

PROMPT_OF_PHASE = (
    int(Prompt.NONE),
    int(Prompt.STOP),
    int(Prompt.REVERSE),
    int(Prompt.STOP),
    int(Prompt.FORWARD),
    int(Prompt.REVERSE),
    int(Prompt.FORWARD),
    int(Prompt.REVERSE),
    int(Prompt.STOP),
    int(Prompt.STOP),
    int(Prompt.STOP),
    int(Prompt.NONE),
)
"""One for each member of Phase, in its order."""
PATH_TRACKING = int(Phase.PATH_TRACKING)
SLOW_DOWN = int(Prompt.SLOW_DOWN)


def advised_speed(path: TwoArcPath, reference: Reference, speed: float, params: ControllerParams) -> float:
    """Return the speed [m/s] that lets the steering follow the path from here on."""
    prompting = params.prompting
    advice = prompting.speed_limit
    k = reference.curvature
    k_next = curvature_after(path, reference.piece)
    to_end = distance_to_end(path, reference)
    if to_end > 0.0:
        end = _speed_before(prompting.creep_speed, to_end, speed, prompting)
        advice = end if end < advice else advice
    if k_next * k <= 0.0 and k_next != 0.0:
        at_jump = jump_speed(k, k_next, params)
        jump = _speed_before(at_jump, distance_to_jump(path, reference), speed, prompting)
        advice = jump if jump < advice else advice
    return advice


def jump_speed(curvature: float, next_curvature: float, params: ControllerParams) -> float:
    """Return the speed [m/s] at which a jump of the reference curvature leaves the accepted error."""
    rate = params.steering_wheel_rate / params.steering_ratio
    swing = abs(math.atan(params.wheelbase * next_curvature) - math.atan(params.wheelbase * curvature)) / rate
    return math.sqrt(3.0 * params.prompting.jump_deviation / abs(next_curvature - curvature)) / swing


def stopping_distance(speed: float, params: PromptParams) -> float:
    """Return the way [m] the car is assumed to go on after the prompt to stop."""
    v = abs(speed)
    return v * params.reaction + 0.5 * v * v / params.deceleration


def prompt_of(phase: int, advice: float, params: PromptParams) -> int:
    """Return the prompt for ``phase``: on the path, to slow down where the advice asks for it."""
    if phase == PATH_TRACKING and advice < params.speed_limit:
        return SLOW_DOWN
    return PROMPT_OF_PHASE[phase]


def _speed_before(speed_there: float, distance: float, speed: float, params: PromptParams) -> float:
    left = distance - abs(speed) * params.reaction
    left = left if left > 0.0 else 0.0
    return math.sqrt(speed_there * speed_there + params.deceleration * left)
