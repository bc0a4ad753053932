"""The outer chart of the parking assist as a table (source, section on the parking state control).

A row says: in ``source``, when ``guard`` holds, go to ``target``. Rows are in order of priority.
"""

from enum import IntEnum

from controller_fmu.common.chart import Row, next_state


class Mode(IntEnum):
    """States of the parking assist, named as in the source."""

    OFF = 0
    STANDBY = 1
    PARKING_SPACE_SEARCH = 2
    PARKING_SPACE_APPEARS = 3
    AUTO_PARKING_ASSIST = 4
    POSITION_TUNING = 5
    PARKING_FINISH = 6
    FAIL = 7


class Guard(IntEnum):
    """Conditions that are worked out at every sample; one bit each."""

    SWITCHED_OFF = 0
    """The switch is off."""
    TAKEN_OVER = 1
    """Wheel, brake, gear or a takeover signal by the driver while the assist drives."""
    FAULT = 2
    """There is a reason to fail."""
    SWITCHED_ON = 3
    READY = 4
    """Slow enough to search."""
    SLOT_GIVEN = 5
    """The car stands, and the slot is known without a search: given, from before, or the one to pull out of."""
    TOO_FAST = 6
    """Faster than the search allows."""
    SLOT_AT_STANDSTILL = 7
    """A valid slot is remembered and the car stands."""
    NO_PLAN = 8
    """No way into the slot was found; others may come."""
    DRIVEN_ON = 9
    """The driver drove on instead of confirming, or chose another slot."""
    CONFIRMED = 10
    """Confirmed at standstill, with a plan."""
    NEARLY = 11
    """The planned way is driven; something remains."""
    ENDED = 12
    """In place, the wheel straight."""
    WANTS_OUT = 13
    """The driver wants to pull out."""


def _row(source: int, guard: Guard, target: Mode) -> Row:
    return (int(source), int(guard), int(target))


TRANSITIONS: tuple[Row, ...] = (
    _row(Mode.OFF, Guard.SWITCHED_ON, Mode.STANDBY),
    _row(Mode.STANDBY, Guard.SWITCHED_OFF, Mode.OFF),
    _row(Mode.PARKING_SPACE_SEARCH, Guard.SWITCHED_OFF, Mode.OFF),
    _row(Mode.PARKING_SPACE_APPEARS, Guard.SWITCHED_OFF, Mode.OFF),
    _row(Mode.PARKING_FINISH, Guard.SWITCHED_OFF, Mode.OFF),
    _row(Mode.FAIL, Guard.SWITCHED_OFF, Mode.OFF),
    _row(Mode.AUTO_PARKING_ASSIST, Guard.TAKEN_OVER, Mode.FAIL),
    _row(Mode.POSITION_TUNING, Guard.TAKEN_OVER, Mode.FAIL),
    _row(Mode.STANDBY, Guard.FAULT, Mode.FAIL),
    _row(Mode.PARKING_SPACE_SEARCH, Guard.FAULT, Mode.FAIL),
    _row(Mode.PARKING_SPACE_APPEARS, Guard.FAULT, Mode.FAIL),
    _row(Mode.AUTO_PARKING_ASSIST, Guard.FAULT, Mode.FAIL),
    _row(Mode.POSITION_TUNING, Guard.FAULT, Mode.FAIL),
    _row(Mode.STANDBY, Guard.SLOT_GIVEN, Mode.PARKING_SPACE_APPEARS),
    _row(Mode.STANDBY, Guard.READY, Mode.PARKING_SPACE_SEARCH),
    _row(Mode.PARKING_SPACE_SEARCH, Guard.WANTS_OUT, Mode.STANDBY),
    _row(Mode.PARKING_SPACE_SEARCH, Guard.TOO_FAST, Mode.STANDBY),
    _row(Mode.PARKING_SPACE_SEARCH, Guard.SLOT_AT_STANDSTILL, Mode.PARKING_SPACE_APPEARS),
    _row(Mode.PARKING_SPACE_APPEARS, Guard.NO_PLAN, Mode.PARKING_SPACE_SEARCH),
    _row(Mode.PARKING_SPACE_APPEARS, Guard.DRIVEN_ON, Mode.PARKING_SPACE_SEARCH),
    _row(Mode.PARKING_SPACE_APPEARS, Guard.CONFIRMED, Mode.AUTO_PARKING_ASSIST),
    _row(Mode.AUTO_PARKING_ASSIST, Guard.ENDED, Mode.PARKING_FINISH),
    _row(Mode.AUTO_PARKING_ASSIST, Guard.NEARLY, Mode.POSITION_TUNING),
    _row(Mode.POSITION_TUNING, Guard.ENDED, Mode.PARKING_FINISH),
)


def transition(mode: int, guards: int) -> int:
    """Return the mode after one sample; ``guards`` holds bit g for guard g."""
    return next_state(mode, guards, TRANSITIONS)
