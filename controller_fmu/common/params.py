"""What can be set of every system that parks: when a car stands or is lost, and how long anything may last."""

from enum import IntEnum
from math import pi
from typing import Annotated, NamedTuple

from modelkit.signal import Signal

HOUSE = "project default; the source states none"


class Longitudinal(IntEnum):
    """Who drives."""

    OWN_SPEED = 0
    """The controller requests speed and brake."""
    DRIVER = 1
    """The driver drives as prompted."""


class ThresholdParams(NamedTuple):
    """When the car stands, the wheel is turned, the target is missed, the car is lost."""

    final_lateral_error: Annotated[
        float, Signal("m", "final error above which the target is missed", 0.0, 10.0, "GB/T 41630")
    ] = 0.15
    final_heading_error: Annotated[
        float, Signal("rad", "final error above which the target is missed", 0.0, 1.5, "GB/T 41630")
    ] = 3.0 * pi / 180.0
    abort_lateral_error: Annotated[float, Signal("m", "error above which the controller aborts", 0.1, 100.0, HOUSE)] = (
        2.0
    )
    steering_angle_reached: Annotated[
        float,
        Signal("rad", "steering-wheel error within which the requested angle counts as reached", 1e-4, 1.0, HOUSE),
    ] = 2.0 * pi / 180.0
    standstill: Annotated[
        float, Signal("m/s", "speed below which the vehicle counts as standing", 1e-6, 0.5, HOUSE)
    ] = 0.005


class LimitParams(NamedTuple):
    """No strategy goes on for ever: each limit ends in Fail with its reason."""

    manoeuvres: Annotated[
        int, Signal("1", "maximum number of manoeuvres; the first reverse motion counts as one", 1, 100, "GB/T 41630")
    ] = 8
    duration: Annotated[
        float, Signal("s", "maximum time to parked; below 0.3 m/s it counts by distance", 1.0, 3600.0, HOUSE)
    ] = 120.0
    driver_response_timeout: Annotated[
        float, Signal("s", "maximum time for the driver to start moving", 0.1, 600.0, HOUSE)
    ] = 15.0
    stopping: Annotated[float, Signal("s", "maximum time for the driver to stop", 0.1, 60.0, HOUSE)] = 2.5
    wrong_direction: Annotated[float, Signal("s", "maximum time of driving against the prompt", 0.1, 60.0, HOUSE)] = 1.5
    pose_frozen: Annotated[float, Signal("s", "maximum time of driving without a change of pose", 0.1, 60.0, HOUSE)] = (
        0.5
    )
    steering_tracking_error: Annotated[
        float, Signal("rad", "steering tracking error above which the fault monitor acts", 0.01, 20.0, HOUSE)
    ] = 0.1
    steering_fault_debounce: Annotated[
        float,
        Signal(
            "s",
            "time without reduction of the tracking error after which a steering fault is set (debounce)",
            0.1,
            60.0,
            HOUSE,
        ),
    ] = 0.28
