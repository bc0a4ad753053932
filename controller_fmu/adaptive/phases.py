"""Phases of driver-adaptive parking, and what is expected in each."""

from enum import IntEnum

from controller_fmu.common.phases import CommonPhase, PhaseExpectation


class AdaptivePhase(IntEnum):
    """State of the chart."""

    STANDBY = CommonPhase.STANDBY
    PRE_STEER = 1
    """The car stands; the wheel turns to what the route begins with."""
    PATH_TRACKING = 2
    """On a route in reverse."""
    STOP = 3
    """The driver is asked to stop, until the car stands."""
    TO_Q4 = 6
    """On a route forward: to where the next in reverse begins."""
    STRAIGHTEN = 8
    """In place; the wheel turns straight."""
    PARKED = CommonPhase.PARKED
    FAILED = CommonPhase.FAILED
    TAKEOVER = CommonPhase.TAKEOVER


def direction_of(phase: int) -> int:
    """Return the direction that a phase drives in: 1 forward, -1 in reverse, 0 none."""
    return 1 if phase == AdaptivePhase.TO_Q4 else -1 if phase == AdaptivePhase.PATH_TRACKING else 0


def motion_expectation(phase: int) -> PhaseExpectation:
    """Return what is expected of driver and car in a phase."""
    steering = phase in (AdaptivePhase.PRE_STEER, AdaptivePhase.STRAIGHTEN)
    return PhaseExpectation(phase != AdaptivePhase.STANDBY, direction_of(phase), steering)
