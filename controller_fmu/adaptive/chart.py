"""The chart of driver-adaptive parking as a table: stand, plan, set the wheel, drive one way, stop, until in place."""

from enum import IntEnum

from controller_fmu.common.chart import ANY, Row, next_state
from controller_fmu.interface import Phase


class Guard(IntEnum):
    """Conditions that are worked out at every sample; one bit each."""

    TAKEOVER = 0
    FAULT = 1
    IN_PLACE = 2
    PLANNED = 3
    WHEEL_SET_TO_REVERSE = 4
    WHEEL_SET_TO_GO_AHEAD = 5
    MUST_STOP = 6
    WHEEL_STRAIGHT = 7


def _row(source: int, guard: Guard, target: Phase) -> Row:
    return (int(source), int(guard), int(target))


TRANSITIONS: tuple[Row, ...] = (
    _row(ANY, Guard.TAKEOVER, Phase.TAKEOVER),
    _row(ANY, Guard.FAULT, Phase.FAILED),
    _row(Phase.STANDBY, Guard.PLANNED, Phase.PRE_STEER),
    _row(Phase.PRE_STEER, Guard.WHEEL_SET_TO_REVERSE, Phase.PATH_TRACKING),
    _row(Phase.PRE_STEER, Guard.WHEEL_SET_TO_GO_AHEAD, Phase.TO_Q4),
    _row(Phase.PATH_TRACKING, Guard.MUST_STOP, Phase.STOP),
    _row(Phase.TO_Q4, Guard.MUST_STOP, Phase.STOP),
    _row(Phase.STOP, Guard.IN_PLACE, Phase.STRAIGHTEN),
    _row(Phase.STOP, Guard.PLANNED, Phase.PRE_STEER),
    _row(Phase.STRAIGHTEN, Guard.WHEEL_STRAIGHT, Phase.PARKED),
)


def transition(phase: int, guards: int) -> int:
    """Return the phase after one sample; ``guards`` holds bit g for guard g."""
    if phase >= Phase.PARKED:
        return phase
    return next_state(phase, guards, TRANSITIONS)
