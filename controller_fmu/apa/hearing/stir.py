"""A neighbour who moves, though the map has him: by how much all sensors that hear him do so nearer than just now.

Of each sensor two means are kept, of the last readings and of those of the last second, both with what the car's own
way brings taken off. Where the map lets both follow a neighbour who comes, their difference tells it: his speed times
the time between the two means. One sensor may hear something else, two and more do not at once.
"""

from typing import NamedTuple

from controller_fmu.apa.around.cone import SILENT, ConeEar, Hit
from controller_fmu.apa.around.local_map import NOBODY, MapEcho
from modelkit.geometry import Point

WEIGHT = 0.4
"""Of a new reading in the mean of the last."""
MEMORY = 0.6
"""The older mean follows the newer one within so long [s]."""
JUMP = 0.25
"""A reading that is further off [m] is of something else."""
LOST = 3
"""So many readings of nothing in a row end what was followed."""
EVENLY = 3
"""So many readings must have been of the same."""
LEAST = 0.06
LEAST_SHARE = 0.08
"""Nearer by this [m], and this much [s] times the car's speed more, he moves."""
ITS_OWN = 0.5
"""A reading no further [m] from what the map has is of that."""
NEARBY = 1.2
"""Who is heard no farther [m] than this is stood still for."""
ALONE = 0.1
ALONE_SHARE = 0.1
NEARBY_ALONE = 2.2
"""The same where one sensor tells it; the share [m s] by the distance [m] to him."""
QUIET = 0.8
"""So long [s] after who moved was last heard to."""


class HeardOf(NamedTuple):
    """What a sensor hears of one whom the map has there, without what the car's own way brings."""

    who: int = NOBODY
    now: float = SILENT
    """Mean of the last readings [m]."""
    before: float = SILENT
    """Mean of those of the last second [m]."""
    readings: int = 0
    lost: int = 0
    off: float = 0.0
    """How much farther [m] than the map has him."""


class OwnWay(NamedTuple):
    """What the car's own way since the last reading brings a sensor nearer [m], to whom; to nobody: it is not known."""

    nearer: float = 0.0
    who: int = NOBODY
    off: float = 0.0
    """How much farther [m] it is heard than the map has it."""


def own_way(ear: ConeEar, before: Point, mapped: MapEcho, reading: float) -> OwnWay:
    """Return by how much a sensor that was ``before`` elsewhere has come nearer to what it hears: its way along n.

    n is the direction of a side that the map has square ahead, or of its corner; the rim of a cone tells none.
    """
    echo = mapped.echo
    plain = echo.hit == Hit.SQUARE or echo.hit == Hit.START
    if not plain or abs(reading - echo.distance) > ITS_OWN or echo.distance < 0.05:
        return OwnWay()
    dx = ear.x - before.x
    dy = ear.y - before.y
    return OwnWay((dx * (echo.x - ear.x) + dy * (echo.y - ear.y)) / echo.distance, mapped.who, reading - echo.distance)


def heard_on(heard: HeardOf, reading: float, cycle: float, furthest: float, own: OwnWay) -> HeardOf:
    """Return what is heard after a reading, ``cycle`` [s] after the last."""
    now = heard.now - own.nearer
    before = heard.before - own.nearer
    if reading >= furthest and heard.lost + 1 < LOST:
        return heard._replace(now=now, before=before, lost=heard.lost + 1)
    off = reading - now
    if reading >= furthest or own.who == NOBODY or own.who != heard.who or abs(off) > JUMP:
        return HeardOf(own.who, reading, reading, off=own.off)
    now = now + WEIGHT * off
    return HeardOf(own.who, now, before + cycle / (cycle + MEMORY) * (now - before), heard.readings + 1, 0, own.off)


def stirs(who: int, all_heard: tuple[HeardOf, ...], speed: float) -> bool:
    """Return whether one on the map comes nearer to a car of this ``speed`` [m/s] than it drives to him.

    What one sensor tells has to be more than what two and more agree on, and more for what is near: there the map
    tells less surely what the car's own way brings. And it has to be nearer than the map has him by now.
    """
    total = 0.0
    count = 0
    alone = False
    for heard in all_heard:
        if heard.who == who and heard.readings >= EVENLY:
            nearer = heard.before - heard.now
            if heard.now < NEARBY:
                total += nearer
                count += 1
            least = ALONE + ALONE_SHARE * abs(speed) / max(heard.now, 0.1)
            alone = alone or (heard.now < NEARBY_ALONE and nearer > least and heard.off < -ALONE)
    return alone or (count > 1 and total > count * (LEAST + LEAST_SHARE * abs(speed)))
