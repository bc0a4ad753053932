"""Phases of the manoeuvre (Guo 2015, Fig. 9 and 11), and what is expected in each."""

from enum import IntEnum

from controller_fmu.common.phases import CommonPhase, PhaseExpectation


class GuoPhase(IntEnum):
    """State of the manoeuvre chart."""

    STANDBY = CommonPhase.STANDBY
    PRE_STEER = 1
    """The car stands; the wheel turns to what the next way begins with."""
    PATH_TRACKING = 2
    """On the planned path."""
    STOP = 3
    """The driver is asked to stop, until the car stands."""
    TO_Q2 = 4
    """Forward to Q2, after the path was left."""
    TO_Q1 = 5
    """Back to Q1, where the path goes on."""
    TO_Q4 = 6
    """Forward to Q4, to set the end right."""
    TO_Q3 = 7
    """Back to Q3, the end."""
    STRAIGHTEN = 8
    """In place; the wheel turns straight."""
    PARKED = CommonPhase.PARKED
    FAILED = CommonPhase.FAILED
    TAKEOVER = CommonPhase.TAKEOVER


DIRECTION_OF_PHASE = (0, 0, -1, 0, 1, -1, 1, -1, 0, 0, 0, 0)
"""Direction that each GuoPhase drives in, in its order."""


def motion_expectation(phase: int) -> PhaseExpectation:
    """Return what is expected of driver and car in a phase."""
    steering = phase in (GuoPhase.PRE_STEER, GuoPhase.STRAIGHTEN)
    return PhaseExpectation(phase != GuoPhase.STANDBY, DIRECTION_OF_PHASE[phase], steering)
