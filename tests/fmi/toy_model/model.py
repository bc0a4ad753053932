"""Nested types, tuples, a hidden state that no output shows, and faults on demand."""

import math
from enum import IntEnum
from typing import Annotated, NamedTuple

from modelkit.random import seed_state, uniform
from modelkit.signal import Group, Role, Signal

GAIN = 1.0


class Mode(IntEnum):
    SLEEPING = 0
    SWINGING = 1
    TIRED = 2


SLEEPING = int(Mode.SLEEPING)


class Oscillator(NamedTuple):
    position: Annotated[float, Signal("m", "distance from rest")] = 0.0
    velocity: Annotated[float, Signal("m/s", "velocity")] = 0.0


class Params(NamedTuple):
    stiffness: Annotated[float, Signal("N/m", "spring", 0.0, 1e4, "chosen"), Role.TUNABLE] = 40.0
    mass: Annotated[float, Signal("kg", "of each oscillator", 0.1, 100.0)] = 2.0
    start: Annotated[tuple[Oscillator, ...], Group("at the start", (("m", 10.0), ("m/s", 20.0)))] = (
        Oscillator(0.1, 0.0),
        Oscillator(-0.2, 0.5),
    )
    seed: Annotated[int, Signal("1", "of the noise", 0, 1000)] = 7
    noisy: Annotated[bool, Signal("1", "with noise on the angle"), Role.TUNABLE] = True
    broken: Annotated[bool, Signal("1", "initialize divides by zero")] = False
    drift: Annotated[tuple[Oscillator, ...], Role.TUNABLE] = (
        Oscillator(0.3, 0.2),
        Oscillator(-0.1, 0.4),
        Oscillator(0.05, -0.6),
    )


class Input(NamedTuple):
    force: tuple[Annotated[float, Signal("N", "on each oscillator")], ...] = (0.0, 0.0)
    wish: Annotated[int, Signal("1", "mode wished", states=Mode)] = 1
    brake: Annotated[bool, Signal("1", "stops both")] = False
    divisor: Annotated[float, Signal("1", "a step divides by it")] = 1.0


class Output(NamedTuple):
    oscillators: tuple[Oscillator, ...] = (Oscillator(), Oscillator())
    angle: Annotated[float, Signal("rad", "of the line through both, noisy"), Role.SAMPLED] = 0.0
    mode: Annotated[int, Signal("1", "mode", states=Mode)] = 0
    count: Annotated[int, Signal("1", "steps so far"), Role.LOCAL] = 0  # type: ignore[assignment]  # tuples have a method count
    resting: Annotated[bool, Signal("1", "braked")] = False
    drifted: Oscillator = Oscillator()
    pull: Annotated[float, Signal("N", "sum of the forces"), Role.LOCAL] = 0.0


class State(NamedTuple):
    oscillators: tuple[Oscillator, ...] = (Oscillator(), Oscillator())
    random: int = 1
    time_ns: int = 0
    count: int = 0  # type: ignore[assignment]  # tuples have a method count


def initialize(params: Params) -> tuple[State, Output]:
    count = 0
    if params.broken:
        count = int(1.0 / (params.mass - params.mass))
    state = State(params.start, seed_state(params.seed), 0, count)
    return state, Output(params.start, 0.0, SLEEPING, 0, False, params.drift[0], 0.0)


def step(state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    dt = dt_ns * 1e-9 * GAIN / inputs.divisor
    first = swing(state.oscillators[0], inputs.force[0], inputs.brake, params, dt)
    second = swing(state.oscillators[1], inputs.force[1], inputs.brake, params, dt)
    random, noise = uniform(state.random)
    angle = math.atan(second.position - first.position)
    if params.noisy:
        angle = angle + 1e-3 * noise
    new = State((first, second), random, state.time_ns + dt_ns, state.count + 1)
    return new, Output(
        (first, second),
        angle,
        inputs.wish,
        new.count,
        inputs.brake,
        drifted(params.drift, new.count, first),
        pull(inputs.force),
    )


def drifted(table: tuple[Oscillator, ...], count: int, now: Oscillator) -> Oscillator:
    """Read the parameters in all ways: item by item, by a variable, from the end, whole, or not at all."""
    place = count % len(table)
    total = 0.0
    for item in table:
        total = total + item.velocity
    chosen = table[place]
    if count > 50:
        chosen = table[-1] if count > 100 else now
    return Oscillator(chosen.position + total, chosen.velocity)


def pull(forces: tuple[float, ...]) -> float:
    total = 0.0
    for force in forces:
        total = total + force
    return total + 0.5 * forces[len(forces) - 1]


def swing(now: Oscillator, force: float, brake: bool, params: Params, dt: float) -> Oscillator:
    if brake:
        return Oscillator(now.position, 0.0)
    velocity = now.velocity + dt * (force - params.stiffness * now.position) / params.mass
    return Oscillator(now.position + dt * velocity, velocity)
