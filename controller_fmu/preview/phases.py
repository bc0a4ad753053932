"""Phases of driving a road."""

from enum import IntEnum

from controller_fmu.common.phases import CommonPhase


class PreviewPhase(IntEnum):
    """What the system is at."""

    STANDBY = CommonPhase.STANDBY
    PATH_TRACKING = 2
    """On the road."""
    STRAIGHTEN = 8
    """At the end of the road: brakes until the car stands."""
    PARKED = CommonPhase.PARKED
    """Stands at the end of the road."""
    FAILED = CommonPhase.FAILED
    TAKEOVER = CommonPhase.TAKEOVER
