"""The manoeuvre chart of NTBPTcwPT as a table (Guo 2015, Fig. 9 and 11).

A row says: in ``source``, when ``guard`` holds, go to ``target`` with ``leg`` as the next way to
drive. Rows are in order of priority. STOP brings the car to standstill, PRE_STEER turns the wheel
there to what the leg begins with, then the leg is driven.
"""

from enum import IntEnum

from controller_fmu.common.chart import ANY
from controller_fmu.interface import Phase


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


KEEP = -1
"""The leg stays as it is."""

Row = tuple[int, int, int, int]


def _row(source: int, guard: Guard, target: Phase, leg: int = KEEP) -> Row:
    return (int(source), int(guard), int(target), int(leg))


TRANSITIONS: tuple[Row, ...] = (
    _row(ANY, Guard.TAKEOVER, Phase.TAKEOVER),
    _row(ANY, Guard.FAULT, Phase.FAILED),
    _row(Phase.STANDBY, Guard.PLANNED, Phase.PRE_STEER, Phase.PATH_TRACKING),
    _row(Phase.PRE_STEER, Guard.WHEEL_SET_FOR_PATH, Phase.PATH_TRACKING),
    _row(Phase.PRE_STEER, Guard.WHEEL_SET_FOR_Q2, Phase.TO_Q2),
    _row(Phase.PRE_STEER, Guard.WHEEL_SET_FOR_Q1, Phase.TO_Q1),
    _row(Phase.PRE_STEER, Guard.WHEEL_SET_FOR_Q4, Phase.TO_Q4),
    _row(Phase.PRE_STEER, Guard.WHEEL_SET_FOR_Q3, Phase.TO_Q3),
    _row(Phase.PATH_TRACKING, Guard.PATH_END, Phase.STOP, Phase.STRAIGHTEN),
    _row(Phase.PATH_TRACKING, Guard.OFF_PATH, Phase.STOP, Phase.TO_Q2),
    _row(Phase.TO_Q2, Guard.PAST_Q2, Phase.STOP, Phase.TO_Q1),
    _row(Phase.TO_Q1, Guard.AT_Q1_RIGHT, Phase.STOP, Phase.PATH_TRACKING),
    _row(Phase.TO_Q1, Guard.AT_Q1_WRONG, Phase.STOP, Phase.TO_Q2),
    _row(Phase.TO_Q4, Guard.POSE_RIGHT, Phase.STOP, Phase.STRAIGHTEN),
    _row(Phase.TO_Q4, Guard.PAST_Q4, Phase.STOP, Phase.TO_Q3),
    _row(Phase.TO_Q3, Guard.AT_Q3, Phase.STOP, Phase.STRAIGHTEN),
    _row(Phase.STOP, Guard.STANDING_TO_DRIVE, Phase.PRE_STEER),
    _row(Phase.STOP, Guard.STANDING_AT_END_WRONG, Phase.PRE_STEER, Phase.TO_Q4),
    _row(Phase.STOP, Guard.STANDING_AT_END, Phase.STRAIGHTEN),
    _row(Phase.STRAIGHTEN, Guard.WHEEL_STRAIGHT, Phase.PARKED),
)


def transition(phase: int, leg: int, guards: int) -> tuple[int, int]:
    """Return (phase, leg) after one sample; ``guards`` holds bit g for guard g."""
    if phase >= Phase.PARKED:
        return phase, leg
    for source, guard, target, next_leg in TRANSITIONS:
        if (source == phase or source == ANY) and (guards >> guard) & 1 == 1:
            return target, leg if next_leg == KEEP else next_leg
    return phase, leg
