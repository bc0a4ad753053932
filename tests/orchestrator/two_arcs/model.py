"""Two arcs in reverse with a stop between them, steered at standstill; ends where the heading is zero again."""

import math
from typing import Annotated, NamedTuple

from modelkit.signal import Signal
from modelkit.vocabulary import Pose

WHEEL = 19.0 * math.atan(2.405 / 5.499)
TURN = 0.76379
SPEED = -0.3
STANDING, FIRST, SECOND, DONE = 0, 2, 8, 9
"""Its phases, by the numbers of ours: 9 is parked."""


class Params(NamedTuple):
    wheel_time: Annotated[float, Signal("s", "time for turning the wheel at standstill", 0.0, 10.0)] = 2.0


class Input(NamedTuple):
    odometry: Pose = Pose()


class Output(NamedTuple):
    steering_wheel_request: Annotated[float, Signal("rad", "requested steering-wheel angle")] = 0.0
    steering_active: Annotated[bool, Signal("1", "holds the wheel")] = True
    speed_control_active: Annotated[bool, Signal("1", "drives")] = True
    speed_request: Annotated[float, Signal("m/s", "requested speed, reverse negative")] = 0.0
    phase: Annotated[int, Signal("1", "how far it is")] = 0
    manoeuvres: Annotated[int, Signal("1", "manoeuvres")] = 1


class State(NamedTuple):
    phase: int = STANDING
    since_ns: int = 0


def initialize(params: Params) -> tuple[State, Output]:
    return State(), Output()


def step(state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    waited = state.since_ns * 1e-9 >= params.wheel_time
    heading = inputs.odometry.heading
    phase = state.phase
    if phase == STANDING and waited:
        phase = FIRST
    elif phase == FIRST and heading >= TURN:
        phase = SECOND
    elif phase == SECOND and waited and heading <= 0.0005:
        phase = DONE
    state = State(phase, state.since_ns + dt_ns if phase == state.phase else 0)
    drives = phase == FIRST or (phase == SECOND and state.since_ns * 1e-9 >= params.wheel_time)
    wheel = WHEEL if phase == SECOND else 0.0 if phase == DONE else -WHEEL
    return state, Output(wheel, True, True, SPEED if drives else 0.0, phase, 1)
