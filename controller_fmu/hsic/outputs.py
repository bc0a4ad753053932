"""Outputs of human-simulated intelligent control."""

from controller_fmu.common.slot_frame import SlotFrame, to_world
from controller_fmu.common.steering_wheel import steering_wheel_angle
from controller_fmu.hsic.characteristic_states import errors
from controller_fmu.hsic.key_points import KeyPoints
from controller_fmu.hsic.params import HsicSystemParams
from controller_fmu.hsic.phases import HsicPhase
from controller_fmu.hsic.rules import RULES
from controller_fmu.hsic.signals import HsicOutput, HsicSignals
from controller_fmu.hsic.system import HsicState
from controller_fmu.interface import Path, Segment
from modelkit.vocabulary import Pose


def tangent_error(points: KeyPoints, pose: Pose) -> float:
    """Return how far ``pose`` lies left of the common tangent of the two arcs [m]."""
    return errors(pose, points.p3, 0.0, 1).lateral


def path_of_plan(points: KeyPoints, frame: SlotFrame) -> Path:
    """Return arc, common tangent, arc; empty without key points."""
    if not points.found:
        return Path()
    k = frame.mirror / points.radius
    arc = points.radius * points.p3.heading
    line = errors(points.p2, points.p3, 0.0, 1).ahead
    return Path(to_world(points.p1, frame), (Segment(arc, -k), Segment(line, 0.0), Segment(arc, k)))


def hsic_outputs(state: HsicState, params: HsicSystemParams) -> HsicOutput:
    """Return the outputs that hold until the next sample."""
    active = state.phase in (HsicPhase.PRE_STEER, HsicPhase.PATH_TRACKING, HsicPhase.STRAIGHTEN)
    modes = RULES[state.characteristic]
    points = state.course.points
    known = points.found
    signals = HsicSignals(
        characteristic=state.characteristic,
        stage=state.course.stage,
        speed_mode=modes[0],
        steer_mode=modes[1],
        distance=state.found.distance,
        tangent_error=tangent_error(state.course.points, state.pose),
        p1=to_world(points.p1, state.frame) if known else Pose(),
        p2=to_world(points.p2, state.frame) if known else Pose(),
        p3=to_world(points.p3, state.frame) if known else Pose(),
        p4=state.frame.target if known else Pose(),
    )
    brake = state.phase != HsicPhase.PATH_TRACKING and state.phase != HsicPhase.TAKEOVER
    return HsicOutput(
        steering_wheel_request=steering_wheel_angle(state.angle, state.frame.mirror, params) if active else 0.0,
        steering_active=active,
        speed_control_active=active,
        speed_request=state.set_speed,
        brake_request=brake,
        phase=state.phase,
        reason=state.reason,
        manoeuvres=state.manoeuvres,
        reference=to_world(state.course.goal, state.frame),
        lateral_error=state.found.lateral,
        heading_error=state.found.heading,
        path=path_of_plan(state.course.points, state.frame),
        hsic=signals,
    )
