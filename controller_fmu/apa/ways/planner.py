"""The search for the next move: a list of stages, each a family of candidates, a few at a time.

Stages go from fewer moves to more; the search ends with the first stage in which a candidate is free
of obstacles, and takes the cheapest of that stage. Only the next move is kept: at its end the car
stands where it really stands, and the search is made again from there.
"""

from typing import NamedTuple

from controller_fmu.apa.outline import Shape
from controller_fmu.apa.slot import Kind, Site
from controller_fmu.apa.ways.candidates import (
    BACK_WAYS,
    FORWARD_PREFIXES,
    REVERSE_PREFIXES,
    SHARES,
    SWING_ANGLES,
    SWING_WAYS,
    TURNS,
    Candidate,
    ahead_back_and_swing,
    back_and_forth,
    back_and_swing,
    inside,
    inside_count,
    into_parallel,
    none_from,
    swing,
    swing_back_and_forth,
    turn_in,
)
from controller_fmu.apa.ways.exit import VARIANTS, Exit, exit_of
from controller_fmu.apa.ways.move import Move
from modelkit.vocabulary import Pose

SEARCHING = 0
FOUND = 1
NOTHING = 2

INSIDE = 0
ENTRY = 20
TURN = 40
SWING = 41
BACK_AND_FORTH = 42
SWING_BACK_AND_FORTH = 43
BACK_AND_SWING = 44
AHEAD_BACK_AND_SWING = 45
NO_STAGE = -1
STEEPEST_INSIDE = 0.9
"""Past this heading [rad] short moves are not looked for, but for a single one."""

ON_THE_WAY = 0.25
"""Turned by more than this [rad] a car before a parallel slot is on its way in already."""

IN_PARALLEL = 8
"""Stages of a car in a parallel slot: short moves, 1 to 8 of them, then out of it and in anew."""
IN_PERPENDICULAR = (40, 1, 2, 41, 3, 44, 42, 45, 4, 43, NO_STAGE)


class PlanSearch(NamedTuple):
    """How far the search has come, and the best so far."""

    status: int = SEARCHING
    stage: int = 0
    number: int = 0
    way_in: Exit = Exit()
    found: bool = False
    cost: float = 0.0
    moves: int = 0
    """Moves of the best way, its first included."""
    move: Move = Move()
    """First move of the best way."""
    barred: int = 0
    """A way does not begin in this direction; 0: in any."""


def new_search(start: Pose, barred: int = 0) -> PlanSearch:
    """Return a search not yet begun, from ``start`` (slot's frame), for a way that does not begin ``barred``."""
    return PlanSearch(move=Move(start), barred=barred)


def search_on(search: PlanSearch, site: Site, car: Shape, count: int) -> PlanSearch:
    """Return the search after at most ``count`` more candidates."""
    for _ in range(count):
        if search.status == SEARCHING:
            search = _one_more(search, site, car)
    return search


def is_inside(start: Pose, site: Site, car: Shape) -> bool:
    """Return whether a car stands so deep in a parallel slot, and not past it, that short moves are looked for."""
    return start.y < 1.3 * car.half_width and start.x < site.x_high + car.front


def stage_of(place: int, start: Pose, site: Site, car: Shape) -> int:
    """Return the family of candidates at ``place`` in the order for this start, -1 past the last."""
    if site.kind == Kind.PARALLEL:
        if is_inside(start, site, car):
            return place + 1 if place < IN_PARALLEL else _entry(place - IN_PARALLEL)
        if abs(start.heading) > ON_THE_WAY:
            return _stage_on_the_way(place)
        return _entry(place)
    return IN_PERPENDICULAR[place] if place < len(IN_PERPENDICULAR) else NO_STAGE


def _stage_on_the_way(place: int) -> int:
    """Return the family for a car that stands turned before a parallel slot: to the end in one reverse, else anew."""
    return 1 if place == 0 else _entry(place - 1)


def _entry(variant: int) -> int:
    """Return the family that reverses in from the road to the begin of a way in."""
    return ENTRY + variant if variant < VARIANTS else NO_STAGE


def count_of(stage: int) -> int:
    """Return how many candidates a stage has."""
    if stage == TURN:
        return TURNS
    if stage == SWING:
        return 2 * SWING_ANGLES * SWING_WAYS
    if stage == BACK_AND_FORTH:
        return 20 * SHARES
    if stage == BACK_AND_SWING:
        return 3 * BACK_WAYS * 2 * SWING_ANGLES
    if stage == AHEAD_BACK_AND_SWING:
        return 4 * 3 * BACK_WAYS * 2 * SWING_ANGLES
    if stage == SWING_BACK_AND_FORTH:
        return 20 * 20 * SHARES
    if stage >= ENTRY:
        return REVERSE_PREFIXES + FORWARD_PREFIXES
    return inside_count(stage)


def _one_more(search: PlanSearch, site: Site, car: Shape) -> PlanSearch:
    start = search.move.start
    stage = stage_of(search.stage, start, site, car)
    if stage == NO_STAGE:
        return search._replace(status=NOTHING)
    way_in = search.way_in
    is_entry = ENTRY <= stage < TURN
    if is_entry and search.number == 0:
        way_in = exit_of(stage - ENTRY, site, car)
    candidate = _candidate(stage, search.number, start, way_in, site, car)
    good = candidate.found and (search.barred == 0 or candidate.move.direction != search.barred)
    better = good and (not search.found or candidate.cost < search.cost)
    last = search.number + 1 >= count_of(stage) or (is_entry and (good or not way_in.found))
    found = search.found or good
    return PlanSearch(
        FOUND if last and found else SEARCHING,
        search.stage + 1 if last else search.stage,
        0 if last else search.number + 1,
        way_in,
        found,
        candidate.cost if better else search.cost,
        candidate.moves if better else search.moves,
        candidate.move if better else search.move,
        search.barred,
    )


def _candidate(stage: int, number: int, start: Pose, way_in: Exit, site: Site, car: Shape) -> Candidate:
    if stage == TURN:
        return turn_in(start, number, site, car)
    if stage == SWING:
        return swing(start, number, site, car)
    if stage == BACK_AND_FORTH:
        return back_and_forth(start, number, site, car)
    if stage == BACK_AND_SWING:
        return back_and_swing(start, number, site, car)
    if stage == AHEAD_BACK_AND_SWING:
        return ahead_back_and_swing(start, number, site, car)
    if stage == SWING_BACK_AND_FORTH:
        return swing_back_and_forth(start, number, site, car)
    if stage >= ENTRY:
        if not way_in.found:
            return none_from(start)
        return into_parallel(start, number, way_in, site, car)
    if stage > 1 and abs(start.heading) > STEEPEST_INSIDE:
        return none_from(start)
    return inside(start, number, stage, site, car)
