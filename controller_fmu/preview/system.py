"""The preview system as one sampled step: see, sequence, steer, drive."""

from typing import NamedTuple

from controller_fmu.preview.control import drive_force, steering_angle
from controller_fmu.preview.params import Camera, Method, PreviewParams
from controller_fmu.preview.preview import PreviewErrors, centre_of_gravity, integrate_sight, look, motion
from controller_fmu.preview.road import curvature_at, project, road_at, road_length
from controller_fmu.preview.sequence import Sequence, advance, straight_distance
from controller_fmu.preview.signals import PreviewSignals
from controller_fmu.preview.stage import PreviewStage
from modelkit.vocabulary import Pose


class PreviewState(NamedTuple):
    """What the preview system remembers between samples."""

    started: bool = False
    centre: Pose = Pose()
    s: float = 0.0
    sight: PreviewErrors = PreviewErrors()
    sequence: Sequence = Sequence()
    last_error: float = 0.0
    signals: PreviewSignals = PreviewSignals()


class PreviewCommand(NamedTuple):
    """What the preview system asks of the car."""

    front_wheel_angle: float
    force: float
    finished: bool


def preview_step(
    state: PreviewState, rear: Pose, speed: float, cg_to_rear: float, params: PreviewParams, dt: float
) -> tuple[PreviewState, PreviewCommand]:
    """Return the next state and the command from the rear-axle pose and the speed [m/s], sampled every ``dt`` [s]."""
    centre = centre_of_gravity(rear, cg_to_rear)
    before = state.centre if state.started else centre
    moved = motion(before, centre)
    s = _arc_length(state, moved.forward, centre, params)
    held = state.sequence
    kappa1 = curvature_at(params.road, s + held.l1)
    kappa2 = curvature_at(params.road, s + held.l2)
    sight = look(s, centre, held.l1, params)
    if state.started and params.camera == Camera.KINEMATICS:
        sight = integrate_sight(state.sight, moved, kappa1, held.l1)
    sequence = _sequence(held, kappa1, kappa2, speed, params, dt)
    error = speed - sequence.set_speed
    rate = (error - state.last_error) / dt if state.started else 0.0
    signals = PreviewSignals(
        s,
        sequence.stage,
        sequence.l1,
        sequence.l2,
        kappa1,
        kappa2,
        sight.y_l,
        sight.eps_l,
        sequence.set_speed,
        road_at(params.road, s + sequence.l1).pose,
        road_at(params.road, s + sequence.l2).pose,
    )
    finished = s + sequence.l1 > road_length(params.road)
    command = PreviewCommand(steering_angle(sight, params), drive_force(error, rate, params), finished)
    return PreviewState(True, centre, s, sight, sequence, error, signals), command


def _arc_length(state: PreviewState, forward: float, centre: Pose, params: PreviewParams) -> float:
    """Return the car's arc length [m]: projected on the road, or driven distance where (2) stands for the camera."""
    if state.started and params.camera == Camera.KINEMATICS:
        return state.s + forward
    return project(params.road, state.s, centre.x, centre.y)


def _sequence(held: Sequence, kappa1: float, kappa2: float, speed: float, params: PreviewParams, dt: float) -> Sequence:
    """Return the distances and set speed for the next sample, by the paper's sequence or the conventional one."""
    if params.method == Method.SINGLE:
        l1 = straight_distance(speed, params)
        return Sequence(PreviewStage.STRAIGHT, l1, l1 + params.near_gap, params.set_speed, 0.0, 0.0)
    return advance(held, kappa1, kappa2, speed, params, dt)
