"""What a gap between neighbours is, and what is wanted of it."""

from enum import IntEnum
from typing import NamedTuple

from modelkit.vocabulary import Pose

DEEP = 50.0
"""Depth [m] of a gap behind which nothing was heard."""
UNHEARD = 1000.0
"""The heading of a road whose other side was not heard."""


class GapLayout(IntEnum):
    """How a car would stand in a gap."""

    NONE = 0
    ALONG = 1
    """Its long side to the road."""
    ACROSS = 2
    """Nose or tail into the gap."""


class Wanted(NamedTuple):
    """What fits: the car's length and width [m], and the room wanted besides."""

    length: float
    width: float
    room_along: float
    room_across: float
    along: bool
    across: bool
    half_angle: float
    """Of the sensor's cone [rad]."""
    deep: float
    """Depth [m] across the road that the car needs to stand in the slot whole."""
    open_ended: bool
    """One neighbour will do."""
    stand_out: float = 0.0
    """So far [m] into the road the car may stand out of the slot; at an angle it is more along the slot."""
    at_end: bool = False
    """The search ends here: what is unclear is decided by what there is."""
    street: float = UNHEARD
    """Heading of the road's other side [rad], if it was heard: the row goes along it."""
    tail_in: bool = False
    """A slot at an angle that leads back against the way is wanted, else one that leads on."""


class Gap(NamedTuple):
    """A gap: corners A (passed first) and B of its opening, direction into it, depth heard, all in the world."""

    layout: int = GapLayout.NONE
    a: Pose = Pose()
    b: Pose = Pose()
    into: float = 0.0
    depth: float = DEEP
    width: float = 0.0
    """Across the direction into it [m]."""
    shallow: bool = False
    """There is a gap, but not deep enough."""
    support: float = 0.0
    """So much [m] of the neighbours' sides has been seen along the gap."""
    longest: float = 0.0
    """So far [m] does a neighbour's front go on."""
    front: float = 0.0
    """Where a car begins that stands as its neighbours do, from A's corner along the direction into it [m]."""
    row: float = 0.0
    """Direction of the row [rad], from A on."""
    out: float = 0.0
    """So much nearer [m] to the road than corner A what stands out of the row lies."""
