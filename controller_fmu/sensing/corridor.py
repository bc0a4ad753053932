"""Gaps between what was heard on one side: free corridors for a car, at the direction that the neighbours stand in.

Every place that is heard bounds the corridors on either side of it, unless it lies deep in: then it bounds their depth.
Hidden parts of neighbours are taken to be there unless an echo says that their place is free. This holds for parallel
and perpendicular slots and for those at any angle alike.
"""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.gap import DEEP, Gap, GapLayout, Wanted
from controller_fmu.sensing.neighbours import EDGE, FACE, beside_body, front_of, is_askew, measured
from controller_fmu.sensing.places import BEFORE_ECHO, PlacesFrame, Spot, is_free, is_sure, seen, spot, spot_of, turned

LONGEST_FRONT = 2.3
"""At an angle, a neighbour's front is no wider [m]."""
BESIDE_ONE = 0.4
"""A slot beside one neighbour is this much [m] wider than the least."""
LONGEST = 15.0
PASSED = 0.5
"""The sensor has passed the gap's end by so much [m]."""
BESIDE = 1.5
"""Deep enough for what bounds a slot along the road [m]; and for one across it."""
CROSS = 2.4
CROSS_ASKEW = 2.5
"""And for one at an angle, behind the front of the car that would stand there."""
STRAIGHT = 0.25
"""The corners of a slot along the road lie along its neighbours, up to so much [m/m]."""
FLUSH = 0.15
"""What lies so near [m] to the front of a neighbour, beside it, is more of its front."""
FAR_OFF = 2.5
TOLD_INSIDE = 0.6
"""From no farther off would a cone that the opening just lets through tell what is so far [m] in."""
JUST_INSIDE = 0.1
LOOKED = 4
"""So many of nine points in a gap's opening have to be known to be free."""


def corridor(store: PlanStore, frame: PlacesFrame, want: Wanted, lengthwise: bool) -> Gap:
    """Return the corridor passed last in a frame, with a car along the row or across it."""
    askew = is_askew(frame)
    least = want.length + want.room_along if lengthwise else want.width + want.room_across
    found = Gap()
    for place in range(frame.first, frame.end):
        if is_sure(store, place, frame.end):
            at_end = _end_of(store, frame, place, want, lengthwise)
            which = at_end.which
            low = spot(store, place, frame).s
            high = spot(store, which, frame).s if which != place else low + least + BESIDE_ONE
            ends = which != place or (want.open_ended and at_end.bounds)
            if ends and least <= high - low < LONGEST and seen(store, which, frame).x < -PASSED:
                if askew:
                    low = beside_body(store, frame, low, -1.0, want)
                    high = beside_body(store, frame, high, 1.0, want) if which != place else low + least + BESIDE_ONE
                gap = measured(store, frame, low, high, which != place, want)
                past = turned(gap.b.x, gap.b.y, frame).x < -PASSED
                open_ = past and high - low >= least and _is_open(store, frame, gap, low, high)
                straight = gap.longest < LONGEST_FRONT if askew else _is_straight(gap, frame)
                if open_ and straight:
                    if _fits(gap, frame, want, lengthwise):
                        found = gap._replace(layout=GapLayout.ALONG if lengthwise else GapLayout.ACROSS)
                    elif not lengthwise and found.layout == GapLayout.NONE:
                        found = gap._replace(layout=GapLayout.ACROSS, shallow=True)
    return found


class CorridorBound(NamedTuple):
    """What bounds a corridor lies beside where a car would stand: before one of these [m], along it, from the row."""

    t: float
    z: float


def _bound_of(store: PlanStore, frame: PlacesFrame, place: int, want: Wanted, lengthwise: bool) -> CorridorBound:
    """Return how deep [m] may lie what bounds a corridor that ``place`` begins.

    Less than so much behind the front of the neighbour that it is of, or behind where the car's own front would be.
    """
    least = want.length + want.room_along if lengthwise else want.width + want.room_across
    one = spot(store, place, frame)
    front = one.z
    for other in range(frame.first, frame.end):
        its = spot(store, other, frame)
        if one.s - FACE <= its.s <= one.s and its.z < front and is_sure(store, other, frame.end):
            front = its.z
    t = front_of(front, one.s, one.s + least, frame, want) + CROSS_ASKEW if is_askew(frame) else -DEEP
    return CorridorBound(t, front + (BESIDE if lengthwise else CROSS * math.sin(frame.into - frame.row)))


class CorridorEnd(NamedTuple):
    """What ends a corridor that a place begins."""

    which: int
    """A place; the one that begins it if none does."""
    bounds: bool
    """The place begins one."""


def _end_of(store: PlanStore, frame: PlacesFrame, place: int, want: Wanted, lengthwise: bool) -> CorridorEnd:
    """Return what ends the corridor that ``place`` begins.

    The bound is told from where the neighbour's hidden body begins, if that is of consequence: it takes its time.
    """
    bound = _bound_of(store, frame, place, want, lengthwise)
    one = spot(store, place, frame)
    which = _next(store, frame, place, want, bound, lengthwise) if _bounds(one, bound) else place
    clear = _clearly(one, bound, frame, want) and _clearly(spot(store, which, frame), bound, frame, want)
    if is_askew(frame) and not clear:
        angle = frame.into - frame.row
        off = beside_body(store, frame, one.s, -1.0, want) - one.s
        bound = bound._replace(t=bound.t + off * math.cos(angle) / math.sin(angle))
        which = _next(store, frame, place, want, bound, lengthwise) if _bounds(one, bound) else place
    return CorridorEnd(which, _bounds(one, bound))


def _clearly(at: Spot, bound: CorridorBound, frame: PlacesFrame, want: Wanted) -> bool:
    """Return whether a place bounds a corridor, or does not, wherever its neighbour's body begins."""
    angle = frame.into - frame.row
    least = bound.t + (want.width + EDGE) * min(math.cos(angle), 0.0) / math.sin(angle)
    return at.z < bound.z or at.t < least or at.t >= bound.t


def _bounds(at: Spot, limit: CorridorBound) -> bool:
    """Return whether a place bounds a corridor, and is not deep in."""
    return at.t < limit.t or at.z < limit.z


def _next(
    store: PlanStore, frame: PlacesFrame, place: int, want: Wanted, limit: CorridorBound, lengthwise: bool
) -> int:
    """Return the place that ends the corridor which ``place`` begins; itself if none does, or where one will do."""
    least = want.length + want.room_along if lengthwise else want.width + want.room_across
    one = spot(store, place, frame)
    which = place
    nearest = one.s + least + BESIDE_ONE if want.open_ended else DEEP
    leans_back = math.cos(frame.into - frame.row) < 0.0 and is_askew(frame)
    for other in range(frame.first, frame.end):
        its = spot(store, other, frame)
        its_front = leans_back and its.s - one.s < want.width and abs(its.t - one.t) < FLUSH
        bounds = _bounds(its, limit) and not its_front
        if bounds and one.s < its.s < nearest and is_sure(store, other, frame.end):
            nearest = its.s
            which = other
    return which


def _fits(gap: Gap, frame: PlacesFrame, want: Wanted, along: bool) -> bool:
    """Return whether a gap is deep enough; along the road a car only stands where neighbours do, or it must."""
    if along:
        return gap.depth >= want.width - 0.1 and (gap.layout == GapLayout.ALONG or gap.depth < want.length - 0.3)
    return gap.depth >= want.deep - want.stand_out / abs(math.sin(frame.into - frame.row))


def _is_straight(gap: Gap, frame: PlacesFrame) -> bool:
    """Return whether the opening lies along the row."""
    a = turned(gap.a.x, gap.a.y, frame)
    b = turned(gap.b.x, gap.b.y, frame)
    along = (b.x - a.x) * math.cos(frame.row) + (b.y - a.y) * math.sin(frame.row)
    across = (b.y - a.y) * math.cos(frame.row) - (b.x - a.x) * math.sin(frame.row)
    return abs(across) < STRAIGHT * along


def _is_open(store: PlanStore, frame: PlacesFrame, gap: Gap, low: float, high: float) -> bool:
    """Return whether echoes say that a gap's opening is free: enough of nine points in it.

    From far away a cone that is wider than the opening reaches hardly into it, as it hears the corners beside it:
    there, three points just inside it. The narrower the opening, the nearer that is.
    """
    a = spot_of(turned(gap.a.x, gap.a.y, frame), frame).t
    b = spot_of(turned(gap.b.x, gap.b.y, frame), frame).t
    count = 0
    first = 0
    for across in (0.25, 0.5, 0.75):
        t = a + across * (b - a)
        s = low + across * (high - low)
        first = first + 1 if is_free(store, t + JUST_INSIDE, s, frame) else first
        for into in (0.2, 0.5, 0.8):
            count = count + 1 if is_free(store, t + into, s, frame) else count
    lets_through = 0.5 * (high - low) / math.sqrt(1.0 - frame.cone)
    off = 0.5 * (turned(gap.a.x, gap.a.y, frame).y + turned(gap.b.x, gap.b.y, frame).y)
    far = off > min(FAR_OFF, lets_through - TOLD_INSIDE - BEFORE_ECHO)
    return count >= LOOKED or (far and first == 3)
