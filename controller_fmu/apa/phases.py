"""Phases of the parking assist as every controller tells them; its own charts say more."""

from enum import IntEnum

from controller_fmu.common.phases import CommonPhase


class ApaPhase(IntEnum):
    """What the assist is at once the driver has confirmed; before, it is in standby."""

    STANDBY = CommonPhase.STANDBY
    PRE_STEER = 1
    """The car stands; the wheel turns to what the move begins with."""
    PATH_TRACKING = 2
    """On a move, in either direction."""
    STOP = 3
    """The car comes to a stop, or stands for the next move to be found."""
    STRAIGHTEN = 8
    """In place; the wheel turns straight."""
    PARKED = CommonPhase.PARKED
    FAILED = CommonPhase.FAILED
    TAKEOVER = CommonPhase.TAKEOVER
