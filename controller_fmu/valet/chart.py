"""The valet's chart: find a slot if wished, plan, set the wheel, drive a piece, halt; at the goal straighten."""

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
    OFF = 8
    """Switched off: waits for the driver to want a slot."""
    SEARCH = 9
    """The driver drives past; a slot is looked for."""
    SHOWN = 10
    """Stands, a slot is shown: plans the way into it, waits to be confirmed."""


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
    SWITCHED_ON = 10
    """A slot is to be looked for, and the switch is on."""
    SWITCHED_OFF = 11
    """A slot is to be looked for, and the switch is off."""
    FOUND = 12
    """A slot has been found, and the car stands."""
    REFUSED = 13
    """No way into the slot that is shown."""
    DRIVEN_ON = 14
    """The driver drove on instead of confirming."""
    CONFIRMED = 15
    """Confirmed at standstill, with a plan."""
    RESUMED = 16
    """Switched on again at standstill on the way into a slot, which is still known."""


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
    *(_row(step, Guard.SWITCHED_OFF, Step.OFF) for step in (Step.PARKED, Step.FAILED, Step.TAKEN_OVER)),
    _row(Step.OFF, Guard.RESUMED, Step.SHOWN),
    _row(Step.OFF, Guard.SWITCHED_ON, Step.SEARCH),
    _row(Step.SEARCH, Guard.SWITCHED_OFF, Step.OFF),
    _row(Step.SEARCH, Guard.FAULT, Step.FAILED),
    _row(Step.SEARCH, Guard.FOUND, Step.SHOWN),
    _row(Step.SHOWN, Guard.SWITCHED_OFF, Step.OFF),
    _row(Step.SHOWN, Guard.FAULT, Step.FAILED),
    _row(Step.SHOWN, Guard.REFUSED, Step.SEARCH),
    _row(Step.SHOWN, Guard.DRIVEN_ON, Step.SEARCH),
    _row(Step.SHOWN, Guard.CONFIRMED, Step.SET_WHEEL),
)


def step_transition(step: int, guards: int) -> int:
    """Return the step after one sample; ``guards`` holds bit g for guard g."""
    return next_state(step, guards, TRANSITIONS)
