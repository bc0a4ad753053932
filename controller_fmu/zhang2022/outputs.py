"""Outputs of the quintic, MPC and PID system."""

import math

from controller_fmu.common.slot_frame import to_world
from controller_fmu.common.steering_wheel import steering_wheel_angle
from controller_fmu.interface import Path, Segment
from controller_fmu.zhang2022.params import ZhangSystemParams
from controller_fmu.zhang2022.path import PathStatus, final_time
from controller_fmu.zhang2022.phases import ZhangPhase
from controller_fmu.zhang2022.signals import QuinticPlan, ZhangOutput, ZhangSignals
from controller_fmu.zhang2022.steering_rate import STOPPING_SHARE
from controller_fmu.zhang2022.system import ZhangState


def zhang_signals(state: ZhangState, params: ZhangSystemParams) -> ZhangSignals:
    """Return the system's own outputs."""
    return ZhangSignals(
        path_status=state.path.status,
        largest_curvature=state.path.largest_curvature,
        solver_status=state.steering.status,
        iterations=state.steering.iterations,
        reference_angle=state.frame.mirror * math.atan(params.car.wheelbase * state.reference.curvature),
        set_speed=state.set_speed,
        plan=quintic_plan(state, params),
    )


def quintic_plan(state: ZhangState, params: ZhangSystemParams) -> QuinticPlan:
    """Return the planned path as its quintics; without a path, all zero."""
    path = state.path
    if path.status != PathStatus.FOUND:
        return QuinticPlan()
    zhang = params.zhang2022
    return QuinticPlan(
        side=1 if state.frame.mirror > 0.0 else -1,
        origin=state.frame.target,
        quintics=(path.first, path.line, path.last),
        length=path.length,
        final_time=final_time(path.length, zhang.speed, zhang.ramp, STOPPING_SHARE * zhang.ramp),
    )


def path_plan(state: ZhangState) -> Path:
    """Return the arc path whose key points the quintics go through; empty without a path."""
    if state.path.status == PathStatus.NONE:
        return Path()
    arcs = state.path.arcs
    k = state.frame.mirror / arcs.radius
    arc = arcs.radius * arcs.angle
    pieces = (Segment(arc, -k), Segment(arcs.line, 0.0), Segment(arc, k))
    return Path(to_world(state.path.start, state.frame), pieces)


def zhang_outputs(state: ZhangState, params: ZhangSystemParams) -> ZhangOutput:
    """Return the outputs that hold until the next sample."""
    active = state.phase in (ZhangPhase.PATH_TRACKING, ZhangPhase.STRAIGHTEN)
    driving = state.phase == ZhangPhase.PATH_TRACKING
    wheel = steering_wheel_angle(state.steering.angle, state.frame.mirror, params)
    force = state.pid.force if driving else 0.0
    speed = state.set_speed if driving else 0.0
    brake = not driving and state.phase != ZhangPhase.TAKEOVER
    manoeuvres = 0 if state.phase == ZhangPhase.STANDBY else 1
    return ZhangOutput(
        steering_wheel_request=wheel if active else 0.0,
        steering_active=active,
        speed_control_active=active,
        speed_request=speed,
        force_control_active=driving,
        force_request=force,
        brake_request=brake,
        phase=state.phase,
        reason=state.reason,
        manoeuvres=manoeuvres,
        reference=to_world(state.reference.pose, state.frame),
        lateral_error=state.reference.lateral_error,
        heading_error=state.reference.heading_error,
        path=path_plan(state),
        zhang2022=zhang_signals(state, params),
    )
