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
    (SpeedMode.STAND, SteerMode.STRAIGHT),
    (SpeedMode.TURN_ROUND, SteerMode.STRONG_PD),
    (SpeedMode.SLOW, SteerMode.BANG_BANG),
    (SpeedMode.FAST, SteerMode.PD),
    (SpeedMode.APPROACH, SteerMode.PID),
    (SpeedMode.TURN_ROUND, SteerMode.EXTREMUM_HOLD),
    (SpeedMode.SLOW, SteerMode.EXTREMUM_HOLD),
    (SpeedMode.FAST, SteerMode.PD),
    (SpeedMode.APPROACH, SteerMode.PID),
    (SpeedMode.TURN_ROUND, SteerMode.STRONG_PD),
    (SpeedMode.SLOW, SteerMode.BANG_BANG),
    (SpeedMode.FAST, SteerMode.PD),
    (SpeedMode.APPROACH, SteerMode.PID),
)
"""Indexed by Characteristic; row 0: no state."""
