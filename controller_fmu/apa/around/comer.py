"""Who comes: what a sensor hears come nearer faster than the car's own way can bring it, with no word of where.

One filter a sensor of distance and rate. A reading that does not fit is of something else and begins anew, so only
what comes evenly counts. The car stands before somebody who comes; a standing car is nobody's fault.
"""

from typing import NamedTuple

from controller_fmu.apa.around.closing import JUMP, Track, own_reach
from controller_fmu.apa.around.cone import SILENT
from controller_fmu.apa.outline import Shape
from modelkit.car import CarUltrasonic

FITS = 0.2
"""A reading that is further off [m] is of something else."""
WEIGHT = 0.5
WEIGHT_OF_RATE = 0.2
BUMPERS = 8
"""Sensors of the flanks come after these; the rim of their cones runs along oblique sides faster than the car."""
EVENLY = 3
"""So many readings in a row must fit."""
SWINGS = 1.3
"""A sensor at the front of a turning car is faster than its rear axle by up to this."""
COMES = 0.4
"""Nearer by so much [m/s] more than the car goes: it comes by itself."""
SOON = 1.2
"""Who would be here within this time [s] is stood still for."""


class Comer(NamedTuple):
    """What a sensor hears, if it comes or goes evenly."""

    at: float = SILENT
    """Distance [m]."""
    rate: float = 0.0
    """Its change [m/s]."""
    fits: int = 0
    """Readings in a row that fitted."""


def followed(comer: Comer, reading: float, cycle: float, furthest: float) -> Comer:
    """Return what a sensor follows after a reading, ``cycle`` [s] after the last; a lost one is bridged."""
    ahead = comer.at + comer.rate * cycle
    if reading >= furthest:
        return Comer(ahead, comer.rate, comer.fits - 1) if comer.fits > 0 else Comer()
    off = reading - ahead
    if comer.fits == 0:
        near = abs(reading - comer.at) < JUMP
        return Comer(reading, (reading - comer.at) / cycle if near else 0.0, 1 if near else 0)
    if abs(off) > FITS:
        return Comer(reading)
    return Comer(ahead + WEIGHT * off, comer.rate + WEIGHT_OF_RATE * off / cycle, comer.fits + 1)


def somebody_comes(
    comers: tuple[Comer, ...], tracks: tuple[Track, ...], speed: float, car: Shape, sensors: CarUltrasonic
) -> bool:
    """Return whether something that is not on the map comes by itself to a car of this ``speed`` [m/s], and soon."""
    for number in range(BUMPERS):
        comer = comers[number]
        if tracks[number].strange and comer.fits >= EVENLY and comer.rate + SWINGS * abs(speed) < -COMES:
            left = comer.at - own_reach(sensors.mounts[number], car, sensors.half_angle)
            if left < -comer.rate * SOON:
                return True
    return False
