"""One sample of the parking system: perceive, search or plan or drive, monitor, and step the chart."""

import math

from controller_fmu.common.chart import bit
from controller_fmu.common.driver_selection import ChosenTask
from controller_fmu.common.external_slot import SlotKind
from controller_fmu.common.monitor import MonitorState, watch
from controller_fmu.common.phases import PhaseExpectation
from controller_fmu.common.steering_wheel import wheel_request
from controller_fmu.interface import Reason
from controller_fmu.parking.chart import Condition, ParkingState, Strategy, next_parking_state
from controller_fmu.parking.following.params import FollowingContext
from controller_fmu.parking.following.path_tracking import (
    PathProgress,
    SpeedTracking,
    is_at_end,
    learn_speed_delay,
    must_stop,
    next_segment,
    profile_speed,
    set_out,
    track_path,
)
from controller_fmu.parking.following.rolling_steering import reference_at, standstill_before
from controller_fmu.parking.geometry.frames import planar_distance
from controller_fmu.parking.geometry.outline import vehicle_outline
from controller_fmu.parking.measurement.cycle import seconds
from controller_fmu.parking.measurement.sensor import MAX_SENSORS
from controller_fmu.parking.measurement.silent_sensor import has_blind_side
from controller_fmu.parking.monitor.collision_monitor import (
    NO_LIMIT,
    EchoObstacle,
    MonitorVerdict,
    VehicleMotion,
    monitor_collision,
)
from controller_fmu.parking.monitor.fault_monitor import (
    FaultClocks,
    advance_clocks,
    fault_reason,
    input_fault,
    is_taken_over,
)
from controller_fmu.parking.objects.track import is_lost_at_once
from controller_fmu.parking.params import ParkingParams, is_driver_driving
from controller_fmu.parking.path_planning import (
    begin_plan,
    continue_plan,
    forget_what_left,
    is_acceptable,
    is_near,
    max_manoeuvres,
    slot_in_map,
    with_way_out,
)
from controller_fmu.parking.perception import (
    is_driving_state,
    is_same_gap,
    number_of_choice,
    perceive,
    search_reason,
    search_slots,
)
from controller_fmu.parking.planning.work import PlanningWork
from controller_fmu.parking.pull_out import is_clear_ahead
from controller_fmu.parking.signals import ParkingSystemInput
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType, row_point
from controller_fmu.parking.slots.goal import goal_pose
from controller_fmu.parking.slots.slot_filter import begin_slot_filter
from controller_fmu.parking.state import ParkingMemory, Perception, PlanProgress, SearchProgress
from modelkit.maths import move_towards, sign
from modelkit.vocabulary import Pose

REPLAN_TIME = 0.3
"""Blocked by the map the vehicle plans again after this time [s]: seven measurement cycles at standstill."""
MAX_RESUME_DISTANCE = 12.0
"""A slot is shown again up to this distance [m]: odometry drifts by 2 % of it, a quarter of a metre."""
DRIVEN_ON = 0.3
"""A vehicle that has moved by more than this [m] since the slot was shown was driven on by its driver."""


def parking_sample(
    work: PlanningWork, memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams, dt_ns: int
) -> ParkingMemory:
    """Return the memory one sample of ``dt_ns`` later."""
    state = memory.state
    is_off = state in (ParkingState.STANDBY, ParkingState.PARKED, ParkingState.FAILED, ParkingState.TAKEOVER)
    wants_out = params.search.active and inputs.driver_selection.task == ChosenTask.PULL_OUT
    perceives = not is_off or is_slot_kept(memory) or (wants_out and state == ParkingState.STANDBY)
    if perceives and input_fault(inputs) == Reason.NONE:
        memory = perceive(memory, inputs, params, dt_ns)
        if is_off:
            memory = forget_what_left(memory, inputs, params)
    if state == ParkingState.SEARCHING:
        memory = search_slots(memory, inputs, params, dt_ns)
        fault = input_fault(inputs)
        is_external = inputs.external_slot.kind != SlotKind.NONE
        reason = fault if fault != Reason.NONE else search_reason(memory.search, is_external, params)
        memory = memory._replace(reason=reason)
    elif state == ParkingState.CONFIRMING or state == ParkingState.PLANNING:
        memory = continue_plan(work, memory, inputs, params)
        memory = memory._replace(search=memory.search._replace(waited=memory.search.waited + dt_ns))
    elif is_driving_state(state):
        memory = _drive(memory, inputs, params)
    if not is_off and state != ParkingState.SEARCHING:
        memory = _watch(memory, inputs, params, dt_ns)
    conditions = conditions_of(memory, inputs, params)
    return enter_state(memory, next_parking_state(state, conditions), inputs, params)


def _watch(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams, dt_ns: int) -> ParkingMemory:
    """Return the memory with the clocks of the fault monitor advanced, and the reason to fail if one ran out."""
    state = memory.state
    if state == ParkingState.CONFIRMING:
        late = seconds(memory.search.waited) > params.slot.confirm_time
        fault = input_fault(inputs)
        fault = Reason.TIMEOUT if fault == Reason.NONE and late else fault
        return memory._replace(reason=fault) if fault != Reason.NONE else memory
    direction = int(memory.progress.direction) if state == ParkingState.DRIVING else 0
    is_steering = state in (ParkingState.STEERING, ParkingState.STRAIGHTENING)
    phase = PhaseExpectation(state != ParkingState.PLANNING, direction, is_steering)
    speed = abs(inputs.measured_speed)
    stands = speed <= params.threshold.standstill
    common = watch(memory.clocks.common, inputs, phase, memory.steering_wheel_angle, dt_ns, params)
    is_blocked = memory.verdict.is_blocked
    clocks = advance_clocks(memory.clocks, common, stands, is_blocked, speed > params.monitor.over_speed, dt_ns)
    spare = 0 if memory.strategy == Strategy.SLOT else max_manoeuvres(memory, params) - params.limit.manoeuvres
    reason = memory.reason
    if reason == Reason.NONE:
        manoeuvres = memory.progress.manoeuvres - spare
        reason = fault_reason(clocks, inputs, phase, manoeuvres, params.monitor.over_speed_time, params)
    is_silent = has_blind_side(memory.perception.local_map.missed) or is_lost_at_once(memory.perception.tracks)
    if reason == Reason.NONE and is_silent:
        reason = Reason.SENSOR_LOSS
    return memory._replace(clocks=clocks, reason=reason)


def _drive(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> ParkingMemory:
    """Return the memory with the progress on the path and the collision monitor's verdict."""
    context = FollowingContext(params.car, params.drive)
    memory = memory._replace(progress=track_path(memory.progress, inputs.odometry, inputs.measured_speed, context))
    if memory.state == ParkingState.DRIVING and not is_driver_driving(params):
        speeds = speed_tracking(memory, inputs, params)
        memory = memory._replace(progress=learn_speed_delay(memory.progress, speeds, params.sample_time, context))
    direction = sign(memory.progress.path.segments[memory.progress.segment].distance)
    angle = memory.steering_wheel_angle if memory.state == ParkingState.STEERING else inputs.steering_wheel_angle
    curvature = math.tan(angle / params.car.steering.ratio) / params.car.wheelbase
    speed = abs(inputs.measured_speed)
    speed = speed if speed > params.threshold.standstill else 0.0
    left = max(memory.progress.upcoming.left, 0.0)
    delay = params.monitor.brake_delay
    deceleration = params.monitor.brake_deceleration
    stand = memory.progress.stand
    motion = VehicleMotion(inputs.odometry, direction, speed, curvature, left, delay, deceleration, stand)
    outline = vehicle_outline(params.car, 1.0)
    verdict = monitor_collision(
        motion, outline, memory.perception.local_map.landmarks, memory.perception.echoes, params.monitor, params.mapping
    )
    if memory.perception.yields > 0:
        verdict = verdict._replace(speed_limit=0.0, is_blocked=True, is_mapped=False)
    return memory._replace(verdict=verdict)


def conditions_of(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> int:
    """Return the bits of the conditions that hold."""
    return _driver_conditions(memory, inputs, params) | _motion_conditions(memory, inputs, params)


def _driver_conditions(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> int:
    """Return the bits of what the driver does, and of what the search and the planner have found for the driver."""
    search = memory.search
    standing = abs(inputs.measured_speed) <= params.threshold.standstill
    moved = planar_distance(inputs.odometry.x, inputs.odometry.y, search.stand.x, search.stand.y)
    searches = params.search.active
    wants_out = searches and inputs.driver_selection.task == ChosenTask.PULL_OUT
    is_out = memory.strategy == Strategy.PULL_OUT
    corner = row_point(search.slot.row, search.slot.behind.end, search.slot.front)
    is_near_slot = planar_distance(inputs.odometry.x, inputs.odometry.y, corner.x, corner.y) < MAX_RESUME_DISTANCE
    is_resumed = not wants_out and search.resumes and standing and inputs.apa_switch and is_near_slot
    is_another = (
        not is_out
        and not search.slot.is_external
        and number_of_choice(search.offered, inputs.driver_selection) != search.shown
    )
    return (
        bit(Condition.GOAL_KNOWN, not searches)
        | bit(Condition.RESUMED, is_resumed)
        | bit(Condition.WANTS_OUT, wants_out and standing and inputs.apa_switch and memory.perception.local_map.begun)
        | bit(Condition.SWITCHED_ON, inputs.apa_switch and searches and not is_resumed and not wants_out)
        | bit(Condition.SWITCHED_OFF, searches and not inputs.apa_switch)
        | bit(Condition.TAKEN_OVER, is_taken_over(memory.clocks, inputs, is_driver_driving(params)))
        | bit(Condition.FAULT, memory.reason != Reason.NONE and (is_out or memory.state != ParkingState.CONFIRMING))
        | bit(Condition.SLOT_FOUND, standing and search.slot.type != SlotType.NONE)
        | bit(Condition.SLOT_REJECTED, memory.reason != Reason.NONE)
        | bit(Condition.DRIVEN_ON, moved > DRIVEN_ON or is_another)
        | bit(Condition.CONFIRMED, inputs.driver_confirm and standing and memory.plan.is_found)
        | bit(Condition.PLANNED, memory.plan.is_found)
        | bit(Condition.NO_NEARER, memory.plan.is_final)
    )


def _motion_conditions(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> int:
    """Return the bits of how the vehicle moves on its path."""
    progress = memory.progress
    context = FollowingContext(params.car, params.drive)
    standing = abs(inputs.measured_speed) <= params.threshold.standstill
    wheel = inputs.steering_wheel_angle
    straight = abs(wheel) <= params.threshold.steering_angle_reached
    rolling_time = 0.0
    if memory.state == ParkingState.STEERING:
        rolling_time = standstill_before(progress.path, progress.segment, context).after
    tolerance = max(params.threshold.steering_angle_reached, params.car.steering.rate_limit * rolling_time)
    blocked = memory.verdict.is_blocked
    is_forward = memory.strategy == Strategy.PULL_OUT and progress.direction > 0.0
    is_out = is_forward and is_clear_ahead(memory.perception.cycle.readings)
    is_aside = abs(progress.lateral_error) > params.monitor.corridor
    lost = is_aside or abs(progress.heading_error) > params.monitor.corridor_heading
    patience = REPLAN_TIME if memory.verdict.is_mapped else params.monitor.wait
    blocked_long = memory.verdict.free_distance < NO_LIMIT and seconds(memory.clocks.blocked) > patience
    halts = blocked or lost or is_out
    straightens = memory.state == ParkingState.STRAIGHTENING
    in_place = straightens and straight and standing and is_in_place(memory, inputs, params)
    return (
        bit(Condition.WHEEL_TURNED, abs(wheel - memory.steering_wheel_angle) <= tolerance and not blocked)
        | bit(Condition.MUST_STOP, must_stop(progress, speed_tracking(memory, inputs, params), context) or halts)
        | bit(Condition.REPLAN, standing and (lost or blocked_long))
        | bit(Condition.AT_END, standing and (is_at_end(progress) or is_out))
        | bit(Condition.STANDING, standing and not blocked)
        | bit(Condition.IN_PLACE, in_place)
        | bit(Condition.MISSED, straightens and straight and standing and not in_place)
    )


def speed_tracking(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> SpeedTracking:
    """Return the speed, measured and requested; a driver is not requested, but brakes after a reaction time."""
    measured = abs(inputs.measured_speed)
    if is_driver_driving(params):
        return SpeedTracking(measured, measured, params.drive.driver_reaction)
    return SpeedTracking(measured, abs(memory.speed), max(params.drive.brake_delay, memory.progress.speed_delay))


def is_in_place(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> bool:
    """Return whether the vehicle is at the goal, or cannot be brought nearer: the plans are used up."""
    is_accepted = is_acceptable(memory, inputs.odometry, memory.plan.is_final, params)
    if memory.strategy == Strategy.PULL_OUT or (memory.plan.is_final and is_accepted):
        return True
    if memory.strategy == Strategy.SLOT and not is_accepted:
        return False
    goal = memory.plan.request.goal
    if memory.strategy == Strategy.SLOT:
        slot = slot_in_map(memory, inputs.odometry, params)
        goal = goal_pose(slot, vehicle_outline(params.car, params.plan.curvature_fraction), params.slot)
    along = params.final.position + abs(params.drive.rolling_offset)
    return is_near(inputs.odometry, goal, along, params.final.position, params.final.heading)


def enter_state(memory: ParkingMemory, state: int, inputs: ParkingSystemInput, params: ParkingParams) -> ParkingMemory:
    """Return the memory in ``state``, with what is requested of steering and speed until the next sample."""
    before = memory.state
    context = FollowingContext(params.car, params.drive)
    if state == ParkingState.SEARCHING and before != ParkingState.SEARCHING:
        memory = _begin_search(memory, before)
    if state == ParkingState.STANDBY and before != ParkingState.STANDBY:
        memory = memory._replace(search=memory.search._replace(resumes=is_slot_kept(memory)))
    if state == ParkingState.CONFIRMING and before != ParkingState.CONFIRMING:
        memory = _with_slot_shown(memory, inputs.odometry)
        if before == ParkingState.STANDBY and inputs.driver_selection.task == ChosenTask.PULL_OUT:
            memory = with_way_out(memory, inputs, params)
        memory = begin_plan(memory)
    if state == ParkingState.PLANNING and before == ParkingState.STANDBY:
        memory = memory._replace(strategy=Strategy.POSE)
    if state == ParkingState.PLANNING and before != ParkingState.PLANNING:
        memory = memory._replace(clocks=memory.clocks._replace(blocked=0), verdict=MonitorVerdict())
        memory = begin_plan(memory)
    if state == ParkingState.STEERING and before != ParkingState.STEERING:
        memory = memory._replace(progress=next_segment(memory.progress, inputs.odometry, context))
    if state == ParkingState.DRIVING and before != ParkingState.DRIVING:
        memory = memory._replace(progress=set_out(memory.progress))
    memory = memory._replace(state=state)
    return _request(memory, inputs, context, params)


def is_slot_kept(memory: ParkingMemory) -> bool:
    """Return whether the vehicle was on its way into a slot, which may be shown again."""
    is_over = memory.state in (ParkingState.FAILED, ParkingState.TAKEOVER)
    was_driven = is_over and memory.strategy == Strategy.SLOT and memory.progress.direction != 0.0
    return memory.search.slot.type != SlotType.NONE and (was_driven or memory.search.resumes)


def _with_slot_shown(memory: ParkingMemory, pose: Pose) -> ParkingMemory:
    """Return the memory of a vehicle at ``pose`` that is shown a slot, found now or driven into before."""
    if not memory.search.resumes:
        slot_filter = begin_slot_filter(memory.search.slot)
        memory = memory._replace(search=memory.search._replace(pose=pose, slot_filter=slot_filter))
    memory = memory._replace(search=memory.search._replace(stand=pose, waited=0, resumes=False))
    memory = memory._replace(perception=memory.perception._replace(echoes=(EchoObstacle(),) * MAX_SENSORS))
    memory = memory._replace(progress=PathProgress(speed_delay=memory.progress.speed_delay))
    memory = memory._replace(clocks=FaultClocks(MonitorState(wheel=memory.clocks.common.wheel)))
    return memory._replace(strategy=Strategy.SLOT, reason=Reason.NONE, plan=PlanProgress(), verdict=MonitorVerdict())


def _begin_search(memory: ParkingMemory, before: int) -> ParkingMemory:
    """Return the memory at the start of a search; a slot that was shown is forgotten, the map is not."""
    if before == ParkingState.CONFIRMING:
        refused = memory.search.slot if memory.reason != Reason.NONE else memory.search.refused
        offered = tuple(SlotCandidate() if is_same_gap(slot, refused) else slot for slot in memory.search.offered)
        search = SearchProgress(
            distance=memory.search.distance, rejected=memory.reason, refused=refused, offered=offered
        )
        return memory._replace(search=search, reason=Reason.NONE, plan=PlanProgress())
    return ParkingMemory(state=memory.state, perception=Perception(time=memory.perception.time))


def _request(
    memory: ParkingMemory, inputs: ParkingSystemInput, context: FollowingContext, params: ParkingParams
) -> ParkingMemory:
    """Return the memory with the requested steering-wheel angle and speed."""
    state = memory.state
    wheel = memory.steering_wheel_angle
    speed = 0.0
    if state == ParkingState.STEERING:
        progress = memory.progress
        ahead = reference_at(progress.path, progress.segment, progress.remaining, context)
        wheel = wheel_request(math.atan(params.car.wheelbase * ahead.curvature), 1.0, params)
    if state == ParkingState.DRIVING or state == ParkingState.STOPPING:
        wheel = wheel_request(memory.progress.front_wheel_angle, 1.0, params)
    if state == ParkingState.STRAIGHTENING:
        wheel = 0.0
    if state == ParkingState.DRIVING:
        speeds = speed_tracking(memory, inputs, params)
        allowed = profile_speed(memory.progress, speeds, memory.verdict.speed_limit, context)
        speed = memory.progress.direction * allowed
    if state == ParkingState.STOPPING and not memory.verdict.is_blocked:
        speed = move_towards(memory.speed, 0.0, params.drive.brake_deceleration * params.sample_time)
    return memory._replace(steering_wheel_angle=wheel, speed=speed)
