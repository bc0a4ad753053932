"""The neighbours of a corridor: how far their bodies reach, and the gap that they leave between them."""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.gap import DEEP, Gap, GapLayout, Wanted
from controller_fmu.sensing.places import (
    UNSEEN,
    PlacesFrame,
    in_world,
    is_certain,
    is_free,
    is_sure,
    spot,
    spot_of,
    turned,
)
from controller_fmu.sensing.row_line import is_post

BODY = 0.97
"""A neighbour is as wide as this share of the car's own width."""
FACE = 2.2
"""Where a neighbour's front is looked for [m] from the gap."""
BAND = 0.12
"""A neighbour's side lies so near [m] to the gap's edge."""
SHOWN = 1.2
"""So much [m] of a neighbour's front shows where its outermost corner is, if that is not the one at the gap."""
SQUARE = 0.26
"""Cosine of 75 deg: slots less askew are square to the road."""
EDGE = 0.05
INSIDE = 0.25
FLUSH = 0.2
APART = 0.4
LONG = 2.6
"""A neighbour longer than this [m] along the road stands along it."""
INTO_BODY = 0.3
"""A hidden body is looked for so far [m] behind its front."""


def is_askew(frame: PlacesFrame) -> bool:
    """Return whether a corridor leads into the side at an angle."""
    return abs(math.cos(frame.into - frame.row)) > SQUARE


def front_of(z: float, low: float, high: float, frame: PlacesFrame, want: Wanted) -> float:
    """Return where [m] along a corridor at an angle the front of a car lies whose outermost corner is at ``z``."""
    angle = frame.into - frame.row
    corner = 0.5 * (want.length * math.sin(angle) + want.width * abs(math.cos(angle)))
    return (z + corner + 0.5 * (low + high) * math.cos(angle)) / math.sin(angle) - 0.5 * want.length


def beside_body(store: PlanStore, frame: PlacesFrame, edge: float, sense: float, want: Wanted) -> float:
    """Return the edge of a gap at an angle, moved to where the neighbour's body must begin.

    The corner that stands out most, of the neighbour beyond which the row recedes, is the far one of its front: the
    near one is a car's width nearer to the gap, whether it was heard or not. Where an echo says that nothing is
    there, or so little was heard of it where sides of cars were, it was a post.
    """
    if sense * math.cos(frame.into - frame.row) < 0.0:
        return edge
    out = edge
    z = DEEP
    for place in range(frame.first, frame.end):
        at = spot(store, place, frame)
        if -EDGE <= sense * (at.s - edge) <= FACE and at.z < z and is_sure(store, place, frame.end):
            body = at.s - sense * BODY * want.width
            hidden = not is_free(store, at.t + INTO_BODY, body + sense * EDGE, frame)
            hidden = hidden and not (frame.cars and is_post(store, frame, place))
            if hidden and not is_free(store, at.t + INTO_BODY, 0.5 * (at.s + body), frame):
                z = at.z
                out = body
    return out if sense * (out - edge) < 0.0 else edge


def free_of_bodies(store: PlanStore, frame: PlacesFrame, gap: Gap, want: Wanted) -> int:
    """Return how many of thirty points of both neighbours of a gap, as long and wide as the car, are known free."""
    a = spot_of(turned(gap.a.x, gap.a.y, frame), frame)
    b = spot_of(turned(gap.b.x, gap.b.y, frame), frame)
    count = 0
    for into in (0.2, 0.35, 0.5, 0.65, 0.8):
        for across in (0.3, 0.5, 0.7):
            t = into * want.length
            s = across * want.width
            count = count + 1 if is_free(store, a.t + t, a.s - s, frame) else count
            beyond = not want.open_ended and is_free(store, b.t + t, b.s + s, frame)
            count = count + 1 if beyond else count
    return count


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
        if -EDGE <= off <= FACE and is_sure(store, place, frame.end):
            t = min(t, at.t)
            z = min(z, at.z)
            far = max(far, off)
        if abs(off) <= BAND:
            deepest = max(deepest, at.t)
    return Flank(t, z, max(0.0, deepest - t), far)


def measured(store: PlanStore, frame: PlacesFrame, low: float, high: float, closed: bool, want: Wanted) -> Gap:
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
    front = front_of(frame.line if frame.line > UNSEEN else z, low, high, frame, want)
    if not is_askew(frame):
        front = 0.5 * (one.t + other.t)
    elif frame.line > UNSEEN:
        one = one._replace(t=max(one.t, _on_line(low, frame)))
        other = other._replace(t=max(other.t, _on_line(high, frame)))
    a = in_world(one.t, low, frame)
    out = spot_of(turned(a.x, a.y, frame), frame).z - frame.line if frame.line > UNSEEN else 0.0
    longer = max(_extent(store, frame, low, one.t, -1.0), _extent(store, frame, high, other.t, 1.0) if closed else 0.0)
    return Gap(
        layout=GapLayout.ALONG if longer > LONG else GapLayout.ACROSS,
        a=a,
        b=in_world(other.t, high, frame),
        into=frame.at.heading - frame.mirror * frame.into,
        depth=_ends(store, frame, low, high, front, want),
        width=high - low,
        support=max(one.support, other.support),
        longest=longer,
        front=front - one.t,
        row=frame.at.heading - frame.mirror * frame.row,
        out=max(out, 0.0),
    )


def _ends(store: PlanStore, frame: PlacesFrame, low: float, high: float, front: float, want: Wanted) -> float:
    """Return how far [m] behind ``front`` a gap ends; across the road at what was heard well enough."""
    depth = DEEP
    across = high - low < want.length
    for place in range(frame.first, frame.end):
        at = spot(store, place, frame)
        if low + INSIDE < at.s < high - INSIDE and is_sure(store, place, frame.end):
            known = not across or is_certain(store, place, frame.first, frame.end)
            depth = min(depth, at.t - front) if known else depth
    return depth


def _on_line(s: float, frame: PlacesFrame) -> float:
    """Return where [m] along a corridor at an angle the row's line lies at ``s`` across it: no corner lies before."""
    angle = frame.into - frame.row
    return (frame.line + s * math.cos(angle)) / math.sin(angle)


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
