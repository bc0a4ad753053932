"""What can be set of driver-adaptive parking: the room, the path, the driver before he is known."""

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

HOUSE = "chosen; this system is the project's own"


class RoomParams(NamedTuple):
    """The room around the target, in the target's frame."""

    slot_front: Annotated[float, Signal("m", "target to the front end of the slot", 0.0, 100.0, HOUSE)] = 6.2
    slot_rear: Annotated[float, Signal("m", "target to the rear end of the slot", 0.0, 100.0, HOUSE)] = 1.1
    line: Annotated[float, Signal("m", "target to the side of the neighbours", 0.0, 10.0, HOUSE)] = 0.825
    depth: Annotated[float, Signal("m", "side of the neighbours to the far side of the slot", 0.0, 100.0, HOUSE)] = 2.0
    road: Annotated[float, Signal("m", "side of the neighbours to the far side of the road", 1.0, 100.0, HOUSE)] = 7.0
    margin: Annotated[float, Signal("m", "safety margin to all of these", 0.0, 1.0, HOUSE)] = 0.1


class PathParams(NamedTuple):
    """How paths are made."""

    radius_reserve: Annotated[
        float, Signal("1", "smallest planned radius over the minimum turning radius", 1.0, 3.0, HOUSE)
    ] = 1.03
    rate_reserve: Annotated[float, Signal("1", "fraction of the steering rate used by a path", 0.1, 1.0, HOUSE)] = 0.88
    rest: Annotated[float, Signal("m", "length of the straight segment before the target", 0.0, 2.0, HOUSE)] = 0.2
    k1: Annotated[float, Signal("1/m2", "tracking, distance gain", 0.0, 100.0, HOUSE)] = 1.0
    k2: Annotated[float, Signal("1/m", "tracking, heading gain", 0.0, 100.0, HOUSE)] = 2.0


class BeliefParams(NamedTuple):
    """What is believed of the driver before he has shown it."""

    reaction: Annotated[float, Signal("s", "driver reaction time", 0.0, 5.0, HOUSE)] = 0.6
    deceleration: Annotated[float, Signal("m/s2", "deceleration of the driver when stopping", 0.1, 10.0, HOUSE)] = 2.7
    gentle: Annotated[float, Signal("m/s2", "deceleration of the advised speed", 0.05, 10.0, HOUSE)] = 0.5
    speed_limit: Annotated[float, Signal("m/s", "default advised speed", 0.1, 10.0, HOUSE)] = 2.5
    creep_speed: Annotated[float, Signal("m/s", "advised speed at the end of a path segment", 0.01, 2.0, HOUSE)] = 0.2


class EndParams(NamedTuple):
    """When the car is off its path, and when it is parked."""

    leave_lateral: Annotated[
        float, Signal("m", "path deviation at which the vehicle stops and replans", 0.0, 10.0, HOUSE)
    ] = 0.12
    leave_heading: Annotated[
        float, Signal("rad", "path deviation at which the vehicle stops and replans", 0.0, 1.5, HOUSE)
    ] = 0.15
    lateral: Annotated[
        float, Signal("m", "error at standstill within which the vehicle is parked", 0.0, 10.0, HOUSE)
    ] = 0.035
    heading: Annotated[
        float, Signal("rad", "error at standstill within which the vehicle is parked", 0.0, 1.5, HOUSE)
    ] = 0.8 * pi / 180.0
    along: Annotated[float, Signal("m", "error at standstill within which the vehicle is parked", 0.0, 10.0, HOUSE)] = (
        0.28
    )


class AdaptiveParams(NamedTuple):
    """Driver-adaptive parking."""

    room: RoomParams = RoomParams()
    path: PathParams = PathParams()
    belief: Annotated[BeliefParams, Role.TUNABLE] = BeliefParams()
    end: Annotated[EndParams, Role.TUNABLE] = EndParams()


class AdaptiveSystem(IntEnum):
    """Its value of ``controller.system``."""

    ADAPTIVE = 6
    """Clothoid paths sized by the driver's speed, predicted stops, planned anew from every standstill."""


class AdaptiveThresholds(Protocol):
    """What it has of the thresholds."""

    steering_angle_reached: float
    standstill: float


class AdaptiveSystemParams(NamedTuple):
    """All that can be set of it."""

    sample_time: SampleTime = 0.01
    car: Annotated[AssumedCar, Subset(OutlinedCar)] = Car()
    target: Target = TARGET
    threshold: Annotated[Thresholds, Subset(AdaptiveThresholds)] = ThresholdParams()
    limit: Limits = LimitParams()
    adaptive: AdaptiveParams = AdaptiveParams()
