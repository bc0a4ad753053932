"""What is remembered of one side on the way past, and how it begins anew."""

from typing import NamedTuple

from controller_fmu.apa.hearing.consensus import NO_WINDOW, HeardSide, taken_up
from controller_fmu.apa.hearing.edge import NO_SAMPLES, Heard, remember
from controller_fmu.apa.hearing.line_fit import Sums

NOTHING = 0
WALL = 1
GAP = 2
NEXT_WALL = 3
DEEP = 50.0
"""Distance [m] of what is not heard."""
CONFIRMED = 0.3
TWO = 1.5
"""A gap is one once it is this long [m], and two echoes were not heard: others are lost echoes."""


class SideState(NamedTuple):
    """Everything remembered of one side."""

    mode: int = NOTHING
    n: float = 0.0
    """Readings in the bin being filled, and their sums."""
    u: float = 0.0
    w: float = 0.0
    r: float = 0.0
    last: Heard = Heard()
    """Last full bin."""
    spacing: float = 0.0
    """Way [m] from the bin before to the last one."""
    steady: int = 0
    """Bins in a row whose distance does not change steeply."""
    begun: float = 0.0
    """Where the neighbour in hand began [m]."""
    extent: float = 0.0
    """Length seen of the first neighbour [m]."""
    missed: float = 0.0
    """Where the neighbour was not heard any more [m]."""
    taken: int = 0
    """Samples kept of the next neighbour's beginning."""
    samples: tuple[Heard, ...] = NO_SAMPLES
    sums: Sums = Sums()
    """Of the neighbour in hand."""
    spare: Sums = Sums()
    """Of it, before they began anew: they count until there are enough of the new ones."""
    before: Sums = Sums()
    """Of the neighbour before the gap."""
    edge: float = 0.0
    """u of corner A [m]."""
    depth: float = DEEP
    found: int = 0
    """Counts the gaps between two neighbours; a slot is new or better whenever ``fresh``."""
    fresh: bool = False
    edge_b: float = 0.0
    """u of corner B [m]."""
    faces: tuple[Heard, ...] = NO_SAMPLES
    """Newest samples past corner A or short of corner B, where the cone's edge touches the neighbour's end."""
    behind: Sums = Sums()
    """Of the kerb or wall that the gap ends at."""
    first: Heard = Heard()
    """Of the neighbour in hand: its first corner, or near it; of none if it was there before it was looked at."""
    window: HeardSide = NO_WINDOW
    """All that is heard of the neighbour in hand, of its corners too."""
    ends: tuple[Heard, ...] = NO_SAMPLES
    """In a gap: the newest samples of the neighbour before it."""


EMPTY = Sums()
START = SideState()


def begin_wall(side: SideState, sample: Heard) -> SideState:
    """Return the side on a neighbour that begins with a sample."""
    window = taken_up(NO_WINDOW, sample)
    return anew(side)._replace(
        mode=WALL, begun=sample.u, first=sample, missed=sample.u, samples=remember(NO_SAMPLES, sample), window=window
    )


def anew(side: SideState) -> SideState:
    """Return the side as it starts, but for the bin being filled, the last one and the gaps counted."""
    return START._replace(
        n=side.n, u=side.u, w=side.w, r=side.r, last=side.last, spacing=side.spacing, found=side.found
    )


def confirmed(side: SideState) -> float:
    """Return how far [m] a neighbour must not have been heard to have ended: never so short that one echo tells it."""
    return max(CONFIRMED, TWO * side.spacing)
