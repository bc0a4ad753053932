"""Short moves in a slot: two arcs to the slot's axis, and arcs at full lock until something is near.

Over an arc of curvature c the lateral change is (cos h - cos h') / c, whatever the direction. Two arcs
of curvature c and -c lead to y = 0, h = 0 if the heading h1 between them obeys

    cos h1 = (1 + cos h + c y) / 2
"""

import math
from typing import NamedTuple

from controller_fmu.apa.outline import Shape, free_way
from controller_fmu.apa.slot import Site
from controller_fmu.apa.ways.move import Move, is_move_free
from controller_fmu.apa.ways.turns import two_arcs
from modelkit.vocabulary import Pose

LONGEST_LINE = 8.0
SHORTEST = 0.02
"""An arc shorter than this [m] is left out: it turns the car by less than 0.3 deg."""
STEEPEST = 1.2


class Finish(NamedTuple):
    """A move that ends in the slot as wished."""

    found: bool
    move: Move
    off_centre: float
    """Distance [m] of its end from x = 0."""


def finish(start: Pose, direction: int, sense: float, aside: float, site: Site, car: Shape) -> Finish:
    """Return the move of two arcs (first curvature of sign ``sense``) and a line that ends in the slot.

    It ends ``aside`` [m] beside the slot's axis, along it.
    """
    c = sense * car.curvature
    none = Finish(False, two_arcs(start, 0, c, 0.0, 0.0, 0.0), 0.0)
    cosine = 0.5 * (1.0 + math.cos(start.heading) + c * (start.y - aside))
    if abs(start.heading) > STEEPEST or not math.cos(STEEPEST) <= cosine <= 1.0:
        return none
    turn = direction * sense
    middle = math.acos(cosine) * turn
    first = (middle - start.heading) * turn / abs(c)
    second = middle * turn / abs(c)
    if first < -1e-9:
        return none
    first = first if first > SHORTEST else 0.0
    x = start.x + (2.0 * math.sin(middle) - math.sin(start.heading)) / c
    line = 0.0
    wanted = direction * (0.0 - x)
    if wanted > 0.0:
        line = wanted
    end_x = x + direction * line
    move = two_arcs(start, direction, c, first, second, line)
    if line > LONGEST_LINE or not site.x_low <= end_x <= site.x_high:
        return none
    if first + second + line < 0.02 or not is_move_free(move, car, site.obstacles):
        return none
    return Finish(True, move, abs(end_x))


def full_lock(start: Pose, direction: int, sense: float, longest: float, site: Site, car: Shape) -> Move:
    """Return the move along one arc as far as nothing is near; no direction if that is under 10 cm."""
    c = sense * car.curvature
    way = free_way(start, float(direction), c, longest, car, site.obstacles)
    return two_arcs(start, direction if way >= 0.1 else 0, c, way, 0.0, 0.0)
