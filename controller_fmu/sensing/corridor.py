"""Gaps between what was heard on one side: free corridors for a car, at the direction that the neighbours stand in.

Every place that is heard bounds the corridors on either side of it, unless it lies deep in: then it bounds their depth.
Hidden parts of neighbours are taken to be there unless an echo says that their place is free. This holds for parallel
and perpendicular slots and for those at any angle alike.
"""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.gap import DEEP, Gap, GapLayout, Wanted
from controller_fmu.sensing.neighbours import FACE, beside_body, free_of_bodies, front_of, is_askew, measured
from controller_fmu.sensing.places import (
    UNSEEN,
    PlacesFrame,
    Spot,
    along,
    frame_of,
    is_free,
    is_sure,
    seen,
    spot,
    spot_of,
    turned,
)
from controller_fmu.sensing.row_line import row_of
from controller_fmu.sensing.rows import UNCLEAR, WIDEST, sides_along, turn_of, wrap_quarter
from modelkit.maths import PI
from modelkit.vocabulary import Pose

ANGLED = 20.0 * PI / 180.0
CROOKED = 6.0 * PI / 180.0
"""Cars along the road stand no more askew to their row: it is the row that tells how the road goes."""
LONGEST_FRONT = 2.3
"""At an angle, a neighbour's front is no wider [m]."""
BESIDE_ONE = 0.4
"""A slot beside one neighbour is this much [m] wider than the least."""
CONTRADICTED = 3
"""Neighbours stand the other way, where so many points more of them are known to be free."""
CLEARLY = 0.15
"""A side is longer than another by more than this [m]."""
HALFWAY = 36.0 * PI / 180.0
LATE = 3.0
LATER = 4.0
LATEST = 7.0
DEEP_IN = 2
"""So many of twelve points deep in a gap at an angle have to be known to be free."""
"""Sides are compared when the gap has been passed by so much [m]: before, the neighbour behind it is not seen.

Later where the one side of a car lies nearly along the row, as the car in front of it hides that.
"""
LEAST_THINGS = 3
"""A row at an angle has so many cars, posts on its line, or it is not known which of them stand out of it."""
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
LOOKED = 4
"""So many of nine points in a gap's opening have to be known to be free."""


def find_gap(store: PlanStore, side: int, places: int, at: Pose, want: Wanted) -> Gap:
    """Return the gap passed last on a side that has heard so many places; or NONE.

    ``at``: the sensor, its heading is the way's direction [rad].
    """
    frame = frame_of(side, places, at, want.half_angle)
    turn = turn_of(store, frame)
    if turn == UNCLEAR:
        return Gap()
    row = row_of(store, frame)
    askew = wrap_quarter(turn - row.turn) if row.behind > UNSEEN else turn
    if abs(askew) <= ANGLED:
        square = along(frame, turn, turn + 0.5 * PI)
        straight = row.turn if row.things >= LEAST_THINGS and abs(askew) < CROOKED else turn
        best = _corridor(store, along(frame, straight, straight + 0.5 * PI), want, True) if want.along else Gap()
        return _corridor(store, square, want, False) if best.layout == GapLayout.NONE and want.across else best
    too_few = row.things < LEAST_THINGS and not want.open_ended and not want.at_end
    if not want.across or too_few:
        return Gap()
    late = LATE if abs(askew) > HALFWAY else LATER
    return _at_an_angle(store, frame._replace(line=row.behind), turn, row.turn, late, want)


def _at_an_angle(store: PlanStore, frame: PlacesFrame, turn: float, row: float, late: float, want: Wanted) -> Gap:
    """Return the gap passed last between cars turned by ``turn`` [rad], or across that, to a row turned by ``row``.

    Long sides and whole fronts tell which of the two; where neither was seen, it is the one in which there is a gap.
    """
    other = turn if turn > 0.0 else turn + PI
    one = turn + 0.5 * PI
    sides = sides_along(store, frame, one)
    across = sides_along(store, frame, other)
    longer = sides.longest - across.longest
    ways = TwoWays(along(frame, row, one), along(frame, row, other), longer)
    if sides.longest > WIDEST or across.longest > WIDEST:
        return _corridor(store, ways.one if longer > 0.0 else ways.other, want, False)
    if across.front != sides.front:
        return _deep(store, ways.one if across.front else ways.other, want)
    return _likelier(store, ways, late, want)


class TwoWays(NamedTuple):
    """Two ways, across each other, in which cars of a row may stand."""

    one: PlacesFrame
    other: PlacesFrame
    longer: float
    """Sides seen along the one than along the other [m]."""


def _likelier(store: PlanStore, ways: TwoWays, late: float, want: Wanted) -> Gap:
    """Return the gap of a row that may stand in two ways: of that way in which there is one.

    If there is one in both, of that whose neighbours stand where less is known to be free, or whose sides are longer.
    """
    one = _passed(store, ways.one, late, want)
    other = _passed(store, ways.other, late, want)
    if one.layout == GapLayout.NONE or other.layout == GapLayout.NONE:
        return other if one.layout == GapLayout.NONE else one
    fewer = free_of_bodies(store, ways.other, other, want) - free_of_bodies(store, ways.one, one, want)
    if abs(fewer) >= CONTRADICTED:
        return one if fewer > 0 else other
    if abs(ways.longer) < CLEARLY:
        return Gap()
    return one if ways.longer > 0.0 else other


def _passed(store: PlanStore, frame: PlacesFrame, late: float, want: Wanted) -> Gap:
    """Return the gap that the sensor has passed by so much [m], else NONE.

    By more if neighbours as large as the car would stand where something is known to be free: those are pillars, or
    parts of cars that stand the other way. At the end of the search what is there has to do.
    """
    gap = _deep(store, frame, want)
    if gap.layout == GapLayout.NONE or want.at_end:
        return gap
    contradicted = free_of_bodies(store, frame, gap, want) >= CONTRADICTED
    return gap if turned(gap.b.x, gap.b.y, frame).x < -(LATEST if contradicted else late) else Gap()


def _deep(store: PlanStore, frame: PlacesFrame, want: Wanted) -> Gap:
    """Return the corridor passed last in a frame at an angle, if echoes say that it is free deep in, else NONE.

    Before the corners of cars that stand at an angle there is free space too, but not deep.
    """
    gap = _corridor(store, frame, want, False)
    if gap.layout == GapLayout.NONE or want.at_end:
        return gap
    a = spot_of(turned(gap.a.x, gap.a.y, frame), frame)
    b = spot_of(turned(gap.b.x, gap.b.y, frame), frame)
    count = 0
    for across in (0.25, 0.5, 0.75):
        for into in (1.2, 1.6, 2.0, 2.4):
            t = a.t + across * (b.t - a.t) + into
            if is_free(store, t, a.s + across * (b.s - a.s), frame):
                count = count + 1
    return gap if count >= DEEP_IN else Gap()


def _corridor(store: PlanStore, frame: PlacesFrame, want: Wanted, lengthwise: bool) -> Gap:
    """Return the corridor passed last in a frame, with a car along the row or across it."""
    askew = is_askew(frame)
    least = want.length + want.room_along if lengthwise else want.width + want.room_across
    found = Gap()
    for place in range(frame.first, frame.end):
        if is_sure(store, place, frame.end):
            limit = _bound_of(store, frame, place, want, lengthwise)
            at = spot(store, place, frame)
            low = at.s
            which = _next(store, frame, place, want, limit, lengthwise) if _bounds(at, limit) else place
            high = spot(store, which, frame).s if which != place else low + least + BESIDE_ONE
            ends = which != place or (want.open_ended and _bounds(at, limit))
            if ends and least <= high - low < LONGEST and seen(store, which, frame).x < -PASSED:
                if askew:
                    low = beside_body(store, frame, low, -1.0, want)
                    high = beside_body(store, frame, high, 1.0, want) if which != place else low + least + BESIDE_ONE
                gap = measured(store, frame, low, high, which != place, want)
                past = turned(gap.b.x, gap.b.y, frame).x < -PASSED
                open_ = past and high - low >= least and _is_open(store, frame, gap, low, high)
                straight = gap.longest < LONGEST_FRONT if askew else _is_straight(gap, frame)
                if open_ and straight:
                    if _fits(gap, want, lengthwise):
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
    for other in range(frame.first, frame.end):
        its = spot(store, other, frame)
        if _bounds(its, limit) and one.s < its.s < nearest and is_sure(store, other, frame.end):
            nearest = its.s
            which = other
    return which


def _fits(gap: Gap, want: Wanted, along: bool) -> bool:
    """Return whether a gap is deep enough; along the road a car only stands where neighbours do, or it must."""
    if along:
        return gap.depth >= want.width - 0.1 and (gap.layout == GapLayout.ALONG or gap.depth < want.length - 0.3)
    return gap.depth >= want.deep


def _is_straight(gap: Gap, frame: PlacesFrame) -> bool:
    """Return whether the opening lies along the row."""
    a = turned(gap.a.x, gap.a.y, frame)
    b = turned(gap.b.x, gap.b.y, frame)
    along = (b.x - a.x) * math.cos(frame.row) + (b.y - a.y) * math.sin(frame.row)
    across = (b.y - a.y) * math.cos(frame.row) - (b.x - a.x) * math.sin(frame.row)
    return abs(across) < STRAIGHT * along


def _is_open(store: PlanStore, frame: PlacesFrame, gap: Gap, low: float, high: float) -> bool:
    """Return whether echoes say that a gap's opening is free: enough of nine points in it."""
    a = spot_of(turned(gap.a.x, gap.a.y, frame), frame).t
    b = spot_of(turned(gap.b.x, gap.b.y, frame), frame).t
    count = 0
    for across in (0.25, 0.5, 0.75):
        for into in (0.2, 0.5, 0.8):
            if is_free(store, a + across * (b - a) + into, low + across * (high - low), frame):
                count = count + 1
    return count >= LOOKED
