"""Gaps between what was heard on one side: free corridors for a car, at the direction that the neighbours stand in.

Seen from the sensor: u forward, w to its side. A corridor leads into the side by the angle a from forward; along it t
grows, across it s: (t, s) = (u cos a + w sin a, u sin a - w cos a). Every place that is heard bounds the corridors on
either side of it, unless it lies deep in: then it bounds their depth. This holds for parallel and perpendicular slots
and for those at any angle alike.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from controller_fmu.planning.plan_store import HEARD, PlanStore
from modelkit.maths import PI, clamp
from modelkit.vocabulary import Pose

DEEP = 50.0
"""Depth [m] of a gap behind which nothing was heard."""
NEAR = 3.0
IN_FRONT = 2.2
"""Sides that tell how neighbours stand lie no farther [m] behind the nearest place within ``NEAR``."""
CORNER = 4
"""Where more echoes came from one place it is a corner, or a post."""
CHORD = 3
"""Directions are told from one place to the so many-th after it."""
UNCLEAR = 9.0
LEAST_SIDE = 1.2
AGREED = 0.6
"""So much [m] of sides tells how neighbours stand, if they agree; else neighbours are taken to stand along the way."""
ANGLED = 20.0 * PI / 180.0
BODY = 0.9
"""A neighbour is no narrower than this share of the car's own width."""
FACE = 2.2
"""Where a neighbour's front is looked for [m] from the gap."""
BAND = 0.12
"""A neighbour's side lies so near [m] to the gap's edge."""
SHOWN = 1.2
"""So much [m] of a neighbour's front shows where its outermost corner is."""
BESIDE_ONE = 0.3
"""A slot beside one neighbour is this much [m] wider than the least."""
LEAST_SUPPORT = 0.5
ASIDE = 0.25
"""Sine of how far chords of one side differ from its direction."""
CLEARLY = 0.15
"""A side is longer than another by more than this [m]."""
WIDER = 0.2
"""At an angle, so much [m] of a neighbour's side must be seen; its front is no wider than the car's by more."""
SQUARE = 0.26
"""Cosine of 75 deg: slots less askew are square to the road."""
EDGE = 0.05
INSIDE = 0.25
FLUSH = 0.2
APART = 0.4
LONGEST = 15.0
PASSED = 0.5
"""The sensor has passed the gap's end by so much [m]."""
BESIDE = 1.0
"""Deep enough for what bounds a slot along the road [m]; and for one across it."""
CROSS = 2.0
LONG = 2.6
"""A neighbour longer than this [m] along the road stands along it."""
STRAIGHT = 0.25
"""The corners of a slot along the road lie along its neighbours, up to so much [m/m]."""
SHARE = 0.75
LOOKED = 0.3
LOOKED_MOST = 2.0
"""A gap has been looked into if nothing was heard before this share of the depth that could be looked into, and [m]."""


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


class GapFrame(NamedTuple):
    """How places are looked at: whose they are, from where, along which way, row and corridor."""

    first: int
    """Of the places."""
    end: int
    mirror: float
    """1 on the right side, -1 on the left."""
    at: Pose
    """The sensor; its heading is that of the way."""
    rim: float
    """Tangent of its cone's half angle."""
    row: float = 0.0
    """Direction of the row against the way, towards the side [rad]."""
    into: float = 0.0
    """Direction into the corridor against the way, towards the side [rad]."""


class Spot(NamedTuple):
    """A place in a frame [m]: along the corridor, across it, and how far behind the row's line."""

    t: float
    s: float
    z: float


def find_gap(store: PlanStore, side: int, places: int, at: Pose, forward: float, want: Wanted) -> Gap:
    """Return the gap passed last on a side that has heard so many places, the sensor ``at``; or NONE.

    ``forward``: the way's direction [rad].
    """
    mirror = 1.0 if side == 0 else -1.0
    frame = GapFrame(side * HEARD, side * HEARD + places, mirror, Pose(at.x, at.y, forward), math.tan(want.half_angle))
    turn = turn_of(store, frame)
    if turn == UNCLEAR:
        return Gap()
    square = frame._replace(row=turn, into=turn + 0.5 * PI)
    if abs(turn) <= ANGLED:
        best = _corridor(store, square, want, True) if want.along else Gap()
        return _corridor(store, square, want, False) if best.layout == GapLayout.NONE and want.across else best
    if not want.across:
        return Gap()
    other = turn if turn > 0.0 else turn + PI
    longer = _longest_side(store, frame, turn + 0.5 * PI) - _longest_side(store, frame, other)
    if longer > CLEARLY:
        return _corridor(store, frame._replace(into=turn + 0.5 * PI), want, False)
    return _corridor(store, frame._replace(into=other), want, False) if longer < -CLEARLY else Gap()


def _longest_side(store: PlanStore, frame: GapFrame, angle: float) -> float:
    """Return the length [m] of the longest side seen along ``angle``: the long sides of cars tell how they stand."""
    longest = 0.0
    start = -1
    for place in range(frame.first + CHORD, frame.end):
        before = _seen(store, place - CHORD, frame)
        here = _seen(store, place, frame)
        off = math.sin(math.atan2(here.y - before.y, here.x - before.x) - angle)
        if _is_side(store, place) and abs(off) < ASIDE:
            start = place - CHORD if start < 0 else start
            first = _seen(store, start, frame)
            dx = here.x - first.x
            dy = here.y - first.y
            longest = max(longest, math.sqrt(dx * dx + dy * dy))
        else:
            start = -1
    return longest


def turn_of(store: PlanStore, frame: GapFrame) -> float:
    """Return how neighbours are turned against the way, towards the side, in [-pi/4, pi/4]: the mean over all sides.

    ``UNCLEAR`` where few have been seen, or where they contradict each other.
    A car has sides at right angles: the mean of angles modulo 90 deg, each weighted by its length.
    """
    cosines = 0.0
    sines = 0.0
    total = 0.0
    for place in range(frame.first + CHORD, frame.end):
        if _is_side(store, place):
            before = _seen(store, place - CHORD, frame)
            here = _seen(store, place, frame)
            du = here.x - before.x
            dw = here.y - before.y
            length = math.sqrt(du * du + dw * dw)
            if here.y < _nearest(store, frame, here.x) + IN_FRONT:
                angle = 4.0 * math.atan2(dw, du)
                cosines += length * math.cos(angle)
                sines += length * math.sin(angle)
                total += length
    if total < LEAST_SIDE:
        return UNCLEAR
    if math.sqrt(sines * sines + cosines * cosines) < AGREED * total:
        return UNCLEAR
    return 0.25 * math.atan2(sines, cosines)


def _is_side(store: PlanStore, place: int) -> bool:
    """Return whether a place and those before it are of one side: joined, and none of them a corner."""
    for number in range(CHORD + 1):
        if store.heard_count[place - number] > CORNER or (number < CHORD and store.heard_joint[place - number] == 0):
            return False
    return True


def _seen(store: PlanStore, place: int, frame: GapFrame) -> Pose:
    """Return a place as the sensor sees it: x forward, y to its side [m]."""
    return _turned(store.heard_x[place], store.heard_y[place], frame)


def _turned(x: float, y: float, frame: GapFrame) -> Pose:
    c = math.cos(frame.at.heading)
    s = math.sin(frame.at.heading)
    dx = x - frame.at.x
    dy = y - frame.at.y
    return Pose(dx * c + dy * s, frame.mirror * (dx * s - dy * c), 0.0)


def _spot(seen: Pose, frame: GapFrame) -> Spot:
    c = math.cos(frame.into)
    s = math.sin(frame.into)
    behind = seen.y * math.cos(frame.row) - seen.x * math.sin(frame.row)
    return Spot(seen.x * c + seen.y * s, seen.x * s - seen.y * c, behind)


def _nearest(store: PlanStore, frame: GapFrame, u: float) -> float:
    """Return how near [m] to the way something was heard around ``u``."""
    nearest = DEEP
    for place in range(frame.first, frame.end):
        seen = _seen(store, place, frame)
        if abs(seen.x - u) < NEAR and seen.y < nearest:
            nearest = seen.y
    return nearest


def _corridor(store: PlanStore, frame: GapFrame, want: Wanted, along: bool) -> Gap:
    """Return the corridor passed last in a frame, with a car along the row or across it."""
    deep = BESIDE if along else CROSS
    least = want.length + want.room_along if along else want.width + want.room_across
    found = Gap()
    for place in range(frame.first, frame.end):
        one = _spot(_seen(store, place, frame), frame)
        end = want.open_ended and -one.s > least + 0.5 * want.width
        nearest = one.s + least + BESIDE_ONE if end else DEEP
        which = place
        for other in range(frame.first, frame.end):
            its = _spot(_seen(store, other, frame), frame)
            if its.z < one.z + deep and one.s < its.s < nearest:
                nearest = its.s
                which = other
        if least <= nearest - one.s < LONGEST and nearest < -PASSED and _is_past(store, frame, which):
            low = one.s
            if abs(math.cos(frame.into - frame.row)) > SQUARE:
                low = _beside_body(store, frame, low, -1.0, want)
                nearest = _beside_body(store, frame, nearest, 1.0, want) if which != place else nearest
                if nearest - low < least:
                    continue
            gap = _measured(store, frame, low, nearest, which != place, want)
            if _is_seen(store, frame, gap, low, nearest) and (not along or _is_straight(gap, frame)):
                if abs(math.cos(frame.into - frame.row)) > SQUARE and not _is_askew(gap, want):
                    continue
                if _fits(gap, want, along):
                    found = gap._replace(layout=GapLayout.ALONG if along else GapLayout.ACROSS)
                elif not along and found.layout == GapLayout.NONE:
                    found = gap._replace(layout=GapLayout.ACROSS, shallow=True)
    return found


def _is_past(store: PlanStore, frame: GapFrame, place: int) -> bool:
    """Return whether the sensor has passed a place."""
    return _seen(store, place, frame).x < -PASSED


def _beside_body(store: PlanStore, frame: GapFrame, edge: float, sense: float, want: Wanted) -> float:
    """Return the edge of a gap at an angle, moved to where the neighbour's body must begin.

    The corner that stands out most, of the neighbour beyond which the row recedes, is the far one of its front: the
    near one is a car's width nearer to the gap, whether it was heard or not.
    """
    if sense * math.cos(frame.into - frame.row) < 0.0:
        return edge
    out = edge
    z = DEEP
    for place in range(frame.first, frame.end):
        spot = _spot(_seen(store, place, frame), frame)
        if -EDGE <= sense * (spot.s - edge) <= FACE and spot.z < z:
            z = spot.z
            out = spot.s
    body = out - sense * BODY * want.width
    return body if sense * (body - edge) < 0.0 else edge


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


def _flank(store: PlanStore, frame: GapFrame, edge: float, sense: float) -> Flank:
    """Return the neighbour that bounds the gap at s = ``edge``, on its lower (``sense`` -1) or upper side."""
    t = DEEP
    z = DEEP
    deepest = -DEEP
    far = 0.0
    for place in range(frame.first, frame.end):
        spot = _spot(_seen(store, place, frame), frame)
        off = sense * (spot.s - edge)
        if -EDGE <= off <= FACE:
            t = min(t, spot.t)
            z = min(z, spot.z)
            far = max(far, off)
        if abs(off) <= BAND:
            deepest = max(deepest, spot.t)
    return Flank(t, z, max(0.0, deepest - t), far)


def _measured(store: PlanStore, frame: GapFrame, low: float, high: float, closed: bool, want: Wanted) -> Gap:
    """Return the gap between the lines s = ``low`` and s = ``high``: its corners, its depth, its neighbours."""
    one = _flank(store, frame, low, -1.0)
    angle = frame.into - frame.row
    along = (high - low) * math.cos(angle) / math.sin(angle)
    other = _flank(store, frame, high, 1.0) if closed else Flank(one.t + along, one.z, 0.0, 0.0)
    z = 0.5 * (one.z + other.z) if other.far > SHOWN else one.z
    corner = 0.5 * (want.length * math.sin(angle) + want.width * abs(math.cos(angle)))
    middle = (z + corner + 0.5 * (low + high) * math.cos(angle)) / math.sin(angle)
    front = middle - 0.5 * want.length
    if abs(math.cos(angle)) < SQUARE:
        front = 0.5 * (one.t + other.t)
    depth = DEEP
    for place in range(frame.first, frame.end):
        spot = _spot(_seen(store, place, frame), frame)
        if low + INSIDE < spot.s < high - INSIDE:
            depth = min(depth, spot.t - front)
    longer = max(_extent(store, frame, low, one.t, -1.0), _extent(store, frame, high, other.t, 1.0) if closed else 0.0)
    return Gap(
        layout=GapLayout.ALONG if longer > LONG else GapLayout.ACROSS,
        a=_in_world(one.t, low, frame),
        b=_in_world(other.t, high, frame),
        into=frame.at.heading - frame.mirror * frame.into,
        depth=depth,
        width=high - low,
        support=max(one.support, other.support),
        longest=longer,
        front=front - one.t,
    )


def _extent(store: PlanStore, frame: GapFrame, edge: float, front: float, sense: float) -> float:
    """Return how far [m] a neighbour's front goes on from the gap's edge, outwards."""
    reached = 0.0
    for _ in range(30):
        further = reached
        for place in range(frame.first, frame.end):
            spot = _spot(_seen(store, place, frame), frame)
            off = sense * (spot.s - edge)
            if abs(spot.t - front) < FLUSH and reached < off < reached + APART:
                further = max(further, off)
        if further <= reached:
            return reached
        reached = further
    return reached


def _in_world(t: float, s: float, frame: GapFrame) -> Pose:
    u = t * math.cos(frame.into) + s * math.sin(frame.into)
    right = frame.mirror * (t * math.sin(frame.into) - s * math.cos(frame.into))
    c = math.cos(frame.at.heading)
    sine = math.sin(frame.at.heading)
    return Pose(frame.at.x + u * c + right * sine, frame.at.y + u * sine - right * c, 0.0)


def _fits(gap: Gap, want: Wanted, along: bool) -> bool:
    """Return whether a gap is deep enough; along the road a car only stands where neighbours do, or it must."""
    if along:
        return gap.depth >= want.width - 0.1 and (gap.layout == GapLayout.ALONG or gap.depth < want.length - 0.3)
    return gap.depth >= want.deep


def _is_askew(gap: Gap, want: Wanted) -> bool:
    """Return whether neighbours at an angle stand along a gap: a side is seen, no front longer than a car is wide."""
    return gap.support > LEAST_SUPPORT and gap.longest < want.width + WIDER


def _is_straight(gap: Gap, frame: GapFrame) -> bool:
    """Return whether the opening lies along the row."""
    a = _turned(gap.a.x, gap.a.y, frame)
    b = _turned(gap.b.x, gap.b.y, frame)
    along = (b.x - a.x) * math.cos(frame.row) + (b.y - a.y) * math.sin(frame.row)
    across = (b.y - a.y) * math.cos(frame.row) - (b.x - a.x) * math.sin(frame.row)
    return abs(across) < STRAIGHT * along


def _is_seen(store: PlanStore, frame: GapFrame, gap: Gap, low: float, high: float) -> bool:
    """Return whether a sensor has looked into a gap (s from ``low`` to ``high``) nearly as deep as its cone lets it.

    The rims of the cone meet the neighbours' sides: at the distance of half the opening over tan(g).
    """
    middle = _turned(0.5 * (gap.a.x + gap.b.x), 0.5 * (gap.a.y + gap.b.y), frame)
    dx = gap.b.x - gap.a.x
    dy = gap.b.y - gap.a.y
    could = 0.5 * math.sqrt(dx * dx + dy * dy) / frame.rim - middle.y
    deep = _spot(middle, frame).t + clamp(SHARE * could, LOOKED, LOOKED_MOST)
    side = frame.first
    for ray in range(side, side + HEARD):
        begin = _spot(_turned(store.ray_x[ray], store.ray_y[ray], frame), frame)
        end = _spot(_turned(store.ray_end_x[ray], store.ray_end_y[ray], frame), frame)
        if end.t > deep and begin.t < deep:
            share = (deep - begin.t) / (end.t - begin.t)
            if low < begin.s + share * (end.s - begin.s) < high:
                return True
    return False
