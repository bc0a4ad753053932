"""Human-simulated intelligent control at one sample: recognise, look up the rule, steer and drive."""

import math
from typing import NamedTuple

from controller_fmu.common.monitor import MonitorState, is_usable_input, reason_to_fail, time_counted, watch
from controller_fmu.common.phases import is_over
from controller_fmu.common.slot_clearance import is_pose_clear, outline_of
from controller_fmu.common.slot_frame import SlotFrame, frame_at, to_slot
from controller_fmu.common.steering_wheel import steering_wheel_angle
from controller_fmu.hsic.characteristic_states import Errors, HsicStage, errors, recognise
from controller_fmu.hsic.control import Situation, curvature, speed
from controller_fmu.hsic.key_points import key_points, ready_point, slot_bounds
from controller_fmu.hsic.params import HsicSystemParams
from controller_fmu.hsic.phases import HsicPhase, motion_expectation
from controller_fmu.hsic.rules import RULES, SpeedMode
from controller_fmu.hsic.stages import Course, advance, is_parked, way_to
from controller_fmu.interface import ParkingInput, Reason
from modelkit.car import largest_curvature
from modelkit.maths import clamp
from modelkit.vocabulary import Pose

ABORT_ERROR_FACTOR = 3.0
"""A key point's axis may be this many times farther off than a path before the car counts as lost."""


class HsicState(NamedTuple):
    """Everything the system remembers."""

    phase: int = HsicPhase.STANDBY
    reason: int = Reason.NONE
    running_ns: int = 0
    frame: SlotFrame = SlotFrame()
    course: Course = Course()
    direction: int = 1
    """Direction last driven, +1 forward."""
    manoeuvres: int = 0
    counted: int = 0
    """Direction of the manoeuvre counted last; 0: none yet."""
    characteristic: int = 0
    integral: float = 0.0
    """Lateral error over the way to the goal [m^2]."""
    angle: float = 0.0
    """Front-wheel angle asked for, in the slot's frame [rad]."""
    set_speed: float = 0.0
    found: Errors = Errors(0.0, 0.0, 0.0, 0.0, 0.0)
    pose: Pose = Pose()
    """The car's, in the slot's frame."""
    monitor: MonitorState = MonitorState()


def hsic_start(params: HsicSystemParams) -> HsicState:
    """Return the system in standby."""
    return HsicState()


def hsic_sample(state: HsicState, inputs: ParkingInput, params: HsicSystemParams, dt_ns: int) -> HsicState:
    """Return the system one sample of ``dt_ns`` later."""
    if is_over(state.phase):
        return state
    if not is_usable_input(inputs):
        return _terminate(state, HsicPhase.FAILED, Reason.BAD_INPUT)
    if inputs.driver_takeover:
        return _terminate(state, HsicPhase.TAKEOVER, Reason.NONE)
    if state.phase == HsicPhase.STANDBY:
        return _plan(inputs, params)
    pose = to_slot(inputs.odometry, state.frame)
    expected = motion_expectation(state.phase, state.direction)
    wheel = steering_wheel_angle(state.angle, state.frame.mirror, params)
    monitor = watch(state.monitor, inputs, expected, wheel, dt_ns, params)
    reason = reason_to_fail(monitor, inputs, expected, state.running_ns, state.manoeuvres, params)
    lost = abs(state.found.lateral) > ABORT_ERROR_FACTOR * params.threshold.abort_lateral_error
    if reason == Reason.NONE and state.course.stage != HsicStage.READY and lost:
        reason = Reason.LEFT_PATH
    if reason != Reason.NONE:
        return _terminate(state, HsicPhase.FAILED, reason)
    state = state._replace(
        running_ns=state.running_ns + time_counted(dt_ns, inputs.measured_speed, params.threshold.standstill),
        pose=pose,
        monitor=monitor,
    )
    if state.phase == HsicPhase.STRAIGHTEN:
        return _straighten(state, inputs, params)
    return _drive(state, inputs, params, dt_ns)


def _plan(inputs: ParkingInput, params: HsicSystemParams) -> HsicState:
    """Return the system on its way to the ready point, or failed: no key points, or the car touches a neighbour."""
    slot = params.hsic.slot
    car = params.car
    radius = slot.radius_reserve * car.wheelbase / math.tan(car.steering.angle_limit / car.steering.ratio)
    frame = frame_at(params.target, inputs.odometry)
    p1 = ready_point(slot, car, radius)
    points = key_points(p1, slot, car, radius)
    clear = is_pose_clear(to_slot(inputs.odometry, frame), outline_of(car), slot_bounds(slot, car))
    possible = points.found and clear
    return HsicState(
        phase=HsicPhase.PRE_STEER if possible else HsicPhase.FAILED,
        reason=Reason.NONE if possible else Reason.NO_PATH,
        frame=frame,
        course=Course(HsicStage.READY, points, p1, way=way_to(p1, to_slot(inputs.odometry, frame))),
    )


def _drive(state: HsicState, inputs: ParkingInput, params: HsicSystemParams, dt_ns: int) -> HsicState:
    """Return the system after one look at the situation and the rule that belongs to it."""
    hsic = params.hsic
    v = inputs.measured_speed
    pose = state.pose
    seen = errors(pose, state.course.goal, v, state.direction)
    course = advance(state.course, pose, seen, params.car, hsic)
    new_goal = course.goal.x != state.course.goal.x or course.stage != state.course.stage
    found = errors(pose, course.goal, v, state.direction) if new_goal else seen
    characteristic = recognise(course.stage, found, hsic.threshold)
    speed_mode, steer_mode = RULES[characteristic]
    standing = abs(v) <= params.threshold.standstill
    direction = state.direction
    if speed_mode == SpeedMode.TURN_ROUND and standing:
        direction = -1 if found.ahead > 0.0 else 1
    turning = speed_mode == SpeedMode.TURN_ROUND and direction == state.direction
    integral = 0.0 if new_goal else state.integral + found.lateral * abs(v) * dt_ns * 1e-9
    now = Situation(course.stage, direction, found, integral)
    angle = _front_wheels(steer_mode, now, 1.0 / course.points.radius, params)
    off = abs(inputs.steering_wheel_angle - steering_wheel_angle(angle, state.frame.mirror, params))
    hold = (course.hold or direction != state.direction) and not (
        standing and off <= hsic.threshold.steering_angle_reached
    )
    still = hold or turning or course.done
    phase = HsicPhase.STRAIGHTEN if course.done else HsicPhase.PRE_STEER if still else HsicPhase.PATH_TRACKING
    counted = _manoeuvre_direction(state, course.stage, phase, direction)
    return state._replace(
        phase=phase,
        course=course._replace(hold=hold),
        direction=direction,
        manoeuvres=state.manoeuvres + 1 if counted != state.counted else state.manoeuvres,
        counted=counted,
        characteristic=characteristic,
        integral=clamp(integral, -1.0, 1.0),
        angle=angle,
        set_speed=0.0 if still else direction * speed(speed_mode, found, hsic.gain),
        found=found,
    )


def _front_wheels(mode: int, now: Situation, arc: float, params: HsicSystemParams) -> float:
    """Return the front-wheel angle that the rule asks for, in the slot's frame [rad]; ``arc``: planned [1/m]."""
    bend = curvature(mode, now, arc, largest_curvature(params.car), params.hsic.gain)
    return math.atan(params.car.wheelbase * bend)


def _manoeuvre_direction(state: HsicState, stage: int, phase: int, direction: int) -> int:
    """Return the direction of the manoeuvre being driven: the first reverse begins the first one."""
    if phase != HsicPhase.PATH_TRACKING or stage == HsicStage.READY or (state.counted == 0 and direction > 0):
        return state.counted
    return direction


def _straighten(state: HsicState, inputs: ParkingInput, params: HsicSystemParams) -> HsicState:
    """Return the system at its end: wheel to the middle, then parked or missed."""
    phase = HsicPhase.STRAIGHTEN
    reason = Reason.NONE
    still = abs(inputs.measured_speed) <= params.threshold.standstill
    if still and abs(inputs.steering_wheel_angle) <= params.hsic.threshold.steering_angle_reached:
        near = is_parked(state.pose, 1.0, params.hsic)
        phase = HsicPhase.PARKED if near else HsicPhase.FAILED
        reason = Reason.NONE if near else Reason.MISSED_TARGET
    return state._replace(
        phase=phase,
        reason=reason,
        integral=0.0,
        angle=0.0,
        set_speed=0.0,
        found=errors(state.pose, state.course.goal, inputs.measured_speed, state.direction),
    )


def _terminate(state: HsicState, phase: int, reason: int) -> HsicState:
    return state._replace(phase=phase, reason=reason, set_speed=0.0)
