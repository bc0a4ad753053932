"""The driver: chooses speed and direction by a speed profile and by the prompts shown.

A prompt is acted on once it has stood for the reaction delay. The driver may ignore prompts to
stop, to change direction or to slow down, may drive faster than meant or unsteadily, may brake
or grab the wheel, and may take over, which means: brake to standstill and hold the wheel.
"""

import math
from typing import NamedTuple

from modelkit.maths import TWO_PI, wrap_angle
from modelkit.vocabulary import Pose, Prompt
from vehicle_fmu.interface import DriverParams

CONFIRM_LASTS = 0.5
"""How long the confirm button is pressed [s]."""
PREVIEW_DISTANCE = 3.0
"""A driver who follows a bend takes back an error within about twice this distance [m]."""


class DriverState(NamedTuple):
    """What the driver has seen and means to do."""

    seen: int = 0
    """Prompt shown now."""
    seen_since: int = 0
    """Time [ns] since when it is shown."""
    heeded: int = 0
    """Prompt the driver acts on."""
    direction: int = 0
    """-1 reverse, 0 stop, 1 forward."""
    takeover: bool = False


def watch(state: DriverState, prompt: int, time_ns: int, params: DriverParams) -> DriverState:
    """Return the driver's intention at ``time_ns`` with ``prompt`` on the display."""
    since = state.seen_since if prompt == state.seen else time_ns
    heeded = prompt if (time_ns - since) * 1e-9 >= params.reaction_delay else state.heeded
    takeover = state.takeover or time_ns * 1e-9 >= params.takeover_time or heeded == Prompt.TAKE_OVER
    direction = 0 if takeover else _direction(state.direction, heeded, params)
    return DriverState(prompt, since, heeded, direction, takeover)


def target_speed(
    state: DriverState, advised_speed: float, time_ns: int, distance: float, params: DriverParams
) -> float:
    """Return the speed [m/s] the driver wants, reverse negative.

    A driver who slows down when prompted also sets out no faster than is advised with the direction
    ("drive slowly forward"); 0 is no advice there.
    """
    speed = profile_speed(params, distance if params.profile_over_distance else time_ns * 1e-9)
    setting_out = state.heeded in (Prompt.FORWARD, Prompt.REVERSE) and advised_speed > 0.0
    if params.complies_with_slow_down and (state.heeded == Prompt.SLOW_DOWN or setting_out) and advised_speed < speed:
        speed = advised_speed
    if params.speed_error != 0.0:
        speed = speed * (1.0 + params.speed_error)
    if params.speed_oscillation_amplitude > 0.0 and speed > 0.0:
        speed = speed + params.speed_oscillation_amplitude * math.sin(
            TWO_PI * time_ns * 1e-9 / params.speed_oscillation_period
        )
        speed = max(0.0, speed)
    return state.direction * speed


def brakes(time_ns: int, params: DriverParams) -> bool:
    """Return whether the driver steps on the brake whatever is prompted."""
    return time_ns * 1e-9 >= params.brake_time


def grabs(time_ns: int, params: DriverParams) -> bool:
    """Return whether the driver turns the wheel against the controller."""
    return time_ns * 1e-9 >= params.steering_override_time


def switch_is_on(time_ns: int, params: DriverParams) -> bool:
    """Return whether the parking assist's switch is on."""
    return params.apa_switch_time <= time_ns * 1e-9 < params.apa_switch_off_time


def follows_bend(state: DriverState, params: DriverParams) -> bool:
    """Return whether the driver steers along a bend while nobody else has the wheel."""
    return params.road_curvature != 0.0 and state.direction > 0 and not state.takeover


def front_wheel_angle_along_bend(pose: Pose, start: Pose, wheelbase: float, curvature: float) -> float:
    """Return the front-wheel angle [rad] that leads back to the arc of ``curvature`` [1/m] through ``start``.

    The errors of place and heading against the arc die out, critically damped, over the preview distance.
    """
    cos = math.cos(start.heading)
    sin = math.sin(start.heading)
    x = (pose.x - start.x) * cos + (pose.y - start.y) * sin
    y = (pose.y - start.y) * cos - (pose.x - start.x) * sin
    to_centre_x = curvature * x
    to_centre_y = 1.0 - curvature * y
    distance = math.sqrt(to_centre_x * to_centre_x + to_centre_y * to_centre_y)
    aside = (1.0 - distance) / curvature
    turn = wrap_angle(pose.heading - start.heading - math.atan2(to_centre_x, to_centre_y))
    wanted = curvature - 2.0 * turn / PREVIEW_DISTANCE - aside / (PREVIEW_DISTANCE * PREVIEW_DISTANCE)
    return math.atan(wheelbase * wanted)


def presses_confirm(state: DriverState, time_ns: int, params: DriverParams) -> bool:
    """Return whether the driver modelled presses the confirm button: at its time, or because it was asked for."""
    if params.confirms_when_asked and state.heeded == Prompt.CONFIRM:
        return True
    return params.confirm_time <= time_ns * 1e-9 < params.confirm_time + CONFIRM_LASTS


def profile_speed(params: DriverParams, at: float) -> float:
    """Return the speed [m/s] of the last profile point not after ``at`` [s or m]; 0 before the first."""
    speed = 0.0
    for point in params.profile:
        if point.at <= at:
            speed = point.speed
    return speed


def _direction(direction: int, heeded: int, params: DriverParams) -> int:
    if heeded == Prompt.STOP and params.complies_with_stop:
        return 0
    if heeded in (Prompt.FORWARD, Prompt.REVERSE) and (direction == 0 or params.complies_with_direction):
        return 1 if heeded == Prompt.FORWARD else -1
    return direction
