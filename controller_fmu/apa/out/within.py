"""What a car on its way out tells of its surroundings beside the map: how far its neighbours stand out, and the street.

From within nobody has heard how far out the neighbours of a slot along the road stand: they are taken to stand out as
far as is likely, and never further in. What lies across the road comes within reach on the way; nothing nearer than a
street is wide is taken for it.
"""

import math

from controller_fmu.apa.around.local_map import OTHER_SIDE, LocalMap, ear_on
from controller_fmu.apa.out.standing_in import NARROWEST_ACROSS
from controller_fmu.apa.slot import UNSEEN, Kind
from controller_fmu.common.sensors import VALID_RANGE_FRACTION
from modelkit.car import CarUltrasonic

FURTHER = 0.3
"""Of what is heard there the nearest is kept, until it is heard so much [m] further off: it was somebody."""
LOST = 0.8
"""What was nearer than this share of the reach and is not heard any more is gone."""
SENSORS = (1, 2, 3, 10)
"""Sensors that look across the road in turn while the car turns to the left."""
SQUARE = math.cos(0.4)
"""A wall is heard at its distance by a sensor whose direction has this share, or more, across the road."""


def heard_within(here: LocalMap, readings: tuple[float, ...], sensors: CarUltrasonic) -> LocalMap:
    """Return the map of a car on its way out after new ``readings``."""
    if here.kind != Kind.PARALLEL:
        for place in SENSORS:
            number = place if here.frame.mirror > 0.0 else OTHER_SIDE[place]
            ear = ear_on(here, sensors, number)
            far = ear.y + readings[number]
            square = ear.ay > SQUARE
            if square and readings[number] >= sensors.max_range and here.across < ear.y + LOST * sensors.max_range:
                here = here._replace(across=UNSEEN)
            heard = (
                square
                and readings[number] < VALID_RANGE_FRACTION * sensors.max_range
                and far > here.a.y + NARROWEST_ACROSS
            )
            if heard and (far < here.across or far > here.across + FURTHER):
                here = here._replace(across=far)
        return here
    return here._replace(a=here.a._replace(y=max(here.a.y, 0.0)), b=here.b._replace(y=max(here.b.y, 0.0)))
