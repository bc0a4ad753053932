"""Where an echo may come from: five points over an arc of the cone, or one if the map tells the direction."""

from typing import NamedTuple

from controller_fmu.apa.around.cone import ConeEar, Echo, rim_point
from controller_fmu.apa.around.near import nearest_told
from modelkit.car import CarUltrasonic
from modelkit.geometry import Point

LOOKED_AT = 1.5
"""Echoes from farther away [m] are not looked at."""
DIFFERENT = 0.5
LEFT = 0.4
"""What was too near to be told is forgotten where the sensor is so far [m] from it, and hears nothing."""
BEHIND = 2.0
"""What is unexplained is forgotten so far [m] from the sensor."""
SHARES = (-1.0, -0.5, 0.0, 0.5, 1.0)
NOWHERE = Point(1e3, 1e3)


class Unknown(NamedTuple):
    """An echo that the map does not explain: five points of the arc it may come from (map's frame)."""

    there: bool = False
    points: tuple[Point, ...] = (Point(0.0, 0.0),) * 5


def arc_of(ear: ConeEar, reading: float) -> Unknown:
    """Return the places that an echo may come from."""
    return Unknown(True, tuple(rim_point(ear, share, reading) for share in SHARES))


def not_refuted(kept: Unknown, ear: ConeEar, reading: float, known: bool) -> Unknown:
    """Return an arc that was kept, as long as the sensor is not far from its middle and, looking there, neither hears
    past it nor something ``known``.
    """
    dx = kept.points[2].x - ear.x
    dy = kept.points[2].y - ear.y
    seen = abs(dy * ear.ax - dx * ear.ay) * ear.cosine < (dx * ear.ax + dy * ear.ay) * ear.sine
    far = dx * dx + dy * dy
    return Unknown(not (seen and (known or far < reading * reading)) and far < BEHIND * BEHIND, kept.points)


def held(close: Unknown, ear: ConeEar, reading: float, sensors: CarUltrasonic) -> Unknown:
    """Return what is too near to be told: as it was when it came so near, until it is heard farther off, or left."""
    if reading <= nearest_told(sensors):
        return close if close.there else arc_of(ear, sensors.min_range)
    dx = close.points[2].x - ear.x
    dy = close.points[2].y - ear.y
    return close if reading >= LOOKED_AT and dx * dx + dy * dy < LEFT * LEFT else Unknown()


def origin(ear: ConeEar, echo: Echo, reading: float) -> Point:
    """Return where an echo comes from [m]: as far as it says, in the direction in which the map has what it is of."""
    if echo.distance > reading + DIFFERENT or echo.distance < 0.05:
        return NOWHERE
    share = reading / echo.distance
    return Point(ear.x + share * (echo.x - ear.x), ear.y + share * (echo.y - ear.y))
