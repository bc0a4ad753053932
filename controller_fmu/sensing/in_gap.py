"""Where a point lies in a gap: across its opening from corner A, and into it."""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.gap import Gap
from modelkit.vocabulary import Pose


def along_of(gap: Gap) -> Pose:
    """Return the direction across the way into a gap, from A to B, as a unit vector."""
    x = -math.sin(gap.into)
    y = math.cos(gap.into)
    forward = (gap.b.x - gap.a.x) * x + (gap.b.y - gap.a.y) * y > 0.0
    return Pose(x if forward else -x, y if forward else -y, 0.0)


class PlaceInGap(NamedTuple):
    """A place as a gap has it [m]: from A towards B across it, and into it."""

    across: float
    deep: float


def in_gap(store: PlanStore, place: int, gap: Gap) -> PlaceInGap:
    """Return where in a gap a place lies that was heard."""
    return point_in_gap(store.heard_x[place], store.heard_y[place], gap)


def point_in_gap(x: float, y: float, gap: Gap) -> PlaceInGap:
    """Return where in a gap a point lies."""
    e = along_of(gap)
    dx = x - gap.a.x
    dy = y - gap.a.y
    return PlaceInGap(dx * e.x + dy * e.y, dx * math.cos(gap.into) + dy * math.sin(gap.into))
