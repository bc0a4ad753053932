"""The way out of a parallel slot: at full lock forward and back in turn, until straight ahead is clear.

The slot lies at y < 0 of its target's frame. Forward to the left and back to the right both turn the car to the road.
Each move goes as far as nothing is near; the last ends where the car could drive straight on past the neighbour ahead.
"""

from typing import NamedTuple

from controller_fmu.apa.outline import Box, Obstacles, Shape, clearance, free_way
from controller_fmu.apa.slot import Site
from controller_fmu.apa.ways.move import Move
from controller_fmu.apa.ways.planner import FOUND, NOTHING, PlanSearch
from controller_fmu.apa.ways.turns import two_arcs
from controller_fmu.common.curve import advance
from modelkit.vocabulary import Pose

CLEAR = 4.0
"""So far [m] straight ahead nothing of the slot may stand when the car is handed over."""
LONGEST = 3.0
SHORTEST = 0.1
"""A move that is shorter [m] leads nowhere."""
STEP = 0.1
FARTHEST = 50
"""Steps of the last move that are looked at."""
MOST = 8
"""Moves that are looked ahead."""


class WayOut(NamedTuple):
    """Moves that a way out takes, 0: there is none, and its first one."""

    moves: int
    first: Move


def plan_out(start: Pose, site: Site, car: Shape) -> PlanSearch:
    """Return the next move on the way out from ``start`` (target's frame), of the way with the fewest moves.

    Found with no moves: the front is clear.
    """
    if is_clear(start, site, car):
        return PlanSearch(FOUND, found=True, move=Move(start))
    best = _way_out(start, 1, 1.0, site, car)
    for share in (0.0, 1.0):
        other = _way_out(start, -1, share, site, car)
        if other.moves > 0 and (best.moves == 0 or other.moves < best.moves):
            best = other
    if best.moves == 0:
        return PlanSearch(NOTHING, move=Move(start))
    return PlanSearch(FOUND, found=True, moves=best.moves, move=best.first)


def is_clear(pose: Pose, site: Site, car: Shape) -> bool:
    """Return whether a car at ``pose`` could drive straight on past the neighbour ahead."""
    none = Box(1.0, -1.0, 1.0, -1.0)
    ahead = Obstacles(none, site.obstacles.ahead, none, none)
    return clearance(pose, car._replace(front=car.front + CLEAR), ahead, 0.0) > 0.0


def way_to_clear(pose: Pose, site: Site, car: Shape) -> float:
    """Return how far [m] to drive forward at full lock until straight ahead is clear, -1 if that cannot be."""
    for number in range(1, FARTHEST + 1):
        way = STEP * number
        at = advance(pose, 1.0, way, car.curvature, car.curvature)
        if clearance(at, car, site.obstacles, 0.0) <= 0.0 or at.heading > 1.2:
            return -1.0
        if is_clear(at, site, car):
            return way
    return -1.0


def _way_out(start: Pose, first: int, share: float, site: Site, car: Shape) -> WayOut:
    """Return the way out whose first move goes in this direction, at full lock or (``share`` 0) straight."""
    none = Move(start)
    pose = start
    direction = first
    first_move = none
    for number in range(MOST):
        lock = share if number == 0 else 1.0
        c = direction * lock * car.curvature
        out = way_to_clear(pose, site, car) if direction > 0 else -1.0
        way = out if out > 0.0 else free_way(pose, float(direction), c, LONGEST, car, site.obstacles)
        if way < SHORTEST:
            return WayOut(0, none)
        if number == 0:
            first_move = two_arcs(start, direction, c, way, 0.0, 0.0)
        if out > 0.0:
            return WayOut(number + 1, first_move)
        pose = advance(pose, float(direction), way, c, c)
        direction = -direction
    return WayOut(0, none)
