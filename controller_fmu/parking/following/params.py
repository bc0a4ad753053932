"""Parameters of path following."""

from typing import Annotated, NamedTuple

from controller_fmu.common.params import HOUSE, Longitudinal
from modelkit.car import Car
from modelkit.signal import Role, Signal

RATE_FRACTION = 0.9
"""Of the steering wheel's rate that a transition asks for; the rest is for tracking."""
START_ACCELERATION = 1.0
"""Acceleration [m/s2] with which a vehicle sets out, the lag of its drive counted."""


class FollowingParams(NamedTuple):
    """How the path is driven and tracked."""

    longitudinal: Annotated[int, Signal("1", "who controls the speed", states=Longitudinal), Role.FIXED] = (
        Longitudinal.OWN_SPEED
    )
    k1: Annotated[float, Signal("1/m2", "tracking gain of the lateral error", 0.0, 100.0, HOUSE)] = 2.0
    k2: Annotated[float, Signal("1/m", "tracking gain of the heading error", 0.0, 100.0, HOUSE)] = 2.4
    speed: Annotated[float, Signal("m/s", "largest speed on a path", 0.1, 3.0, HOUSE)] = 0.8
    creep_speed: Annotated[float, Signal("m/s", "speed at the end of a segment", 0.01, 0.5, HOUSE)] = 0.08
    deceleration: Annotated[float, Signal("m/s2", "planned deceleration towards a stop", 0.1, 5.0, HOUSE)] = 0.5
    brake_deceleration: Annotated[float, Signal("m/s2", "deceleration at the end of a segment", 0.1, 10.0, HOUSE)] = 1.0
    brake_delay: Annotated[float, Signal("s", "least delay from a speed request to its effect", 0.0, 2.0, HOUSE)] = 0.03
    driver_reaction: Annotated[float, Signal("s", "delay from a prompt to the driver's brake", 0.0, 5.0, HOUSE)] = 0.3
    rolling_offset: Annotated[
        float, Signal("m", "lateral offset for steering while rolling; 0: it steers at standstill", 0.0, 0.2, HOUSE)
    ] = 0.02
    steering_delay: Annotated[float, Signal("s", "delay from steering request to effect", 0.0, 1.0, HOUSE)] = 0.06


class FollowingContext(NamedTuple):
    """The vehicle and the parameters that following needs."""

    car: Car
    drive: FollowingParams
