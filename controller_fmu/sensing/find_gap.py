"""A gap between cars: along the road, square to it, or at an angle, where they may stand in either of two ways."""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.corridor import corridor
from controller_fmu.sensing.gap import DEEP, Gap, GapLayout, Wanted
from controller_fmu.sensing.neighbours import free_of_bodies
from controller_fmu.sensing.places import UNSEEN, PlacesFrame, along, frame_of, is_free, spot_of, turned
from controller_fmu.sensing.row_line import row_of
from controller_fmu.sensing.rows import UNCLEAR, WIDEST, sides_along, turn_of, wrap_quarter
from modelkit.maths import PI
from modelkit.vocabulary import Pose

ANGLED = 20.0 * PI / 180.0
CROOKED = 6.0 * PI / 180.0
"""Cars along the road stand no more askew to their row: it is the row that tells how the road goes."""
FRONT = 1.1
"""So much [m] of one straight front is heard of cars that stand square to the road."""
CONTRADICTED = 3
"""Neighbours stand the other way, where so many points more of them are known to be free."""
LONG_SIDE = 1.0
"""A side longer than this [m] is a car's, no post's."""
CLEARLY = 0.15
"""A side is longer than another by more than this [m]."""
MUCH_LONGER = 0.5
"""Where sides one way are longer than across it by more than this [m], cars stand that way, whatever is free."""
MUCH = 0.3
"""Much shorter than the other sides is what is by more than this [m]."""
HALFWAY = 36.0 * PI / 180.0
LATE = 3.0
LATER = 4.0
LATEST = 7.0
"""Sides are compared when the gap has been passed by so much [m]: before, the neighbour behind it is not seen.

Later where the one side of a car lies nearly along the row, as the car in front of it hides that.
"""
DEEP_IN = 2
"""So many of twelve points deep in a gap at an angle have to be known to be free."""
LEAST_THINGS = 3
"""A row at an angle has so many cars, posts on its line, or it is not known which of them stand out of it."""


def find_gap(store: PlanStore, side: int, places: int, at: Pose, want: Wanted) -> Gap:
    """Return the gap passed last on a side that has heard so many places; or NONE.

    ``at``: the sensor, its heading is the way's direction [rad].
    """
    frame = frame_of(side, places, at, want.half_angle)
    turn = turn_of(store, frame)
    if turn == UNCLEAR:
        return Gap()
    row = row_of(store, frame, want.street)
    askew = wrap_quarter(turn - row.turn) if row.behind > UNSEEN else turn
    if abs(askew) <= ANGLED:
        square = along(frame, turn, turn + 0.5 * PI)
        straight = row.turn if row.things >= LEAST_THINGS and abs(askew) < CROOKED else turn
        best = corridor(store, along(frame, straight, straight + 0.5 * PI), want, True) if want.along else Gap()
        return _square(store, square, turn, want) if best.layout == GapLayout.NONE and want.across else best
    too_few = row.things < LEAST_THINGS and not want.open_ended and not want.at_end
    if not want.across or too_few:
        return Gap()
    both_show = abs(askew) > HALFWAY
    frame = frame._replace(line=row.behind, cars=abs(turn) > HALFWAY)
    gap = _at_an_angle(store, frame, turn, row.turn, both_show, want)
    if gap.layout == GapLayout.NONE and want.at_end and both_show and not frame.cars:
        gap = _at_an_angle(store, frame._replace(cars=True), turn, row.turn, True, want)
    return gap


def _square(store: PlanStore, frame: PlacesFrame, turn: float, want: Wanted) -> Gap:
    """Return the corridor passed last between cars square to the road, if a front of them was heard; else NONE.

    Corners of cars that stand at an angle look square from far away, but lie on no straight side along ``turn`` [rad].
    """
    heard = want.at_end or sides_along(store, frame, turn).longest > FRONT
    return corridor(store, frame, want, False) if heard else Gap()


def gap_across(store: PlanStore, side: int, places: int, at: Pose, want: Wanted, into: float) -> Gap:
    """Return the gap between cars at an angle if they stand across the direction ``into`` [rad], not along it; or NONE.

    Cars turned by 45 deg look alike from before, whichever of two ways they stand. But not if sides one way are longer
    than any front, and much longer than those across.
    """
    frame = frame_of(side, places, at, want.half_angle)
    turn = turn_of(store, frame)
    row = row_of(store, frame, want.street)
    if turn == UNCLEAR or row.behind <= UNSEEN or abs(wrap_quarter(turn - row.turn)) <= ANGLED:
        return Gap()
    one = turn + 0.5 * PI
    other = turn if turn > 0.0 else turn + PI
    was = frame.mirror * (at.heading - into)
    was_one = abs(math.cos(was - one)) > abs(math.cos(was - other))
    way = other if was_one else one
    stood = sides_along(store, frame, one if was_one else other).longest
    if stood > max(WIDEST, sides_along(store, frame, way).longest + MUCH_LONGER):
        return Gap()
    return corridor(store, along(frame._replace(line=row.behind), row.turn, way), want, False)


def _at_an_angle(store: PlanStore, frame: PlacesFrame, turn: float, row: float, both_show: bool, want: Wanted) -> Gap:
    """Return the gap passed last between cars turned by ``turn`` [rad], or across that, to a row turned by ``row``.

    ``both_show``: of each car the front and a side; else the side that lies nearly along the row is hidden by the car
    in front of it, and a corner of a car looks like a post. So it does if the sensor does not look at both faces
    (``frame.cars`` is false): then nothing is a post, but at the end of a search in which sides do not tell either.

    Long sides and whole fronts tell which of the two; where neither was seen, it is the one in which there is a gap.
    So it is at the end of the search, if what they tell leaves no gap: a side longer than a front only if it is whole.
    """
    other = turn if turn > 0.0 else turn + PI
    one = turn + 0.5 * PI
    sides = sides_along(store, frame, one)
    across = sides_along(store, frame, other)
    longer = sides.longest - across.longest
    posts = frame.cars or (want.at_end and abs(longer) < CLEARLY)
    frame = frame._replace(cars=posts and both_show and max(sides.longest, across.longest) > LONG_SIDE)
    ways = TwoWays(along(frame, row, one), along(frame, row, other), longer, both_show)
    if sides.longest > WIDEST or across.longest > WIDEST:
        gap = corridor(store, ways.one if longer > 0.0 else ways.other, want, False)
        whole = sides.front if longer > 0.0 else across.front
        if gap.layout != GapLayout.NONE or not want.at_end or not whole:
            return gap
    if across.front != sides.front:
        gap = _deep(store, ways.one if across.front else ways.other, want)
        if gap.layout != GapLayout.NONE or not want.at_end:
            return gap
    return _likelier(store, ways, want)


class TwoWays(NamedTuple):
    """Two ways, across each other, in which cars of a row may stand."""

    one: PlacesFrame
    other: PlacesFrame
    longer: float
    """Sides seen along the one than along the other [m]."""
    both_show: bool
    """Of each car the front and a side are seen."""


def _likelier(store: PlanStore, ways: TwoWays, want: Wanted) -> Gap:
    """Return the gap of a row that may stand in two ways: of that way in which there is one.

    If there is one in both, of that whose sides are much longer where both show, else of that whose neighbours stand
    where less is known to be free, or whose sides are longer. At the end of the search, where neither tells, of that
    into which the driver wants to go: nose in along the way. Where sides are not clearly longer it waits: beside one
    neighbour, of whom less is seen, to the end.
    """
    late = LATE if ways.both_show else LATER
    unclear = DEEP if want.open_ended else LATEST
    one = _passed(store, ways.one, late if ways.longer > CLEARLY else unclear, want)
    other = _passed(store, ways.other, late if ways.longer < -CLEARLY else unclear, want)
    if one.layout == GapLayout.NONE:
        return Gap() if _is_unlikely(store, ways.other, other, ways.longer, want) else other
    if other.layout == GapLayout.NONE:
        return Gap() if _is_unlikely(store, ways.one, one, -ways.longer, want) else one
    if ways.both_show and abs(ways.longer) > MUCH_LONGER:
        return one if ways.longer > 0.0 else other
    fewer = free_of_bodies(store, ways.other, other, want) - free_of_bodies(store, ways.one, one, want)
    if abs(fewer) >= CONTRADICTED:
        return one if fewer > 0 else other
    if abs(ways.longer) < CLEARLY:
        leads_back = math.cos(ways.one.into - ways.one.row) < 0.0
        return (one if leads_back == want.tail_in else other) if want.at_end else Gap()
    return one if ways.longer > 0.0 else other


def _is_unlikely(store: PlanStore, frame: PlacesFrame, gap: Gap, shorter: float, want: Wanted) -> bool:
    """Return whether cars beside a gap would stand where it is free, and show sides so much ``shorter`` [m] there."""
    return shorter > MUCH and free_of_bodies(store, frame, gap, want) >= CONTRADICTED


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
    gap = corridor(store, frame, want, False)
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
