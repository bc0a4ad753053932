"""The planner in the system: a request from the slot as it is known now, continued a bounded amount at each sample."""

import math
from typing import NamedTuple

from controller_fmu.common.external_slot import SlotKind, is_usable_slot
from controller_fmu.interface import Reason
from controller_fmu.parking.chart import Strategy
from controller_fmu.parking.following.params import FollowingContext
from controller_fmu.parking.following.path_tracking import begin_path
from controller_fmu.parking.geometry.frames import planar_distance, point_to_frame, pose_to_frame
from controller_fmu.parking.geometry.outline import VehicleOutline, vehicle_outline
from controller_fmu.parking.geometry.polygons import ObstacleMap
from controller_fmu.parking.map.landmark import Landmark, LandmarkType
from controller_fmu.parking.map.visibility import predict_range
from controller_fmu.parking.measurement.cycle import seconds
from controller_fmu.parking.measurement.sensor import (
    MAX_SENSORS,
    ReadingStatus,
    SensorPose,
    reading_status,
    sensor_pose,
)
from controller_fmu.parking.monitor.collision_monitor import EchoObstacle, landmark_distance
from controller_fmu.parking.obstacle_map import (
    away_from_vehicle,
    echo_away_from_vehicle,
    is_on_map,
    obstacle_map,
    with_echoes,
)
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.perception import with_slot_type
from controller_fmu.parking.planning.gear_segments import without_short_end
from controller_fmu.parking.planning.planner import (
    PlanningStatus,
    continue_search,
    path_of_plan,
    search_status,
    search_until,
)
from controller_fmu.parking.planning.problem import PlanningRequest
from controller_fmu.parking.planning.work import PlanningWork
from controller_fmu.parking.pull_out import free_box, pose_on_road, road_side, with_neighbours
from controller_fmu.parking.signals import ParkingSystemInput
from controller_fmu.parking.slots.candidate import LOG_TEN, UNKNOWN_DEPTH, SlotCandidate, SlotType, log_likelihood_ratio
from controller_fmu.parking.slots.correction import correct_slot
from controller_fmu.parking.slots.external import external_pose
from controller_fmu.parking.slots.goal import goal_pose, kerb_shift, least_depth, most_overhang, overhang_of
from controller_fmu.parking.slots.slot_filter import slot_of_filter
from controller_fmu.parking.state import ParkingMemory, SearchProgress, with_landmarks
from modelkit.geometry import Point
from modelkit.maths import wrap_angle
from modelkit.vocabulary import Pose


def begin_plan(memory: ParkingMemory) -> ParkingMemory:
    """Return the memory with a new plan due; the first sample at standstill makes its request."""
    return memory._replace(plan=memory.plan._replace(steps=0, is_found=False, failure=Reason.NONE))


def wait_for_change(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> ParkingMemory:
    """Return the memory of a vehicle that has no path: planned again once something has gone, else the reason.

    Echoes that were explained by what has gone came from elsewhere.
    """
    if seconds(memory.perception.time - memory.plan.failed_at) > params.monitor.wait:
        return memory._replace(reason=memory.plan.failure)
    before = obstacle_count(memory)
    memory = forget_what_left(memory, inputs, params)
    if obstacle_count(memory) < before:
        memory = memory._replace(perception=memory.perception._replace(echoes=(EchoObstacle(),) * MAX_SENSORS))
        memory = memory._replace(plan=memory.plan._replace(plans=memory.plan.plans - 1))
        memory = begin_plan(memory)
    return memory


def obstacle_count(memory: ParkingMemory) -> int:
    """Return how many landmarks and echoes there are."""
    landmarks = sum(1 if item.type != LandmarkType.NONE else 0 for item in memory.perception.local_map.landmarks)
    return landmarks + sum(1 if echo.is_present else 0 for echo in memory.perception.echoes)


def forget_what_left(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> ParkingMemory:
    """Return the memory without landmarks through which a sensor at rest measures, in the middle of its cone.

    An object that left a slot had come between the cones of two sensors: neither has all of its landmark in view.
    """
    if not memory.perception.cycle.is_new:
        return memory
    views = tuple(_view_at_rest(number, memory, inputs, params) for number in range(MAX_SENSORS))
    echoes = tuple(_without_passed(memory.perception.echoes[number], views[number]) for number in range(MAX_SENSORS))
    memory = memory._replace(perception=memory.perception._replace(echoes=echoes))
    landmarks = tuple(_contradict_at_rest(item, views, params) for item in memory.perception.local_map.landmarks)
    return with_landmarks(memory, landmarks)


class ViewAtRest(NamedTuple):
    """The middle of a sensor's cone, and up to which distance [m] nothing is in it; below zero: not known."""

    sensor: SensorPose
    limit: float = -1.0


def _view_at_rest(number: int, memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> ViewAtRest:
    """Return what the newest reading of a sensor says of the middle of its cone."""
    sensors = params.car.ultrasonic
    reading = memory.perception.cycle.readings[number]
    is_known = reading_status(reading, sensors) in (ReadingStatus.ECHO, ReadingStatus.NO_ECHO)
    middle = sensor_pose(sensors.mounts[number], 0.5 * sensors.half_angle, inputs.odometry)
    return ViewAtRest(middle, reading - params.monitor.unexplained if is_known else -1.0)


def _without_passed(echo: EchoObstacle, view: ViewAtRest) -> EchoObstacle:
    """Return the echo of a sensor unless it measures through its place now."""
    is_passed = echo.is_present and planar_distance(echo.x, echo.y, view.sensor.x, view.sensor.y) < view.limit
    return EchoObstacle() if is_passed else echo


def _contradict_at_rest(landmark: Landmark, views: tuple[ViewAtRest, ...], params: ParkingParams) -> Landmark:
    """Return a landmark after the readings of all sensors; none after enough that measured through it."""
    for view in views:
        if landmark.type != LandmarkType.NONE and predict_range(view.sensor, landmark).distance <= view.limit:
            count = landmark.contradictions + 1
            landmark = Landmark() if count >= params.mapping.contradictions else landmark._replace(contradictions=count)
    return landmark


def continue_plan(
    work: PlanningWork, memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams
) -> ParkingMemory:
    """Return the memory after some steps of the path search; the vehicle stands.

    Into a slot it may take a quarter of ``plan.max_steps`` (15 s): 100 runs of ``apa-world`` end as with all of them.
    """
    if abs(inputs.measured_speed) > params.threshold.standstill or memory.plan.is_found:
        return memory
    if memory.plan.failure != Reason.NONE:
        return wait_for_change(memory, inputs, params)
    if memory.plan.steps == 0:
        memory = _with_request(memory, inputs, params)
        if memory.plan.is_final or memory.plan.is_found:
            return memory
    plan = memory.plan
    search_until(work, plan.obstacles, params.map, plan.request, plan.steps)
    count = continue_search(work, plan.request, params.plan.steps_per_sample)
    memory = memory._replace(plan=plan._replace(steps=count))
    status = search_status(work)
    most = params.plan.max_steps // 4 if memory.strategy == Strategy.SLOT else params.plan.max_steps
    if status == PlanningStatus.PLANNING and count <= most:
        return memory
    if status == PlanningStatus.PLANNED:
        path = without_short_end(path_of_plan(work, plan.request))
        if path.margin >= params.plan.min_margin:
            context = FollowingContext(params.car, params.drive)
            progress = begin_path(memory.progress, path, plan.request.start, context)
            return memory._replace(progress=progress, plan=memory.plan._replace(is_found=True))
    elif plan.request.run_in != 0.0:
        return memory._replace(plan=plan._replace(request=plan.request._replace(run_in=0.0), steps=1))
    is_blocked = status in (PlanningStatus.GOAL_BLOCKED, PlanningStatus.START_BLOCKED)
    is_blocked = is_blocked or any(echo.is_present and echo.is_unexplained for echo in memory.perception.echoes)
    reason = Reason.BLOCKED if is_blocked else Reason.NO_PATH
    reason = Reason.BAD_PARAMETER if status == PlanningStatus.TOO_MANY_EDGES else reason
    return without_path(memory, reason, inputs, params)


def without_path(
    memory: ParkingMemory, reason: int, inputs: ParkingSystemInput, params: ParkingParams
) -> ParkingMemory:
    """Return the memory after a plan failed: a vehicle that stands in its slot stays there, else for ``reason``."""
    if memory.progress.manoeuvres > 0 and is_acceptable(memory, inputs.odometry, True, params):
        return memory._replace(plan=memory.plan._replace(is_final=True))
    if memory.progress.direction != 0.0 and reason != Reason.LEFT_PATH:
        return memory._replace(plan=memory.plan._replace(failure=reason, failed_at=memory.perception.time))
    return memory._replace(reason=reason)


def is_acceptable(memory: ParkingMemory, pose: Pose, is_final: bool, params: ParkingParams) -> bool:
    """Return whether a vehicle at ``pose`` has arrived, if not as finely as was meant.

    Where no path leads nearer (``is_final``) the best estimate of the slot decides, however uncertain it is.
    """
    if memory.strategy != Strategy.SLOT:
        accepted = params.final.accepted
        return is_near(pose, memory.plan.request.goal, accepted, accepted, params.final.accepted_heading)
    confidence = 0.0 if is_final else params.slot.confidence
    return stands_in_slot(slot_in_map(memory, pose, params), pose, confidence, params)


def is_near(pose: Pose, goal: Pose, along: float, across: float, heading: float) -> bool:
    """Return whether a pose is within ``along`` and ``across`` [m], and ``heading`` [rad], of a goal."""
    error = pose_to_frame(pose, goal)
    return abs(error.x) < along and abs(error.y) < across and abs(wrap_angle(error.heading)) < heading


def slot_in_map(memory: ParkingMemory, pose: Pose, params: ParkingParams) -> SlotCandidate:
    """Return the slot as a vehicle at ``pose`` knows it now: by all echoes of it, and by what else is mapped in it."""
    outline = vehicle_outline(params.car, params.plan.curvature_fraction)
    landmarks = without_driven_over(memory.perception.local_map.landmarks, pose, outline)
    by_echoes = slot_of_filter(memory.search.slot, memory.search.slot_filter, outline)
    return correct_slot(by_echoes, landmarks, outline, least_depth(by_echoes, outline, params.slot), params.mapping)


def stands_in_slot(slot: SlotCandidate, pose: Pose, confidence: float, params: ParkingParams) -> bool:
    """Return whether a vehicle at ``pose`` is parked, by ``confidence`` standard deviations [1] of its slot.

    Beside a kerb, too, it is so by where it stands beside its neighbours. Where the kerb leaves no pose that is surer
    the intended one counts.
    """
    outline = vehicle_outline(params.car, params.plan.curvature_fraction)
    limits = params.slot._replace(confidence=confidence)
    room = 0.5 * (slot.ahead.start - slot.behind.end)
    along = params.final.accepted
    sigma = slot.middle_sigma
    flush = slot
    intended = 0.0
    if slot.type == SlotType.PARALLEL:
        along = max(along, room - outline.half_length)
        sigma = slot.front_sigma
        flush = slot._replace(depth=UNKNOWN_DEPTH)
        intended = abs(kerb_shift(slot, outline, limits)) + abs(params.drive.rolling_offset)
    across = max(params.final.accepted - confidence * sigma, min(intended, params.final.accepted))
    turn = params.final.accepted_heading - confidence * slot.row.heading_sigma
    overhang = overhang_of(slot, outline, pose)
    most = most_overhang(slot, outline, limits)
    beside = slot.depth - 2.0 * outline.half_width + overhang
    is_at_goal = is_near(pose, goal_pose(slot, outline, limits), along, params.final.position, turn)
    if slot.type == SlotType.PARALLEL and (is_at_goal or limits.kerb_min < beside < limits.kerb_max):
        across = max(across, most)
    return is_near(pose, goal_pose(flush, outline, limits), along, across, turn) and overhang < most


def max_manoeuvres(memory: ParkingMemory, params: ParkingParams) -> int:
    """Return how many manoeuvres are allowed: into a slot those of GB/T 41630, one less if it is perpendicular."""
    if memory.strategy != Strategy.SLOT:
        return params.plan.max_manoeuvres
    return params.limit.manoeuvres - (1 if memory.search.slot.type == SlotType.PERPENDICULAR else 0)


def _with_request(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> ParkingMemory:
    """Return the memory with the request for a path from here into the slot as it is known now."""
    pose = inputs.odometry
    outline = vehicle_outline(params.car, params.plan.curvature_fraction)
    landmarks = without_driven_over(memory.perception.local_map.landmarks, pose, outline)
    memory = with_landmarks(memory, landmarks)
    if memory.strategy != Strategy.SLOT:
        return _with_pose_request(memory, inputs, params)
    slot = slot_in_map(memory, pose, params)
    is_too_shallow = slot.depth < least_depth(slot, outline, params.slot) and log_likelihood_ratio(slot) > -LOG_TEN
    if is_too_shallow:
        memory = memory._replace(search=with_slot_type(memory.search, True, params))
        slot = slot_in_map(memory, pose, params)
    beside = tuple(away_from_vehicle(landmark, outline, pose) for landmark in landmarks)
    mapped = obstacle_map(beside, slot, outline, pose, _free_road(memory, params), params.mapping)
    memory = _with_plan(memory, mapped, goal_pose(slot, outline, params.slot), inputs, params)
    least = least_depth(slot, outline, params.slot)
    if slot.depth < least:
        known = slot_of_filter(memory.search.slot, memory.search.slot_filter, outline).depth
        reason = Reason.SLOT_TOO_SHALLOW if known < least else Reason.BLOCKED
        memory = without_path(memory, reason, inputs, params)
    return memory


def _with_pose_request(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> ParkingMemory:
    """Return the memory with the request for a path to a known goal, among the known polygons and what is not there."""
    pose = inputs.odometry
    outline = vehicle_outline(params.car, params.plan.curvature_fraction)
    landmarks = tuple(
        Landmark() if is_on_map(item, params.map, params.monitor.unexplained) else item
        for item in memory.perception.local_map.landmarks
    )
    beside = tuple(away_from_vehicle(item, outline, pose) for item in landmarks)
    local = obstacle_map(beside, SlotCandidate(), outline, pose, Point(0.0, 0.0), params.mapping)
    if memory.strategy == Strategy.PULL_OUT:
        return _with_plan(memory, local, memory.plan.way_out, inputs, params)
    goal = params.target
    if inputs.external_slot.kind != SlotKind.NONE:
        goal = external_pose(inputs.external_slot, outline, pose)
    if not is_usable_slot(inputs.external_slot):
        return memory._replace(reason=Reason.BAD_INPUT)
    final = params.final
    is_there = is_near(pose, goal, final.position, final.position, final.heading)
    memory = _with_plan(memory, local, goal, inputs, params)
    return memory._replace(plan=memory.plan._replace(is_final=True)) if is_there else memory


def with_way_out(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> ParkingMemory:
    """Return the memory of a vehicle that is to pull out, with its neighbours in the map as they are measured."""
    pose = inputs.odometry
    side = road_side(inputs.driver_selection.side)
    box = free_box(memory.perception.cycle.readings, params.car)
    before = memory.perception.local_map.landmarks
    memory = with_landmarks(memory, with_neighbours(before, box, side, pose, params.car, params.mapping))
    goal = pose_on_road(box, side, pose, vehicle_outline(params.car, params.plan.curvature_fraction))
    memory = memory._replace(strategy=Strategy.PULL_OUT, search=SearchProgress(pose=pose, stand=pose))
    return memory._replace(plan=memory.plan._replace(way_out=goal))


def _with_plan(
    memory: ParkingMemory, mapped: ObstacleMap, goal: Pose, inputs: ParkingSystemInput, params: ParkingParams
) -> ParkingMemory:
    """Return the memory with a request for a path to ``goal``; after ``max_plans`` there is one a manoeuvre.

    A path may change its direction once less than manoeuvres are allowed: to set out in reverse is one by itself. Into
    a slot found across the road it ends straight, if it can: the wheel turns from full lock about where that begins.
    What the sensors measure now of what is ``mapped`` is kept clear of, too: the monitor may not let it nearer.
    """
    outline = vehicle_outline(params.car, params.plan.curvature_fraction)
    present = tuple(echo_away_from_vehicle(echo, outline, inputs.odometry) for echo in memory.perception.echoes)
    obstacles = with_echoes(mapped, present)
    cusps = max(max_manoeuvres(memory, params) - memory.progress.manoeuvres - 1, 0)
    has_map = memory.strategy == Strategy.POSE
    run_in = 0.0
    if memory.search.slot_filter.is_begun and memory.search.slot.type == SlotType.PERPENDICULAR:
        turning_time = params.car.steering.angle_limit / params.car.steering.rate_limit
        run_in = (0.5 if memory.search.slot.is_nose_in else -0.5) * params.drive.speed * turning_time
    request = PlanningRequest(inputs.odometry, goal, outline, params.plan.margin, cusps, has_map, run_in)
    memory = memory._replace(
        plan=memory.plan._replace(request=request, obstacles=obstacles, plans=memory.plan.plans + 1)
    )
    if memory.plan.plans > max(params.plan.max_plans, memory.progress.manoeuvres):
        return without_path(memory, Reason.LEFT_PATH, inputs, params)
    return memory


def without_driven_over(landmarks: tuple[Landmark, ...], pose: Pose, outline: VehicleOutline) -> tuple[Landmark, ...]:
    """Return the landmarks without those that the outline at ``pose`` touches: the vehicle stands there."""
    return tuple(
        Landmark() if item.type != LandmarkType.NONE and landmark_distance(item, pose, outline) <= 0.0 else item
        for item in landmarks
    )


def _free_road(memory: ParkingMemory, params: ParkingParams) -> Point:
    """Return how far the road is taken to be free in the row's frame: x ahead, y on its other side."""
    search = memory.search
    car = params.car
    slot = search.slot
    at = point_to_frame(search.pose.x, search.pose.y, slot.row.frame)
    reach = car.ultrasonic.max_range
    ahead = car.wheelbase + car.front_overhang + reach
    across = (0.5 * car.width + reach) * math.sqrt(1.0 + slot.row.slope * slot.row.slope)
    return Point(at.x + ahead, slot.row.side * (at.y + slot.row.slope * ahead) - across)
