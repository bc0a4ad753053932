"""One track per sensor of what it measures: range and closing rate by a Kalman filter, and whether the map explains it.

State (r, v): r' = v, white acceleration of density q; measurement r + n. The vehicle's own motion towards the object is
taken out first, so that v is the object's own. A track is tentative, confirmed after ``MIN_CONFIRMATIONS`` echoes,
coasts over ``MAX_COASTING`` missed ones and ends.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.measurement.predicted_range import EchoSurface
from controller_fmu.parking.measurement.sensor import SensorPose

ACCELERATION_DENSITY = 4.0
"""Spectral density [m2/s3] of a pedestrian's acceleration: 2 m/s2 within a quarter of a second."""
INITIAL_RATE_VARIANCE = 4.0
"""Objects move at up to 2 m/s, one standard deviation [m2/s2]."""
INNOVATION_GATE = 16.0
"""Innovation gate, chi-square of one degree of freedom: 4 sigma."""
MIN_CONFIRMATIONS = 2
"""Echoes after which a track is confirmed: one alone may be noise."""
MAX_COASTING = 4
"""Measurement cycles: 0.16 s."""
MIN_LOST_AT_ONCE = 4
"""Sensors that fall silent lose their echoes in one cycle; two objects, each in two views, hardly ever leave so."""
MIN_APPROACH = 0.25
"""Approach [m] that no motion of the vehicle explains and that shows a moving object: 8 sigma of 3 cm of noise."""
TIME_TO_STAND = 1.5
"""A moving object is yielded to from this time [s] before it arrives: the longest stop from top speed, and a half."""
NEARBY_RANGE = 1.0
"""Within this range [m] a moving object is yielded to wherever it moves: a step or two."""


class ObjectTrack(NamedTuple):
    """Range [m] and rate [m/s] of an object along a sensor's direction, own motion removed, with covariance."""

    range: float = 0.0
    rate: float = 0.0
    rr: float = 0.0
    rv: float = 0.0
    vv: float = 0.0
    confirmations: int = 0
    """Echoes so far; 0: there is no track."""
    missed: int = 0
    """Cycles without an echo since the last."""
    unexplained: int = 0
    """Cycles for which it still counts as an object that the map does not hold."""
    expected: float = 0.0
    """Range [m] that map and plan predict."""
    ux: float = 1.0
    """Unit vector from the sensor to where the predicted echo comes from."""
    uy: float = 0.0
    surface: EchoSurface = EchoSurface()
    """The side that this is of."""
    approach: float = 0.0
    """Approach [m] that no static object could cause: a cumulative sum, begun anew at 0 and above ``MIN_APPROACH``."""


def update_track(
    track: ObjectTrack, is_echo: bool, measured: float, own_approach: float, variance: float, dt: float
) -> ObjectTrack:
    """Return the track after ``dt`` [s] in which the sensor came ``own_approach`` [m] nearer; ``variance`` in m2."""
    begun = ObjectTrack(measured, 0.0, variance, 0.0, INITIAL_RATE_VARIANCE, 1)
    if track.confirmations == 0:
        return begun if is_echo else track
    q = ACCELERATION_DENSITY
    predicted = track._replace(
        range=track.range + track.rate * dt - own_approach,
        rr=track.rr + 2.0 * dt * track.rv + dt * dt * track.vv + q * dt * dt * dt / 3.0,
        rv=track.rv + dt * track.vv + 0.5 * q * dt * dt,
        vv=track.vv + q * dt,
    )
    if not is_echo:
        ends = track.missed >= MAX_COASTING or track.confirmations < MIN_CONFIRMATIONS
        return ObjectTrack() if ends else predicted._replace(missed=track.missed + 1)
    s = predicted.rr + variance
    y = measured - predicted.range
    if y * y > INNOVATION_GATE * s:
        return begun
    kr = predicted.rr / s
    kv = predicted.rv / s
    r = predicted.range + kr * y
    v = predicted.rate + kv * y
    rr = predicted.rr - kr * predicted.rr
    rv = predicted.rv - kr * predicted.rv
    vv = predicted.vv - kv * predicted.rv
    return ObjectTrack(r, v, rr, rv, vv, track.confirmations + 1, 0, track.unexplained, approach=track.approach)


def with_approach(before: ObjectTrack, after: ObjectTrack, static_approach: float) -> ObjectTrack:
    """Return the track ``after`` a cycle with the sum of the approach beyond ``static_approach`` [m], the most that
    the sensor's own motion can bring about; a track that has just begun starts a new sum."""
    if after.confirmations < MIN_CONFIRMATIONS:
        return after
    summed = before.approach if before.approach <= MIN_APPROACH else 0.0
    return after._replace(approach=max(0.0, summed + before.range - after.range - static_approach))


def static_approach(before: SensorPose, after: SensorPose) -> float:
    """Return by how much [m] a static object anywhere in the cone comes nearer at most as the sensor moves."""
    dx = after.x - before.x
    dy = after.y - before.y
    along = dx * after.axis_x + dy * after.axis_y
    across = abs(dy * after.axis_x - dx * after.axis_y)
    if along > 0.0 and across * after.cone_cos <= along * after.cone_sin:
        return math.sqrt(dx * dx + dy * dy)
    return along * after.cone_cos + across * after.cone_sin


def is_yielded_to(track: ObjectTrack) -> bool:
    """Return whether the vehicle has to stand for a moving object: one close by, or one that arrives soon."""
    return track.approach > MIN_APPROACH and (track.range < NEARBY_RANGE or track.range < -track.rate * TIME_TO_STAND)


def is_lost_at_once(tracks: tuple[ObjectTrack, ...]) -> bool:
    """Return whether sensors have fallen silent: many have missed their echoes since the same cycle."""
    return sum(1 if track.missed == MAX_COASTING else 0 for track in tracks) >= MIN_LOST_AT_ONCE


def range_in_blind_zone(track: ObjectTrack, own_approach: float, min_range: float) -> float:
    """Return the range [m] of an object that a sensor reports as nearer than ``min_range``: by its own motion."""
    return max(0.0, min(min_range, track.range - own_approach))


def with_expectation(
    track: ObjectTrack, expected: float, ux: float, uy: float, surface: EchoSurface, is_unexplained: bool
) -> ObjectTrack:
    """Return the track with what was ``expected`` [m] in the direction (ux, uy), and whether that explains it.

    What it does not explain has no known ``surface``.
    """
    left = MAX_COASTING if is_unexplained else max(track.unexplained - 1, 0)
    return track._replace(expected=expected, ux=ux, uy=uy, surface=surface, unexplained=left)


def closing_speed(track: ObjectTrack) -> float:
    """Return how fast [m/s] an unexplained object of a confirmed track approaches by itself, two sigma above 0."""
    is_confirmed = track.unexplained > 0 and track.confirmations >= MIN_CONFIRMATIONS
    approaches = track.rate <= 0.0 and track.rate * track.rate >= 4.0 * track.vv
    return -track.rate if is_confirmed and approaches else 0.0
