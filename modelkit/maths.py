"""Small functions that mean the same in CPython and in compiled code, to the last bit."""

import math

PI = math.pi
TWO_PI = 2.0 * math.pi


def clamp(value: float, low: float, high: float) -> float:
    """Return ``value`` held to [low, high]; NaN comes back as NaN."""
    if value < low:
        return low
    if value > high:
        return high
    return value


def sign(value: float) -> float:
    """Return 1.0, -1.0, or 0.0 for zero (and for NaN)."""
    if value > 0.0:
        return 1.0
    if value < 0.0:
        return -1.0
    return 0.0


def wrap_angle(angle: float) -> float:
    """Return ``angle`` [rad] in (-pi, pi]; any finite input."""
    if -PI < angle <= PI:
        return angle
    wrapped = angle - TWO_PI * math.floor(angle / TWO_PI + 0.5)
    if wrapped <= -PI:
        return PI
    if wrapped > PI:
        return PI
    return wrapped


def move_towards(value: float, target: float, largest_change: float) -> float:
    """Return ``value`` moved to ``target`` by at most ``largest_change`` (>= 0)."""
    change = target - value
    if change > largest_change:
        return value + largest_change
    if change < -largest_change:
        return value - largest_change
    return target


def is_finite(value: float) -> bool:
    """Return False for NaN and for both infinities."""
    return value - value == 0.0
