"""Phases of human-simulated intelligent control, and what is expected in each."""

from enum import IntEnum

from controller_fmu.common.phases import CommonPhase, PhaseExpectation


class HsicPhase(IntEnum):
    """What the system is at."""

    STANDBY = CommonPhase.STANDBY
    PRE_STEER = 1
    """The car stands, or comes to a stop, while the wheel turns to what the rule asks for."""
    PATH_TRACKING = 2
    """On the way to a key point, in either direction."""
    STRAIGHTEN = 8
    """At the end; the wheel turns straight."""
    PARKED = CommonPhase.PARKED
    FAILED = CommonPhase.FAILED
    TAKEOVER = CommonPhase.TAKEOVER


def motion_expectation(phase: int, direction: int) -> PhaseExpectation:
    """Return what is expected of driver and car in a phase; ``direction`` is that driven last, 1 forward."""
    driven = (1 if direction > 0 else -1) if phase == HsicPhase.PATH_TRACKING else 0
    steering = phase in (HsicPhase.PRE_STEER, HsicPhase.STRAIGHTEN)
    return PhaseExpectation(phase != HsicPhase.STANDBY, driven, steering)
