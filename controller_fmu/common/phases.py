"""The phases that every system has, and what a monitor must know of any other.

Each system has an enumeration of its own, with these four among its members; any other member means that it parks.
What two systems both have is of the same number and name in both: ``controller_fmu.registry`` makes the union of all.
"""

from enum import IntEnum
from typing import NamedTuple


class CommonPhase(IntEnum):
    """What every system may be in; at any other phase it is parking (or driving, where there is no slot)."""

    STANDBY = 0
    """Waits for a way to drive."""
    PARKED = 9
    """Done."""
    FAILED = 10
    """Given up; the reason says why."""
    TAKEOVER = 11
    """The driver has taken over."""


class PhaseExpectation(NamedTuple):
    """What is expected of driver and car in a phase."""

    begun: bool = True
    """False: in standby."""
    direction: int = 0
    """The car drives forward (1), in reverse (-1), or comes to a stop (0)."""
    steering: bool = False
    """The car stands and its wheel turns."""


def is_over(phase: int) -> bool:
    """Return whether a system has ended: parked, failed or taken over."""
    return phase in (CommonPhase.PARKED, CommonPhase.FAILED, CommonPhase.TAKEOVER)


def is_parking(phase: int) -> bool:
    """Return whether a system is at work: neither in standby nor at its end."""
    return phase != CommonPhase.STANDBY and not is_over(phase)
