"""A small model with work arrays: a column of each type, written and read at places that move."""

import sys
from typing import Annotated, NamedTuple

from modelkit.model import Model
from modelkit.signal import Signal
from modelkit.store import Column, Floats, Ints

LENGTH = 50


class Work(NamedTuple):
    exact: Annotated[Floats, Column("d", LENGTH, "m", "what came in")]
    short: Annotated[Floats, Column("f", LENGTH, "m", "the same, rounded")]
    whole: Annotated[Ints, Column("i", LENGTH, "1", "counts")]
    small: Annotated[Ints, Column("h", 7, "1", "small counts")]


class Params(NamedTuple):
    gain: Annotated[float, Signal("1", "of what comes in", 0.0, 10.0)] = 0.7


class Input(NamedTuple):
    u: Annotated[float, Signal("m", "what comes in")] = 0.0
    jump: Annotated[int, Signal("1", "how far the place moves")] = 1
    skip: Annotated[bool, Signal("1", "nothing is written")] = False


class Output(NamedTuple):
    total: Annotated[float, Signal("m", "of all that came in")] = 0.0
    rounded: Annotated[float, Signal("m", "of the same, rounded")] = 0.0
    count: Annotated[int, Signal("1", "written so far")] = 0  # type: ignore[assignment]  # tuples have a method count


class State(NamedTuple):
    place: int = 0
    ready: bool = False


def note(store: Work, place: int, value: float) -> int:
    """Write a value; returns how often its place has been written."""
    store.exact[place] = value
    store.short[place] = 0.1 * value
    store.short[place] += value
    store.whole[place] += 1
    store.small[place % 7] = store.whole[place] * 100
    return store.whole[place]


def clear(store: Work, place: int) -> None:
    """Forget what stands at a place; places out of range stay."""
    if place < 0:
        return
    store.exact[place] = 0.0


def total(store: Work) -> float:
    """Return the sum of the exact column."""
    found = 0.0
    for place in range(LENGTH):
        found += store.exact[place]
    return found


def step(store: Work, state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    """Move the place on and write."""
    place = (state.place + inputs.jump) % LENGTH
    often = 0
    if not inputs.skip:
        often = note(store, place, params.gain * inputs.u)
    clear(store, place - 25)
    rounded = store.short[place] + store.short[(place + 1) % LENGTH]
    return State(place, True), Output(total(store), rounded, often + store.small[place % 7])


def initialize(params: Params) -> tuple[State, Output]:
    return State(), Output()


MODEL = Model(
    name="Worker",
    description="A model with work arrays",
    package=sys.modules[__name__],
    state=State,
    params=Params,
    inputs=Input,
    outputs=Output,
    initialize=initialize,
    step=step,
    step_size=0.01,
    stop_time=1.0,
    store=Work,
)
