"""The pose a car believes in: dead reckoning from wheel speed and steering angle, with their errors.

    d = (1 + e) * distance rolled, counted in ticks    phi = steering angle + offset, rounded
    heading += d tan(phi) / L    position += d along the arc's chord

Errors grow as: straight on, e * distance along; with a steering offset o the believed path is a
circle of radius L / tan(o) instead of a straight line.
"""

import math
from typing import Annotated, NamedTuple

from modelkit.signal import Role, Signal
from modelkit.vocabulary import Pose

HOUSE = "project default; the source states none"


class OdometryParams(NamedTuple):
    """Errors of wheel-speed and steering sensors; perfect by default."""

    ideal: Annotated[bool, Signal("1", "ideal odometry: the controller receives the true pose and speed")] = True
    radius_error: Annotated[
        float, Signal("1", "relative error of the wheel radius", -0.5, 0.5, HOUSE), Role.TUNABLE
    ] = 0.0
    steering_offset: Annotated[
        float, Signal("rad", "error of the measured front-wheel angle", -0.5, 0.5, HOUSE), Role.TUNABLE
    ] = 0.0
    tick: Annotated[float, Signal("m", "distance per wheel-speed pulse; 0: continuous", 0.0, 1.0, HOUSE)] = 0.0
    steering_resolution: Annotated[
        float, Signal("rad", "quantisation of the measured front-wheel angle; 0: none", 0.0, 0.5, HOUSE)
    ] = 0.0


class OdometryState(NamedTuple):
    """Believed pose and the way not yet counted."""

    pose: Pose = Pose()
    rest: float = 0.0
    """Way rolled since the last whole tick [m]."""


def reckon(
    state: OdometryState, rolled: float, front_wheel_angle: float, wheelbase: float, params: OdometryParams
) -> OdometryState:
    """Return the believed pose after the wheels ``rolled`` [m] (reverse negative) at this front-wheel angle [rad]."""
    way = state.rest + (1.0 + params.radius_error) * rolled
    counted = way
    if params.tick > 0.0:
        counted = params.tick * math.floor(way / params.tick + 0.5)
    angle = front_wheel_angle + params.steering_offset
    if params.steering_resolution > 0.0:
        angle = params.steering_resolution * math.floor(angle / params.steering_resolution + 0.5)
    turn = counted * math.tan(angle) / wheelbase
    half = 0.5 * turn
    chord = counted * math.sin(half) / half if abs(half) > 1e-9 else counted
    pose = state.pose
    middle = pose.heading + half
    return OdometryState(
        Pose(pose.x + chord * math.cos(middle), pose.y + chord * math.sin(middle), pose.heading + turn), way - counted
    )


def wheel_speed_reading(speed: float, params: OdometryParams) -> float:
    """Return the speed [m/s] the wheel sensors tell."""
    return speed if params.ideal else (1.0 + params.radius_error) * speed
