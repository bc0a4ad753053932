"""What the driver chooses on the display: to park or to pull out, which side, which of the slots offered."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from modelkit.signal import Signal

MAX_OFFERS = 3
"""Slots that are remembered, and offered."""


class ChosenTask(IntEnum):
    """What the assist is wanted for."""

    PARK = 0
    PULL_OUT = 1
    """Out of a parallel slot, until the front is clear."""


class ChosenSide(IntEnum):
    """Where to park; pulling out, where to: any is left, as the traffic keeps to the right."""

    ANY = 0
    RIGHT = 1
    LEFT = 2


class DriverSelection(NamedTuple):
    """The driver's choice, which may change at any time before it is confirmed."""

    task: Annotated[int, Signal("1", "to park, or to pull out", states=ChosenTask)] = ChosenTask.PARK
    side: Annotated[int, Signal("1", "side of the road", states=ChosenSide)] = ChosenSide.ANY
    slot: Annotated[
        int, Signal("1", "number of the slot among those offered, from 1; 0: the newest", 0, MAX_OFFERS)
    ] = 0
