"""The stages of the preview sequence."""

from enum import IntEnum


class PreviewStage(IntEnum):
    """What the two preview points have seen."""

    STRAIGHT = 0
    """L2 alternates between near and far."""
    SLOWING = 1
    """Far L2 has seen the curve (A): slow down, L2 = L1 + 2."""
    SHORTENED = 2
    """Near L2 has seen it (B): L1 from (6), L2 unchanged."""
    CURVE = 3
    """L1 has seen it (C): steer, L2 = L1 + 2."""
    LEAVING = 4
    """L2 has seen the exit (D)."""
