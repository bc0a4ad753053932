"""The local map: two neighbours, what is behind the slot and across the road, each where the sensors hear it.

Everything is in one frame, A's frame as the slot was chosen, mirrored for a slot on the left; the odometry
drifts in it, so every thing becomes less sure with the way (``moved``) until it is heard again (``heard``).
A neighbour has a side along the road and a flank, square to it, with a heading of its own.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.around.cone import ConeEar, Echo, Hit, ear_of, echo_of
from controller_fmu.apa.around.thing import Slope, Thing, learnt, spread_along, thing_at, wider
from controller_fmu.apa.hearing.mute import is_mute
from controller_fmu.apa.outline import Stand, stand_at
from controller_fmu.apa.params import MapParams
from controller_fmu.apa.slot import UNSEEN, Kind, Slot, mirror_of
from controller_fmu.common.slot_frame import SlotFrame, to_slot
from modelkit.car import CarUltrasonic, SensorMount
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

SOME_EAR = ConeEar(0.0, 0.0, 1.0, 0.0, 0.0, 1.0)
NOBODY, A, B, WALL, ACROSS = 0, 1, 2, 3, 4
"""Who is heard."""
SIDE_PARALLEL = 5.0
SIDE_PERPENDICULAR = 2.5
"""How long [m] a neighbour's side along the road is taken to be."""
DEPTH_PARALLEL = 1.8
DEPTH_PERPENDICULAR = 4.8
"""How deep [m] it is taken to be."""
DEEPER = 0.6
"""From within nobody has heard how far out a neighbour stands: it may be so much [m] deeper than that."""
SURE = 1.3
SURE_PARALLEL = 3.5
"""So far [m] from its corner a neighbour's side goes on for sure."""
MUCH = 0.4
"""A reading that is further off [m] is of something else."""
LOOKED_FOR = 1.5
GONE = 0.006
"""A wall that is not heard from so near [m] is less sure of its direction by this [rad] each time."""
RIM_LEARNT = 0.6
RIM_OFF = 0.06
"""Echoes of a cone's rim are learnt from up to so far [m], where they are nearer than expected by so much [m]."""
DOUBT = 0.002
"""One that is off by less, but by more than it may, makes a thing less sure by this [m]."""
SHARED = 0.8
SHARED_AT_FIRST = 0.15
KNOWN = 0.03
"""Of what a wall is heard nearer than thought, this share is drift of the odometry, the same for the neighbours: most
once its place was known to so much [m]; at first it is the search that was wrong, past neighbours who stand askew."""
OTHER_SIDE = (3, 2, 1, 0, 7, 6, 5, 4, 10, 11, 8, 9)
"""The sensor on the other side of the car, of each: a slot on the left is heard in the mirrored order."""
PLAIN = 0.7
CORNER_PLAIN = 0.2
"""An echo of a side whose direction has this share across the road tells how far out a neighbour stands, others do
not; of a corner at the end of a parallel slot, which is easily taken for its flank, this share; of others any."""
LONG = 30.0
APART = 0.12
"""Two things whose distances differ by less [m] cannot be told apart by a reading."""


class LocalMap(NamedTuple):
    """What stands around the slot chosen."""

    frame: SlotFrame = SlotFrame()
    kind: int = Kind.NONE
    a: Thing = Thing()
    b: Thing = Thing()
    wall: Thing = Thing()
    walled: bool = False
    """A kerb or wall behind the slot was heard."""
    across: float = UNSEEN
    """y [m] of what lies across the road."""
    out: float = 0.0
    """How far [m] corner B was found to stand out further than corner A,"""
    found: float = 0.0
    """and how far along the road from it."""
    pose: Pose = Pose()
    """The car at the last reading."""
    empty_a: bool = False
    """Nobody stands there: it is not heard, and nothing is learnt of it."""
    empty_b: bool = False
    within: bool = False
    """The car stood between the neighbours when the map was begun."""


class MapEcho(NamedTuple):
    """What a sensor should hear, of whom, and what it should hear of the next other one."""

    echo: Echo = Echo()
    who: int = NOBODY
    other: float = 100.0


def begin_map(slot: Slot, pose: Pose, params: MapParams) -> LocalMap:
    """Return the map of a slot as it was found or given, seen from a car at ``pose`` (odometry)."""
    place = params.corner + slot.unsure
    frame = SlotFrame(slot.a, mirror_of(slot))
    return LocalMap(
        frame,
        slot.kind,
        thing_at(0.0, 0.0, slot.skew_a, place, params.turned),
        thing_at(slot.length, slot.b_out, slot.skew_b, place, params.turned),
        thing_at(0.5 * slot.length, -slot.depth, 0.0, params.corner, 0.5 * params.turned),
        slot.depth < UNSEEN,
        slot.opposite,
        slot.b_out,
        slot.length,
        to_slot(pose, frame),
        slot.empty_a,
        slot.empty_b,
    )


def moved(here: LocalMap, odometry: Pose, params: MapParams) -> LocalMap:
    """Return the map after the car has driven on: everything is less sure by what the odometry may be wrong by."""
    pose = to_slot(odometry, here.frame)
    dx = pose.x - here.pose.x
    dy = pose.y - here.pose.y
    way = math.sqrt(dx * dx + dy * dy)
    if way == 0.0:
        return here
    place = params.drift * way
    turned = params.turn_drift * way
    return here._replace(
        a=wider(here.a, place, turned), b=wider(here.b, place, turned), wall=wider(here.wall, place, turned), pose=pose
    )


def ear_at(mount: SensorMount, pose: Pose, mirror: float, half_angle: float) -> ConeEar:
    """Return a sensor of a car at ``pose`` (map's frame)."""
    place = place_of(mount, stand_at(pose), mirror)
    return ear_of(place.x, place.y, pose.heading + mirror * mount.yaw, half_angle)


def place_of(mount: SensorMount, stand: Stand, mirror: float) -> Point:
    """Return where a sensor is of a car that stands so (map's frame)."""
    y = mirror * mount.y
    return Point(stand.x + mount.x * stand.cos - y * stand.sin, stand.y + mount.x * stand.sin + y * stand.cos)


def ear_on(here: LocalMap, sensors: CarUltrasonic, number: int, wider_by: float = 0.0) -> ConeEar:
    """Return a sensor of the car on the map, its half angle wider by so much [rad]."""
    return ear_at(sensors.mounts[number], here.pose, here.frame.mirror, sensors.half_angle + wider_by)


def ears_on(here: LocalMap, sensors: CarUltrasonic) -> tuple[ConeEar, ...]:
    """Return all sensors of the car on the map."""
    stand = stand_at(here.pose)
    sine = math.sin(sensors.half_angle)
    cosine = math.cos(sensors.half_angle)
    ears: tuple[ConeEar, ...] = (SOME_EAR,) * 12
    for number in range(12):
        mount = sensors.mounts[number]
        place = place_of(mount, stand, here.frame.mirror)
        axis = here.pose.heading + here.frame.mirror * mount.yaw
        ear = ConeEar(place.x, place.y, math.cos(axis), math.sin(axis), sine, cosine)
        ears = ears[:number] + (ear,) + ears[number + 1 :]
    return ears


def neighbour_of(here: LocalMap, who: int) -> Thing:
    """Return neighbour A or B."""
    return here.a if who == A else here.b


def with_neighbour(here: LocalMap, who: int, thing: Thing) -> LocalMap:
    """Return the map with neighbour A or B as ``thing``."""
    return here._replace(a=thing) if who == A else here._replace(b=thing)


def expected(ear: ConeEar, here: LocalMap) -> MapEcho:
    """Return what a sensor should hear."""
    found = MapEcho()
    if not here.empty_a:
        found = _nearer(found, echo_of_neighbour(ear, here, A), A)
    if not here.empty_b:
        found = _nearer(found, echo_of_neighbour(ear, here, B), B)
    if here.walled:
        found = _nearer(found, _line(ear, here.wall), WALL)
    if here.across < UNSEEN:
        found = _nearer(found, echo_of(ear, Point(-LONG, here.across), Point(LONG, here.across)), ACROSS)
    return found


def echo_of_neighbour(ear: ConeEar, here: LocalMap, who: int) -> Echo:
    """Return what a sensor should hear of neighbour A or B."""
    length = SIDE_PARALLEL if here.kind == Kind.PARALLEL else SIDE_PERPENDICULAR
    depth = DEPTH_PARALLEL if here.kind == Kind.PARALLEL else DEPTH_PERPENDICULAR
    depth = depth + DEEPER if here.within else depth
    return _of(ear, neighbour_of(here, who), -length if who == A else length, depth)


def as_deep_as_any(here: LocalMap) -> LocalMap:
    """Return the map with neighbours who stand as deep as the widest cars, by which echoes from there are explained."""
    return here._replace(within=True)


def nearest_case(here: LocalMap, times: float) -> LocalMap:
    """Return the map with both neighbours ``times`` standard deviations nearer, into the slot and out of it."""
    a = here.a
    b = here.b
    wall = here.wall
    return here._replace(
        a=a._replace(x=a.x + times * math.sqrt(a.xx), y=a.y + times * math.sqrt(a.yy)),
        b=b._replace(x=b.x - times * math.sqrt(b.xx), y=b.y + times * math.sqrt(b.yy)),
        wall=wall._replace(y=wall.y + times * math.sqrt(wall.yy)),
    )


def unsure_of(here: LocalMap, who: int) -> float:
    """Return the standard deviation [m] of the place of one of those who are heard."""
    if who == NOBODY or who == ACROSS:
        return 0.0
    thing = here.a if who == A else here.b if who == B else here.wall
    return math.sqrt(thing.yy if who == WALL else max(thing.xx, thing.yy))


def _nearer(found: MapEcho, echo: Echo, who: int) -> MapEcho:
    if echo.distance < found.echo.distance:
        return MapEcho(echo, who, found.echo.distance)
    return found if echo.distance >= found.other else MapEcho(found.echo, found.who, echo.distance)


def _of(ear: ConeEar, thing: Thing, along: float, depth: float) -> Echo:
    """Return what is heard of a neighbour: of its side, ``along`` [m] from its corner, or of its flank."""
    c = math.cos(thing.heading)
    s = math.sin(thing.heading)
    corner = Point(thing.x, thing.y)
    side = echo_of(ear, corner, Point(thing.x + along * c, thing.y + along * s))
    flank = echo_of(ear, corner, Point(thing.x + depth * s, thing.y - depth * c))
    return side if side.distance <= flank.distance else flank


def _line(ear: ConeEar, wall: Thing) -> Echo:
    c = LONG * math.cos(wall.heading)
    s = LONG * math.sin(wall.heading)
    return echo_of(ear, Point(wall.x - c, wall.y - s), Point(wall.x + c, wall.y + s))


def heard(here: LocalMap, readings: tuple[float, ...], sensors: CarUltrasonic, params: MapParams) -> LocalMap:
    """Return the map after new ``readings`` of all sensors: each sets right what it was heard of, if that is plain."""
    lowest = sensors.min_range + 1.1 * sensors.resolution
    ears = ears_on(here, sensors)
    for place in range(12):
        number = place if here.frame.mirror > 0.0 else OTHER_SIDE[place]
        reading = readings[number]
        ear = ears[number]
        if reading < params.heard:
            here = _told(here, ear, expected(ear, here), Reading(reading, reading > lowest), params)
        elif here.walled and not is_mute(reading):
            here = _unheard(here, ear)
    return here


def _from_corner(thing: Thing, echo: Echo) -> float:
    """Return how far [m] along the road from a neighbour's corner an echo comes from."""
    return abs((echo.x - thing.x) * math.cos(thing.heading) + (echo.y - thing.y) * math.sin(thing.heading))


def _unheard(here: LocalMap, ear: ConeEar) -> LocalMap:
    """Return the map after a sensor heard nothing: a wall it looks at square is perhaps none, and tells no road."""
    ahead = _line(ear, here.wall)
    if ahead.hit != Hit.SQUARE or ahead.distance > LOOKED_FOR or expected(ear, here).who != WALL:
        return here
    return here._replace(wall=wider(here.wall, 0.0, GONE))


class Reading(NamedTuple):
    """One reading [m], and whether it is a distance: the nearest that can be told says no more than nearer."""

    reading: float
    exact: bool


def _told(here: LocalMap, ear: ConeEar, what: MapEcho, told: Reading, params: MapParams) -> LocalMap:
    """Return the map after one reading; unchanged if it may be of something else, or of the rim of the cone.

    A reading of the rim, or of the nearest that can be told, is learnt from if it is plainly nearer than expected:
    then the thing is nearer, wherever in the cone.
    """
    reading = told.reading
    if what.who == ACROSS or what.other - what.echo.distance < APART or what.echo.distance < 0.05:
        return here
    plain = told.exact and (what.echo.hit == Hit.SQUARE or what.echo.hit == Hit.START)
    nearer = reading < RIM_LEARNT and what.echo.distance - reading > RIM_OFF + 0.1 * reading
    if not plain and not nearer:
        return here
    thing = neighbour_of(here, what.who) if what.who in (A, B) else here.wall
    if what.who != WALL and _from_corner(thing, what.echo) > (SURE_PARALLEL if here.kind == Kind.PARALLEL else SURE):
        return here
    nx = (what.echo.x - ear.x) / what.echo.distance
    ny = (what.echo.y - ear.y) / what.echo.distance
    lever = nx * (thing.y - what.echo.y) - ny * (thing.x - what.echo.x)
    slope = Slope(nx, ny, lever)
    noise = params.noise * params.noise + 0.0001 * reading * reading
    error = reading - what.echo.distance
    most = params.gate * math.sqrt(spread_along(thing, slope) + noise)
    if abs(error) > MUCH:
        return here
    if abs(error) > most:
        thing = wider(thing, DOUBT, 0.0)
    else:
        told_out = learnt(thing, slope, error, noise, params.floor)
        least = (PLAIN if here.within else CORNER_PLAIN) if here.kind == Kind.PARALLEL else 0.0
        least = PLAIN if what.echo.hit == Hit.SQUARE else least
        along = what.who != WALL and abs(ny) < least
        thing = told_out._replace(y=thing.y, yy=thing.yy) if along else told_out
    if what.who in (A, B):
        return with_neighbour(here, what.who, thing)
    share = SHARED if here.wall.yy < KNOWN * KNOWN else SHARED_AT_FIRST
    off = share * (thing.y - here.wall.y)
    return here._replace(wall=thing, a=_drifted(here.a, off), b=_drifted(here.b, off))


def _drifted(thing: Thing, off: float) -> Thing:
    """Return a neighbour moved by what the wall says the odometry has drifted: less, the surer it is of its own."""
    return thing._replace(y=thing.y + off * thing.yy / (thing.yy + KNOWN * KNOWN))
