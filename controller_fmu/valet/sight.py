"""What the distance sensors hear that the map does not have: slow down and stop before it, and remember it.

A reading of a sensor on the driven side is compared with what it should hear from the polygons of the map. Nearer
than that by ``surprise`` is something unknown. What is known is left to the path.
"""

import math
from typing import NamedTuple

from controller_fmu.common.sensors import sensor_at
from controller_fmu.planning.plan import Piece, take_corner
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.planning.task import CORNERS, Corner, drive
from controller_fmu.sensing.gap import Gap, GapLayout
from controller_fmu.sensing.in_gap import point_in_gap
from controller_fmu.valet.params import MAP_CORNERS, ValetParams
from controller_fmu.valet.signals import ValetInput
from modelkit.car import car_length
from modelkit.geometry import Point, cone_line
from modelkit.maths import sign
from modelkit.vocabulary import Pose

FREE = 100.0
LOOKED_AT = 1.5
"""Readings [m] up to this are looked at."""
CORNER = 0.3
"""Neighbours of a slot that was found are not known everywhere: corner sensors are heeded from here on [m]."""
CORNER_SURPRISE = 0.1
APART = 0.5
APART_SURPRISE = 0.25
"""Beyond the slot's neighbours less is known: so near [m] there, by so much [m], it may end between two sensors."""
TOUCHING = 0.22
"""What corner and side sensors hear so near [m] is nearly touched: there a smaller surprise [m] counts."""
TOUCHING_SURPRISE = 0.04
SIDE = 0.2
"""What lies beside the car is heeded from here on [m], and this much nearer [m] than known."""
SENSORS = 12
SIDE_SENSOR = 8
BEND = 0.05
"""A front swings out where the way bends by more [1/m]."""
CLOSE = 0.18
"""Straight ahead, nothing is let come nearer than this [m] in a slot that was found, known or not.

A corner of the car is so far from its sensor: on the way into a slot that was found, the car could stop before it.
"""
AT_CORNER = 0.21
"""What a corner sensor that leads hears so near [m] is as good as touched, known or not."""
NEARER = 0.05
"""A corner of the car is so much nearer [m] than its sensor to what that hears: the car drives slowly sooner."""
SOON = 0.05
"""What a corner sensor hears is left if what is known there is farther off so much [m] of way later."""
CLOSEST = 0.07
"""But where the move ends before that, up to so much [m]."""
BOTH = 0.25
"""What a slot ends at is heard by both sensors that look straight ahead, as far off but for this [m]."""
SAME = 0.8
"""What the other of them hears of it lies no farther [m] from there."""
AGAIN = 0.1
"""A standing car sets out again when there is so much more room [m]."""
SEEN_CORNERS = CORNERS - MAP_CORNERS
"""Four corners for each thing remembered."""
SEEN_WIDTH = 0.8
SEEN_DEPTH = 0.5
"""A thing that was heard is taken to be so large [m]; its front is where the echo came from."""
SMALL = 0.1
"""And what a corner or side sensor heard beside the way into a slot."""
NUMBER = 1_000_000
"""Number of the first polygon of what was heard."""


class Sight(NamedTuple):
    """What is in the way."""

    speed: float = FREE
    """Largest speed [m/s] with which the car still stops in time."""
    blocked: bool = False
    ahead: bool = False
    """It was heard straight ahead."""
    echo: Pose = Pose()
    """Where the nearest unknown thing was heard, and in which direction."""


class SensorOnWay(NamedTuple):
    """One sensor, as a car drives on."""

    number: int
    at: Pose
    reading: float
    leads: bool
    """It looks where the car is going, or swings out."""
    ahead: bool
    """It looks straight there."""


def look(store: PlanStore, inputs: ValetInput, piece: Piece, gap: Gap, params: ValetParams) -> Sight:
    """Return the sight of a car that drives a ``piece``, the rest of its move, on its way into a ``gap``, or no gap."""
    readings = inputs.ultrasonic
    first = 0 if piece.way > 0.0 else 4
    swings = _swinging_corner(piece) if params.search.active else -1
    nearest = FREE
    leading = FREE
    echo = Pose()
    straight = False
    for number in range(SENSORS):
        on_side = number >= SIDE_SENSOR and params.search.active
        reading = readings[number]
        leads = first <= number < first + 4 or number == swings
        off = reading if first < number < first + 3 else reading - NEARER
        leading = off if leads and off < leading else leading
        if (leads or on_side) and reading < LOOKED_AT and reading < nearest:
            at = sensor_at(params.car.ultrasonic.mounts[number], inputs.odometry)
            ahead = first < number < first + 3 and params.search.active
            one = SensorOnWay(number, at, reading, leads, ahead)
            if _stops(store, one, inputs.odometry, piece, gap, params):
                nearest = reading
                beside = readings[2 * first + 3 - number] if ahead else reading
                straight = ahead and abs(beside - reading) < BOTH
                echo = _end_of(at, reading)
    if params.search.active and not straight and nearest < FREE:
        end = end_ahead(inputs, piece.way > 0.0, params)
        straight = end.heard and end.reading < nearest
        echo = end.echo if straight else echo
    return _sight(nearest, leading, abs(inputs.measured_speed), straight, echo, params)


def _stops(store: PlanStore, one: SensorOnWay, pose: Pose, piece: Piece, gap: Gap, params: ValetParams) -> bool:
    """Return whether a car stops before what a sensor hears.

    Into or out of a slot along the road what a corner sensor hears stands before or behind the car: what is known
    there does not stop a car that leaves it. Across the road a corner swings past it.
    """
    if one.ahead or not params.search.active:
        close = one.ahead and one.reading < min(CLOSE, abs(piece.way) + CLOSEST)
        return close or one.reading < expected(store, one.at, params) - params.guard.surprise
    near = SIDE if one.number >= SIDE_SENSOR else CORNER
    if one.reading >= APART or (one.reading >= near and not _is_apart(_end_of(one.at, one.reading), gap, params)):
        return False
    known = expected(store, one.at, params)
    stops = one.reading < known - _surprise(one.reading) or (one.leads and one.reading < AT_CORNER)
    if stops and gap.layout == GapLayout.ALONG and one.leads and one.reading > known - CORNER_SURPRISE:
        return not _leaves(store, one.number, pose, piece, known, params)
    return stops


def _is_apart(echo: Pose, gap: Gap, params: ValetParams) -> bool:
    """Return whether an echo came from beyond a gap's neighbours, where less was heard when it was found."""
    across = point_in_gap(echo.x, echo.y, gap).across
    beyond = params.car.width if gap.layout == GapLayout.ACROSS else car_length(params.car)
    return gap.layout != GapLayout.NONE and not -beyond < across < gap.width + beyond


class EndAhead(NamedTuple):
    """What both sensors that look straight ahead hear."""

    heard: bool = False
    reading: float = FREE
    """Of the nearer one [m]."""
    echo: Pose = Pose()


def end_ahead(inputs: ValetInput, forward: bool, params: ValetParams) -> EndAhead:
    """Return what both sensors straight ahead hear, or behind: the same thing, as far off but for ``BOTH``."""
    one = 1 if forward else 5
    readings = inputs.ultrasonic
    nearer = one if readings[one] < readings[one + 1] else one + 1
    reading = readings[nearer]
    heard = abs(readings[one] - readings[one + 1]) < BOTH and reading < LOOKED_AT
    at = sensor_at(params.car.ultrasonic.mounts[nearer], inputs.odometry)
    return EndAhead(heard, reading, _end_of(at, reading))


def _end_of(at: Pose, reading: float) -> Pose:
    """Return the point so far [m] from a sensor, along its axis."""
    return Pose(at.x + reading * math.cos(at.heading), at.y + reading * math.sin(at.heading), at.heading)


def _sight(nearest: float, leading: float, speed: float, straight: bool, echo: Pose, params: ValetParams) -> Sight:
    """Return the sight of a car with something unknown ``nearest`` [m] to it, or anything ``leading`` [m] before it."""
    room = nearest - params.guard.gap
    law = params.drive
    stop = speed * law.delay + 0.5 * speed * speed / law.brake
    if speed <= params.threshold.standstill:
        stop = AGAIN
    fast = math.sqrt(law.brake * max(room, 0.0))
    if params.search.active:
        fast = min(fast, math.sqrt(2.0 * law.deceleration * max(leading - CLOSE, 0.0)))
    return Sight(fast, room <= stop, straight, echo)


def _leaves(store: PlanStore, number: int, pose: Pose, piece: Piece, known: float, params: ValetParams) -> bool:
    """Return whether a sensor leaves what it should hear, ``known`` [m] off, on a ``piece`` driven from ``pose``."""
    soon = drive(pose, sign(piece.way) * SOON, piece.k)
    return expected(store, sensor_at(params.car.ultrasonic.mounts[number], soon), params) >= known


def heard_again(sight: Sight, before: Sight) -> Sight:
    """Return a sight after another: what both sensors heard straight ahead is so if one of them misses an echo now."""
    x = sight.echo.x - before.echo.x
    y = sight.echo.y - before.echo.y
    same = sight.blocked and before.blocked and before.ahead and x * x + y * y < SAME * SAME
    return sight._replace(ahead=sight.ahead or same)


def _swinging_corner(piece: Piece) -> int:
    """Return the sensor at the front corner that swings out where the car backs around a bend; -1: none does."""
    if piece.way > 0.0 or abs(piece.k) < BEND:
        return -1
    return 3 if piece.k > 0.0 else 0


def _surprise(reading: float) -> float:
    """Return how much nearer [m] than the map says something beside the way is that is unknown."""
    if reading > CORNER:
        return APART_SURPRISE
    return CORNER_SURPRISE if reading > TOUCHING else TOUCHING_SURPRISE


def expected(store: PlanStore, at: Pose, params: ValetParams) -> float:
    """Return the distance [m] that a sensor should hear from the scene's polygons, at most its range."""
    start = Point(at.x, at.y)
    half = params.car.ultrasonic.half_angle
    nearest = params.car.ultrasonic.max_range
    first = 0
    for number in range(len(store.corner_x)):
        polygon = store.corner_of[number]
        if polygon > 0:
            if number > 0 and store.corner_of[number - 1] != polygon:
                first = number
            last = number == len(store.corner_x) - 1
            goes_on = store.corner_of[0 if last else number + 1] == polygon and not last
            after = number + 1 if goes_on else first
            a = Point(store.corner_x[number], store.corner_y[number])
            b = Point(store.corner_x[after], store.corner_y[after])
            gap = cone_line(start, at.heading, half, a, b)
            nearest = gap if gap < nearest else nearest
    return nearest


def remembered(seen: tuple[Corner, ...], echo: Pose, count: int, small: bool) -> tuple[Corner, ...]:
    """Return the things heard with one more, the ``count``-th; the oldest is forgotten when there is no room."""
    width = SMALL if small else SEEN_WIDTH
    depth = SMALL if small else SEEN_DEPTH
    first = 4 * (count % (SEEN_CORNERS // 4))
    c = math.cos(echo.heading)
    s = math.sin(echo.heading)
    for corner in range(SEEN_CORNERS):
        if first <= corner < first + 4:
            side = corner - first
            x = 0.0 if side == 0 or side == 3 else depth
            y = 0.5 * width if side < 2 else -0.5 * width
            new = Corner(echo.x + x * c - y * s, echo.y + x * s + y * c, NUMBER + count)
            seen = seen[:corner] + (new,) + seen[corner + 1 :]
    return seen


def take_scene(store: PlanStore, params: ValetParams, seen: tuple[Corner, ...]) -> None:
    """Take over the map's polygons, or those made of what was heard in a search, and what was heard besides."""
    room = len(params.map)
    for number in range(len(params.map)):
        if params.search.active:
            heard = Corner(store.around_x[number], store.around_y[number], store.around_of[number])
            take_corner(store, number, heard)
        else:
            take_corner(store, number, params.map[number])
    for number in range(len(seen)):
        take_corner(store, room + number, seen[number])
