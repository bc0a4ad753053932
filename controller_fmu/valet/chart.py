"""The valet's chart: plan, set the wheel, drive a piece, halt, and so on; at the goal straighten the wheel."""

from enum import IntEnum

from controller_fmu.common.chart import Row, next_state


class Step(IntEnum):
    """What the valet is doing."""

    PLAN = 0
    SET_WHEEL = 1
    DRIVE = 2
    HALT = 3
    STRAIGHTEN = 4
    PARKED = 5
    FAILED = 6
    TAKEN_OVER = 7


class Guard(IntEnum):
    """Conditions that are worked out at every sample; one bit each."""

    TAKEN_OVER = 0
    FAULT = 1
    """There is a reason to give up."""
    PLANNED = 2
    WHEEL_SET = 3
    """The wheel is turned as the piece needs it, and nothing unknown is in the way."""
    MUST_HALT = 4
    """The end of a piece, something in the way, or off the path."""
    STANDING_LOST = 5
    """Standing off the path, or something unknown has been in the way for long."""
    STANDING_AT_END = 6
    """Standing at the end of the last piece."""
    STANDING = 7
    IN_PLACE = 8
    """Wheel straight, at the goal."""
    MISSED = 9
    """Wheel straight, not at the goal."""


def _row(source: Step, guard: Guard, target: Step) -> Row:
    return (int(source), int(guard), int(target))


def _given_up(source: Step) -> tuple[Row, Row]:
    return _row(source, Guard.TAKEN_OVER, Step.TAKEN_OVER), _row(source, Guard.FAULT, Step.FAILED)


TRANSITIONS: tuple[Row, ...] = (
    *_given_up(Step.PLAN),
    _row(Step.PLAN, Guard.PLANNED, Step.SET_WHEEL),
    *_given_up(Step.SET_WHEEL),
    _row(Step.SET_WHEEL, Guard.STANDING_LOST, Step.PLAN),
    _row(Step.SET_WHEEL, Guard.WHEEL_SET, Step.DRIVE),
    *_given_up(Step.DRIVE),
    _row(Step.DRIVE, Guard.MUST_HALT, Step.HALT),
    *_given_up(Step.HALT),
    _row(Step.HALT, Guard.STANDING_LOST, Step.PLAN),
    _row(Step.HALT, Guard.STANDING_AT_END, Step.STRAIGHTEN),
    _row(Step.HALT, Guard.STANDING, Step.SET_WHEEL),
    *_given_up(Step.STRAIGHTEN),
    _row(Step.STRAIGHTEN, Guard.IN_PLACE, Step.PARKED),
    _row(Step.STRAIGHTEN, Guard.MISSED, Step.PLAN),
)


def step_transition(step: int, guards: int) -> int:
    """Return the step after one sample; ``guards`` holds bit g for guard g."""
    return next_state(step, guards, TRANSITIONS)
