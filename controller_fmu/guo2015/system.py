"""The NTBPTcwPT system at one sample: plan once, track the leg, let the chart decide, prompt."""

from typing import NamedTuple

from controller_fmu.common.chart import bit
from controller_fmu.common.monitor import (
    MonitorState,
    is_usable_input,
    reason_to_fail,
    time_counted,
    watch,
)
from controller_fmu.common.phases import is_over
from controller_fmu.common.slot_frame import to_slot
from controller_fmu.common.steering_wheel import wheel_request
from controller_fmu.guo2015.chart import Guard, transition
from controller_fmu.guo2015.guards import standing_guards, way_guards, wheel_guards, within
from controller_fmu.guo2015.legs import Tracking, track
from controller_fmu.guo2015.params import GuoSystemParams
from controller_fmu.guo2015.path import SECOND_ARC
from controller_fmu.guo2015.phases import DIRECTION_OF_PHASE, GuoPhase, motion_expectation
from controller_fmu.guo2015.planner import Plan, plan
from controller_fmu.guo2015.prompts import (
    is_moving,
    path_speed,
    point_speed,
    swing_speed,
)
from controller_fmu.interface import ParkingInput, Reason
from modelkit.car import smallest_radius
from modelkit.maths import clamp
from modelkit.vocabulary import Pose


class GuoState(NamedTuple):
    """Everything the system remembers."""

    phase: int = GuoPhase.STANDBY
    leg: int = GuoPhase.PATH_TRACKING
    """What is driven next, once the car stands and the wheel is set."""
    driven: int = GuoPhase.PATH_TRACKING
    """What was driven last: its law holds while the car comes to a stop."""
    reason: int = Reason.NONE
    manoeuvres: int = 0
    direction: int = 0
    running_ns: int = 0
    piece: int = 0
    plan: Plan = Plan()
    tracking: Tracking = Tracking()
    request: float = 0.0
    moving: bool = False
    """The car moves in the requested direction."""
    advice: float = 0.0
    """Speed advised [m/s]; it holds while the driver is asked to stop."""
    swing: float = 0.0
    """Speed advised [m/s] while the wheel swings to where the path wants it."""
    takeover: bool = False
    monitor: MonitorState = MonitorState()


class Sample(NamedTuple):
    """What is known at a sample before the chart decides."""

    pose: Pose
    """In the slot's frame."""
    leg: int
    """What is driven, or was before the car comes to a stop."""
    tracking: Tracking
    dt_ns: int


def guo_start(params: GuoSystemParams) -> GuoState:
    """Return the system in standby."""
    return GuoState()


def guo_sample(state: GuoState, inputs: ParkingInput, params: GuoSystemParams, dt_ns: int) -> GuoState:
    """Return the system one sample of ``dt_ns`` later."""
    if is_over(state.phase):
        return _terminate(state, state.phase, state.reason, inputs.driver_takeover)
    if not is_usable_input(inputs):
        return _terminate(state, GuoPhase.FAILED, Reason.BAD_INPUT, inputs.driver_takeover)
    if state.phase == GuoPhase.STANDBY:
        if not params.guo2015.prompting.deceleration > 0.0:
            return _terminate(state, GuoPhase.FAILED, Reason.BAD_PARAMETER, inputs.driver_takeover)
        smallest = smallest_radius(params.car)
        reserve = params.guo2015.radius_reserve
        radius = params.guo2015.radius
        shape = params.guo2015.path
        planned = plan(inputs.odometry, params.target, radius, reserve * smallest, shape, params.car.wheelbase)
        state = state._replace(plan=Plan())
        if planned.path.found:
            state = state._replace(plan=planned)
    pose = to_slot(inputs.odometry, state.plan.frame)
    watched = inputs.steering_wheel_angle if state.phase == GuoPhase.STANDBY else state.request
    expected = motion_expectation(state.phase)
    state = state._replace(monitor=watch(state.monitor, inputs, expected, watched, dt_ns, params))
    leg = state.driven if state.phase == GuoPhase.STOP else state.leg
    tracking = track(leg, pose, state.plan.path, state.piece, params)
    now = Sample(pose, leg, tracking, dt_ns)
    reason = _reason(state, inputs, now, params)
    guards = _guards(state, inputs, now, reason, params)
    phase, next_leg = transition(state.phase, state.leg, guards)
    if is_over(phase):
        return _terminate(state, phase, reason if phase == GuoPhase.FAILED else Reason.NONE, inputs.driver_takeover)
    return _enter_phase(state, inputs, now, phase, next_leg, params)


def _reason(state: GuoState, inputs: ParkingInput, now: Sample, params: GuoSystemParams) -> int:
    limit = params.threshold
    expected = motion_expectation(state.phase)
    reason = reason_to_fail(state.monitor, inputs, expected, state.running_ns, state.manoeuvres, params)
    if reason != Reason.NONE:
        return reason
    if not state.plan.path.found:
        return Reason.NO_PATH
    if abs(now.tracking.lateral_error) > limit.abort_lateral_error:
        return Reason.LEFT_PATH
    straight = state.phase == GuoPhase.STRAIGHTEN and abs(inputs.steering_wheel_angle) <= limit.steering_angle_reached
    if straight and not within(now.pose.y, now.pose.heading, limit.final_lateral_error, limit.final_heading_error):
        return Reason.MISSED_TARGET
    return Reason.NONE


def _guards(state: GuoState, inputs: ParkingInput, now: Sample, reason: int, params: GuoSystemParams) -> int:
    wheel = inputs.steering_wheel_angle
    speed = inputs.measured_speed
    path = state.plan.path
    standing = standing_guards(state.leg, now.pose, inputs, params)
    return (
        bit(Guard.TAKEOVER, inputs.driver_takeover)
        | bit(Guard.FAULT, reason != Reason.NONE)
        | bit(Guard.PLANNED, path.found and abs(speed) <= params.threshold.standstill)
        | wheel_guards(state.leg, wheel, state.request, params.threshold.steering_angle_reached)
        | way_guards(now.leg, now.tracking, now.pose, path, speed, params)
        | standing
    )


def _enter_phase(
    state: GuoState, inputs: ParkingInput, now: Sample, phase: int, leg: int, params: GuoSystemParams
) -> GuoState:
    back_on_path = state.phase == GuoPhase.STOP and phase == GuoPhase.PRE_STEER and leg == GuoPhase.PATH_TRACKING
    direction = DIRECTION_OF_PHASE[phase]
    turned = direction != 0 and direction != state.direction
    driven = phase if direction != 0 else state.driven
    tracked = driven if phase == GuoPhase.STOP else leg
    piece = SECOND_ARC if back_on_path else state.piece
    tracking = now.tracking
    if tracked != now.leg or piece != state.piece:
        tracking = track(tracked, now.pose, state.plan.path, piece, params)
    request = _wheel_request(phase, tracking, state.plan, params)
    swing = _swing(state, inputs, phase, request, params)
    begun = state.phase != GuoPhase.STANDBY
    counted = time_counted(now.dt_ns, inputs.measured_speed, params.threshold.standstill, begun)
    return GuoState(
        phase=phase,
        leg=leg,
        driven=driven,
        reason=Reason.NONE,
        manoeuvres=state.manoeuvres + 1 if turned else state.manoeuvres,
        direction=direction if direction != 0 else state.direction,
        running_ns=state.running_ns + counted,
        piece=tracking.reference.piece,
        plan=state.plan,
        tracking=tracking,
        request=request,
        moving=is_moving(state.moving, inputs.measured_speed, direction, params.threshold.standstill),
        advice=_advice(state, phase, inputs.measured_speed, tracking, swing, params),
        swing=swing,
        takeover=inputs.driver_takeover,
        monitor=state.monitor,
    )


def _advice(
    state: GuoState, phase: int, speed: float, tracking: Tracking, swing: float, params: GuoSystemParams
) -> float:
    """Return the speed advised [m/s] at ``speed`` [m/s]; while a stop is requested it may fall but not rise."""
    if phase == GuoPhase.STANDBY:
        return params.guo2015.prompting.speed_limit
    driving = DIRECTION_OF_PHASE[phase] != 0
    if not driving and phase != GuoPhase.STOP:
        return state.advice
    last_phase = phase if driving else state.driven
    advice = swing
    if last_phase == GuoPhase.PATH_TRACKING:
        advice = path_speed(state.plan.path, tracking.reference, speed, state.monitor.wheel.steering, params)
    else:
        left = -DIRECTION_OF_PHASE[last_phase] * tracking.ahead
        advice = point_speed(left, speed, params.guo2015.prompting)
    advice = min(advice, swing)
    return advice if driving else min(state.advice, advice)


def _swing(state: GuoState, inputs: ParkingInput, phase: int, request: float, params: GuoSystemParams) -> float:
    """Return the speed [m/s] at which the wheel may swing to its request; held until it has arrived."""
    limit = params.guo2015.prompting.speed_limit
    wheel = inputs.steering_wheel_angle
    if DIRECTION_OF_PHASE[phase] == 0 or abs(request - wheel) <= params.limit.steering_tracking_error:
        return limit
    lock = params.car.steering.angle_limit
    angle = clamp(wheel, -lock, lock) / params.car.steering.ratio
    speed = swing_speed(angle, request / params.car.steering.ratio, state.monitor.wheel.steering, params)
    return min(state.swing, speed) if DIRECTION_OF_PHASE[state.phase] != 0 else speed


def _wheel_request(phase: int, tracking: Tracking, planned: Plan, params: GuoSystemParams) -> float:
    if phase in (GuoPhase.STANDBY, GuoPhase.STRAIGHTEN):
        return 0.0
    return wheel_request(tracking.front_wheel_angle, planned.frame.mirror, params)


def _terminate(state: GuoState, phase: int, reason: int, takeover: bool) -> GuoState:
    return state._replace(phase=phase, reason=reason, moving=False, advice=0.0, takeover=takeover)
