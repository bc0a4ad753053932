"""What can be set of every system that parks: when a car stands or is lost, and how long anything may last."""

from math import pi
from typing import Annotated, NamedTuple

from modelkit.signal import Signal

HOUSE = "chosen; the source states none"


class ThresholdParams(NamedTuple):
    """When the car stands, the wheel is turned, the target is missed, the car is lost."""

    miss_lateral: Annotated[float, Signal("m", "at the end: target missed", 0.0, 10.0, "GB/T 41630")] = 0.15
    miss_heading: Annotated[float, Signal("rad", "at the end: target missed", 0.0, 1.5, "GB/T 41630")] = (
        3.0 * pi / 180.0
    )
    lost_lateral: Annotated[float, Signal("m", "so far off that the controller fails", 0.1, 100.0, HOUSE)] = 2.0
    wheel: Annotated[float, Signal("rad", "steering wheel counts as turned", 1e-4, 1.0, HOUSE)] = 2.0 * pi / 180.0
    standstill: Annotated[float, Signal("m/s", "car counts as standing", 1e-6, 0.5, HOUSE)] = 0.005


class LimitParams(NamedTuple):
    """No strategy goes on for ever: each limit ends in Fail with its reason."""

    shifts: Annotated[int, Signal("1", "most manoeuvres, the first reverse counts one", 1, 100, "GB/T 41630")] = 8
    duration: Annotated[float, Signal("s", "longest time from start to parked", 1.0, 3600.0, HOUSE)] = 120.0
    patience: Annotated[float, Signal("s", "longest wait for the driver to move", 0.1, 600.0, HOUSE)] = 15.0
    stopping: Annotated[float, Signal("s", "longest wait for the driver to stop", 0.1, 60.0, HOUSE)] = 2.5
    wrong_direction: Annotated[float, Signal("s", "longest drive against the prompt", 0.1, 60.0, HOUSE)] = 1.5
    pose_frozen: Annotated[float, Signal("s", "longest drive without a change of pose", 0.1, 60.0, HOUSE)] = 0.5
    wheel_off: Annotated[
        float, Signal("rad", "steering wheel off its request: it must come nearer", 0.01, 20.0, HOUSE)
    ] = 0.1
    wheel_fault: Annotated[
        float, Signal("s", "longest time off its request without coming nearer", 0.1, 60.0, HOUSE)
    ] = 0.28
