"""A slot as what was heard on the way into it tells it anew: its sides, its direction, how deep it is."""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import HEARD, SIDES, PlanStore
from controller_fmu.sensing.gap import DEEP, Gap, GapLayout
from controller_fmu.sensing.in_gap import PlaceInGap, along_of, in_gap
from controller_fmu.valet.found.nearby import INSIDE, SURE, Nearby
from modelkit.vocabulary import Pose

WIDER = 0.5
"""A gap was thought to be narrower by no more than this [m]."""
EDGE = 0.25
"""So much [m] of a neighbour's flank, or of a post, was heard if the gap is taken to be as wide as that."""
FLANK = 1.0
"""And so much if it tells how the gap is turned."""
KERB_LINE = 0.7
"""So much [m] of a kerb was heard if it tells how the road goes."""
ASKEW = 0.18
"""A flank, or a kerb, is turned by no more than this [m/m] against what it was thought to be."""
KERB = 0.8
"""A kerb lies behind this share of a car's width that stands flush with its neighbours."""
KERB_BEHIND = 1.0
"""And no farther [m] behind a car that stands so."""
KERB_PLACES = 3
KERB_OFF = 0.3
"""It lies no farther [m] from where it was heard from the road."""
LEAST_ACROSS = 0.3
"""Slots lie to their row at more than the angle with this sine."""
BEFORE_END = 0.3
"""What is heard so near [m] to what a slot ends at is part of that."""
BEHIND = 0.3
"""What is heard so far [m] from both neighbours is no part of them."""


class OnSide(NamedTuple):
    """Where something heard lies along a side, and aside from it [m]."""

    along: float
    aside: float
    there: bool
    """It may be of that side."""


def corrected(store: PlanStore, state: Nearby, gap: Gap, length: float, told: bool) -> Gap:
    """Return a gap as what was heard in it on the way in leaves it, beside a car of this length [m].

    What stands in it makes it narrower; its middle moves along the row. Where a flank was heard over more than
    ``EDGE``, the gap ends there, and may be wider than it was thought to be, but not than it was told. Along the road a
    kerb heard tells how deep it is.
    """
    e = along_of(gap)
    least = 0.0 if told else -WIDER
    low = max(_edge(store, state, gap, length, 1.0), least)
    high = gap.width - max(_edge(store, state, gap, length, -1.0), least)
    a = Pose(gap.a.x + low * e.x, gap.a.y + low * e.y, gap.a.heading)
    depth = _kerb_behind(store, state, gap, length) if gap.layout == GapLayout.ALONG else gap.depth
    on = _along_row(gap, 0.5 * (low + high - gap.width))
    return gap._replace(a=a, width=high - low, front=gap.front + on, depth=depth - on if depth < DEEP else depth)


def _along_row(gap: Gap, aside: float) -> float:
    """Return how much farther [m] into a gap the neighbours' front lies, so far [m] aside along their row."""
    e = along_of(gap)
    c = math.cos(gap.row)
    s = math.sin(gap.row)
    across = e.x * c + e.y * s
    into = math.cos(gap.into) * c + math.sin(gap.into) * s
    return aside * into / across if abs(across) > LEAST_ACROSS else 0.0


def turned_gap(store: PlanStore, state: Nearby, gap: Gap, length: float) -> Gap:
    """Return a gap turned about the middle of a car of this length [m] that stands in it, as was heard on the way in.

    Across the road as the mean of both neighbours' flanks; where only one was heard, the other one is thought to stand
    as it was. Along the road as the kerb.
    """
    if gap.layout == GapLayout.ALONG:
        turn = -_turn(store, state, gap, length, 0.0)
    else:
        turn = 0.5 * (_turn(store, state, gap, length, 1.0) - _turn(store, state, gap, length, -1.0))
    e = along_of(gap)
    c = math.cos(gap.into)
    s = math.sin(gap.into)
    left = c * e.y - s * e.x > 0.0
    into = gap.into + (math.atan(turn) if left else -math.atan(turn))
    deep = gap.front + 0.5 * length
    half = 0.5 * gap.width
    x = gap.a.x + deep * c + half * e.x
    y = gap.a.y + deep * s + half * e.y
    now = gap._replace(into=into)
    e = along_of(now)
    a = Pose(x - deep * math.cos(into) - half * e.x, y - deep * math.sin(into) - half * e.y, gap.a.heading)
    return now._replace(a=a)


def _turn(store: PlanStore, state: Nearby, gap: Gap, size: float, sense: float) -> float:
    """Return by how much [m/m] a side of a gap is turned away from what it was thought to be; 0: too little heard.

    ``sense``: the flank at A (1) or at B (-1), beside a car of this length, or the kerb (0) behind one of this width.
    """
    aside = 0.0
    along = 0.0
    for number in range(4):
        first = (SIDES + number) * HEARD
        for place in range(first + 1, first + state.ears[number].places):
            if store.heard_joint[place] == 1:
                one = _on_side(in_gap(store, place - 1, gap), gap, size, sense)
                other = _on_side(in_gap(store, place, gap), gap, size, sense)
                forward = 1.0 if other.along > one.along else -1.0
                run = forward * (other.along - one.along)
                off = forward * (other.aside - one.aside)
                if one.there and other.there and abs(off) < ASKEW * run:
                    along += run
                    aside += off
    return aside / along if along > (KERB_LINE if sense == 0.0 else FLANK) else 0.0


def _on_side(at: PlaceInGap, gap: Gap, size: float, sense: float) -> OnSide:
    """Return where a place lies along a flank, or the kerb, of ``_turn``."""
    if sense == 0.0:
        return OnSide(at.across, at.deep, _is_behind(at, gap, size))
    beside = _from_side(at, gap, sense)
    return OnSide(beside.deep, beside.across, _is_beside(beside, gap, size))


def _from_side(at: PlaceInGap, gap: Gap, sense: float) -> PlaceInGap:
    """Return where a place lies from the side at A (``sense`` 1), or at B (-1), and from the neighbours' front."""
    return PlaceInGap(at.across if sense > 0.0 else gap.width - at.across, at.deep - gap.front)


def _is_beside(at: PlaceInGap, gap: Gap, length: float) -> bool:
    """Return whether a place, seen from a gap's side, lies there beside a car of this length [m]."""
    return -WIDER < at.across < 0.5 * gap.width and 0.0 < at.deep < min(length, gap.depth - BEFORE_END)


def _is_behind(at: PlaceInGap, gap: Gap, width: float) -> bool:
    """Return whether a place may be of the kerb behind a car of this width [m]."""
    return BEHIND < at.across < gap.width - BEHIND and KERB * width < at.deep - gap.front < width + KERB_BEHIND


def _edge(store: PlanStore, state: Nearby, gap: Gap, length: float, sense: float) -> float:
    """Return how far [m] inside its side at A (``sense`` 1), or at B (-1), a gap begins; negative: outside."""
    edge = -WIDER
    first = DEEP
    last = -DEEP
    for number in range(4):
        for place in range((SIDES + number) * HEARD, (SIDES + number) * HEARD + state.ears[number].places):
            at = _from_side(in_gap(store, place, gap), gap, sense)
            if store.heard_count[place] >= SURE and _is_beside(at, gap, length):
                edge = max(edge, at.across)
                first = min(first, at.deep)
                last = max(last, at.deep)
    return edge if last - first > EDGE else max(edge if edge > INSIDE else 0.0, 0.0)


def _kerb_behind(store: PlanStore, state: Nearby, gap: Gap, width: float) -> float:
    """Return how deep [m] a gap along the road is, by the kerb heard behind a car of this width; else as known."""
    depth = DEEP
    count = 0
    for number in range(4):
        for place in range((SIDES + number) * HEARD, (SIDES + number) * HEARD + state.ears[number].places):
            at = in_gap(store, place, gap)
            if store.heard_count[place] >= SURE and _is_behind(at, gap, width):
                depth = min(depth, at.deep - gap.front)
                count = count + 1
    told = count >= KERB_PLACES and (gap.depth >= DEEP or abs(depth - gap.depth) < KERB_OFF)
    return depth if told else gap.depth
