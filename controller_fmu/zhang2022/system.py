"""The quintic, MPC and PID system at one sample: plan once, steer, drive, brake at the target, straighten."""

import math
from typing import NamedTuple

from controller_fmu.common.monitor import MonitorState, is_usable_input, reason_to_fail, time_counted, watch
from controller_fmu.common.phases import is_over
from controller_fmu.common.slot_clearance import outline_of
from controller_fmu.common.slot_frame import SlotFrame, frame_at, to_slot
from controller_fmu.common.steering_wheel import steering_wheel_angle
from controller_fmu.interface import ParkingInput, Reason
from controller_fmu.zhang2022.mpc import FrontAxle, FrontWheels, steer, turn_wheels
from controller_fmu.zhang2022.params import ZhangSystemParams
from controller_fmu.zhang2022.path import PathStatus, QuinticPath, Reference, nearest
from controller_fmu.zhang2022.phases import ZhangPhase, expectation_of
from controller_fmu.zhang2022.pid import PidState, pid
from controller_fmu.zhang2022.planner import plan_in_slot
from controller_fmu.zhang2022.refinement import PathLimits
from controller_fmu.zhang2022.slot import slot_bounds
from controller_fmu.zhang2022.steering_rate import PlannedMotion, speed_before_target
from modelkit.maths import move_towards
from modelkit.vocabulary import Pose


class ZhangState(NamedTuple):
    """Everything the system remembers."""

    phase: int = ZhangPhase.STANDBY
    reason: int = Reason.NONE
    running_ns: int = 0
    solved_ns: int = 0
    """Time since the MPC was solved last."""
    frame: SlotFrame = SlotFrame()
    path: QuinticPath = QuinticPath()
    reference: Reference = Reference()
    steering: FrontWheels = FrontWheels()
    set_speed: float = 0.0
    pid: PidState = PidState()
    monitor: MonitorState = MonitorState()


def zhang_start(params: ZhangSystemParams) -> ZhangState:
    """Return the system in standby."""
    return ZhangState()


def zhang_sample(state: ZhangState, inputs: ParkingInput, params: ZhangSystemParams, dt_ns: int) -> ZhangState:
    """Return the system one sample of ``dt_ns`` later."""
    if is_over(state.phase):
        return state
    if not is_usable_input(inputs):
        return _end(state, ZhangPhase.FAILED, Reason.BAD_INPUT)
    if inputs.driver_takeover:
        return _end(state, ZhangPhase.TAKEOVER, Reason.NONE)
    if state.phase == ZhangPhase.STANDBY:
        return _plan(inputs, params)
    pose = to_slot(inputs.odometry, state.frame)
    reference = nearest(state.path, pose)
    wheel = steering_wheel_angle(state.steering.angle, state.frame.mirror, params)
    expected = expectation_of(state.phase)
    monitor = watch(state.monitor, inputs, expected, wheel, dt_ns, params)
    reason = reason_to_fail(monitor, inputs, expected, state.running_ns, 1, params)
    if reason == Reason.NONE and abs(reference.lateral_error) > params.threshold.abort_lateral_error:
        reason = Reason.LEFT_PATH
    if reason != Reason.NONE:
        return _end(state, ZhangPhase.FAILED, reason)
    state = state._replace(
        running_ns=state.running_ns + time_counted(dt_ns, inputs.measured_speed, params.threshold.standstill),
        reference=reference,
        monitor=monitor,
    )
    if state.phase == ZhangPhase.STRAIGHTEN:
        return _straighten(state, inputs, pose, params)
    return _drive(state, inputs, pose, params, dt_ns)


def front_axle_of(params: ZhangSystemParams) -> FrontAxle:
    """Return wheelbase [m] and the limits of the front-wheel angle [rad, rad/s]."""
    ratio = params.car.steering.ratio
    return FrontAxle(
        params.car.wheelbase, params.car.steering.angle_limit / ratio, params.car.steering.rate_limit / ratio
    )


def _plan(inputs: ParkingInput, params: ZhangSystemParams) -> ZhangState:
    """Return the system on its path, or failed for want of one."""
    car = front_axle_of(params)
    frame = frame_at(params.target, inputs.odometry)
    start = to_slot(inputs.odometry, frame)
    quintic = params.zhang2022.quintic
    limit = quintic.curvature_share * math.tan(car.angle_limit) / car.wheelbase
    zhang = params.zhang2022
    motion = PlannedMotion(car.wheelbase, zhang.speed, zhang.ramp, quintic.curvature_share * car.rate_limit)
    limits = PathLimits(limit, motion, outline_of(params.car), slot_bounds(zhang.slot, params.car))
    path = plan_in_slot(start, quintic.radius, limits)
    angle = frame.mirror * inputs.steering_wheel_angle / params.car.steering.ratio
    found = path.status == PathStatus.FOUND
    return ZhangState(
        phase=ZhangPhase.PATH_TRACKING if found else ZhangPhase.FAILED,
        reason=Reason.NONE if found else Reason.NO_PATH,
        solved_ns=math.floor(params.zhang2022.mpc.period * 1e9),
        frame=frame,
        path=path,
        reference=nearest(path, start) if found else Reference(),
        steering=FrontWheels(angle),
    )


def _drive(state: ZhangState, inputs: ParkingInput, pose: Pose, params: ZhangSystemParams, dt_ns: int) -> ZhangState:
    """Return the system with its steering and speed for the next sample; at the target it brakes."""
    zhang = params.zhang2022
    dt = dt_ns * 1e-9
    car = front_axle_of(params)
    steering = state.steering
    solved_ns = state.solved_ns + dt_ns
    if solved_ns * 1e-9 > zhang.mpc.period - 0.5 * dt:
        steering = steer(steering, state.path, state.reference, inputs.measured_speed, car, zhang.mpc)
        solved_ns = 0
    arrived = pose.x <= zhang.stop_distance
    wanted = -speed_before_target(pose.x, zhang.speed, zhang.ramp)
    set_speed = move_towards(state.set_speed, wanted, zhang.ramp * dt)
    speed = pid(state.pid, set_speed - inputs.measured_speed, zhang.pid, dt)
    return state._replace(
        phase=ZhangPhase.STRAIGHTEN if arrived else ZhangPhase.PATH_TRACKING,
        reason=Reason.NONE,
        solved_ns=solved_ns,
        steering=turn_wheels(steering, car, dt),
        set_speed=0.0 if arrived else set_speed,
        pid=speed,
    )


def _straighten(state: ZhangState, inputs: ParkingInput, pose: Pose, params: ZhangSystemParams) -> ZhangState:
    """Return the system at the target: wheel to the middle, then parked or missed."""
    limit = params.threshold
    phase = ZhangPhase.STRAIGHTEN
    reason = Reason.NONE
    still = abs(inputs.measured_speed) <= limit.standstill
    if still and abs(inputs.steering_wheel_angle) <= limit.steering_angle_reached:
        near = abs(pose.y) <= limit.final_lateral_error and abs(pose.heading) <= limit.final_heading_error
        phase = ZhangPhase.PARKED if near else ZhangPhase.FAILED
        reason = Reason.NONE if near else Reason.MISSED_TARGET
    return state._replace(
        phase=phase,
        reason=reason,
        solved_ns=0,
        steering=state.steering._replace(angle=0.0, rate=0.0),
        set_speed=0.0,
    )


def _end(state: ZhangState, phase: int, reason: int) -> ZhangState:
    return state._replace(phase=phase, reason=reason, set_speed=0.0)
