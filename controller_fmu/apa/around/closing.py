"""What comes nearer than the map has it: each sensor's readings over the way, wherever in the cone they are from.

A wall or a flank goes on beside the cone, so an arc of places says too little of it. But who goes on as he goes hears
what he will touch come nearer, and has to stand before it is as near as his own outline is to the sensor.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.around.cone import SILENT
from controller_fmu.apa.around.near import FREE, nearest_told
from controller_fmu.apa.hearing.mute import is_mute
from controller_fmu.apa.outline import Shape
from modelkit.car import CarUltrasonic, SensorMount

WEIGHT = 0.4
"""Of a new reading in the mean of the last."""
JUMP = 0.35
"""A reading that differs by more [m] is of something else."""
MEMORY = 0.15
"""Over so much way [m] the older mean follows the newer one."""
FALLING = 0.015
"""Newer less than older by this [m]: it comes nearer."""
STRANGE = 0.06
"""The map has it farther off by so much [m]."""
SILENCES = 3
"""So many readings of nothing in a row are no lost ones."""
GAP = 0.03
"""Kept [m] to what comes nearer, beyond the car's own outline."""
KNOWN = -0.03
"""The same where the map has it there, and none beside a corner: a reading and a brake may be off by so much."""
WIDER = 0.1
"""A corner of the car may be heard from so far [rad] beside the cone."""
NEAR_CORNER = 0.6
TAIL = ((4, 9), (7, 11))
"""The sensors at the corners of the tail, each with the rear one of its flank."""
AT_TAIL = 0.8
SLANTS = 0.15
"""The flank's one stands in for the corner's up to so far [m], where what it hears comes nearer by this share."""
TAIL_GAP = 0.08
"""Kept [m] to it."""


class Track(NamedTuple):
    """What a sensor has heard since the car goes this way."""

    now: float = SILENT
    """Mean of the last readings [m]."""
    before: float = SILENT
    """The same some 15 cm of way ago."""
    silent: int = 0
    """Readings of nothing in a row."""
    strange: bool = False
    """It is nearer than the map has it."""


def tracked_on(track: Track, reading: float, way: float, expected: float, furthest: float) -> Track:
    """Return the track after a reading, ``way`` [m] after the last; the map expected ``expected`` [m]."""
    if reading >= furthest:
        silent = track.silent + 1
        return track._replace(silent=silent) if silent < SILENCES else Track(silent=silent)
    if abs(reading - track.now) > JUMP:
        return Track(reading, reading, 0, False)
    now = track.now + WEIGHT * (reading - track.now)
    before = track.before + way / (way + MEMORY) * (now - track.before)
    return Track(now, before, 0, now < expected - STRANGE)


def without_lost(readings: tuple[float, ...], tracks: tuple[Track, ...]) -> tuple[float, ...]:
    """Return the readings [m]; one or two of nothing in a row are lost echoes: there the mean of those before."""
    for number in range(12):
        track = tracks[number]
        if 0 < track.silent < SILENCES and track.now < readings[number] and not is_mute(readings[number]):
            readings = readings[:number] + (track.now,) + readings[number + 1 :]
    return readings


def turned_round(track: Track) -> Track:
    """Return the track of a car that begins to go the other way."""
    return track._replace(before=track.now)


def room_to_strange(tracks: tuple[Track, ...], car: Shape, sensors: CarUltrasonic) -> float:
    """Return how far [m] a car may go on as it goes before it is at what comes nearer and is not on the map there."""
    room = FREE
    lowest = nearest_told(sensors)
    for number in range(12):
        track = tracks[number]
        if track.now < track.before - FALLING:
            reach = own_reach(sensors.mounts[number], car, sensors.half_angle)
            if track.strange:
                room = min(room, track.now - max(reach + GAP, lowest))
            elif reach > 0.0:
                room = min(room, track.now - reach - KNOWN)
    return room


def room_at_tail(tracks: tuple[Track, ...], readings: tuple[float, ...], car: Shape, sensors: CarUltrasonic) -> float:
    """Return how far [m] a car in reverse may go before a corner of its tail is at what the rear sensor of that flank
    hears, where the corner's own tells nothing.

    What comes nearer to the flank by a share of the way does so at the corner, which is as much further on.
    """
    room = FREE
    lowest = nearest_told(sensors)
    for corner, flank in TAIL:
        track = tracks[flank]
        if is_mute(readings[corner]) and track.now < AT_TAIL:
            share = (track.before - track.now) / MEMORY
            ahead = sensors.mounts[flank].x + car.rear
            if track.strange and track.now <= lowest:
                room = 0.0
            elif share > SLANTS:
                gap = TAIL_GAP if track.strange else 0.0
                room = min(room, max(0.0, (track.now - gap) / share - ahead))
    return room


def own_reach(mount: SensorMount, car: Shape, half_angle: float) -> float:
    """Return how far [m] the car's own corner is from a sensor that may hear what touches it there; else 0."""
    dx = (car.front if mount.x > 0.5 * (car.front - car.rear) else -car.rear) - mount.x
    dy = (car.half_width if mount.y > 0.0 else -car.half_width) - mount.y
    far = math.sqrt(dx * dx + dy * dy)
    beside = abs(dy * math.cos(mount.yaw) - dx * math.sin(mount.yaw))
    along = dx * math.cos(mount.yaw) + dy * math.sin(mount.yaw)
    seen = far < NEAR_CORNER and math.atan2(beside, along) < half_angle + WIDER
    return far if seen else 0.0
