"""The way out of a slot: moves back and forth, looked for level by level, until the car can drive off.

Level n of the search holds the best poses after n moves, ``WIDTH`` of them at most. From each the moves of
``moves.py`` go as far as nothing is near; two poses that are nearly the same are one. The first level from which one
move leads out has a way of the fewest moves; its first move is driven, then the search is made anew.
"""

from typing import NamedTuple

from controller_fmu.apa.out.moves import CHOICES, NO_WAY, is_out, last_move, next_move
from controller_fmu.apa.outline import Shape
from controller_fmu.apa.slot import Kind, Site
from controller_fmu.apa.ways.move import Move, end_of, length_of
from controller_fmu.apa.ways.planner import FOUND, NOTHING, SEARCHING, PlanSearch
from modelkit.vocabulary import Pose

WIDTH = 24
AT_A_TIME = 8
"""Poses looked on from in one sample."""
SHORTEST = 0.04
"""A move that is shorter [m] leads nowhere."""
SAME_PLACE = 0.03
SAME_HEADING = 0.02
"""Poses that differ by less [m, rad] are one."""


class OutNode(NamedTuple):
    """A pose reached, and the first move on the way to it."""

    pose: Pose = Pose()
    direction: int = 0
    """Of the next move; 0: no pose."""
    score: float = 0.0
    """How much [rad] of the way is done."""
    first: int = 0
    """Number of the first move among those from the start."""
    ahead: int = 1
    """Its direction."""


class OutSearch(NamedTuple):
    """The level that is looked on from, the next one, and how far the search has come."""

    start: Pose = Pose()
    level: int = 0
    """Moves driven to the poses of this level."""
    place: int = 0
    nodes: tuple[OutNode, ...] = (OutNode(),) * WIDTH
    reached: tuple[OutNode, ...] = (OutNode(),) * WIDTH


def begun_at(start: Pose) -> OutSearch:
    """Return the search from ``start`` (target's frame), forward or back."""
    nodes = (OutNode(),) * WIDTH
    return OutSearch(start, nodes=_kept(_kept(nodes, OutNode(start, 1)), OutNode(start, -1, 0.0, 0, -1)))


class OutPlan(NamedTuple):
    """The search, and what has come of it."""

    search: OutSearch
    plan: PlanSearch


def plan_out(search: OutSearch, start: Pose, site: Site, car: Shape, most: int) -> OutPlan:
    """Return the search from ``start`` for a way of at most so many moves, some poses later.

    Found with no moves: the car is out.
    """
    if search.level == 0 and search.nodes[0].direction == 0:
        search = begun_at(start)
    start = search.start
    if is_out(start, site, car):
        return OutPlan(search, PlanSearch(FOUND, found=True, move=Move(start)))
    for _ in range(AT_A_TIME):
        node = search.nodes[search.place]
        if node.direction == 0 or search.place == WIDTH - 1:
            search = search._replace(
                level=search.level + 1,
                place=0,
                nodes=search.reached,
                reached=(OutNode(),) * WIDTH,
            )
            if search.nodes[0].direction == 0 or search.level >= most:
                return OutPlan(search, PlanSearch(NOTHING, move=Move(start)))
        else:
            last = last_move(node.pose, site, car) if node.direction > 0 else NO_WAY
            if last.direction != 0:
                first = last if search.level == 0 else next_move(start, node.ahead, node.first, site, car)
                return OutPlan(search, PlanSearch(FOUND, found=True, moves=search.level + 1, move=first))
            search = search._replace(place=search.place + 1, reached=_on_from(search, node, site, car))
    return OutPlan(search, PlanSearch(SEARCHING, move=Move(start)))


def _on_from(search: OutSearch, node: OutNode, site: Site, car: Shape) -> tuple[OutNode, ...]:
    """Return the poses reached, with those that a move from ``node`` leads to."""
    reached = search.reached
    for number in range(CHOICES):
        move = next_move(node.pose, node.direction, number, site, car)
        if length_of(move) >= SHORTEST:
            pose = end_of(move)
            first = number if search.level == 0 else node.first
            reached = _kept(reached, OutNode(pose, -node.direction, _score(pose, site, car), first, node.ahead))
    return reached


def _score(pose: Pose, site: Site, car: Shape) -> float:
    """Return how much [rad] of the way out is done at ``pose``: turned to the road, and out of the row."""
    if site.kind == Kind.PERPENDICULAR:
        return pose.heading + 0.1 * pose.x
    return pose.heading + 2.0 * pose.y / car.front


def _kept(nodes: tuple[OutNode, ...], node: OutNode) -> tuple[OutNode, ...]:
    """Return the best of ``nodes`` and ``node``, best first; of two that are nearly the same the better one."""
    carried = node
    for _ in range(WIDTH):
        here = nodes[0]
        kept = here
        if carried.direction != 0:
            if here.direction != 0 and _is_same(here, node):
                kept = here if here.score >= carried.score else carried
                carried = OutNode()
            elif here.direction == 0 or carried.score > here.score:
                kept = carried
                carried = here
        nodes = nodes[1:] + (kept,)
    return nodes


def _is_same(one: OutNode, other: OutNode) -> bool:
    a = one.pose
    b = other.pose
    near = abs(a.x - b.x) < SAME_PLACE and abs(a.y - b.y) < SAME_PLACE
    return one.direction == other.direction and near and abs(a.heading - b.heading) < SAME_HEADING
