"""A sensor that hears nothing any more without saying so: nothing where the map has a neighbour right before it.

One lost echo says nothing, and a map may be wrong. But a neighbour whose place is known, whom another sensor hears
where he is, and who stands well within the cone and near, is heard by a sensor that works.
"""

import math

from controller_fmu.apa.around.local_map import A, B, LocalMap, ear_on, expected, neighbour_of, unsure_of
from controller_fmu.apa.hearing.mute import MUTE, is_mute
from controller_fmu.apa.hearing.stir import EVENLY, HeardOf
from controller_fmu.apa.slot import Kind
from modelkit.car import CarUltrasonic

NARROWER = 0.12
"""Who stands so far [rad] within the cone is heard: sensors look aside, and cones are narrower than thought."""
NEAR = 1.2
"""So near [m]: where it is needed."""
KNOWN = 0.15
"""His place is known to this [m]."""
WHERE = 0.1
"""Another sensor hears him where he is, to this [m]."""
SILENCES = 10
"""A sensor that should have heard him so many times, and heard nothing in between, is lost."""
SIDE = (3.5, 1.3)
DEPTH = (1.4, 3.4)
"""How far [m] along and across the road from his corner a neighbour is there for sure, of a parallel slot and else."""


def silences(
    before: int, reading: float, number: int, here: LocalMap, others: tuple[HeardOf, ...], sensors: CarUltrasonic
) -> int:
    """Return how many times in a row a sensor heard nothing where it should have; ``others``: what all have heard.

    From within a slot nobody has heard yet how deep neighbours are. Who is lost stays so on this map.
    """
    if is_mute(reading) or here.within:
        return before
    if reading < sensors.max_range:
        return 0
    told = expected(ear_on(here, sensors, number, -NARROWER), here)
    if told.who not in (A, B) or told.echo.distance > NEAR or unsure_of(here, told.who) > KNOWN:
        return before
    thing = neighbour_of(here, told.who)
    kind = 0 if here.kind == Kind.PARALLEL else 1
    dx = told.echo.x - thing.x
    dy = told.echo.y - thing.y
    c = math.cos(thing.heading)
    s = math.sin(thing.heading)
    sure = abs(dx * c + dy * s) < SIDE[kind] and abs(dy * c - dx * s) < DEPTH[kind]
    for heard in others:
        if sure and heard.who == told.who and heard.readings >= EVENLY and abs(heard.off) < WHERE:
            return before + 1
    return before


def without_deaf(readings: tuple[float, ...], counts: tuple[int, ...]) -> tuple[float, ...]:
    """Return the readings [m]; those of sensors that hear nothing any more tell nothing."""
    for number in range(12):
        if counts[number] >= SILENCES:
            readings = readings[:number] + (MUTE,) + readings[number + 1 :]
    return readings
