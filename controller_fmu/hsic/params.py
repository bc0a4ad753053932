"""What can be set in human-simulated intelligent control: slot, thresholds, gains, speeds."""

from enum import IntEnum
from math import pi
from typing import Annotated, NamedTuple, Protocol

from controller_fmu.common.params import LimitParams, ThresholdParams
from controller_fmu.interface import (
    TARGET,
    AssumedCar,
    Limits,
    OutlinedCar,
    SampleTime,
    Target,
    Thresholds,
)
from modelkit.car import Car
from modelkit.signal import Role, Signal, Subset

PAPER = "HSIC paper"
HOUSE = "project default; the source states none"
RAD_PER_DEGREE = pi / 180.0


class HsicSlot(NamedTuple):
    """The slot, and the gaps kept to its ends."""

    slot_length: Annotated[float, Signal("m", "length of the slot", 0.1, 30.0, HOUSE)] = 7.2
    slot_width: Annotated[float, Signal("m", "width of the slot", 0.1, 10.0, HOUSE)] = 2.2
    rear_gap: Annotated[float, Signal("m", "gap to the slot's rear end when parked", 0.0, 10.0, HOUSE)] = 0.6
    ready_gap: Annotated[float, Signal("m", "gap to the neighbour at the ready point", 0.0, 5.0, PAPER)] = 0.5
    end_gap: Annotated[float, Signal("m", "clearance to the slot's ends", 0.0, 5.0, HOUSE)] = 0.2
    radius_reserve: Annotated[float, Signal("1", "planned radius over the smallest", 1.0, 3.0, HOUSE)] = 1.05


class HsicThresholds(NamedTuple):
    """When a state counts as aligned, near, reached, parked."""

    aligned: Annotated[float, Signal("rad", "heading error below which the car is aligned", 1e-3, 1.5, HOUSE)] = (
        5.0 * RAD_PER_DEGREE
    )
    turned: Annotated[float, Signal("rad", "heading error that ends an arc", 1e-4, 1.5, HOUSE)] = 0.4 * RAD_PER_DEGREE
    near: Annotated[float, Signal("m", "distance below which the key point counts as near", 1e-3, 20.0, HOUSE)] = 0.8
    reached: Annotated[float, Signal("m", "distance at which a key point is reached", 1e-4, 1.0, HOUSE)] = 0.01
    ready_heading: Annotated[float, Signal("rad", "heading error accepted at the ready point", 1e-4, 0.5, HOUSE)] = (
        1.0 * RAD_PER_DEGREE
    )
    ready_lateral: Annotated[float, Signal("m", "lateral error accepted at the ready point", 1e-3, 2.0, HOUSE)] = 0.1
    retry_distance: Annotated[float, Signal("m", "distance reversed for another approach", 0.1, 20.0, HOUSE)] = 3.0
    parked_heading: Annotated[float, Signal("rad", "largest heading error of a parked car", 1e-4, 0.5, PAPER)] = (
        5.0 * RAD_PER_DEGREE
    )
    parked_lateral: Annotated[float, Signal("m", "largest lateral error of a parked car", 1e-4, 1.0, PAPER)] = 0.1
    shuffle_share: Annotated[
        float, Signal("1", "fraction of the parked limits at which the in-slot shuffle ends", 0.01, 1.0, HOUSE)
    ] = 0.6
    steering_angle_reached: Annotated[
        float,
        Signal("rad", "steering-wheel error within which the requested angle counts as reached", 1e-4, 1.0, HOUSE),
    ] = 2.0 * RAD_PER_DEGREE


class HsicGains(NamedTuple):
    """Steering and speed of the control modes."""

    lateral: Annotated[float, Signal("1/m2", "proportional, lateral error to curvature", 0.0, 100.0, HOUSE)] = 2.5
    heading: Annotated[
        float, Signal("1/m", "derivative, heading error (the rate of the lateral one) to curvature", 0.0, 100.0, HOUSE)
    ] = 4.0
    integral: Annotated[
        float, Signal("1/m3", "integral over the travelled distance, lateral error to curvature", 0.0, 100.0, HOUSE)
    ] = 0.1
    max_approach_heading: Annotated[
        float, Signal("rad", "maximum heading of the approach to the ready point's line", 0.01, 1.0, HOUSE)
    ] = 4.5 * RAD_PER_DEGREE
    gain_boost: Annotated[float, Signal("1", "factor on both gains while the error grows", 1.0, 10.0, HOUSE)] = 2.0
    max_speed: Annotated[float, Signal("m/s", "speed far from the key point", 0.01, 3.0, HOUSE)] = 0.8
    corrective_speed: Annotated[float, Signal("m/s", "speed while the heading error is large", 0.01, 3.0, HOUSE)] = 0.35
    approach: Annotated[float, Signal("1/s", "speed per distance near the key point", 0.01, 10.0, HOUSE)] = 1.0
    min_speed: Annotated[float, Signal("m/s", "smallest speed", 1e-3, 1.0, HOUSE)] = 0.12


class HsicParams(NamedTuple):
    """Slot, thresholds, gains."""

    slot: HsicSlot = HsicSlot()
    threshold: Annotated[HsicThresholds, Role.TUNABLE] = HsicThresholds()
    gain: Annotated[HsicGains, Role.TUNABLE] = HsicGains()


class HsicSystem(IntEnum):
    """Its value of ``controller.system``."""

    HSIC = 3
    """Human-simulated intelligent control."""


class HsicThresholdsShared(Protocol):
    """Those of the thresholds of every system that it has."""

    abort_lateral_error: float
    standstill: float


class HsicSystemParams(NamedTuple):
    """All that can be set of it."""

    sample_time: SampleTime = 0.01
    car: Annotated[AssumedCar, Subset(OutlinedCar)] = Car()
    target: Target = TARGET
    threshold: Annotated[Thresholds, Subset(HsicThresholdsShared)] = ThresholdParams()
    limit: Limits = LimitParams()
    hsic: HsicParams = HsicParams()
