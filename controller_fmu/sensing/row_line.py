"""Where a row lies: the line through what stands out of it, whatever single things stand before it or behind it."""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.gap import UNHEARD
from controller_fmu.sensing.places import UNSEEN, PlacesFrame, is_sure, seen
from modelkit.vocabulary import Pose

FAR = 50.0
SLOPES = (0.0, 0.08, -0.08, 0.16, -0.16, 0.24, -0.24)
"""A row is turned against the way by about one of these [m/m]."""
STEEP = 0.35
"""And by no more than this."""
ON_LINE = 0.3
"""What lies so near [m] to a line is on it."""
CLOSE = 0.25
"""And so near [m] to the line that it speaks for it."""
TURNED = 0.3
"""A line that is turned against the way by 1 [m/m] speaks for itself by this share less."""
AROUND = 1.2
"""What stands out of the row is the nearest to the way within this [m]."""
CRESTS = 12
ONE_CORNER = 0.25
"""Echoes so near [m] to each other are of one corner."""
CERTAIN = 20.0
"""So many echoes of a corner are as good as more."""
APART = 2.0
"""A line is drawn through things that stand so far apart [m]."""
POST = 0.6
"""What is no larger [m] may be a post, that stands before its row or behind it."""
ENOUGH = 4
"""So many things tell alone how their row goes: one of three may be a post before it."""
LEAST_ROW = 2.5
"""Sum of squares [m2] of how far apart things have to stand for a direction."""


class RowLine(NamedTuple):
    """The line through what stands out of a row."""

    turn: float = 0.0
    """Against the way [rad]."""
    behind: float = UNSEEN
    """So far [m] from the sensor, across; ``UNSEEN``: too little stands out."""
    things: int = 0
    """So many things stand on it."""


class Crest(NamedTuple):
    """What stands out of a row: where [m], and how well it was heard."""

    x: float = 0.0
    y: float = 0.0
    weight: float = 0.0
    post: bool = False


def row_of(store: PlanStore, frame: PlacesFrame, street: float) -> RowLine:
    """Return the line of a row: out of those through two things that stand out, the one on which most others lie.

    A pillar that stands before the row, or what stands alone behind it, is on no line with the others; where two cars
    were heard, posts do not count. What is on the line tells it by regression. If fewer than ``ENOUGH``
    are on it, but the road's other side was heard, the row goes along that, ``street`` its heading [rad]: of the first
    or last car the sensor may have heard a part of a side alone, which stands less out of the row than its corner.
    """
    line = _line_of(store, frame)
    if line.things >= ENOUGH or street == UNHEARD:
        return line
    return _line_along(store, frame, math.tan(frame.mirror * (frame.at.heading - street)), line)


def _line_along(store: PlanStore, frame: PlacesFrame, steep: float, line: RowLine) -> RowLine:
    """Return the line of a slope [m/m] on which most of what stands out lies, for a ``line`` of another slope."""
    crests = _without_posts(_crests(store, frame, steep))
    most = 0.0
    at = FAR
    for one in crests:
        score = _score(crests, steep, one.y - steep * one.x)
        if one.weight > 0.0 and score > most:
            most = score
            at = one.y - steep * one.x
    if most <= 0.0:
        return line
    n = 0.0
    behind = 0.0
    for crest in crests:
        if crest.weight > 0.0 and abs(crest.y - at - steep * crest.x) < CLOSE:
            n += crest.weight
            behind += crest.weight * (crest.y - steep * crest.x)
    return line._replace(turn=math.atan(steep), behind=behind / n / math.sqrt(1.0 + steep * steep))


def _line_of(store: PlanStore, frame: PlacesFrame) -> RowLine:
    """Return the line that things tell."""
    crests = _without_posts(_crests(store, frame, _leaning(store, frame)))
    most = 0.0
    slope = 0.0
    at = FAR
    for one in crests:
        for other in crests:
            run = other.x - one.x
            if run > APART and one.weight > 0.0 and other.weight > 0.0:
                steep = (other.y - one.y) / run
                score = _score(crests, steep, one.y - steep * one.x)
                if abs(steep) < STEEP and score > most:
                    most = score
                    slope = steep
                    at = one.y - steep * one.x
    return _fitted(crests, slope, at)


def _without_posts(crests: tuple[Crest, ...]) -> tuple[Crest, ...]:
    """Return what stands out and is no post, if that is enough for a line; else all."""
    cars = 0
    for crest in crests:
        cars = cars + 1 if crest.weight > 0.0 and not crest.post else cars
    if cars < 2:
        return crests
    return tuple(Crest() if crests[number].post else crests[number] for number in range(CRESTS))


def _score(crests: tuple[Crest, ...], slope: float, at: float) -> float:
    """Return how many echoes are of what lies on a line: those beside it count less, all a little if it is turned."""
    score = 0.0
    for crest in crests:
        off = abs(crest.y - at - slope * crest.x)
        score += crest.weight * (1.0 - off / CLOSE) if off < CLOSE else 0.0
    return score * (1.0 - TURNED * abs(slope))


def _fitted(crests: tuple[Crest, ...], slope: float, at: float) -> RowLine:
    """Return the line of those things that lie on one, by regression."""
    n = 0.0
    su = 0.0
    sw = 0.0
    suu = 0.0
    suw = 0.0
    things = 0
    for crest in crests:
        if crest.weight > 0.0 and abs(crest.y - at - slope * crest.x) < ON_LINE:
            things = things + 1
            n += 1.0
            su += crest.x
            sw += crest.y
            suu += crest.x * crest.x
            suw += crest.x * crest.y
    spread = suu - su * su / n if n > 0.0 else 0.0
    if spread < LEAST_ROW:
        return RowLine()
    steep = (suw - su * sw / n) / spread
    turn = math.atan(steep)
    return RowLine(turn, (sw - steep * su) / n * math.cos(turn), things)


def _crests(store: PlanStore, frame: PlacesFrame, slope: float) -> tuple[Crest, ...]:
    """Return what stands out of a row of about this slope, the last of it if there is more."""
    crests: tuple[Crest, ...] = (Crest(),) * CRESTS
    for place in range(frame.first, frame.end):
        if is_sure(store, place, frame.end):
            here = seen(store, place, frame)
            if _stands_out(store, frame, here, slope):
                post = is_post(store, frame, place)
                crests = crests[1:] + (Crest(here.x, here.y, _echoes(store, frame, here), post),)
    return crests


def is_post(store: PlanStore, frame: PlacesFrame, place: int) -> bool:
    """Return whether a place is of something no larger than a post."""
    first = place
    last = place
    begins = False
    for number in range(frame.first, place):
        at = place - 1 - (number - frame.first)
        begins = begins or store.heard_joint[at + 1] == 0
        first = first if begins else at
    ends = False
    for at in range(place + 1, frame.end):
        ends = ends or store.heard_joint[at] == 0
        last = last if ends else at
    one = seen(store, first, frame)
    here = seen(store, place, frame)
    other = seen(store, last, frame)
    before = (here.x - one.x) * (here.x - one.x) + (here.y - one.y) * (here.y - one.y)
    after = (other.x - here.x) * (other.x - here.x) + (other.y - here.y) * (other.y - here.y)
    return before < POST * POST and after < POST * POST


def _echoes(store: PlanStore, frame: PlacesFrame, here: Pose) -> float:
    """Return how many echoes came from around a point, at most ``CERTAIN``."""
    count = 0.0
    for place in range(frame.first, frame.end):
        other = seen(store, place, frame)
        if abs(other.x - here.x) < ONE_CORNER and abs(other.y - here.y) < ONE_CORNER:
            count += store.heard_count[place]
    return min(count, CERTAIN)


def _stands_out(store: PlanStore, frame: PlacesFrame, here: Pose, slope: float) -> bool:
    """Return whether nothing around is nearer to a line of this slope before the row."""
    for place in range(frame.first, frame.end):
        other = seen(store, place, frame)
        nearer = other.y - here.y < slope * (other.x - here.x)
        if abs(other.x - here.x) < AROUND and nearer and is_sure(store, place, frame.end):
            return False
    return True


def _leaning(store: PlanStore, frame: PlacesFrame) -> float:
    """Return which of ``SLOPES`` has a line with nothing before it on which places lie the farthest apart."""
    best = 0.0
    most = -1.0
    for slope in SLOPES:
        at = _support(store, frame, slope)
        n = 0.0
        su = 0.0
        suu = 0.0
        for place in range(frame.first, frame.end):
            here = seen(store, place, frame)
            if here.y - slope * here.x < at + ON_LINE and is_sure(store, place, frame.end):
                n += 1.0
                su += here.x
                suu += here.x * here.x
        spread = suu - su * su / n if n > 0.0 else 0.0
        if spread > most:
            most = spread
            best = slope
    return best


def _support(store: PlanStore, frame: PlacesFrame, slope: float) -> float:
    """Return where [m], beside the sensor, the line of a slope lies that has nothing before it."""
    at = FAR
    for place in range(frame.first, frame.end):
        here = seen(store, place, frame)
        at = min(at, here.y - slope * here.x) if is_sure(store, place, frame.end) else at
    return at
