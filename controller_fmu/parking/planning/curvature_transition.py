"""A transition: in place of a jump of the path's curvature a linear change, half of its length before the joint.

The heading behind the transition is the path's, and the car is beside it by dk r^2 / 24. Half way along it the car is
off its direction by dk r / 8, and its nose swings out by so much times its length.
"""

import math
from typing import NamedTuple

SAME_CURVATURE = 1e-6
"""Curvatures nearer than this [1/m] are one."""


class TransitionState(NamedTuple):
    """What a car on a transition has more than the path."""

    curvature: float
    """[1/m]"""
    lateral: float
    """To the left [m]."""
    turned: float
    """Heading [rad], as the curvature takes it when the car goes forward."""


def transition_length(off: float, jump: float, longest: float) -> float:
    """Return the length [m], at most ``longest``, of a transition by ``jump`` [1/m] that ends ``off`` [m] aside."""
    return longest if abs(jump) * longest * longest <= 24.0 * off else math.sqrt(24.0 * off / abs(jump))


def lateral_offset_after(jump: float, length: float) -> float:
    """Return how far [m] to the left of its path a car is behind a transition: ``jump`` [1/m] over ``length`` [m]."""
    return jump * length * length / 24.0


def transition_state(jump: float, length: float, past: float, is_past: bool) -> TransitionState:
    """Return the state ``past`` [m] behind the joint, against the segment behind (``is_past``) or before it."""
    on = past + 0.5 * length
    share = on / length
    path_turned = 1.0 if is_past else 0.0
    return TransitionState(
        jump * (share - path_turned),
        jump * (on * on * share / 6.0 - path_turned * 0.5 * past * past),
        jump * (0.5 * on * share - path_turned * past),
    )
