"""A neighbour, or the wall, that stands nearer than the map has it: found while the car stands before it.

The map learns from echoes that are about where it expects them. Where the search was wrong by more, the car stands
before an echo that nothing explains. If it does not go away, it is no passer-by: the map with one thing nearer that
explains best what all twelve sensors hear is taken for it, and the way is planned again.
"""

from typing import NamedTuple

from controller_fmu.apa.around.arcs import LOOKED_AT, Unknown
from controller_fmu.apa.around.guard import GuardState, is_known
from controller_fmu.apa.around.local_map import (
    NOBODY,
    WALL,
    A,
    B,
    LocalMap,
    ear_on,
    expected,
    neighbour_of,
    with_neighbour,
)
from controller_fmu.apa.around.thing import Thing, thing_at
from controller_fmu.apa.hearing.mute import is_mute
from controller_fmu.apa.params import ApaSystemParams
from controller_fmu.apa.slot import Kind
from modelkit.maths import clamp

STEP = 0.06
STEPS = 20
"""Things are tried so many times so much [m] nearer."""
WAYS = ((A, 1.0, 0.0), (B, -1.0, 0.0), (WALL, 0.0, 1.0), (A, 0.0, 1.0), (B, 0.0, 1.0))
"""Who, and which way nearer: along the road into the slot, or out towards it; neighbours across the road come out.

Who stands there when a car itself comes out is a person on the road."""
MOST = 0.3
"""No reading says more [m] against a map: it may be lost, or of something else."""
BETTER = 0.2
"""A map is better whose distances are nearer to what is heard by so much [m], summed over all sensors."""
NEAR = 0.6
PRESSED = 0.04
"""Something no farther than ``NEAR`` [m] beside which the car may not begin to move is so much [m] nearer."""


class Nearer(NamedTuple):
    """A map that explains better what is heard, if there is one."""

    found: bool
    map: LocalMap


def nearer_than_thought(here: LocalMap, readings: tuple[float, ...], params: ApaSystemParams) -> Nearer:
    """Return the map with that thing nearer which explains best what is heard."""
    best = Nearer(False, here)
    least = misfit(here, readings, params) - BETTER
    for who, along, out in WAYS:
        comes_out = here.kind == Kind.PERPENDICULAR and not here.within
        if here.walled if who == WALL else along != 0.0 or comes_out:
            for number in range(STEPS):
                way = STEP * (number + 1)
                there = _moved(here, who, way * along, way * out, params)
                off = misfit(there, readings, params)
                if off < least:
                    least = off
                    best = Nearer(True, there)
    return best


def pressed(here: LocalMap, readings: tuple[float, ...], params: ApaSystemParams) -> LocalMap:
    """Return the map with that neighbour nearer who is heard nearest: as it has him, the car could go on beside him."""
    sensors = params.car.ultrasonic
    least = NEAR
    who = NOBODY
    for number in range(12):
        ear = ear_on(here, sensors, number)
        if readings[number] < least:
            least = readings[number]
            who = expected(ear, here).who
    if who not in (A, B):
        return here
    thing = neighbour_of(here, who)
    return with_neighbour(here, who, thing._replace(x=thing.x + PRESSED if who == A else thing.x - PRESSED))


def misfit(here: LocalMap, readings: tuple[float, ...], params: ApaSystemParams) -> float:
    """Return by how much [m] the readings are off what the map lets expect, summed over all sensors."""
    sensors = params.car.ultrasonic
    total = 0.0
    for number in range(12):
        if not is_mute(readings[number]):
            ear = ear_on(here, sensors, number)
            told = clamp(expected(ear, here).echo.distance, sensors.min_range, LOOKED_AT)
            total += min(MOST, abs(min(readings[number], LOOKED_AT) - told))
    return total


def _moved(here: LocalMap, who: int, along: float, out: float, params: ApaSystemParams) -> LocalMap:
    if who == WALL:
        return here._replace(wall=_placed(here.wall, along, out, params))
    return with_neighbour(here, who, _placed(neighbour_of(here, who), along, out, params))


def _placed(thing: Thing, along: float, out: float, params: ApaSystemParams) -> Thing:
    """Return a thing elsewhere, less sure than a car may be parked beside."""
    unsure = params.apa.map
    return thing_at(thing.x + along, thing.y + out, thing.heading, unsure.certain + 0.5 * STEP, unsure.turned)


def explained(state: GuardState, readings: tuple[float, ...], here: LocalMap, params: ApaSystemParams) -> GuardState:
    """Return the guard without the echoes that the map explains now."""
    sensors = params.car.ultrasonic
    unknown = state.unknown
    for number in range(12):
        ear = ear_on(here, sensors, number)
        if is_known(readings[number], expected(ear, here).echo.distance, params):
            unknown = unknown[:number] + (Unknown(),) + unknown[number + 1 :]
    return state._replace(unknown=unknown)
