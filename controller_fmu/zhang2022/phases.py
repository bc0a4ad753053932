"""Phases of the quintic, MPC and PID system, and what is expected in each."""

from enum import IntEnum

from controller_fmu.common.phases import CommonPhase, PhaseExpectation


class ZhangPhase(IntEnum):
    """What the system is at."""

    STANDBY = CommonPhase.STANDBY
    PATH_TRACKING = 2
    """In reverse on the quintic path."""
    STRAIGHTEN = 8
    """At the target; the car brakes, the wheel turns straight."""
    PARKED = CommonPhase.PARKED
    FAILED = CommonPhase.FAILED
    TAKEOVER = CommonPhase.TAKEOVER


def expectation_of(phase: int) -> PhaseExpectation:
    """Return what is expected of driver and car in a phase."""
    direction = -1 if phase == ZhangPhase.PATH_TRACKING else 0
    return PhaseExpectation(phase != ZhangPhase.STANDBY, direction, phase == ZhangPhase.STRAIGHTEN)
