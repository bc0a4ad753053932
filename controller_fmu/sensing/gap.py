"""Gaps between what was heard on one side: free corridors for a car, at the direction that the neighbours stand in.

Every place that is heard bounds the corridors on either side of it, unless it lies deep in: then it bounds their depth.
Hidden parts of neighbours are taken to be there unless an echo says that their place is free. This holds for parallel
and perpendicular slots and for those at any angle alike.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.places import (
    PlacesFrame,
    along,
    frame_of,
    in_world,
    is_free,
    is_sure,
    seen,
    spot,
    spot_of,
    turned,
)
from controller_fmu.sensing.rows import UNCLEAR, WIDEST, sides_along, turn_of
from modelkit.maths import PI
from modelkit.vocabulary import Pose

DEEP = 50.0
"""Depth [m] of a gap behind which nothing was heard."""
ANGLED = 20.0 * PI / 180.0
BODY = 0.9
"""A neighbour is no narrower than this share of the car's own width."""
LONGEST_FRONT = 2.3
"""At an angle, a neighbour's front is no wider [m]."""
FACE = 2.2
"""Where a neighbour's front is looked for [m] from the gap."""
BAND = 0.12
"""A neighbour's side lies so near [m] to the gap's edge."""
SHOWN = 1.2
"""So much [m] of a neighbour's front shows where its outermost corner is, if that is not the one at the gap."""
BESIDE_ONE = 0.3
"""A slot beside one neighbour is this much [m] wider than the least."""
CLEARLY = 0.15
"""A side is longer than another by more than this [m]."""
LATE = 3.0
"""Sides are compared when the gap has been passed by so much [m]: before, the neighbour behind it is not seen."""
SQUARE = 0.26
"""Cosine of 75 deg: slots less askew are square to the road."""
EDGE = 0.05
INSIDE = 0.25
FLUSH = 0.2
APART = 0.4
LONGEST = 15.0
PASSED = 0.5
"""The sensor has passed the gap's end by so much [m]."""
BESIDE = 1.5
"""Deep enough for what bounds a slot along the road [m]; and for one across it."""
CROSS = 2.4
CROSS_ASKEW = 2.5
"""And for one at an angle, behind the front of the car that would stand there."""
LONG = 2.6
"""A neighbour longer than this [m] along the road stands along it."""
STRAIGHT = 0.25
"""The corners of a slot along the road lie along its neighbours, up to so much [m/m]."""
LOOKED = 4
"""So many of nine points in a gap's opening have to be known to be free."""
INTO_BODY = 0.3
"""A hidden body is looked for so far [m] behind its front."""


class GapLayout(IntEnum):
    """How a car would stand in a gap."""

    NONE = 0
    ALONG = 1
    """Its long side to the road."""
    ACROSS = 2
    """Nose or tail into the gap."""


class Wanted(NamedTuple):
    """What fits: the car's length and width [m], and the room wanted besides."""

    length: float
    width: float
    room_along: float
    room_across: float
    along: bool
    across: bool
    half_angle: float
    """Of the sensor's cone [rad]."""
    deep: float
    """Least depth [m] across the road."""
    open_ended: bool
    """One neighbour will do."""


class Gap(NamedTuple):
    """A gap: corners A (passed first) and B of its opening, direction into it, depth heard, all in the world."""

    layout: int = GapLayout.NONE
    a: Pose = Pose()
    b: Pose = Pose()
    into: float = 0.0
    depth: float = DEEP
    width: float = 0.0
    """Across the direction into it [m]."""
    shallow: bool = False
    """There is a gap, but not deep enough."""
    support: float = 0.0
    """So much [m] of the neighbours' sides has been seen along the gap."""
    longest: float = 0.0
    """So far [m] does a neighbour's front go on."""
    front: float = 0.0
    """Where a car begins that stands as its neighbours do, from A's corner along the direction into it [m]."""


def find_gap(store: PlanStore, side: int, places: int, at: Pose, want: Wanted) -> Gap:
    """Return the gap passed last on a side that has heard so many places; or NONE.

    ``at``: the sensor, its heading is the way's direction [rad].
    """
    frame = frame_of(side, places, at, want.half_angle)
    turn = turn_of(store, frame)
    if turn == UNCLEAR:
        return Gap()
    if abs(turn) <= ANGLED:
        square = along(frame, turn, turn + 0.5 * PI)
        best = _corridor(store, square, want, True) if want.along else Gap()
        return _corridor(store, square, want, False) if best.layout == GapLayout.NONE and want.across else best
    if not want.across:
        return Gap()
    other = turn if turn > 0.0 else turn + PI
    one = turn + 0.5 * PI
    sides = sides_along(store, frame, one)
    across = sides_along(store, frame, other)
    longer = sides.longest - across.longest
    if sides.longest > WIDEST or across.longest > WIDEST:
        return _corridor(store, along(frame, 0.0, one if longer > 0.0 else other), want, False)
    if across.front != sides.front:
        return _corridor(store, along(frame, 0.0, one if across.front else other), want, False)
    if abs(longer) < CLEARLY:
        return Gap()
    gap = _corridor(store, along(frame, 0.0, one if longer > 0.0 else other), want, False)
    return gap if turned(gap.b.x, gap.b.y, frame).x < -LATE else Gap()


def _corridor(store: PlanStore, frame: PlacesFrame, want: Wanted, lengthwise: bool) -> Gap:
    """Return the corridor passed last in a frame, with a car along the row or across it."""
    askew = _is_askew(frame)
    least = want.length + want.room_along if lengthwise else want.width + want.room_across
    found = Gap()
    for place in range(frame.first, frame.end):
        if is_sure(store, place, frame):
            low = spot(store, place, frame).s
            which = _next(store, frame, place, want, lengthwise)
            high = spot(store, which, frame).s if which != place else low + least + BESIDE_ONE
            ends = which != place or want.open_ended
            if ends and least <= high - low < LONGEST and seen(store, which, frame).x < -PASSED:
                if askew:
                    low = _beside_body(store, frame, low, -1.0, want)
                    high = _beside_body(store, frame, high, 1.0, want) if which != place else high
                gap = _measured(store, frame, low, high, which != place, want)
                past = turned(gap.b.x, gap.b.y, frame).x < -PASSED
                open_ = past and high - low >= least and _is_open(store, frame, gap, low, high)
                straight = gap.longest < LONGEST_FRONT if askew else _is_straight(gap, frame)
                if open_ and straight:
                    if _fits(gap, want, lengthwise):
                        found = gap._replace(layout=GapLayout.ALONG if lengthwise else GapLayout.ACROSS)
                    elif not lengthwise and found.layout == GapLayout.NONE:
                        found = gap._replace(layout=GapLayout.ACROSS, shallow=True)
    return found


def _next(store: PlanStore, frame: PlacesFrame, place: int, want: Wanted, lengthwise: bool) -> int:
    """Return the place that ends the corridor which ``place`` begins; itself if none does where one neighbour will do.

    Only what lies beside where a car would stand counts, not what is deep in: less than so much behind the front of
    the neighbour that ``place`` is of, or behind where the car's own front would be.
    """
    least = want.length + want.room_along if lengthwise else want.width + want.room_across
    one = spot(store, place, frame)
    front = one.z
    for other in range(frame.first, frame.end):
        its = spot(store, other, frame)
        if one.s - FACE <= its.s <= one.s and its.z < front and is_sure(store, other, frame):
            front = its.z
    askew = _is_askew(frame)
    t = _front(front, one.s, one.s + least, frame, want) + CROSS_ASKEW if askew else -DEEP
    z = front + (BESIDE if lengthwise else CROSS * math.sin(frame.into - frame.row))
    which = place
    nearest = one.s + least + BESIDE_ONE if want.open_ended else DEEP
    for other in range(frame.first, frame.end):
        its = spot(store, other, frame)
        beside = its.t < t or its.z < z
        if beside and one.s < its.s < nearest and is_sure(store, other, frame):
            nearest = its.s
            which = other
    return which


def _is_askew(frame: PlacesFrame) -> bool:
    """Return whether a corridor leads into the side at an angle."""
    return abs(math.cos(frame.into - frame.row)) > SQUARE


def _front(z: float, low: float, high: float, frame: PlacesFrame, want: Wanted) -> float:
    """Return where [m] along a corridor at an angle the front of a car lies whose outermost corner is at ``z``."""
    angle = frame.into - frame.row
    corner = 0.5 * (want.length * math.sin(angle) + want.width * abs(math.cos(angle)))
    return (z + corner + 0.5 * (low + high) * math.cos(angle)) / math.sin(angle) - 0.5 * want.length


def _beside_body(store: PlanStore, frame: PlacesFrame, edge: float, sense: float, want: Wanted) -> float:
    """Return the edge of a gap at an angle, moved to where the neighbour's body must begin.

    The corner that stands out most, of the neighbour beyond which the row recedes, is the far one of its front: the
    near one is a car's width nearer to the gap, whether it was heard or not. Where an echo says that nothing is
    there, it was a post.
    """
    if sense * math.cos(frame.into - frame.row) < 0.0:
        return edge
    out = edge
    z = DEEP
    for place in range(frame.first, frame.end):
        at = spot(store, place, frame)
        if -EDGE <= sense * (at.s - edge) <= FACE and at.z < z and is_sure(store, place, frame):
            body = at.s - sense * BODY * want.width
            hidden = not is_free(store, at.t + INTO_BODY, body + sense * EDGE, frame)
            if hidden and not is_free(store, at.t + INTO_BODY, 0.5 * (at.s + body), frame):
                z = at.z
                out = body
    return out if sense * (out - edge) < 0.0 else edge


class Flank(NamedTuple):
    """What is known of the neighbour on one side of a gap, in the gap's frame [m]."""

    t: float
    """Its front's."""
    z: float
    """Its outermost corner's."""
    support: float
    """How far its side is seen into the gap."""
    far: float
    """How far it is seen away from the gap."""


def _flank(store: PlanStore, frame: PlacesFrame, edge: float, sense: float) -> Flank:
    """Return the neighbour that bounds the gap at s = ``edge``, on its lower (``sense`` -1) or upper side."""
    t = DEEP
    z = DEEP
    deepest = -DEEP
    far = 0.0
    for place in range(frame.first, frame.end):
        at = spot(store, place, frame)
        off = sense * (at.s - edge)
        if -EDGE <= off <= FACE and is_sure(store, place, frame):
            t = min(t, at.t)
            z = min(z, at.z)
            far = max(far, off)
        if abs(off) <= BAND:
            deepest = max(deepest, at.t)
    return Flank(t, z, max(0.0, deepest - t), far)


def _measured(store: PlanStore, frame: PlacesFrame, low: float, high: float, closed: bool, want: Wanted) -> Gap:
    """Return the gap between the lines s = ``low`` and s = ``high``: its corners, its depth, its neighbours."""
    one = _flank(store, frame, low, -1.0)
    angle = frame.into - frame.row
    along = (high - low) * math.cos(angle) / math.sin(angle)
    other = _flank(store, frame, high, 1.0) if closed else Flank(one.t + along, one.z, 0.0, 0.0)
    leans_back = math.cos(angle) < 0.0
    z = 0.5 * (one.z + other.z)
    if not leans_back and other.far < SHOWN:
        z = one.z
    if leans_back and one.far < SHOWN:
        z = other.z
    front = _front(z, low, high, frame, want)
    if not _is_askew(frame):
        front = 0.5 * (one.t + other.t)
    depth = DEEP
    for place in range(frame.first, frame.end):
        at = spot(store, place, frame)
        if low + INSIDE < at.s < high - INSIDE and is_sure(store, place, frame):
            depth = min(depth, at.t - front)
    longer = max(_extent(store, frame, low, one.t, -1.0), _extent(store, frame, high, other.t, 1.0) if closed else 0.0)
    return Gap(
        layout=GapLayout.ALONG if longer > LONG else GapLayout.ACROSS,
        a=in_world(one.t, low, frame),
        b=in_world(other.t, high, frame),
        into=frame.at.heading - frame.mirror * frame.into,
        depth=depth,
        width=high - low,
        support=max(one.support, other.support),
        longest=longer,
        front=front - one.t,
    )


def _extent(store: PlanStore, frame: PlacesFrame, edge: float, front: float, sense: float) -> float:
    """Return how far [m] a neighbour's front goes on from the gap's edge, outwards."""
    reached = 0.0
    for _ in range(30):
        further = reached
        for place in range(frame.first, frame.end):
            at = spot(store, place, frame)
            off = sense * (at.s - edge)
            if abs(at.t - front) < FLUSH and reached < off < reached + APART:
                further = max(further, off)
        if further <= reached:
            return reached
        reached = further
    return reached


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
