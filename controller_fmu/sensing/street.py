"""The road's other side: a wall, a kerb or a fence along it tells how the road goes, and so the row."""

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.gap import UNHEARD
from controller_fmu.sensing.places import frame_of
from controller_fmu.sensing.rows import UNCLEAR, sides_along, turn_of
from modelkit.maths import PI
from modelkit.vocabulary import Pose

LONGER = 6.0
"""No car is so long [m]."""
STEEP = 20.0 * PI / 180.0
"""Nor does anybody look for a slot so far askew to the road."""


def street_of(store: PlanStore, side: int, places: int, at: Pose, half_angle: float) -> float:
    """Return the heading [rad] of the longest straight side heard on a side, if it is longer than any car; ``UNHEARD``.

    ``at``: a sensor, its heading is the way's direction [rad].
    """
    frame = frame_of(side, places, at, half_angle)
    turn = turn_of(store, frame)
    if turn == UNCLEAR or abs(turn) > STEEP:
        return UNHEARD
    sides = sides_along(store, frame, turn)
    return at.heading - frame.mirror * sides.turn if sides.longest > LONGER else UNHEARD
