"""Who comes: what a sensor hears come nearer faster than the car's own way can bring it, with no word of where.

One filter a sensor of distance and rate. A reading that does not fit is of something else and begins anew, so only
what comes evenly counts. The car stands before somebody who comes; a standing car is nobody's fault.
"""

from typing import NamedTuple

from controller_fmu.apa.around.closing import JUMP
from controller_fmu.apa.around.cone import SILENT

FITS = 0.2
"""A reading that is further off [m] is of something else."""
WEIGHT = 0.5
WEIGHT_OF_RATE = 0.2
LEAST_WEIGHT = 0.1
"""What has been followed for long changes its rate less: noise alone comes no nearer."""
BUMPERS = 8
"""Sensors of the flanks come after these; the rim of their cones runs along oblique sides faster than the car."""
STRANGE = 0.4
"""The map has nothing up to so much [m] behind what is heard,"""
ALONE = 1.0
"""or so much for sensors of the flanks."""
EVENLY = 3
"""So many readings in a row must fit."""
BRIDGED = 2
"""Who is not heard so many times in a row is still thought to come."""
SWINGS = 1.3
"""A sensor at the front of a turning car is faster than its rear axle by up to this."""
COMES = 0.4
RUNS = 2.0
"""Nearer by so much and less [m/s] more than the car goes: it comes by itself."""
SLOWS = 1.0
"""A rate follows a car that brakes as late as if it slowed down by this [m/s2]."""
STEADY = 8
NEAR = 0.9
ODD = 0.2
LOOKED_AT = 2.0
"""So many readings in a row, of what is no farther [m], that are nearer than the map has it by so much and less [m]."""
SOON = 1.4
"""Who would be here within this time [s] is stood still for."""


class Comer(NamedTuple):
    """What a sensor hears, if it comes or goes evenly."""

    at: float = SILENT
    """Distance [m]."""
    rate: float = 0.0
    """Its change [m/s]."""
    fits: int = 0
    """Readings in a row that fitted."""
    nearer: float = 0.0
    """Than the map has anything there [m]."""


def followed(comer: Comer, reading: float, cycle: float, furthest: float, expected: float) -> Comer:
    """Return what a sensor follows after a reading, ``cycle`` [s] after the last; a lost one is bridged.

    The map ``expected`` to hear something so far [m] off.
    """
    then = _followed(comer, reading, cycle, furthest)
    return then._replace(nearer=expected - then.at)


def _followed(comer: Comer, reading: float, cycle: float, furthest: float) -> Comer:
    ahead = comer.at + comer.rate * cycle
    if reading >= furthest:
        return Comer(ahead, comer.rate, min(comer.fits, EVENLY + BRIDGED) - 1) if comer.fits > 0 else Comer()
    off = reading - ahead
    if comer.fits == 0:
        near = abs(reading - comer.at) < JUMP
        return Comer(reading, (reading - comer.at) / cycle if near else 0.0, 1 if near else 0)
    if abs(off) > FITS:
        return Comer(reading)
    weight = max(LEAST_WEIGHT, min(WEIGHT_OF_RATE, EVENLY * WEIGHT_OF_RATE / comer.fits))
    return Comer(ahead + WEIGHT * off, comer.rate + weight * off / cycle, comer.fits + 1)


def pace_after(pace: float, speed: float, cycle: float) -> float:
    """Return the pace [m/s] to which rates are compared: that of the car, or a little ago if it brakes."""
    return max(abs(speed), pace - SLOWS * cycle)


def somebody_comes(comers: tuple[Comer, ...], pace: float) -> bool:
    """Return whether something that is not on the map comes by itself to a car of this ``pace`` [m/s], and soon."""
    for number in range(12):
        comer = comers[number]
        strange = comer.nearer > (STRANGE if number < BUMPERS else ALONE) and comer.fits >= EVENLY
        if strange and comer.rate + SWINGS * pace < -COMES and comer.rate + pace > -RUNS:
            if comer.at < -comer.rate * SOON:
                return True
    return False


def is_odd(comers: tuple[Comer, ...]) -> bool:
    """Return whether something near is heard steadily, and plainly nearer than the map has it."""
    odd = False
    for comer in comers:
        odd = odd or (comer.fits >= STEADY and comer.at < NEAR and ODD < comer.nearer < LOOKED_AT)
    return odd
