"""Each step adds the gain to every cell of the rows that are lit."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from modelkit.signal import Signal


class Colour(IntEnum):
    RED = 1
    GREEN = 2
    BLUE = 4


class Row(NamedTuple):
    cells: tuple[Annotated[float, Signal("m", "a cell", -100.0, 100.0)], ...] = (0.0, 0.0, 0.0)
    lit: Annotated[bool, Signal("1", "takes part")] = True
    colour: Annotated[int, Signal("1", "colour", states=Colour)] = 1


class Params(NamedTuple):
    rows: tuple[Row, ...] = (Row((1.0, 2.0, 3.0), True, 1), Row((4.0, 5.0, 6.0), False, 4))
    one: tuple[Annotated[float, Signal("m", "alone in its array")], ...] = (7.0,)


class Input(NamedTuple):
    gain: Annotated[float, Signal("m", "added")] = 1.0
    lit: tuple[Annotated[bool, Signal("1", "which rows")], ...] = (True, True)


class Output(NamedTuple):
    now: tuple[Row, ...] = (Row(), Row())
    total: Annotated[float, Signal("m", "sum of all cells")] = 0.0


class State(NamedTuple):
    rows: tuple[Row, ...] = (Row(), Row())


def initialize(params: Params) -> tuple[State, Output]:
    return State(params.rows), Output(params.rows, total(params.rows) + params.one[0])


def step(state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    first = moved(state.rows[0], inputs.gain, inputs.lit[0])
    second = moved(state.rows[1], inputs.gain, inputs.lit[1])
    rows = (first, second)
    return State(rows), Output(rows, total(rows) + params.one[0])


def moved(row: Row, gain: float, lit: bool) -> Row:
    if not (row.lit and lit):
        return row
    return Row((row.cells[0] + gain, row.cells[1] + gain, row.cells[2] + gain), row.lit, row.colour)


def total(rows: tuple[Row, ...]) -> float:
    found = 0.0
    for row in rows:
        for cell in row.cells:
            found = found + cell
    return found
