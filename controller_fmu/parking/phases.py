"""Phases of the parking system as every controller reports them."""

from enum import IntEnum

from controller_fmu.common.phases import CommonPhase


class ParkingPhase(IntEnum):
    """What the system is at; while it searches and plans it is in standby."""

    STANDBY = CommonPhase.STANDBY
    PRE_STEER = 1
    """At standstill; the wheel turns to what the next segment begins with."""
    PATH_TRACKING = 2
    """Drives along the path, in either direction."""
    STOP = 3
    """Comes to a stop."""
    STRAIGHTEN = 8
    """At the goal; the wheel turns straight."""
    PARKED = CommonPhase.PARKED
    FAILED = CommonPhase.FAILED
    TAKEOVER = CommonPhase.TAKEOVER
