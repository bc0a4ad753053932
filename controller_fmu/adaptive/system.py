"""Driver-adaptive parking at one sample: plan where the car stands, follow the route, foresee the stop, prompt."""

import math
from typing import NamedTuple

from controller_fmu.adaptive.chart import Guard, transition
from controller_fmu.adaptive.curves import SteeringLimits
from controller_fmu.adaptive.driver import (
    Driver,
    has_stopped,
    on_stop_prompt,
    reaction_of,
    shortest_drive,
    stopping_distance,
    update_at_standstill,
    update_prompt,
    update_while_driving,
    update_while_stopping,
)
from controller_fmu.adaptive.params import AdaptiveSystemParams
from controller_fmu.adaptive.phases import AdaptivePhase, direction_of, motion_expectation
from controller_fmu.adaptive.planner import ANY_SPEED, NO_PLAN, Demand, Plan, plan
from controller_fmu.adaptive.room import room_of
from controller_fmu.adaptive.route import STANDSTILL_LOOKAHEAD, Foot, curvature_at, drivable, foot_on
from controller_fmu.common.chart import bit
from controller_fmu.common.monitor import (
    MonitorState,
    is_usable_input,
    reason_to_fail,
    time_counted,
    watch,
)
from controller_fmu.common.phases import is_over
from controller_fmu.common.slot_frame import SlotFrame, frame_at, to_slot
from controller_fmu.common.steering_monitor import Steering, delay_of, rate_of
from controller_fmu.common.steering_wheel import wheel_request
from controller_fmu.interface import ParkingInput, Reason
from modelkit.car import smallest_radius
from modelkit.maths import clamp
from modelkit.vocabulary import Pose

MAX_TRACKING_HEADING = 1.3
LOOP_DEAD_TIME = 0.02
"""From a request to the wheel's first movement, of the loop itself [s]."""
UNKNOWN_SPEED = 1.0
"""Speed [m/s] of a driver who has not driven yet, where no route is free of stops."""
STOPPING_DISTANCE_FACTOR = 1.0
RESERVE_SPEED = 0.05
TOO_FAST = 1.08
TOO_FAST_BY = 0.03


class AdaptiveState(NamedTuple):
    """Everything the system remembers."""

    phase: int = AdaptivePhase.STANDBY
    reason: int = Reason.NONE
    manoeuvres: int = 0
    direction: int = 0
    running_ns: int = 0
    frame: SlotFrame = SlotFrame()
    plan: Plan = NO_PLAN
    end: float = 0.0
    """Way along the route [m] at which the car is to stand."""
    foot: Foot = Foot()
    begun: Foot = Foot()
    """At the beginning of the route."""
    driver: Driver = Driver()
    request: float = 0.0
    moving: bool = False
    """The car moves in the requested direction."""
    advice: float = 0.0
    takeover: bool = False
    monitor: MonitorState = MonitorState()


def adaptive_start(params: AdaptiveSystemParams) -> AdaptiveState:
    """Return the system in standby."""
    return AdaptiveState()


def adaptive_sample(
    state: AdaptiveState, inputs: ParkingInput, params: AdaptiveSystemParams, dt_ns: int
) -> AdaptiveState:
    """Return the system one sample of ``dt_ns`` later."""
    if is_over(state.phase):
        return _terminate(state, state.phase, state.reason, inputs.driver_takeover)
    if not is_usable_input(inputs):
        return _terminate(state, AdaptivePhase.FAILED, Reason.BAD_INPUT, inputs.driver_takeover)
    frame = frame_at(params.target, inputs.odometry) if state.phase == AdaptivePhase.STANDBY else state.frame
    pose = to_slot(inputs.odometry, frame)
    watched = inputs.steering_wheel_angle if state.phase == AdaptivePhase.STANDBY else state.request
    expected = motion_expectation(state.phase)
    monitor = watch(state.monitor, inputs, expected, watched, dt_ns, params)
    counted = time_counted(dt_ns, inputs.measured_speed, params.threshold.standstill, expected.begun)
    seen = state._replace(
        frame=frame,
        monitor=monitor,
        running_ns=state.running_ns + counted,
        takeover=inputs.driver_takeover,
        driver=_driver(state, inputs, params, dt_ns),
    )
    standing = abs(inputs.measured_speed) <= params.threshold.standstill
    if state.phase == AdaptivePhase.STOP:
        standing = standing and has_stopped(seen.driver, params.adaptive.belief)
    if standing and state.phase in (AdaptivePhase.STANDBY, AdaptivePhase.STOP):
        seen = _replan_at_standstill(seen, pose, params)
    elif direction_of(state.phase) != 0 or state.phase == AdaptivePhase.STOP:
        seen = _update_tracking(seen, pose)
    reason = reason_to_fail(monitor, inputs, expected, seen.running_ns, state.manoeuvres, params)
    if reason == Reason.NONE and standing and _is_stuck(seen, pose, params):
        reason = Reason.NO_PATH if state.phase == AdaptivePhase.STANDBY else Reason.MISSED_TARGET
    phase = transition(state.phase, _guards(seen, reason, pose, inputs, standing, params))
    if is_over(phase):
        return _terminate(seen, phase, reason if phase == AdaptivePhase.FAILED else Reason.NONE, inputs.driver_takeover)
    return _enter_phase(seen, phase, inputs, params)


def is_in_place(pose: Pose, params: AdaptiveSystemParams) -> bool:
    """Return whether a car standing at ``pose`` (slot's frame) is parked."""
    limit = params.adaptive.end
    return abs(pose.y) <= limit.lateral and abs(pose.heading) <= limit.heading and abs(pose.x) <= limit.along


def _driver(state: AdaptiveState, inputs: ParkingInput, params: AdaptiveSystemParams, dt_ns: int) -> Driver:
    """Return the driver as known after this sample."""
    speed = inputs.measured_speed
    if state.phase == AdaptivePhase.STOP:
        return update_while_stopping(state.driver, speed, params.threshold.standstill, dt_ns)
    if direction_of(state.phase) != 0:
        believed = params.adaptive.belief
        return update_while_driving(state.driver, speed, state.advice, params.threshold.standstill, believed, dt_ns)
    return state.driver


def _replan_at_standstill(state: AdaptiveState, pose: Pose, params: AdaptiveSystemParams) -> AdaptiveState:
    """Return the system with a plan from where the car stands, and the driver as his stop has shown him."""
    driver = (
        update_at_standstill(state.driver, params.adaptive.belief)
        if state.phase == AdaptivePhase.STOP
        else state.driver
    )
    if is_in_place(pose, params):
        return state._replace(driver=driver, plan=NO_PLAN)
    path = params.adaptive.path
    known = driver.fastest > 0.0
    speed = (
        STOPPING_DISTANCE_FACTOR * 0.5 * (driver.cruise + driver.fastest) + RESERVE_SPEED if known else UNKNOWN_SPEED
    )
    shortest = 0.05 if driver.slows else shortest_drive(driver, params.adaptive.belief)
    demand = Demand(speed, driver.obeys, path.rest, 0.5 if driver.stops > 0 else 0.4, shortest)
    wheel = wheel_of(state.monitor.wheel.steering, params)
    planned = plan(pose, demand, wheel, room_of(params.car, params.adaptive.room))
    foot = foot_on(planned.route, 0.0, pose) if planned.route.direction != 0 else Foot(reference=pose)
    return state._replace(driver=driver, plan=planned, end=drivable(planned.route), foot=foot, begun=foot)


def wheel_of(steering: Steering, params: AdaptiveSystemParams) -> SteeringLimits:
    """Return what paths are planned with."""
    path = params.adaptive.path
    rate = rate_of(steering, params.car.steering.rate_limit) / params.car.steering.ratio
    smallest = smallest_radius(params.car)
    return SteeringLimits(params.car.wheelbase, path.rate_reserve * rate, path.radius_reserve * smallest)


def _update_tracking(state: AdaptiveState, pose: Pose) -> AdaptiveState:
    """Return the system with the foot of the car; a driver too fast for the route stays on its first arc to a stop."""
    foot = foot_on(state.plan.route, state.foot.s, pose)
    slower = state.plan.slower
    if slower.direction == 0 or state.phase == AdaptivePhase.STOP:
        return state._replace(foot=foot)
    pieces = state.plan.route.pieces
    leaves = pieces[0].length
    if slower.pieces[0].k0 != 0.0:
        leaves += pieces[1].length + pieces[2].length
    too_fast = state.driver.speed > TOO_FAST * state.plan.speed + TOO_FAST_BY or not state.driver.obeys
    end = drivable(slower)
    soon = foot.s >= leaves or end - foot.s <= state.driver.speed * 2.0
    if too_fast and soon:
        return state._replace(foot=foot, plan=Plan(slower, ANY_SPEED), end=end)
    if foot.s >= leaves:
        return state._replace(foot=foot, plan=Plan(state.plan.route, state.plan.speed))
    return state._replace(foot=foot)


def _is_stuck(state: AdaptiveState, pose: Pose, params: AdaptiveSystemParams) -> bool:
    """Return whether a car that stands to be planned for has no way on."""
    planning = state.phase in (AdaptivePhase.STANDBY, AdaptivePhase.STOP)
    return planning and state.plan.route.direction == 0 and not is_in_place(pose, params)


def _guards(
    state: AdaptiveState,
    reason: int,
    pose: Pose,
    inputs: ParkingInput,
    standing: bool,
    params: AdaptiveSystemParams,
) -> int:
    wheel_there = abs(inputs.steering_wheel_angle - state.request) <= params.threshold.steering_angle_reached
    straight = abs(inputs.steering_wheel_angle) <= params.threshold.steering_angle_reached
    limit = params.adaptive.end
    begun = state.begun
    off = abs(state.foot.lateral_error) > limit.leave_lateral + abs(begun.lateral_error) or abs(
        state.foot.heading_error
    ) > limit.leave_heading + abs(begun.heading_error)
    left = state.end - state.foot.s
    must = off or left <= stopping_distance(state.driver, params.adaptive.belief)
    return (
        bit(Guard.TAKEOVER, inputs.driver_takeover)
        | bit(Guard.FAULT, reason != Reason.NONE)
        | bit(Guard.IN_PLACE, standing and is_in_place(pose, params))
        | bit(Guard.PLANNED, standing and state.plan.route.direction != 0)
        | bit(Guard.WHEEL_SET_TO_REVERSE, wheel_there and state.plan.route.direction < 0)
        | bit(Guard.WHEEL_SET_TO_GO_AHEAD, wheel_there and state.plan.route.direction > 0)
        | bit(Guard.MUST_STOP, must)
        | bit(Guard.WHEEL_STRAIGHT, straight)
    )


def _enter_phase(state: AdaptiveState, phase: int, inputs: ParkingInput, params: AdaptiveSystemParams) -> AdaptiveState:
    direction = direction_of(phase)
    turned = direction != 0 and direction != state.direction
    counted = turned and (state.manoeuvres > 0 or direction < 0)
    driver = state.driver
    if phase != state.phase and direction != 0:
        driver = update_prompt(driver, inputs.measured_speed)
    if phase != state.phase and phase == AdaptivePhase.STOP:
        driver = on_stop_prompt(driver, inputs.measured_speed, state.advice, params.adaptive.belief)
    along = direction * inputs.measured_speed
    moved = state._replace(
        phase=phase,
        manoeuvres=state.manoeuvres + 1 if counted else state.manoeuvres,
        direction=direction if direction != 0 else state.direction,
        driver=driver,
        moving=along > 0.05 or (state.moving and along > params.threshold.standstill),
    )
    advice = _advice(moved, params)
    held = phase == AdaptivePhase.STOP and state.phase != AdaptivePhase.STANDBY
    request = _request(moved, params)
    return moved._replace(advice=min(advice, state.advice) if held else advice, request=request)


def _request(state: AdaptiveState, params: AdaptiveSystemParams) -> float:
    """Return the steering-wheel angle to ask for [rad]."""
    if state.phase in (AdaptivePhase.STANDBY, AdaptivePhase.STRAIGHTEN) or state.plan.route.direction == 0:
        return 0.0
    route = state.plan.route
    path = params.adaptive.path
    late = delay_of(state.monitor.wheel.steering) + LOOP_DEAD_TIME
    soon = max(STANDSTILL_LOOKAHEAD, state.foot.s + late * state.driver.speed)
    curvature = curvature_at(route, min(soon, max(state.end, state.foot.s)))
    turned = clamp(state.foot.heading_error, -MAX_TRACKING_HEADING, MAX_TRACKING_HEADING)
    c = math.cos(turned)
    feedback = path.k1 * state.foot.lateral_error + route.direction * path.k2 * math.tan(turned)
    angle = math.atan(params.car.wheelbase * c * c * c * (curvature - feedback))
    return wheel_request(angle, state.frame.mirror, params)


def _advice(state: AdaptiveState, params: AdaptiveSystemParams) -> float:
    """Return the speed advised [m/s]: that of the route, and less towards the place to stand."""
    believed = params.adaptive.belief
    fast = min(believed.speed_limit, state.plan.speed)
    if state.phase == AdaptivePhase.STANDBY:
        return believed.speed_limit
    left = state.end - state.foot.s - state.driver.speed * reaction_of(state.driver, believed)
    creep = believed.creep_speed
    near = math.sqrt(creep * creep + 2.0 * believed.gentle * max(0.0, left))
    return min(fast, near)


def _terminate(state: AdaptiveState, phase: int, reason: int, takeover: bool) -> AdaptiveState:
    return state._replace(phase=phase, reason=reason, moving=False, advice=0.0, takeover=takeover)
