"""A neighbour of a parallel slot who stands elsewhere than the map has him: he has driven on since it was found.

The map learns from echoes that are nearly where they should be; one that is half a metre nearer is to it of something
else. But cars move along themselves: for each such echo the shift is found at which a neighbour would be heard so near.
Where echo after echo of a car that drives tells the same shift, and no sensor hears past the place, he stands there.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.around.cone import ConeEar
from controller_fmu.apa.around.local_map import (
    A,
    B,
    LocalMap,
    ear_on,
    echo_of_neighbour,
    expected,
    neighbour_of,
    with_neighbour,
)
from controller_fmu.apa.around.near import nearest_told
from controller_fmu.apa.around.thing import wider
from controller_fmu.apa.hearing.mute import is_mute
from modelkit.car import CarUltrasonic

MOST = 1.2
"""Neighbours are looked for so far [m] from where the map has them,"""
LEAST = 0.15
"""and no nearer than this [m]: so much the map learns by itself."""
FARTHEST = 2.0
"""Echoes from farther away [m] are not looked at."""
NEARER = 0.12
"""An echo tells a shift that is nearer than expected by this [m] and a tenth of its distance."""
HALVINGS = 7
MEETS = 0.06
"""A shift explains an echo to this [m]."""
ALIKE = 0.15
"""Echoes tell the same shift if they differ by no more than this [m]."""
ENOUGH = 10
"""So many of them are believed."""
OLDER = 6
"""The mean is of about so many."""
UNSURE = 0.08
"""Who has moved is less sure by this [m]."""
NARROWER = 0.1
"""Cones may be so much [rad] narrower than thought."""
LOOKED_AT = 1.5
"""Sensors that he would be nearer to [m] than this are asked whether they hear past him."""
SAME = 0.1
"""He is heard where the map has him if he is to this [m]."""
PAST = 0.2
"""A sensor that hears something so much [m] farther than the neighbour would be hears past him."""


NO_SHIFT = 100.0
"""Where none explains an echo [m]."""


class Shift(NamedTuple):
    """By how much a neighbour seems to stand nearer."""

    by: float = 0.0
    """Mean of what the last echoes tell [m]."""
    echoes: int = 0


class Shifts(NamedTuple):
    """How far A and B seem to stand further in the slot."""

    a: Shift = Shift()
    b: Shift = Shift()


def followed(shifts: Shifts, here: LocalMap, readings: tuple[float, ...], sensors: CarUltrasonic) -> Shifts:
    """Return the shifts after new readings of all sensors."""
    lowest = nearest_told(sensors)
    a = shifts.a
    b = shifts.b
    for number in range(12):
        reading = readings[number]
        if lowest < reading < FARTHEST:
            ear = ear_on(here, sensors, number)
            if expected(ear, here).echo.distance - reading > NEARER + 0.1 * reading:
                a = _told(a, shift_that_explains(ear, here, A, reading))
                b = _told(b, shift_that_explains(ear, here, B, reading))
    return Shifts(a, b)


def _told(shift: Shift, by: float) -> Shift:
    """Return a shift after one more echo, which tells it to be ``by`` [m]."""
    if by < LEAST or by >= NO_SHIFT:
        return shift
    if shift.echoes == 0 or abs(by - shift.by) > ALIKE:
        return Shift(by, 1)
    return Shift(shift.by + (by - shift.by) / min(shift.echoes + 1, OLDER), shift.echoes + 1)


def shift_that_explains(ear: ConeEar, here: LocalMap, who: int, reading: float) -> float:
    """Return the least shift [m] into the slot at which a sensor hears a neighbour ``reading`` [m] away."""
    if here.empty_a if who == A else here.empty_b:
        return NO_SHIFT
    low = 0.0
    high = MOST
    if echo_of_neighbour(ear, shifted(here, who, high), who).distance > reading:
        return NO_SHIFT
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if echo_of_neighbour(ear, shifted(here, who, middle), who).distance > reading:
            low = middle
        else:
            high = middle
    off = abs(echo_of_neighbour(ear, shifted(here, who, high), who).distance - reading)
    return high if off < MEETS else NO_SHIFT


def shifted(here: LocalMap, who: int, by: float) -> LocalMap:
    """Return the map with a neighbour, along himself, ``by`` [m] further in the slot."""
    thing = neighbour_of(here, who)
    way = by if who == A else -by
    there = thing._replace(x=thing.x + way * math.cos(thing.heading), y=thing.y + way * math.sin(thing.heading))
    return with_neighbour(here, who, there)


class Relocated(NamedTuple):
    """The map with a neighbour where he stands now, and what is still followed."""

    map: LocalMap
    shifts: Shifts


def relocated(here: LocalMap, shifts: Shifts, readings: tuple[float, ...], sensors: CarUltrasonic) -> Relocated:
    """Return the map in which a neighbour stands where enough echoes have him, if no sensor hears past that place.

    Of two shifts that explain the same it is the less.
    """
    first = shifts.a.echoes >= ENOUGH and (shifts.b.echoes < ENOUGH or shifts.a.by < shifts.b.by)
    if not first and shifts.b.echoes < ENOUGH:
        return Relocated(here, shifts)
    who = A if first else B
    there = shifted(here, who, shifts.a.by if first else shifts.b.by)
    if _is_refuted(here, there, who, readings, sensors):
        return Relocated(here, Shifts())
    return Relocated(with_neighbour(there, who, wider(neighbour_of(there, who), UNSURE, 0.0)), Shifts())


def _is_refuted(here: LocalMap, there: LocalMap, who: int, readings: tuple[float, ...], sensors: CarUltrasonic) -> bool:
    """Return whether a sensor hears past a neighbour whom it should hear, or hears him where he was, and not there."""
    for number in range(12):
        reading = readings[number]
        narrow = ear_on(here, sensors, number, -NARROWER)
        distance = echo_of_neighbour(narrow, there, who).distance
        if distance < LOOKED_AT and reading > distance + PAST and not is_mute(reading):
            return True
        ear = ear_on(here, sensors, number)
        before = expected(ear, here)
        heard_there = before.who == who and reading < LOOKED_AT and abs(reading - before.echo.distance) < SAME
        if heard_there and abs(reading - echo_of_neighbour(ear, there, who).distance) > PAST:
            return True
    return False
