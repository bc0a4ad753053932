"""The inner chart: plan, set the wheel, drive, halt, and so on until in place; then straighten the wheel."""

from enum import IntEnum

from controller_fmu.common.chart import Row, next_state


class Step(IntEnum):
    """What the assist is doing while it parks."""

    IDLE = 0
    PLAN = 1
    SET_WHEEL = 2
    DRIVE = 3
    HALT = 4
    STRAIGHTEN = 5
    DONE = 6


class Guard(IntEnum):
    """Conditions that are worked out at every sample; one bit each."""

    STARTED = 0
    IN_PLACE = 1
    """The car stands as it should, or nothing better is left and it stands well enough."""
    PLANNED = 2
    """The next move is found, and driving is allowed."""
    WHEEL_SET = 3
    MUST_HALT = 4
    """The end of the move, a jump of its curvature, or something in the way."""
    STANDING_TO_GO_ON = 5
    """Standing within a move, the way is free."""
    STANDING_AT_END = 6
    WHEEL_STRAIGHT = 7


def _row(source: Step, guard: Guard, target: Step) -> Row:
    return (int(source), int(guard), int(target))


TRANSITIONS: tuple[Row, ...] = (
    _row(Step.IDLE, Guard.STARTED, Step.PLAN),
    _row(Step.PLAN, Guard.IN_PLACE, Step.STRAIGHTEN),
    _row(Step.PLAN, Guard.PLANNED, Step.SET_WHEEL),
    _row(Step.SET_WHEEL, Guard.WHEEL_SET, Step.DRIVE),
    _row(Step.DRIVE, Guard.MUST_HALT, Step.HALT),
    _row(Step.HALT, Guard.STANDING_AT_END, Step.PLAN),
    _row(Step.HALT, Guard.STANDING_TO_GO_ON, Step.SET_WHEEL),
    _row(Step.STRAIGHTEN, Guard.WHEEL_STRAIGHT, Step.DONE),
)


def step_transition(step: int, guards: int) -> int:
    """Return the step after one sample; ``guards`` holds bit g for guard g."""
    return next_state(step, guards, TRANSITIONS)
