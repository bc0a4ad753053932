"""The body chosen by ``params.body``, behind one pair of functions."""

from typing import NamedTuple

from modelkit.vocabulary import Pose
from vehicle_fmu.chassis import ChassisParams, Motion, RoadParams
from vehicle_fmu.double_track import DoubleTrackParams, DoubleTrackState, resting, step_double_track
from vehicle_fmu.effort import Effort
from vehicle_fmu.interface import Body
from vehicle_fmu.loads import Felt
from vehicle_fmu.single_track import AxleForces, SingleTrackParams, SingleTrackState, step_single_track
from vehicle_fmu.tires import Force
from vehicle_fmu.wheels import Wheel

KINEMATIC = int(Body.KINEMATIC)
SINGLE_TRACK = int(Body.SINGLE_TRACK)
DOUBLE_TRACK = int(Body.DOUBLE_TRACK)
STILL = 1e-3
"""Speed [m/s] below which a car that rocks on its tyres is told to stand."""


class BodyState(NamedTuple):
    """State of the bodies with mass; the one not chosen stays at rest."""

    single: SingleTrackState = SingleTrackState()
    double: DoubleTrackState = DoubleTrackState()


def place(
    start: Pose, body: int, wheelbase: float, chassis: ChassisParams, double_track: DoubleTrackParams, road: RoadParams
) -> BodyState:
    """Return the body at rest at ``start``, wheel straight."""
    double = lifted(start)
    if body == DOUBLE_TRACK:
        double = resting(start, 0.0, wheelbase, chassis, double_track, road)
    single = SingleTrackState(Motion(start, 0.0, 0.0, 0.0), 0.0, 0.0, 0.0, AxleForces(0.0, 0.0, 0.0))
    return BodyState(single, double)


def lifted(start: Pose) -> DoubleTrackState:
    """Return a four-wheel body at ``start`` with no force on any tyre."""
    wheel = Wheel(0.0, 0.0, 0.0, Force(0.0, 0.0))
    return DoubleTrackState(Motion(start, 0.0, 0.0, 0.0), (wheel, wheel, wheel, wheel), Felt(0.0, 0.0))


def push_body(
    state: BodyState,
    angle: float,
    effort: Effort,
    body: int,
    wheelbase: float,
    chassis: ChassisParams,
    single_track: SingleTrackParams,
    double_track: DoubleTrackParams,
    road: RoadParams,
    h: float,
) -> BodyState:
    """Return the chosen body ``h`` [s] later at front-wheel ``angle`` [rad] under ``effort``."""
    if body == SINGLE_TRACK:
        single = step_single_track(state.single, angle, effort, wheelbase, chassis, single_track, road, h)
        return BodyState(single, state.double)
    double = step_double_track(state.double, angle, effort, wheelbase, chassis, double_track, road, h)
    return BodyState(state.single, double)


def motion_of(state: BodyState, body: int) -> Motion:
    """Return the motion of the body chosen."""
    if body == SINGLE_TRACK:
        return state.single.motion
    return state.double.motion


def wheel_speed(state: BodyState, body: int, radius: float) -> float:
    """Return the speed [m/s] of the rear wheels' rims, which the wheel sensors count."""
    if body == SINGLE_TRACK:
        return state.single.motion.speed_x
    wheels = state.double.wheels
    return 0.5 * radius * (wheels[2].spin + wheels[3].spin)


def told(speed: float) -> float:
    """Return ``speed`` [m/s], zero while the car only rocks on its tyres."""
    return 0.0 if abs(speed) < STILL else speed
