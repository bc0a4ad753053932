"""The chart of driver-adaptive parking as a table: stand, plan, set the wheel, drive to a stop, until in place."""

from enum import IntEnum

from controller_fmu.adaptive.phases import AdaptivePhase
from controller_fmu.common.chart import ANY_STATE, Row, next_state
from controller_fmu.common.phases import is_over


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


def _row(source: int, guard: Guard, target: AdaptivePhase) -> Row:
    return (int(source), int(guard), int(target))


TRANSITIONS: tuple[Row, ...] = (
    _row(ANY_STATE, Guard.TAKEOVER, AdaptivePhase.TAKEOVER),
    _row(ANY_STATE, Guard.FAULT, AdaptivePhase.FAILED),
    _row(AdaptivePhase.STANDBY, Guard.PLANNED, AdaptivePhase.PRE_STEER),
    _row(AdaptivePhase.PRE_STEER, Guard.WHEEL_SET_TO_REVERSE, AdaptivePhase.PATH_TRACKING),
    _row(AdaptivePhase.PRE_STEER, Guard.WHEEL_SET_TO_GO_AHEAD, AdaptivePhase.TO_Q4),
    _row(AdaptivePhase.PATH_TRACKING, Guard.MUST_STOP, AdaptivePhase.STOP),
    _row(AdaptivePhase.TO_Q4, Guard.MUST_STOP, AdaptivePhase.STOP),
    _row(AdaptivePhase.STOP, Guard.IN_PLACE, AdaptivePhase.STRAIGHTEN),
    _row(AdaptivePhase.STOP, Guard.PLANNED, AdaptivePhase.PRE_STEER),
    _row(AdaptivePhase.STRAIGHTEN, Guard.WHEEL_STRAIGHT, AdaptivePhase.PARKED),
)


def transition(phase: int, guards: int) -> int:
    """Return the phase after one sample; ``guards`` holds bit g for guard g."""
    if is_over(phase):
        return phase
    return next_state(phase, guards, TRANSITIONS)
