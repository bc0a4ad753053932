"""How far a car may go before what the sensors hear straight where it drives, whatever it is of.

A wall or kerb behind the slot that the map has, and has surely, may come nearer than what nobody knows of: a car
that parks before a wheel stop stands in the row only if it comes near it.
"""

import math

from controller_fmu.apa.around.arcs import LOOKED_AT
from controller_fmu.apa.around.local_map import WALL, A, B, LocalMap, ear_on, expected
from controller_fmu.apa.around.near import FREE, nearest_told
from controller_fmu.apa.params import ApaSystemParams

STRAIGHT = 0.2
SURE = 0.03
"""A wall known to so much [m] may come nearer."""
WALL_GAP = 0.06
"""So near [m]."""
NEIGHBOUR_GAP = 0.05
"""A car on its way out may come so near [m] to the neighbours whom it heard before it set out."""
SAME = 0.06
"""An echo is of the wall if it says the distance to it to so much [m] and a tenth of it."""


def room_straight(readings: tuple[float, ...], here: LocalMap, direction: int, params: ApaSystemParams) -> float:
    """Return how far [m] the car may go by the nearest of the sensors that look straight where it drives."""
    sensors = params.car.ultrasonic
    guard = params.apa.guard
    lowest = nearest_told(sensors)
    sure = here.walled and here.wall.yy < SURE * SURE
    room = FREE
    first = 0 if direction > 0 else 4
    for number in range(first, first + 4):
        mount = sensors.mounts[number]
        reading = readings[number]
        yaw = abs(mount.yaw)
        ahead = yaw < STRAIGHT if direction > 0 else yaw > math.pi - STRAIGHT
        if ahead and reading < LOOKED_AT:
            free = reading - guard.stop_gap
            if sure or here.within:
                known = expected(ear_on(here, sensors, number), here)
                far = known.echo.distance
                told = (sure and known.who == WALL) or (here.within and (known.who == A or known.who == B))
                if told and abs(max(far, sensors.min_range) - reading) < SAME + 0.1 * reading:
                    gap = WALL_GAP if known.who == WALL else NEIGHBOUR_GAP
                    free = max(free, (min(reading, far) if reading > lowest else far) - gap)
            room = min(room, free)
    return room
