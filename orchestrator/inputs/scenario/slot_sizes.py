"""The shortest slots that standards require a system to use, as data: ``orchestrator/library/requirements/slots``."""

from enum import IntEnum
from typing import NamedTuple

from modelkit.car import Car, car_length
from orchestrator.inputs.scenario.requirements import REQUIREMENT_SETS
from orchestrator.inputs.text.quantities import parse_quantity
from orchestrator.inputs.text.yaml_file import read_mapping


class ParkingType(IntEnum):
    """How a car stands in a slot, as ISO 16787 and GB/T 41630 distinguish."""

    NONE = 0
    PARALLEL = 1
    PERPENDICULAR = 2


class StandardSlot(NamedTuple):
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


def library_slot_sizes(standard: str) -> StandardSlot:
    """Return the numbers of a standard in SI. Raises ``BadInput`` if its file does not say them all."""
    file = REQUIREMENT_SETS / "slots" / f"{standard}.yaml"
    return StandardSlot(
        **{name: parse_quantity(value, file=file, key=name)[0] for name, value in read_mapping(file).items()}
    )


def shortest_slot(kind: int, car: Car, sizes: StandardSlot) -> float:
    """Return the length (width) [m] of the shortest slot for this car."""
    if kind != ParkingType.PARALLEL:
        return car.width + sizes.across_room
    length = car_length(car)
    if length < sizes.short:
        return length + sizes.short_room
    return sizes.share * length if length <= sizes.long else length + sizes.long_room
