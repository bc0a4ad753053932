"""Phases of the valet as every controller tells them."""

from enum import IntEnum

from controller_fmu.common.phases import CommonPhase


class ValetPhase(IntEnum):
    """What the valet is at; while it plans it is in standby."""

    STANDBY = CommonPhase.STANDBY
    PRE_STEER = 1
    """The car stands; the wheel turns to what the piece begins with."""
    PATH_TRACKING = 2
    """On a piece of the path, in either direction."""
    STOP = 3
    """The car comes to a stop."""
    STRAIGHTEN = 8
    """At the goal; the wheel turns straight."""
    PARKED = CommonPhase.PARKED
    FAILED = CommonPhase.FAILED
    TAKEOVER = CommonPhase.TAKEOVER
