"""The body chosen by ``params.body``, behind one pair of functions."""

from typing import NamedTuple

from modelkit.vocabulary import Pose
from vehicle_fmu.bodies.chassis import Build, Motion, Stance
from vehicle_fmu.bodies.double_track import DoubleTrackState, resting, step_double_track
from vehicle_fmu.bodies.single_track import SingleTrackState, step_single_track
from vehicle_fmu.effort import Effort
from vehicle_fmu.interface import Body, VehicleParams

SHOWN_STANDSTILL_SPEED = 1e-3
"""Speed [m/s] below which a car that rocks on its tyres counts as standing."""


class BodyState(NamedTuple):
    """State of the bodies with mass; the one not chosen stays at rest."""

    single: SingleTrackState = SingleTrackState()
    double: DoubleTrackState = DoubleTrackState()


def place(start: Pose, body: int, params: VehicleParams) -> BodyState:
    """Return ``body`` at rest at ``start``, wheel straight."""
    at_rest = Motion(start)
    double = DoubleTrackState(at_rest)
    if body == Body.DOUBLE_TRACK:
        double = resting(start, 0.0, _build(params), params.double_track)
    return BodyState(SingleTrackState(at_rest), double)


def push_body(state: BodyState, angle: float, effort: Effort, params: VehicleParams, h: float) -> BodyState:
    """Return the chosen body ``h`` [s] later at front-wheel ``angle`` [rad] under ``effort``."""
    if params.body == Body.SINGLE_TRACK:
        single = step_single_track(state.single, angle, effort, _build(params), params.single_track, h)
        return state._replace(single=single)
    return state._replace(double=step_double_track(state.double, angle, effort, _build(params), params.double_track, h))


def _build(params: VehicleParams) -> Build:
    return Build(Stance(params.car.wheelbase, params.car.cg_to_rear), params.chassis, params.road)


def motion_of(state: BodyState, body: int) -> Motion:
    """Return the motion of the body chosen."""
    if body == Body.SINGLE_TRACK:
        return state.single.motion
    return state.double.motion


def wheel_speed(state: BodyState, body: int, radius: float) -> float:
    """Return the speed [m/s] of the rear wheels' rims, which the wheel sensors count."""
    if body == Body.SINGLE_TRACK:
        return state.single.motion.speed_x
    wheels = state.double.wheels
    return 0.5 * radius * (wheels[2].spin + wheels[3].spin)


def speed_for_display(speed: float) -> float:
    """Return ``speed`` [m/s], zero while the car only rocks on its tyres."""
    return 0.0 if abs(speed) < SHOWN_STANDSTILL_SPEED else speed
