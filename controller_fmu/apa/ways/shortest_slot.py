"""The shortest slot that a standard asks a car to be parked in.

Its numbers stand in ``orchestrator/library/requirements/slots``; a test holds those here equal to them.
"""

from typing import NamedTuple

from controller_fmu.apa.slot import Kind
from modelkit.car import Car, car_length


class SlotSizes(NamedTuple):
    """By how much a slot is larger than the car."""

    short: float
    """A car shorter than this [m]"""
    short_room: float
    """has so much more [m] along the road,"""
    share: float
    """a longer one this many times its length,"""
    long: float
    """one longer than this [m]"""
    long_room: float
    """so much more [m] again."""
    across_room: float
    """A perpendicular slot is so much [m] wider than the car,"""
    deeper: float
    """a parallel one so much [m] deeper than the car is wide."""


ISO_16787 = SlotSizes(4.0, 1.0, 1.25, 6.0, 1.5, 1.2, 0.2)


def shortest_slot(kind: int, car: Car, sizes: SlotSizes) -> float:
    """Return the length (width) [m] of the shortest slot for this car."""
    if kind != Kind.PARALLEL:
        return car.width + sizes.across_room
    length = car_length(car)
    if length < sizes.short:
        return length + sizes.short_room
    return sizes.share * length if length <= sizes.long else length + sizes.long_room
