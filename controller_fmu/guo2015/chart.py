"""The manoeuvre chart of NTBPTcwPT as a table (Guo 2015, Fig. 9 and 11).

A row says: in ``source``, when ``guard`` holds, go to ``target`` with ``leg`` as the next way to
drive. Rows are in order of priority. STOP brings the car to standstill, PRE_STEER turns the wheel
there to what the leg begins with, then the leg is driven.
"""

from enum import IntEnum

from controller_fmu.common.chart import ANY_STATE
from controller_fmu.common.phases import is_over
from controller_fmu.guo2015.phases import GuoPhase


class Guard(IntEnum):
    """Conditions that are worked out at every sample; one bit each."""

    TAKEOVER = 0
    FAULT = 1
    PLANNED = 2
    WHEEL_SET_FOR_PATH = 3
    WHEEL_SET_FOR_Q2 = 4
    WHEEL_SET_FOR_Q1 = 5
    WHEEL_SET_FOR_Q4 = 6
    WHEEL_SET_FOR_Q3 = 7
    OFF_PATH = 8
    PATH_END = 9
    PAST_Q2 = 10
    AT_Q1_RIGHT = 11
    AT_Q1_WRONG = 12
    POSE_RIGHT = 13
    PAST_Q4 = 14
    AT_Q3 = 15
    STANDING_TO_DRIVE = 16
    STANDING_AT_END = 17
    STANDING_AT_END_WRONG = 18
    WHEEL_STRAIGHT = 19
    STANDING_AHEAD = 20


SAME_LEG = -1
"""The leg stays as it is."""

Row = tuple[int, int, int, int]


def _row(source: int, guard: Guard, target: GuoPhase, leg: int = SAME_LEG) -> Row:
    return (int(source), int(guard), int(target), int(leg))


TRANSITIONS: tuple[Row, ...] = (
    _row(ANY_STATE, Guard.TAKEOVER, GuoPhase.TAKEOVER),
    _row(ANY_STATE, Guard.FAULT, GuoPhase.FAILED),
    _row(GuoPhase.STANDBY, Guard.PLANNED, GuoPhase.PRE_STEER, GuoPhase.PATH_TRACKING),
    _row(GuoPhase.PRE_STEER, Guard.WHEEL_SET_FOR_PATH, GuoPhase.PATH_TRACKING),
    _row(GuoPhase.PRE_STEER, Guard.WHEEL_SET_FOR_Q2, GuoPhase.TO_Q2),
    _row(GuoPhase.PRE_STEER, Guard.WHEEL_SET_FOR_Q1, GuoPhase.TO_Q1),
    _row(GuoPhase.PRE_STEER, Guard.WHEEL_SET_FOR_Q4, GuoPhase.TO_Q4),
    _row(GuoPhase.PRE_STEER, Guard.WHEEL_SET_FOR_Q3, GuoPhase.TO_Q3),
    _row(GuoPhase.PATH_TRACKING, Guard.PATH_END, GuoPhase.STOP, GuoPhase.STRAIGHTEN),
    _row(GuoPhase.PATH_TRACKING, Guard.OFF_PATH, GuoPhase.STOP, GuoPhase.TO_Q2),
    _row(GuoPhase.TO_Q2, Guard.PAST_Q2, GuoPhase.STOP, GuoPhase.TO_Q1),
    _row(GuoPhase.TO_Q1, Guard.AT_Q1_RIGHT, GuoPhase.STOP, GuoPhase.PATH_TRACKING),
    _row(GuoPhase.TO_Q1, Guard.AT_Q1_WRONG, GuoPhase.STOP, GuoPhase.TO_Q2),
    _row(GuoPhase.TO_Q4, Guard.POSE_RIGHT, GuoPhase.STOP, GuoPhase.STRAIGHTEN),
    _row(GuoPhase.TO_Q4, Guard.PAST_Q4, GuoPhase.STOP, GuoPhase.TO_Q3),
    _row(GuoPhase.TO_Q3, Guard.AT_Q3, GuoPhase.STOP, GuoPhase.STRAIGHTEN),
    _row(GuoPhase.STOP, Guard.STANDING_TO_DRIVE, GuoPhase.PRE_STEER),
    _row(GuoPhase.STOP, Guard.STANDING_AT_END_WRONG, GuoPhase.PRE_STEER, GuoPhase.TO_Q4),
    _row(GuoPhase.STOP, Guard.STANDING_AHEAD, GuoPhase.PRE_STEER, GuoPhase.TO_Q3),
    _row(GuoPhase.STOP, Guard.STANDING_AT_END, GuoPhase.STRAIGHTEN),
    _row(GuoPhase.STRAIGHTEN, Guard.WHEEL_STRAIGHT, GuoPhase.PARKED),
)


GUARDS_OF_PHASE = tuple(
    sum(1 << guard for source, guard, _, _ in TRANSITIONS if source in (phase, ANY_STATE)) for phase in GuoPhase
)
"""The bits of the guards that lead out of each phase."""


def transition(phase: int, leg: int, guards: int) -> tuple[int, int]:
    """Return (phase, leg) after one sample; ``guards`` holds bit g for guard g."""
    if is_over(phase) or guards & GUARDS_OF_PHASE[phase] == 0:
        return phase, leg
    for source, guard, target, next_leg in TRANSITIONS:
        if (source == phase or source == ANY_STATE) and (guards >> guard) & 1 == 1:
            return target, leg if next_leg == SAME_LEG else next_leg
    return phase, leg
