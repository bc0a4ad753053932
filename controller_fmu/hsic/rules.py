"""The production rules: IF characteristic state THEN speed mode and steering mode.

One row for each characteristic state. Modes are the paper's: bang-bang, proportional, integral,
derivative and extremum hold, and their sums.
"""

from enum import IntEnum


class SpeedMode(IntEnum):
    """How the speed is chosen."""

    STAND = 0
    TURN_ROUND = 1
    """Bang-bang: slow, towards the key point."""
    SLOW = 2
    """Extremum hold at the low speed."""
    FAST = 3
    """Extremum hold at the high speed."""
    APPROACH = 4
    """Proportional to the distance."""


class SteerMode(IntEnum):
    """How the front-wheel angle is chosen."""

    STRAIGHT = 0
    BANG_BANG = 1
    """Full lock by the sign of the switching line."""
    EXTREMUM_HOLD = 2
    """Full lock of the arc, held until the heading is reached."""
    PD = 3
    """Proportional and derivative."""
    PID = 4
    """Proportional, integral and derivative."""
    STRONG_PD = 5
    """PD, strengthened."""


RULES = (
    (SpeedMode.STAND.value, SteerMode.STRAIGHT.value),
    (SpeedMode.TURN_ROUND.value, SteerMode.STRONG_PD.value),
    (SpeedMode.SLOW.value, SteerMode.BANG_BANG.value),
    (SpeedMode.FAST.value, SteerMode.PD.value),
    (SpeedMode.APPROACH.value, SteerMode.PID.value),
    (SpeedMode.TURN_ROUND.value, SteerMode.EXTREMUM_HOLD.value),
    (SpeedMode.SLOW.value, SteerMode.EXTREMUM_HOLD.value),
    (SpeedMode.FAST.value, SteerMode.PD.value),
    (SpeedMode.APPROACH.value, SteerMode.PID.value),
    (SpeedMode.TURN_ROUND.value, SteerMode.STRONG_PD.value),
    (SpeedMode.SLOW.value, SteerMode.BANG_BANG.value),
    (SpeedMode.FAST.value, SteerMode.PD.value),
    (SpeedMode.APPROACH.value, SteerMode.PID.value),
)
"""Indexed by Characteristic; row 0: no state."""
