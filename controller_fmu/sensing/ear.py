"""From the distances that one sensor tells on the way past to the places where the echoes came from.

A sensor that moves by ds hears the nearest point of what stands there at a distance r that changes by dr = -cos(b) ds,
b the bearing of that point off the direction in which the sensor moves: what is ahead comes nearer. So the change of
the distance tells the bearing, and both together the place, whatever stands there: a side, a corner, a post. Where the
nearest part lies at the rim of the cone, of half angle g, the distance changes by more or less: the bearing is that of
the rim. (Envelope of circles; A. Sakamoto and T. Sato's boundary scattering transform is the same.)
"""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import SIDES, PlanStore
from controller_fmu.sensing.heard_store import put_heard, put_ray
from modelkit.car import CarUltrasonic
from modelkit.maths import PI, clamp, sign, wrap_angle
from modelkit.vocabulary import Pose

BIN = 0.1
"""Readings over so much way [m] are averaged."""
SAME = 0.15
"""Readings that differ by less [m] are averaged."""
KEPT = 7
MIDDLE = 3
STEEPEST = 2.3
"""The distance to one thing changes by no more than this over the way [m/m]: the rim of the cone on a side across."""
STEP = 0.06
LOST = 0.3
LEAST = 3
"""So many more samples must have heard the same for a slope."""
CLOSE = 1.0
"""On the way into a slot, where the car turns, only what is so near [m] and not at the cone's rim tells its place."""
RIM = 0.08
CREST = 0.4
"""Where the distance stops growing and shrinks, by so much [m/m], the sensor hears one thing before and another after.

The distance to one convex thing never does that.
"""
SHARP = 1.0
"""By so much [m/m] where only a few samples go together, as in an opening that the cone just passes."""
DOUBTFUL = 0.25
"""Where it does so by less, noise may be the reason: the place is not known, what comes may be of the same thing."""


class HeardSample(NamedTuple):
    """Mean over a bin: where the sensor was, and what it heard."""

    x: float = 0.0
    y: float = 0.0
    axis: float = 0.0
    r: float = 0.0


class SideEar(NamedTuple):
    """What is remembered of one sensor: the bin being filled, the last samples, the oldest first, places known."""

    n: float = 0.0
    sums: HeardSample = HeardSample()
    samples: tuple[HeardSample, ...] = (HeardSample(),) * KEPT
    taken: int = 0
    """Samples so far, at most ``KEPT``."""
    silent: bool = True
    """Nothing was heard since the last echo."""
    places: int = 0
    rays: int = 0


def listen(store: PlanStore, ear: SideEar, side: int, at: Pose, reading: float, sensors: CarUltrasonic) -> SideEar:
    """Return the ear after one reading of a sensor that is at ``at`` and looks along its heading.

    ``side``: which places it puts into, ``Ears``.
    """
    n = ear.n
    if n > 0.0:
        dx = at.x - ear.sums.x / n
        dy = at.y - ear.sums.y / n
        full = dx * dx + dy * dy >= 0.25 * BIN * BIN or abs(reading - ear.sums.r / n) > SAME
        if not full:
            sums = HeardSample(ear.sums.x + at.x, ear.sums.y + at.y, ear.sums.axis + at.heading, ear.sums.r + reading)
            return ear._replace(n=n + 1.0, sums=sums)
        mean = HeardSample(ear.sums.x / n, ear.sums.y / n, ear.sums.axis / n, ear.sums.r / n)
        lost = _lost(ear.samples, mean)
        kept = _without(ear.samples, lost) + (mean,)
        ear = ear._replace(samples=kept, taken=ear.taken + 1 if ear.taken < KEPT else KEPT)
        if ear.taken == KEPT and lost == 0:
            dx = kept[KEPT - 1].x - kept[0].x
            dy = kept[KEPT - 1].y - kept[0].y
            ear = _placed(store, ear, side, math.atan2(dy, dx), sensors)
    return ear._replace(n=1.0, sums=HeardSample(at.x, at.y, at.heading, reading))


def _lost(samples: tuple[HeardSample, ...], mean: HeardSample) -> int:
    """Return how many of the last samples were lost, or of something else: one or two between others that agree."""
    last = samples[KEPT - 1].r
    before = samples[KEPT - 2].r
    if _is_between(before, last, mean.r):
        return 1
    first = samples[KEPT - 3].r
    return 2 if _is_between(first, before, mean.r) and _is_between(first, last, mean.r) else 0


def _is_between(before: float, middle: float, after: float) -> bool:
    """Return whether a reading differs from two others that agree."""
    return abs(middle - before) > LOST and abs(middle - after) > LOST and abs(before - after) < LOST


def _without(samples: tuple[HeardSample, ...], lost: int) -> tuple[HeardSample, ...]:
    """Return the samples to which one more is added: without the oldest, or the lost ones."""
    if lost == 0:
        return samples[1:]
    return samples[: KEPT - 1] if lost == 1 else samples[:1] + samples[: KEPT - 2]


def _placed(store: PlanStore, ear: SideEar, side: int, forward: float, sensors: CarUltrasonic) -> SideEar:
    """Return the ear with the place that the middle sample heard put into the store."""
    middle = ear.samples[MIDDLE]
    before = ear.samples[MIDDLE - 1].r
    end_x = middle.x + middle.r * math.cos(middle.axis)
    end_y = middle.y + middle.r * math.sin(middle.axis)
    if side < SIDES:
        put_ray(store, side, ear.rays, Pose(middle.x, middle.y, middle.axis), Pose(end_x, end_y, middle.axis))
    ear = ear._replace(rays=ear.rays + 1)
    if middle.r > 0.97 * sensors.max_range:
        return ear._replace(silent=True)
    first = _reach(ear.samples, -1)
    last = _reach(ear.samples, 1)
    if last - first < LEAST:
        return ear
    half = (first + last) // 2
    bend = _slope(ear.samples, half, last, forward) - _slope(ear.samples, first, half, forward)
    whole = last - first == KEPT - 1
    if bend < -(DOUBTFUL if whole else SHARP):
        return ear._replace(silent=ear.silent or not whole or bend < -CREST)
    slope = _slope(ear.samples, first, last, forward)
    looks = wrap_angle(middle.axis - forward)
    least = max(abs(looks) - sensors.half_angle, 0.0)
    most = min(abs(looks) + sensors.half_angle, PI)
    ahead = math.cos(least)
    behind = math.cos(most)
    if side >= SIDES and (middle.r > CLOSE or not behind + RIM < -slope < ahead - RIM):
        return ear._replace(silent=True)
    angle = forward + sign(looks) * math.acos(clamp(-slope, behind, ahead))
    x = middle.x + middle.r * math.cos(angle)
    y = middle.y + middle.r * math.sin(angle)
    jump = abs(middle.r - before) > _most(ear.samples[MIDDLE - 1], middle)
    places = put_heard(store, side, ear.places, x, y, ear.silent or jump)
    return ear._replace(places=places, silent=False)


def _reach(samples: tuple[HeardSample, ...], sense: int) -> int:
    """Return the first (``sense`` -1) or last (1) of the samples around the middle one that go with it."""
    at = MIDDLE
    goes_on = True
    for _ in range(KEPT - 1 - MIDDLE):
        after = samples[at + sense]
        goes_on = goes_on and abs(after.r - samples[at].r) <= _most(samples[at], after)
        at = at + sense if goes_on else at
    return at


def _slope(samples: tuple[HeardSample, ...], first: int, last: int, forward: float) -> float:
    """Return how the distance changes over the way [m/m] from one sample to another: the regression."""
    c = math.cos(forward)
    s = math.sin(forward)
    n = 0.0
    su = 0.0
    sr = 0.0
    suu = 0.0
    sur = 0.0
    for number in range(KEPT):
        sample = samples[number]
        if first <= number <= last:
            u = (sample.x - samples[MIDDLE].x) * c + (sample.y - samples[MIDDLE].y) * s
            n += 1.0
            su += u
            sr += sample.r
            suu += u * u
            sur += u * sample.r
    spread = suu - su * su / n
    return (sur - su * sr / n) / spread if spread > 1e-6 else 0.0


def _most(one: HeardSample, other: HeardSample) -> float:
    """Return the largest change of the distance [m] between two samples that heard the same thing."""
    dx = other.x - one.x
    dy = other.y - one.y
    return STEEPEST * math.sqrt(dx * dx + dy * dy) + STEP
