"""Learns the steering from what it does, and tells a wheel that fails from one that is only slow.

A wheel that is off its request must come nearer. It may be late (dead time), slow (rate) or filtered
(lag), and it may go on towards an earlier request; it may not stand still or go away.
So no number of the steering has to be known to find a fault.

What is learnt: the dead time, from a jump of the request at rest to the first movement; the rate,
where the wheel goes evenly towards a far request; the lag, where it creeps up to one that holds.
Each replaces what was believed only where it differs from it by more than the measurement can err.
"""

from typing import NamedTuple

from modelkit.maths import clamp, sign

MIN_PROGRESS_ANGLE = 0.05
PROGRESS_FRACTION = 0.15
PROGRESS_TIME = 0.02
"""Coming nearer means: by this share of the angle, at most as far as the known rate goes in this time [s], but by
``MIN_PROGRESS_ANGLE`` [rad] at least."""
REQUEST_FILTER_TIME = 0.15
"""Time constant [s] of what was asked for a moment ago."""
REQUEST_JUMP = 0.3
MIN_MOVEMENT = 0.02
SHORTEST_DEAD_TIME = 0.05
"""The loop itself takes two samples; a dead time [s] is one that is longer than this."""
LONGEST_DEAD_TIME = 0.5
USUAL_DEAD_TIME = 0.1
"""A dead time [s] up to this needs no more time than is allowed anyway."""
FIRST_RESPONSE_TIME = 0.2
FIRST_RESPONSE_ANGLE = 0.01
"""A steering that has not yet been seen to follow, and has begun to by so much [rad], may take this much [s] longer to
come nearer: its lag and rate are unknown yet."""
WINDOW_NS = 100_000_000
STEADY_RATE_TOLERANCE = 0.05
"""Two windows are even, and a rate is as believed, if they differ by less than this share."""
FAR_REQUEST = 0.5
HELD_REQUEST = 0.02
LAG_RATE_RATIO = 0.8
LAG_FIT_TOLERANCE = 0.2
"""A wheel is held back by its lag where it becomes slower as it comes nearer, in proportion to what is left."""
LONGEST_LAG = 1.0


class Steering(NamedTuple):
    """The steering as it is known."""

    rate: float = 0.0
    """Largest steering-wheel rate [rad/s]; 0: nothing learnt yet, what is believed holds."""
    dead_time: float = 0.0
    lag: float = 0.0
    seen: bool = False
    """The wheel has been seen to move when asked."""


class Stretch(NamedTuple):
    """A stretch of the wheel's movement, being measured."""

    length_ns: int = 0
    angle: float = 0.0
    request: float = 0.0
    rate: float = 0.0
    """Of the window before [rad/s]."""


class SteeringMonitorState(NamedTuple):
    """What the monitor remembers."""

    steering: Steering = Steering()
    off_ns: int = 0
    """The wheel is off its request and has not come nearer for so long."""
    away_ns: int = 0
    """Of this, time in which it went away."""
    anchor: float = 0.0
    """Angle [rad] from which coming nearer counts."""
    side: float = 0.0
    """On which side of the wheel its request lies; 0: it is there."""
    angle: float = 0.0
    """At the last sample [rad], with its request."""
    request: float = 0.0
    late: float = 0.0
    """What was asked for a moment ago [rad]."""
    asked_ns: int = -1
    """Since the request jumped away from a wheel at rest; -1: it did not."""
    window: Stretch = Stretch()


def at_rest(angle: float, steering: Steering) -> SteeringMonitorState:
    """Return the watch over a wheel at ``angle`` [rad] that nothing is asked of."""
    window = Stretch(angle=angle, request=angle)
    return SteeringMonitorState(steering=steering, anchor=angle, angle=angle, request=angle, late=angle, window=window)


def watch_steering(
    state: SteeringMonitorState, request: float, angle: float, tolerance: float, believed_rate: float, dt_ns: int
) -> SteeringMonitorState:
    """Return the watch after ``request`` [rad] held for ``dt_ns`` and brought the wheel to ``angle`` [rad]."""
    dt = dt_ns * 1e-9
    moved = angle - state.angle
    late = state.late + (request - state.late) * dt / (dt + REQUEST_FILTER_TIME)
    side = sign(request - angle) if abs(request - angle) > tolerance else 0.0
    step = clamp(
        PROGRESS_FRACTION * abs(request - angle),
        MIN_PROGRESS_ANGLE,
        MIN_PROGRESS_ANGLE + PROGRESS_TIME * rate_of(state.steering, believed_rate),
    )
    nearer = side * (angle - state.anchor) >= step
    away = side * moved < 0.0
    explained = away and side * (late - angle) < 0.0
    follows = side == 0.0 or side != state.side or nearer or explained
    asked_ns, dead_time = _dead_time(state, request, angle, tolerance, dt_ns)
    kept_up = side == 0.0 and abs(angle - state.window.angle) > MIN_MOVEMENT
    seen = state.steering.seen or nearer or kept_up
    window, rate, lag = _window(state, request, angle, believed_rate, dt_ns)
    return SteeringMonitorState(
        steering=Steering(rate, dead_time, lag, seen),
        off_ns=0 if follows else state.off_ns + dt_ns,
        away_ns=0 if follows else state.away_ns + dt_ns if away else state.away_ns,
        anchor=angle if follows or away else state.anchor,
        side=side,
        angle=angle,
        request=request,
        late=late,
        asked_ns=asked_ns,
        window=window,
    )


def has_failed(state: SteeringMonitorState, longest: float) -> bool:
    """Return whether the wheel has stood or gone away for ``longest`` [s], longer only if its dead time is long."""
    late = state.steering.dead_time - USUAL_DEAD_TIME
    allowed = longest + 2.0 * late if late > 0.0 else longest
    begun = not state.steering.seen and state.side * (state.angle - state.anchor) >= FIRST_RESPONSE_ANGLE
    return state.off_ns * 1e-9 > (allowed + FIRST_RESPONSE_TIME if begun else allowed)


def rate_of(steering: Steering, believed: float) -> float:
    """Return the steering-wheel rate [rad/s]: as learnt, or as believed."""
    return steering.rate if steering.rate > 0.0 else believed


def delay_of(steering: Steering) -> float:
    """Return how late the wheel is [s], its rate left aside."""
    return steering.dead_time + steering.lag


def _dead_time(
    state: SteeringMonitorState, request: float, angle: float, tolerance: float, dt_ns: int
) -> tuple[int, float]:
    """Return the time since the request jumped [ns], -1 if none runs, and the dead time [s]."""
    known = state.steering.dead_time
    if state.asked_ns < 0:
        resting = abs(state.request - state.angle) <= tolerance and abs(state.request - state.late) <= tolerance
        jumped = resting and abs(request - state.request) > REQUEST_JUMP
        return (dt_ns if jumped else -1), known
    if state.side * (angle - state.anchor) < MIN_MOVEMENT and state.side != 0.0:
        return state.asked_ns + dt_ns, known
    dead_time = state.asked_ns * 1e-9
    if SHORTEST_DEAD_TIME < dead_time < LONGEST_DEAD_TIME:
        return -1, dead_time
    return -1, known


def _window(
    state: SteeringMonitorState, request: float, angle: float, believed_rate: float, dt_ns: int
) -> tuple[Stretch, float, float]:
    """Return the window being measured, the rate [rad/s] and the lag [s] as known after it."""
    window = state.window
    steering = state.steering
    length_ns = window.length_ns + dt_ns
    if length_ns < WINDOW_NS:
        return Stretch(length_ns, window.angle, window.request, window.rate), steering.rate, steering.lag
    moved = angle - window.angle
    rate = abs(moved) / (length_ns * 1e-9)
    before = abs(window.request - window.angle)
    left = abs(request - angle)
    towards = (request - angle) * moved > 0.0
    holds = abs(request - window.request)
    known = rate_of(steering, believed_rate)
    learnt = steering.rate
    lag = steering.lag
    if (
        towards
        and left > FAR_REQUEST
        and holds < 0.2 * abs(moved)
        and abs(rate - window.rate) < STEADY_RATE_TOLERANCE * rate
    ):
        learnt = rate if abs(rate - known) > STEADY_RATE_TOLERANCE * known else learnt
    elif (
        towards
        and holds < HELD_REQUEST
        and left > HELD_REQUEST
        and abs(moved) > HELD_REQUEST
        and rate < LAG_RATE_RATIO * window.rate
        and abs(rate * before - window.rate * left) < LAG_FIT_TOLERANCE * window.rate * left
    ):
        lag = 0.5 * (before + left) / rate
        lag = lag if lag < LONGEST_LAG else LONGEST_LAG
    return Stretch(0, angle, request, rate), learnt, lag
