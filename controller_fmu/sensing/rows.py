"""How the cars of a row are turned, from the sides that were seen of them."""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.places import PlacesFrame, along, is_free, seen
from modelkit.maths import PI
from modelkit.vocabulary import Pose

NEAR = 3.0
IN_FRONT = 2.2
"""Sides that tell how neighbours stand lie no farther [m] behind the nearest place within ``NEAR``."""
CORNER = 4
"""Where more echoes came from one place it is a corner, or a post."""
CHORD = 3
"""Directions are told from one place to the so many-th after it."""
UNCLEAR = 9.0
LEAST_SIDE = 1.0
AGREED = 0.35
"""Sides that agree are at least this share of all, else nothing is told."""
WITHIN = (10.0, 0.5, 0.25)
"""Sides that are turned [rad] by less against the mean before are taken, in turn: what lies about is left out."""
BESIDE_LINE = 0.08
"""Places of one side lie so near [m] to the line along it through its first place,"""
ASKEW = 0.1
"""and as much farther [m/m] as it may be turned against it."""
FAR = 50.0
NARROWEST = 0.6
"""So much of a front [m] is seen at least, else it may be a post."""
WIDEST = 2.1
"""And it is no wider."""
BEYOND = (0.3, 0.45, 0.6, 0.8, 1.0, 1.3, 1.6)
"""Where a side goes on there is no free space so far [m] beyond what was seen of it, and so far behind its line."""
BEYOND_IN = 0.15
ENOUGH = 2


def turn_of(store: PlanStore, frame: PlacesFrame) -> float:
    """Return how neighbours are turned against the way, towards the side, in [-pi/4, pi/4]: the mean over all sides.

    ``UNCLEAR`` where few have been seen, or where they contradict each other.
    A car has sides at right angles: the mean of angles modulo 90 deg, each weighted by its length.
    """
    mean = 0.0
    for within in WITHIN:
        least = math.cos(4.0 * within)
        cosines = 0.0
        sines = 0.0
        total = 0.0
        agreed = 0.0
        for place in range(frame.first + CHORD, frame.end):
            if _is_side(store, place):
                before = seen(store, place - CHORD, frame)
                here = seen(store, place, frame)
                du = here.x - before.x
                dw = here.y - before.y
                length = math.sqrt(du * du + dw * dw)
                if here.y < _nearest(store, frame, here.x) + IN_FRONT:
                    angle = 4.0 * (math.atan2(dw, du) - mean)
                    total += length
                    if math.cos(angle) > least or within > 1.0:
                        agreed += length
                        cosines += length * math.cos(angle)
                        sines += length * math.sin(angle)
        if total < LEAST_SIDE or agreed < AGREED * total:
            return UNCLEAR
        mean = mean + 0.25 * math.atan2(sines, cosines)
    return wrap_quarter(mean)


class Sides(NamedTuple):
    """What was seen of the sides that lie in one direction."""

    longest: float = 0.0
    """Length [m] of the longest."""
    front: bool = False
    """One is as long as a car is wide, and ends there."""
    turn: float = 0.0
    """Of the longest against the way [rad], in [-pi/2, pi/2]."""


def wrap_quarter(angle: float) -> float:
    """Return an angle modulo 90 deg, in [-pi/4, pi/4]."""
    return 0.25 * math.atan2(math.sin(4.0 * angle), math.cos(4.0 * angle))


def sides_along(store: PlanStore, frame: PlacesFrame, angle: float) -> Sides:
    """Return what was seen of sides along ``angle`` [rad]: long sides and whole fronts tell how cars stand."""
    longest = 0.0
    turn = 0.0
    front = False
    for start in range(frame.first, frame.end):
        end = _end_of_side(store, frame, start, angle)
        first = seen(store, start, frame)
        here = seen(store, end, frame)
        dx = here.x - first.x
        dy = here.y - first.y
        length = math.sqrt(dx * dx + dy * dy)
        if length > longest:
            longest = length
            turn = math.atan2(dy, dx) if dx > 0.0 else math.atan2(-dy, -dx)
        if not front and NARROWEST < length < WIDEST:
            front = _ends_at(store, frame, here if dy > 0.0 else first, angle)
    return Sides(longest, front, turn)


def _end_of_side(store: PlanStore, frame: PlacesFrame, start: int, angle: float) -> int:
    """Return the last place of those joined to ``start`` that lie with it on a side along ``angle``; itself if none."""
    c = math.cos(angle)
    s = math.sin(angle)
    first = seen(store, start, frame)
    last = start
    goes_on = True
    for place in range(start + 1, frame.end):
        if goes_on and store.heard_joint[place] == 1:
            here = seen(store, place, frame)
            dx = here.x - first.x
            dy = here.y - first.y
            on = abs(dx * c + dy * s)
            goes_on = abs(dx * s - dy * c) < BESIDE_LINE + ASKEW * on
            last = place if goes_on else last
        else:
            goes_on = False
    return last


def _ends_at(store: PlanStore, frame: PlacesFrame, end: Pose, angle: float) -> bool:
    """Return whether echoes say that behind the deep end of a side there is nothing: not more of the side."""
    c = math.cos(angle)
    s = math.sin(angle)
    inwards = -BEYOND_IN if c > 0.0 else BEYOND_IN
    square = along(frame, 0.0, 0.5 * PI)
    count = 0
    for beyond in BEYOND:
        u = end.x + beyond * c + inwards * s
        w = end.y + beyond * s - inwards * c
        if is_free(store, w, u, square):
            count = count + 1
    return count >= ENOUGH


def _is_side(store: PlanStore, place: int) -> bool:
    """Return whether a place and those before it are of one side: joined, and none of them a corner."""
    for number in range(CHORD + 1):
        if store.heard_count[place - number] > CORNER or (number < CHORD and store.heard_joint[place - number] == 0):
            return False
    return True


def _nearest(store: PlanStore, frame: PlacesFrame, u: float) -> float:
    """Return how near [m] to the way something was heard around ``u``."""
    nearest = FAR
    for place in range(frame.first, frame.end):
        spot = seen(store, place, frame)
        if abs(spot.x - u) < NEAR and spot.y < nearest:
            nearest = spot.y
    return nearest
