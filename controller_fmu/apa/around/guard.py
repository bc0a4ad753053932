"""The guard: stops the car before it could touch anything, whoever drives and whatever is planned.

It knows nothing of the plan. It drives the outline in thought along the arc of the front wheels as they are,
as far as the car needs to stop, and looks at three things: what the map says stands there, what sensors hear
that the map does not explain (anywhere on the arc that such an echo may come from), and how near anything is
straight ahead. Besides it stops for what comes nearer to a sensor than the map has it (``closing``), and for who
comes by himself (``comer``). Nothing else may keep the brake off; a car may drive away from what is near.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.around.arcs import LOOKED_AT, NOWHERE, Unknown, arc_of, held, not_refuted, origin
from controller_fmu.apa.around.closing import SILENCES, Track, room_at_tail, room_to_strange, tracked_on, turned_round
from controller_fmu.apa.around.comer import Comer, followed, pace_after, somebody_comes
from controller_fmu.apa.around.cone import ConeEar, Echo
from controller_fmu.apa.around.course import HeldCourse, after
from controller_fmu.apa.around.local_map import (
    A,
    B,
    LocalMap,
    MapEcho,
    as_deep_as_any,
    ear_on,
    ears_on,
    expected,
    nearest_case,
    place_of,
    unsure_of,
)
from controller_fmu.apa.around.near import FREE, NEARER, room_by_echoes
from controller_fmu.apa.around.straight import room_straight
from controller_fmu.apa.hearing.deaf import silences
from controller_fmu.apa.hearing.mute import is_mute
from controller_fmu.apa.hearing.stir import QUIET, HeardOf, heard_on, own_way, stirs
from controller_fmu.apa.outline import (
    Box,
    Obstacles,
    Shape,
    Stand,
    clearance,
    grown,
    outline_rate,
    stand_at,
    stand_clearance,
    sure_steps,
)
from controller_fmu.apa.params import ApaSystemParams
from modelkit.car import CarUltrasonic
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

WIDER = 0.1
"""The rim of a cone may touch something known that lies so much [rad] beside it."""
LOOKS = 6
AHEAD = 0.1
"""Looked ahead so many times by so much [m], and at where the car would stand, ``LEAST`` at least."""
LEAST = 0.04
UNSURE = 0.7
"""Kept away from what is known by so many standard deviations more."""
SURE = 0.03
"""The gap is made for things that are as sure as this [m]."""
RESERVE = 0.03
"""A car is slowed down so that it could stop so much [m] earlier than it must."""
SLOW = 0.15
"""So fast [m/s] a car may go beside anything that is heard, however near."""
STANDING = 0.05
TELLS = 0.4
UNSEEN_BRAKE = 0.3
"""Until a stop from ``TELLS`` [m/s] was seen the brake is taken to be so late [s]: what 1.1 m/s2 take longer than 2."""
DOUBTS = 2.5
MOVED = 0.002
"""A car that has gone less [m] stands."""


class Sight(NamedTuple):
    """What the guard says."""

    speed: float = FREE
    """Largest speed [m/s] with which the car still stops in time."""
    blocked: bool = False
    unknown: bool = False
    """What blocks is not on the map."""


class GuardState(NamedTuple):
    """What the guard remembers: one unexplained echo for each sensor, and how late the brake is."""

    unknown: tuple[Unknown, ...] = (Unknown(),) * 12
    echoes: tuple[Point, ...] = (NOWHERE,) * 12
    """Where the last echo of each sensor comes from (map's frame), if the map explains it."""
    close: tuple[Unknown, ...] = (Unknown(),) * 12
    """What is nearer than a sensor can tell: where it was when it came so near, for the readings tell no more of it."""
    tracks: tuple[Track, ...] = (Track(),) * 12
    """What each sensor has heard since the car goes this way."""
    comers: tuple[Comer, ...] = (Comer(),) * 12
    neighbours: tuple[HeardOf, ...] = (HeardOf(),) * 12
    """What each sensor has heard of the neighbours."""
    silences: tuple[int, ...] = (0,) * 12
    """How many times in a row each sensor heard nothing where it should have."""
    quiet: float = QUIET
    """How long [s] nobody was heard to move."""
    pace: float = 0.0
    """Of the car just now [m/s], see ``comer``."""
    direction: int = 0
    """Which way the car goes."""
    pose: Pose = Pose()
    """The car at the last reading (map's frame)."""
    delay: float = 0.0
    """Longest seen from a brake request to its effect [s]."""
    shown: bool = False
    """The car was seen to stop from a speed that tells."""
    braked_from: float = 0.0
    """Speed [m/s] at which a stop was last asked for; 0: none is under way."""
    braked_way: float = 0.0
    """Driven since [m]."""
    speed: float = 0.0
    """At the last sample [m/s]."""


class Explained(NamedTuple):
    """Whether the map explains an echo, and where that then comes from (map's frame)."""

    by_map: bool = True
    origin: Point = NOWHERE


class HeardHere(NamedTuple):
    """What a sensor hears [m], where it is, and what the map has it hear."""

    reading: float
    ear: ConeEar
    mapped: Echo


def stopping_way(state: GuardState, speed: float, params: ApaSystemParams) -> float:
    """Return the way [m] that the car needs to stop, as late as its brake was ever seen to be."""
    v = abs(speed)
    late = max(state.delay, params.apa.guard.brake_delay)
    return v * late + 0.5 * v * v / params.apa.drive.brake


def speed_for(state: GuardState, room: float, least: float, params: ApaSystemParams) -> float:
    """Return the speed [m/s] from which the car stops within ``room`` [m]: v t + v^2 / 2 b = room; 0 without room.

    ``least``: how late [s] the brake is taken to be where nothing worse was seen.
    """
    late = max(state.delay, least)
    brake = params.apa.drive.brake
    return brake * (math.sqrt(late * late + 2.0 * room / brake) - late) if room > 0.0 else 0.0


def listen(state: GuardState, readings: tuple[float, ...], here: LocalMap, params: ApaSystemParams) -> GuardState:
    """Return the guard that followed each sensor, and keeps echoes that the map does not explain until refuted."""
    sensors = params.car.ultrasonic
    unknown = state.unknown
    echoes = state.echoes
    close = state.close
    deep = as_deep_as_any(here)
    near = nearest_case(deep, DOUBTS)
    way = _way(state.pose, here.pose)
    direction = state.direction if abs(way) < MOVED else 1 if way > 0.0 else -1
    tracks = state.tracks
    comers = state.comers
    ears = ears_on(here, sensors)
    for number in range(12):
        reading = readings[number]
        ear = ears[number]
        mapped = expected(ear, deep).echo
        track = tracks[number] if direction == state.direction else turned_round(tracks[number])
        track = tracked_on(track, reading, abs(way), mapped.distance, sensors.max_range)
        tracks = tracks[:number] + (track,) + tracks[number + 1 :]
        comer = followed(comers[number], reading, sensors.cycle, sensors.max_range, mapped.distance)
        comers = comers[:number] + (comer,) + comers[number + 1 :]
        close = close[:number] + (held(close[number], ear, reading, sensors),) + close[number + 1 :]
        kept = unknown[number]
        told = Explained()
        if reading < LOOKED_AT:
            wide = ear_on(here, sensors, number, WIDER)
            told = _explained(
                HeardHere(reading, ear, mapped), expected(wide, deep), expected(wide, near).echo, here, params
            )
        echoes = echoes[:number] + (told.origin,) + echoes[number + 1 :]
        if not told.by_map:
            kept = arc_of(ear, reading)
        elif kept.there and not is_mute(reading) and (reading < sensors.max_range or track.silent >= SILENCES):
            kept = not_refuted(kept, ear, reading, is_known(reading, mapped.distance, params))
        unknown = unknown[:number] + (kept,) + unknown[number + 1 :]
    state = _heard_of_neighbours(state._replace(comers=comers), readings, here, ears, sensors)
    return state._replace(
        unknown=unknown, echoes=echoes, close=close, tracks=tracks, direction=direction, pose=here.pose
    )


def _explained(heard: HeardHere, beside: MapEcho, closest: Echo, here: LocalMap, params: ApaSystemParams) -> Explained:
    """Return whether an echo is no nearer than what a little wider cone should hear, or hears in the nearest case."""
    least = min(closest.distance, beside.echo.distance - DOUBTS * unsure_of(here, beside.who))
    if heard.reading < least - params.apa.guard.surprise - 0.05 * heard.reading:
        return Explained(False)
    place = origin(heard.ear, heard.mapped, heard.reading)
    return Explained(True, origin(heard.ear, closest, heard.reading) if place.x == NOWHERE.x else place)


def _heard_of_neighbours(
    state: GuardState,
    readings: tuple[float, ...],
    here: LocalMap,
    ears: tuple[ConeEar, ...],
    sensors: CarUltrasonic,
) -> GuardState:
    """Return the guard that knows whether anybody moves, and which sensors hear no neighbour where one is."""
    neighbours = state.neighbours
    silent = state.silences
    stood = stand_at(state.pose)
    for number in range(12):
        ear = ears[number]
        before = place_of(sensors.mounts[number], stood, here.frame.mirror)
        own = own_way(ear, before, expected(ear, here), readings[number])
        missed = silences(silent[number], readings[number], number, here, state.neighbours, sensors)
        silent = silent[:number] + (missed,) + silent[number + 1 :]
        heard = heard_on(neighbours[number], readings[number], sensors.cycle, sensors.max_range, own)
        neighbours = neighbours[:number] + (heard,) + neighbours[number + 1 :]
    moves = stirs(A, neighbours, state.speed) or stirs(B, neighbours, state.speed)
    pace = pace_after(state.pace, state.speed, sensors.cycle)
    moves = moves or somebody_comes(state.comers, pace)
    quiet = 0.0 if moves else state.quiet + sensors.cycle
    return state._replace(neighbours=neighbours, silences=silent, quiet=quiet, pace=pace)


def is_known(reading: float, distance: float, params: ApaSystemParams) -> bool:
    """Return whether a reading is of what the map has at this distance [m]."""
    return reading < LOOKED_AT and abs(reading - distance) <= params.apa.guard.surprise


def _way(before: Pose, now: Pose) -> float:
    """Return how far [m] the car has gone, in reverse negative."""
    return (now.x - before.x) * math.cos(now.heading) + (now.y - before.y) * math.sin(now.heading)


def learn_brake(state: GuardState, speed: float, braking: bool, dt_ns: int, params: ApaSystemParams) -> GuardState:
    """Return the guard with how late the brake was, once the car stands: way = v t + v^2 / 2 b."""
    v = abs(speed)
    state = state._replace(speed=speed)
    if not braking:
        return state._replace(braked_from=0.0, braked_way=0.0)
    begun = state.braked_from if state.braked_from > 0.0 else v
    way = state.braked_way + v * dt_ns * 1e-9
    if v > 0.01 or begun < STANDING:
        return state._replace(braked_from=begun, braked_way=way)
    late = (way - 0.5 * begun * begun / params.apa.drive.brake) / begun
    return state._replace(delay=max(state.delay, min(late, 0.5)), shown=state.shown or begun >= TELLS)


def watch_way(
    state: GuardState,
    readings: tuple[float, ...],
    here: LocalMap,
    around: Obstacles,
    course: HeldCourse,
    params: ApaSystemParams,
) -> Sight:
    """Return the sight of a car on its ``course`` among obstacles not grown; ``here`` has its pose on the map."""
    guard = params.apa.guard
    needed = stopping_way(state, course.speed, params)
    stop = max(LEAST, needed)
    known = _free_way(course, stop, _unsure(around, here, guard.gap))
    mapped = course._replace(pose=here.pose)
    strange = _free_of_unknown(state.unknown, mapped, stop, guard.surprise_gap)
    tight = _free_of_unknown(state.close, mapped, stop, guard.echo_gap)
    straight = room_straight(readings, here, course.direction, params)
    raw = _free_of_echoes(state, mapped, stop, guard.echo_gap)
    beside = min(min(known, raw), tight)
    old = abs(course.speed) * params.car.ultrasonic.cycle
    if course.direction == state.direction:
        beside = min(beside, room_to_strange(state.tracks, course.car, params.car.ultrasonic) - 2.0 * old)
        if course.direction < 0:
            beside = min(beside, room_at_tail(state.tracks, readings, course.car, params.car.ultrasonic) - 2.0 * old)
    allowed = speed_for(state, min(min(beside, strange), straight) - RESERVE, guard.brake_delay, params)
    heard = room_by_echoes(readings, course, here.frame.mirror, params.car.ultrasonic)
    late = guard.brake_delay if state.shown else max(guard.brake_delay, UNSEEN_BRAKE)
    allowed = min(allowed, max(SLOW, speed_for(state, heard - old - RESERVE, late, params)))
    if state.quiet < QUIET:
        return Sight(0.0, True, True)
    return Sight(allowed, min(beside, strange) <= stop or straight <= needed, strange <= stop and strange <= beside)


def _unsure(around: Obstacles, here: LocalMap, gap: float) -> Obstacles:
    """Return what is known, grown by the ``gap`` kept to it and by how unsure it is along the road and across."""
    behind = grown(around.behind, gap)
    ahead = grown(around.ahead, gap)
    return Obstacles(
        behind._replace(x1=behind.x1 + _spread(here.a.xx), y1=behind.y1 + _spread(here.a.yy)),
        ahead._replace(x0=ahead.x0 - _spread(here.b.xx), y1=ahead.y1 + _spread(here.b.yy)),
        grown(around.beside, gap),
        grown(around.opposite, gap),
    )


def _spread(variance: float) -> float:
    return UNSURE * max(0.0, math.sqrt(variance) - SURE)


def _free_way(course: HeldCourse, stop: float, around: Obstacles) -> float:
    """Return how far [m] the outline can go before it would touch one of these boxes, and comes nearer to them."""
    now = clearance(course.pose, course.car, around, NEARER)
    rate = outline_rate(course.curvature, course.car)
    for number in range(LOOKS + 1):
        way = stop if number == 0 else AHEAD * number
        if sure_steps(now, way * rate) == 0:
            there = clearance(after(course, way), course.car, around, 0.0)
            if there < 0.0 and there < now - NEARER:
                return way if number > 0 else 0.0
    return FREE


def _free_of_unknown(arcs: tuple[Unknown, ...], course: HeldCourse, stop: float, gap: float) -> float:
    """Return how far [m] the outline can go before it is nearer than ``gap`` to a place that an echo may be of."""
    nearest = FREE
    now = stand_at(course.pose)
    for item in arcs:
        if item.there:
            for number in range(LOOKS + 1):
                way = stop if number == 0 else AHEAD * number
                if way < nearest and _comes_near(item, now, stand_at(after(course, way)), course.car, gap):
                    nearest = way if number > 0 else 0.0
    return nearest


def _free_of_echoes(state: GuardState, course: HeldCourse, stop: float, gap: float) -> float:
    """Return how far [m] the outline can go before it is nearer than ``gap`` to where an echo just came from."""
    now = stand_at(course.pose)
    for number in range(2):
        way = stop if number == 0 else stop + AHEAD
        there = stand_at(after(course, way))
        for point in state.echoes:
            if point.x < NOWHERE.x and _comes_nearer(point, now, there, course.car, gap):
                return way if number > 0 else 0.0
    return FREE


def _comes_near(item: Unknown, now: Stand, there: Stand, car: Shape, gap: float) -> bool:
    """Return whether a point of an arc is nearer than ``gap`` to a car that stands ``there``, and nearer than now."""
    comes = False
    for point in item.points:
        comes = comes or _comes_nearer(point, now, there, car, gap)
    return comes


def _comes_nearer(point: Point, now: Stand, there: Stand, car: Shape, gap: float) -> bool:
    """Return the same of one point."""
    box = Box(point.x, point.x, point.y, point.y)
    near = stand_clearance(there, car, box, gap)
    return near < gap and near < stand_clearance(now, car, box) - NEARER
