"""From where along the road one reverse leads into a parallel slot: [Px_min, Px_max] of the source.

The second arc is fixed by the slot. At Px_min both arcs touch; further ahead a line lies between them,
its heading falls, and at Px_max the car would cut corner B.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.outline import Shape
from controller_fmu.apa.slot import Site
from controller_fmu.apa.ways.exit import Exit
from controller_fmu.apa.ways.move import is_move_free
from controller_fmu.apa.ways.turns import reverse_s, turn_of
from modelkit.vocabulary import Pose

FURTHEST = 8.0
HALVINGS = 12


class StartRange(NamedTuple):
    """Smallest and largest x [m] of a start at a given y and heading, slot's frame."""

    found: bool
    low: float
    high: float


def start_range(y: float, heading: float, way_in: Exit, site: Site, car: Shape) -> StartRange:
    """Return the range; ``high`` to 2 mm by halving. Not found if even the steepest way is not free."""
    turn = turn_of(car.curvature, car.curvature, car.ramp)
    r = 1.0 / car.curvature
    end = way_in.pose
    dy = y - r * math.cos(heading) - (end.y + r * math.cos(end.heading))
    least = turn.tangent + turn.tangent
    both = 2.0 * turn.rho
    squared = both * both + least * least - dy * dy
    if squared <= 0.0 or not way_in.found:
        return StartRange(False, 0.0, 0.0)
    low = math.sqrt(squared) + end.x - r * math.sin(end.heading) - r * math.sin(heading) + 1e-9
    free = low
    blocked = low + FURTHEST
    if not leads_in(Pose(low, y, heading), way_in, site, car):
        return StartRange(False, low, low)
    for _ in range(HALVINGS):
        middle = 0.5 * (free + blocked)
        if leads_in(Pose(middle, y, heading), way_in, site, car):
            free = middle
        else:
            blocked = middle
    return StartRange(True, low, free)


def leads_in(start: Pose, way_in: Exit, site: Site, car: Shape) -> bool:
    """Return whether one reverse leads in from this pose (slot's frame): whether it lies within its range."""
    turn = turn_of(car.curvature, car.curvature, car.ramp)
    move = reverse_s(start, way_in.pose, 0.0, turn, turn)
    return move.direction != 0 and is_move_free(move, car, site.obstacles)
