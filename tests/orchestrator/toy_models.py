"""Two small models that speak all kinds of variables, for tests of everything but parking."""

import sys
from enum import IntEnum
from typing import Annotated, NamedTuple

from modelkit.model import Model
from modelkit.signal import Signal
from modelkit.vocabulary import Pose


class Mode(IntEnum):
    IDLE = 0
    BUSY = 1
    DONE = 200


class Cell(NamedTuple):
    charge: Annotated[float, Signal("1", "charge")] = 0.0
    mode: Annotated[int, Signal("1", "mode of the cell", states=Mode)] = 0


class PlantInput(NamedTuple):
    command: Annotated[float, Signal("m/s", "requested speed")] = 0.5
    mode: Annotated[int, Signal("1", "requested mode", states=Mode)] = 0
    active: Annotated[bool, Signal("1", "command holds")] = False
    right: Annotated[int, Signal("1", "count of the other side")] = 0


class PlantOutput(NamedTuple):
    pose: Pose = Pose()
    moving: Annotated[bool, Signal("1", "it moves")] = False
    left: Annotated[int, Signal("1", "count of this side")] = 0
    rays: Annotated[tuple[float, ...], Signal("m", "distances")] = (1.0, 2.0, 3.0)
    cells: tuple[Cell, ...] = (Cell(), Cell(0.5, 1))


class PlantParams(NamedTuple):
    gain: Annotated[float, Signal("1", "gain", 0.0, 10.0)] = 1.0
    start: Pose = Pose()


class PlantState(NamedTuple):
    x: float = 0.0
    time_ns: int = 0
    left: int = 0


def initialize_plant(params: PlantParams) -> tuple[PlantState, PlantOutput]:
    state = PlantState(params.start.x, 0, 0)
    return state, _plant_output(state, False)


def step_plant(
    state: PlantState, inputs: PlantInput, params: PlantParams, dt_ns: int
) -> tuple[PlantState, PlantOutput]:
    speed = params.gain * inputs.command if inputs.active else 0.0
    state = PlantState(state.x + speed * dt_ns / 1e9, state.time_ns + dt_ns, inputs.right + 1)
    return state, _plant_output(state, speed != 0.0)


def _plant_output(state: PlantState, moving: bool) -> PlantOutput:
    t = state.time_ns / 1e9
    cells = (Cell(t, int(Mode.BUSY)), Cell(-t, int(Mode.DONE)))
    return PlantOutput(Pose(state.x, t, 0.25), moving, state.left, (t, 2.0 * t, 3.0 * t), cells)


class BrainInput(NamedTuple):
    pose: Pose = Pose()
    moving: Annotated[bool, Signal("1", "it moves")] = False
    left: Annotated[int, Signal("1", "count of the other side")] = 0


class BrainOutput(NamedTuple):
    command: Annotated[float, Signal("m/s", "requested speed")] = 0.0
    mode: Annotated[int, Signal("1", "requested mode", states=Mode)] = 0
    active: Annotated[bool, Signal("1", "command holds")] = True
    right: Annotated[int, Signal("1", "count of this side")] = 0
    seen: Annotated[float, Signal("m", "y it saw last")] = 0.0


class BrainParams(NamedTuple):
    speed: Annotated[float, Signal("m/s", "speed it asks for")] = 2.0


class BrainState(NamedTuple):
    right: int = 0


def initialize_brain(params: BrainParams) -> tuple[BrainState, BrainOutput]:
    return BrainState(), BrainOutput(params.speed)


def step_brain(
    state: BrainState, inputs: BrainInput, params: BrainParams, dt_ns: int
) -> tuple[BrainState, BrainOutput]:
    state = BrainState(inputs.left + 1)
    return state, BrainOutput(params.speed, int(Mode.BUSY), True, state.right, inputs.pose.y)


HERE = sys.modules[__name__]
PLANT = Model(
    "Plant", "toy", HERE, PlantState, PlantParams, PlantInput, PlantOutput, initialize_plant, step_plant, 0.01, 1.0
)
BRAIN = Model(
    "Brain", "toy", HERE, BrainState, BrainParams, BrainInput, BrainOutput, initialize_brain, step_brain, 0.01, 1.0
)
