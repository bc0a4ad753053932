"""The manoeuvre chart: search, confirm, plan, steer, drive, stop, straighten; rows in order of priority.

Priority within a state: first what the driver does (switched off, takeover), then a fault, then what ends the state
early (a lost path, a blocked one), last what the state waits for.
"""

from enum import IntEnum

from controller_fmu.common.chart import Row as TransitionRow
from controller_fmu.common.chart import next_state
from controller_fmu.common.phases import CommonPhase


class ParkingState(IntEnum):
    """What the system is doing."""

    STANDBY = 0
    SEARCHING = 1
    """The driver drives past; slots are searched on both sides."""
    CONFIRMING = 2
    """Standstill: a path into the slot shown is planned, the driver's confirmation awaited."""
    PLANNING = 3
    STEERING = 4
    """Standstill; the wheel turns."""
    DRIVING = 5
    STOPPING = 6
    STRAIGHTENING = 7
    PARKED = 8
    FAILED = 9
    TAKEOVER = 10


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


class Strategy(IntEnum):
    """What the system does with the vehicle."""

    SLOT = 0
    """Into a slot that it searches, or that is given from outside."""
    POSE = 1
    """To a goal that is known, among the polygons of a map."""
    PULL_OUT = 2
    """Out of the slot in which the vehicle stands."""


class Condition(IntEnum):
    """Conditions evaluated at every sample, one bit each."""

    SWITCHED_ON = 0
    SWITCHED_OFF = 1
    TAKEN_OVER = 2
    FAULT = 3
    SLOT_FOUND = 4
    """A slot is found and the vehicle stands."""
    SLOT_REJECTED = 5
    """No path into the slot shown."""
    DRIVEN_ON = 6
    """The driver drove on instead of confirming, or chose another slot."""
    CONFIRMED = 7
    PLANNED = 8
    WHEEL_TURNED = 9
    """The wheel is where the segment needs it, and the way is free."""
    MUST_STOP = 10
    """The next planned stop, an obstacle, or a lost path is near."""
    REPLAN = 11
    """Standing off the path, or blocked for long."""
    AT_END = 12
    """Standing at the end of the path."""
    STANDING = 13
    """Standing, and the way is free."""
    IN_PLACE = 14
    """Wheel straight, at the goal."""
    MISSED = 15
    """Wheel straight, not at the goal."""
    NO_NEARER = 16
    """Standing in the slot, and no path leads nearer to the goal."""
    GOAL_KNOWN = 17
    """No slot is searched: the vehicle sets out at once."""
    RESUMED = 18
    """Switched on again at standstill near the slot that the vehicle was driven into."""
    WANTS_OUT = 19
    """Switched on at standstill to pull out of the slot."""


def _row(source: ParkingState, condition: Condition, target: ParkingState) -> TransitionRow:
    return (int(source), int(condition), int(target))


def _aborts(source: ParkingState) -> tuple[TransitionRow, TransitionRow, TransitionRow]:
    return (
        _row(source, Condition.TAKEN_OVER, ParkingState.TAKEOVER),
        _row(source, Condition.SWITCHED_OFF, ParkingState.TAKEOVER),
        _row(source, Condition.FAULT, ParkingState.FAILED),
    )


TRANSITIONS: tuple[TransitionRow, ...] = (
    _row(ParkingState.STANDBY, Condition.GOAL_KNOWN, ParkingState.PLANNING),
    _row(ParkingState.STANDBY, Condition.WANTS_OUT, ParkingState.CONFIRMING),
    _row(ParkingState.STANDBY, Condition.RESUMED, ParkingState.CONFIRMING),
    _row(ParkingState.STANDBY, Condition.SWITCHED_ON, ParkingState.SEARCHING),
    _row(ParkingState.SEARCHING, Condition.SWITCHED_OFF, ParkingState.STANDBY),
    _row(ParkingState.SEARCHING, Condition.FAULT, ParkingState.FAILED),
    _row(ParkingState.SEARCHING, Condition.SLOT_FOUND, ParkingState.CONFIRMING),
    _row(ParkingState.CONFIRMING, Condition.SWITCHED_OFF, ParkingState.STANDBY),
    _row(ParkingState.CONFIRMING, Condition.FAULT, ParkingState.FAILED),
    _row(ParkingState.CONFIRMING, Condition.SLOT_REJECTED, ParkingState.SEARCHING),
    _row(ParkingState.CONFIRMING, Condition.DRIVEN_ON, ParkingState.SEARCHING),
    _row(ParkingState.CONFIRMING, Condition.CONFIRMED, ParkingState.STEERING),
    *_aborts(ParkingState.PLANNING),
    _row(ParkingState.PLANNING, Condition.NO_NEARER, ParkingState.STRAIGHTENING),
    _row(ParkingState.PLANNING, Condition.PLANNED, ParkingState.STEERING),
    *_aborts(ParkingState.STEERING),
    _row(ParkingState.STEERING, Condition.REPLAN, ParkingState.PLANNING),
    _row(ParkingState.STEERING, Condition.WHEEL_TURNED, ParkingState.DRIVING),
    *_aborts(ParkingState.DRIVING),
    _row(ParkingState.DRIVING, Condition.MUST_STOP, ParkingState.STOPPING),
    *_aborts(ParkingState.STOPPING),
    _row(ParkingState.STOPPING, Condition.REPLAN, ParkingState.PLANNING),
    _row(ParkingState.STOPPING, Condition.AT_END, ParkingState.STRAIGHTENING),
    _row(ParkingState.STOPPING, Condition.STANDING, ParkingState.STEERING),
    *_aborts(ParkingState.STRAIGHTENING),
    _row(ParkingState.STRAIGHTENING, Condition.IN_PLACE, ParkingState.PARKED),
    _row(ParkingState.STRAIGHTENING, Condition.MISSED, ParkingState.PLANNING),
    _row(ParkingState.PARKED, Condition.SWITCHED_OFF, ParkingState.STANDBY),
    _row(ParkingState.FAILED, Condition.SWITCHED_OFF, ParkingState.STANDBY),
    _row(ParkingState.TAKEOVER, Condition.SWITCHED_OFF, ParkingState.STANDBY),
)


def next_parking_state(state: int, guards: int) -> int:
    """Return the state after one sample; ``guards`` holds bit c for condition c."""
    return next_state(state, guards, TRANSITIONS)
