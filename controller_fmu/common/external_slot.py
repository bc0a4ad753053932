"""A slot from outside at run time: corners, kind and direction, as a camera, a map or a test bench tells them."""

import math
from enum import IntEnum
from typing import Annotated, NamedTuple

from modelkit.maths import is_finite
from modelkit.signal import Signal

MIN_SLOT_DEPTH = 0.1
"""Corners C and D tell a depth if they lie so far [m] behind A and B."""
UNKNOWN_DEPTH = 50.0
"""Depth [m] of a slot of which none is given."""
WELL_IN = 0.25
"""An echo so far [m] inside a slot contradicts it."""
AT_THE_ROAD = 0.15
"""Slots begin so far [m] before their corners A and B."""


class SlotKind(IntEnum):
    """How to stand in a slot that is given by its corners."""

    NONE = 0
    """No slot is given: the goal is the target."""
    PARALLEL = 1
    """Along the side from A to B, turned as the car is now."""
    TAIL_IN = 2
    """Rear end first, as deep as the slot's middle."""
    NOSE_IN = 3
    """Front end first."""


class ExternalSlot(NamedTuple):
    """A slot as an external source reports it: A and B where it opens to the road, C behind B, D behind A."""

    kind: Annotated[int, Signal("1", "slot type; none: no external slot", states=SlotKind)] = SlotKind.NONE
    ax: Annotated[float, Signal("m", "x of corner A, at the road")] = 0.0
    ay: Annotated[float, Signal("m", "y of corner A")] = 0.0
    bx: Annotated[float, Signal("m", "x of corner B, at the road")] = 0.0
    by: Annotated[float, Signal("m", "y of corner B")] = 0.0
    cx: Annotated[float, Signal("m", "x of corner C, behind B; C = A and D = B: depth unknown")] = 0.0
    cy: Annotated[float, Signal("m", "y of corner C")] = 0.0
    dx: Annotated[float, Signal("m", "x of corner D, behind A")] = 0.0
    dy: Annotated[float, Signal("m", "y of corner D")] = 0.0
    heading: Annotated[float, Signal("rad", "direction from the road into the slot")] = 0.0


def depth_of(reported: ExternalSlot) -> float:
    """Return how deep [m] a slot is, ``UNKNOWN_DEPTH`` if that is not given."""
    c = math.cos(reported.heading)
    s = math.sin(reported.heading)
    depth = 0.5 * (
        (reported.dx - reported.ax + reported.cx - reported.bx) * c
        + (reported.dy - reported.ay + reported.cy - reported.by) * s
    )
    return depth if depth > MIN_SLOT_DEPTH else UNKNOWN_DEPTH


def is_usable_slot(reported: ExternalSlot) -> bool:
    """Return whether no slot is given, or one whose numbers are finite."""
    corners = (
        reported.ax + reported.ay + reported.bx + reported.by + reported.cx + reported.cy + reported.dx + reported.dy
    )
    return reported.kind == SlotKind.NONE or is_finite(corners + reported.heading)
