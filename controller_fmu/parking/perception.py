"""One sample of perception: the map, the slot search on it, and echoes that the planned obstacles do not explain."""

import math

from controller_fmu.common.driver_selection import MAX_OFFERS, ChosenSide, DriverSelection
from controller_fmu.common.external_slot import SlotKind
from controller_fmu.interface import Reason
from controller_fmu.parking.chart import ParkingState
from controller_fmu.parking.geometry.frames import planar_distance, point_to_frame, pose_from_frame, pose_to_frame
from controller_fmu.parking.geometry.outline import vehicle_outline
from controller_fmu.parking.map.chain_update import put_facing
from controller_fmu.parking.map.facing_surface import FACING_ECHOES, MAX_FACING_RANGE, facing_segment, point_between
from controller_fmu.parking.map.free_space import path_curvature
from controller_fmu.parking.map.local_map import range_by_map, update_map, with_post
from controller_fmu.parking.measurement.cycle import next_cycle, seconds
from controller_fmu.parking.measurement.predicted_range import (
    EchoOrigin,
    EchoSurface,
    PredictedRange,
    direction_of,
    range_to_polygons,
)
from controller_fmu.parking.measurement.sensor import (
    FRONT_LEFT_SIDE,
    FRONT_MIDDLE,
    MAX_SENSORS,
    REAR_MIDDLE,
    ReadingStatus,
    measurement_of,
    range_variance,
    sensor_pose,
)
from controller_fmu.parking.measurement.silent_sensor import is_silent
from controller_fmu.parking.monitor.collision_monitor import EchoObstacle
from controller_fmu.parking.monitor.params import MonitorParams
from controller_fmu.parking.objects.track import (
    ObjectTrack,
    closing_speed,
    is_yielded_to,
    range_in_blind_zone,
    static_approach,
    update_track,
    with_approach,
    with_expectation,
)
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.signals import ParkingSystemInput
from controller_fmu.parking.slots.angled_row import find_angled_row
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType, find_slot, middle_of, row_point
from controller_fmu.parking.slots.external import external_candidate, has_passed_external
from controller_fmu.parking.slots.row import RoadBend, find_row
from controller_fmu.parking.slots.slot_filter import (
    SlotFilter,
    count_absent,
    is_slot_corner,
    predict_slot,
    slot_frame,
    update_slot,
)
from controller_fmu.parking.state import ParkingMemory, Perception, SearchProgress, with_landmarks
from modelkit.car import car_length
from modelkit.vocabulary import Pose

YIELD_TIME = 3.0
"""The vehicle stands for this long [s] after it last had to yield: a pedestrian of 0.6 m/s passes it in that time."""
MAX_MONITORED_RANGE = 1.5
"""Echoes farther [m] than this are not monitored: twice the stopping distance from top speed with a slow brake."""
MAX_DISPLACEMENT = 0.06
"""Ranges that differ by more than this [m] from the predicted ones move a surface: three standard deviations of two
centimetres."""
HALF_SENSOR_SPACING = 0.25
"""Half of the distance [m] of the two middle sensors of a bumper, at y = +-0.25 m (``modelkit.car``)."""
BUMPER_PAIRS = (0, FRONT_MIDDLE, 2, 4, REAR_MIDDLE, 6)
"""The first of two sensors that sit beside each other in a bumper."""
MAX_REST = 0.3
"""What moves more slowly [m/s] stands: people walk at 0.5 m/s and more."""
ABSENT_ECHOES = 10
"""Measurements in a row through both neighbours: a working sensor loses so many echoes once in 1e13 times."""
SAME_GAP = 0.5
"""Two gaps whose corners lie nearer than this [m] are one: sides end within 0.3 m, odometry drifts by less."""


def perceive(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams, dt_ns: int) -> ParkingMemory:
    """Return the memory with perception ``dt_ns`` later; while driving, echoes are compared with planned obstacles."""
    time = memory.perception.time + dt_ns
    cycle = next_cycle(memory.perception.cycle, inputs.ultrasonic, time, dt_ns, params.car.ultrasonic.cycle)
    memory = memory._replace(perception=memory.perception._replace(cycle=cycle, time=time))
    if not cycle.is_new:
        return memory
    memory = memory._replace(perception=memory.perception._replace(yields=max(memory.perception.yields - 1, 0)))
    if is_driving_state(memory.state):
        tracks = tuple(_track(memory, number, inputs, params) for number in range(MAX_SENSORS))
        slot_filter = _update_slot_filter(memory, inputs, params)
        memory = _with_path_moved(memory, slot_filter)
        memory = memory._replace(search=memory.search._replace(slot_filter=slot_filter))
        memory = memory._replace(search=with_slot_type(memory.search, False, params))
        memory = memory._replace(perception=memory.perception._replace(tracks=tracks))
    memory = memory._replace(perception=_with_measurements(memory.perception, inputs, params))
    return _with_obstacles(memory, inputs, params) if is_driving_state(memory.state) else memory


def _with_measurements(perception: Perception, inputs: ParkingSystemInput, params: ParkingParams) -> Perception:
    """Return perception with the map after a measurement cycle."""
    readings = perception.cycle.readings
    sensors = params.car.ultrasonic
    return perception._replace(
        local_map=update_map(perception.local_map, readings, inputs.odometry, sensors, params.mapping)
    )


def _update_slot_filter(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> SlotFilter:
    """Return what is known of the slot after a measurement cycle, as the vehicle enters it."""
    search = memory.search
    before = memory.perception.local_map.pose
    sensors = params.car.ultrasonic
    driven = planar_distance(inputs.odometry.x, inputs.odometry.y, before.x, before.y)
    if not search.slot_filter.is_begun or driven <= 0.0:
        return search.slot_filter
    slot_filter = predict_slot(search.slot_filter, before, inputs.odometry, params.mapping)
    readings = memory.perception.cycle.readings
    for number in range(MAX_SENSORS):
        found = measurement_of(number, readings[number], inputs.odometry, sensors, params.mapping.range_noise)
        if found.status == ReadingStatus.ECHO:
            slot_filter = update_slot(slot_filter, search.slot, found, params.mapping.gate)
        is_silent_one = is_silent(memory.perception.local_map.missed, number)
        if found.status in (ReadingStatus.ECHO, ReadingStatus.NO_ECHO) and not is_silent_one:
            slot_filter = count_absent(slot_filter, search.slot, found)
    return slot_filter


def _with_path_moved(memory: ParkingMemory, slot_filter: SlotFilter) -> ParkingMemory:
    """Return the memory whose path and goal have moved with the slot, as ``slot_filter`` knows that now."""
    search = memory.search
    if not slot_filter.is_begun:
        return memory
    before = slot_frame(search.slot, search.slot_filter)
    after = slot_frame(search.slot, slot_filter)
    begin = pose_from_frame(pose_to_frame(memory.progress.begin, before), after)
    goal = pose_from_frame(pose_to_frame(memory.plan.request.goal, before), after)
    plan = memory.plan
    return memory._replace(
        progress=memory.progress._replace(begin=begin), plan=plan._replace(request=plan.request._replace(goal=goal))
    )


def with_slot_type(search: SearchProgress, is_too_shallow: bool, params: ParkingParams) -> SearchProgress:
    """Return the search with a slot along the road that was taken for one across it.

    For that it is too shallow, or it lies between cars not so deep. In a gap too short to park along the vehicle stands
    across the road whatever its neighbours are.
    """
    slot = search.slot
    is_inferred = params.slot.wanted == SlotKind.NONE and not slot.is_external and slot.row.slope == 0.0
    is_wide = slot.ahead.start - slot.behind.end >= car_length(params.car) + params.slot.room_along
    if not is_inferred or not is_wide or not (is_too_shallow or search.slot_filter.absent >= ABSENT_ECHOES):
        return search
    return search._replace(slot=slot._replace(type=SlotType.PARALLEL, is_nose_in=False))


def _with_obstacles(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> ParkingMemory:
    """Return the memory with the echoes that the monitor respects, and surfaces before the bumpers, by the tracks."""
    echoes = tuple(
        echo_obstacle(memory.perception.tracks[number], number, inputs, params) for number in range(MAX_SENSORS)
    )
    stands = any(is_yielded_to(track) for track in memory.perception.tracks)
    yields = math.floor(YIELD_TIME / params.car.ultrasonic.cycle) if stands else memory.perception.yields
    memory = memory._replace(perception=memory.perception._replace(echoes=echoes, yields=yields))
    return _with_bumper_pairs(memory, inputs, params)


def _with_bumper_pairs(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> ParkingMemory:
    """Return the memory with what two sensors of a bumper beside each other measure elsewhere than map and plan.

    Both in the middle measure a surface at rest. One of them and the outer one, which looks aside, measure a post: it
    may come between their cones later. Into a slot across the road the bumper passes its corners, which are neither.
    """
    sensors = params.car.ultrasonic
    variance = range_variance(params.mapping.range_noise, sensors.resolution)
    moves = abs(inputs.measured_speed) > params.threshold.standstill
    for number in BUMPER_PAIRS:
        a = memory.perception.tracks[number]
        b = memory.perception.tracks[number + 1]
        nearer = a.expected - a.range
        nearer_b = b.expected - b.range
        is_middle = number == FRONT_MIDDLE or number == REAR_MIDDLE
        if is_middle:
            counts = min(abs(nearer), abs(nearer_b)) > MAX_DISPLACEMENT and is_at_rest(a) and is_at_rest(b)
        else:
            counts = moves and max(nearer, nearer_b) > MAX_DISPLACEMENT and min(a.range, b.range) > 0.0
        if counts and a.missed == 0 and b.missed == 0 and max(a.range, b.range) < MAX_FACING_RANGE:
            first = sensor_pose(sensors.mounts[number], sensors.half_angle, inputs.odometry)
            second = sensor_pose(sensors.mounts[number + 1], sensors.half_angle, inputs.odometry)
            at = point_between(first, a.range, second, b.range)
            is_across = memory.search.slot.type == SlotType.PERPENDICULAR
            is_corner = is_across and is_slot_corner(memory.search.slot_filter, at)
            if not is_corner and is_middle:
                new = facing_segment(first, a.range, second, b.range, variance)
                landmarks = put_facing(memory.perception.local_map.landmarks, new, params.mapping)
                memory = with_landmarks(memory, landmarks)
            elif not is_corner:
                memory = memory._replace(
                    perception=memory.perception._replace(
                        local_map=with_post(memory.perception.local_map, first, second, at, variance, params.mapping)
                    )
                )
    return memory


def is_at_rest(track: ObjectTrack) -> bool:
    """Return whether a track is confirmed by enough echoes, and its object stands."""
    return track.confirmations >= FACING_ECHOES and abs(track.rate) < MAX_REST


def _track(memory: ParkingMemory, number: int, inputs: ParkingSystemInput, params: ParkingParams) -> ObjectTrack:
    """Return the track of one sensor after its reading."""
    perception = memory.perception
    sensors = params.car.ultrasonic
    reading = perception.cycle.readings[number]
    found = measurement_of(number, reading, inputs.odometry, sensors, params.mapping.range_noise)
    sensor = found.sensor
    before = sensor_pose(sensors.mounts[number], sensors.half_angle, perception.local_map.pose)
    approach = (sensor.x - before.x) * sensor.axis_x + (sensor.y - before.y) * sensor.axis_y
    is_echo = found.status in (ReadingStatus.ECHO, ReadingStatus.BLIND_ZONE)
    before_track = perception.tracks[number]
    measured = reading
    if found.status == ReadingStatus.BLIND_ZONE and before_track.confirmations > 0:
        measured = range_in_blind_zone(before_track, approach, reading)
    track = update_track(before_track, is_echo, measured, approach, found.variance, sensors.cycle)
    if abs(inputs.measured_speed) <= params.threshold.standstill or before_track.unexplained > 0:
        track = with_approach(before_track, track, static_approach(before, sensor))
    if not is_echo or measured >= MAX_MONITORED_RANGE:
        return track._replace(unexplained=max(track.unexplained - 1, 0))
    planned = range_to_polygons(sensor, memory.plan.obstacles.vertices, sensors.max_range)
    if memory.plan.request.has_map:
        mapped = range_to_polygons(sensor, params.map, sensors.max_range)
        planned = mapped if mapped.distance < planned.distance else planned
    tolerance = params.monitor.unexplained
    expected = range_by_map(perception.local_map.landmarks, sensor, planned, measured - tolerance, params.mapping)
    unexplained = measured < expected.distance - tolerance
    towards = direction_of(expected, sensor)
    surface = surface_near(expected, measured, params.monitor)
    return with_expectation(track, expected.distance, towards.x, towards.y, surface, unexplained)


def surface_near(expected: PredictedRange, measured: float, params: MonitorParams) -> EchoSurface:
    """Return the side that an echo at ``measured`` [m] came from, as far as half way to the next sensor.

    A farther echo shows that no side is where one was expected, a nearer one that it is displaced; an end has no side.
    """
    is_side = expected.origin in (EchoOrigin.INTERIOR, EchoOrigin.CONE_EDGE)
    nearer = expected.distance - measured
    if not is_side or nearer > params.unexplained or nearer < -MAX_DISPLACEMENT:
        return EchoSurface()
    side = expected.surface
    return side._replace(low=max(side.low, -HALF_SENSOR_SPACING), high=min(side.high, HALF_SENSOR_SPACING))


def echo_obstacle(track: ObjectTrack, number: int, inputs: ParkingSystemInput, params: ParkingParams) -> EchoObstacle:
    """Return what the monitor must keep clear of, from the track of one sensor.

    An echo nearer than that of the corner that is expected may come from anywhere in the cone: it is the chord of it.
    Where none was expected yet its direction is not known: it was beyond the range of those monitored.
    """
    sensors = params.car.ultrasonic
    sensor = sensor_pose(sensors.mounts[number], sensors.half_angle, inputs.odometry)
    distance = max(track.range, 0.0)
    unknown = track.unexplained > 0
    surface = EchoSurface() if unknown else track.surface
    is_nearer = track.missed == 0 and track.expected - track.range > MAX_DISPLACEMENT
    is_anywhere = not unknown and is_nearer and surface.low == surface.high
    if is_anywhere:
        half = distance * sensor.cone_sin
        surface = EchoSurface(-sensor.axis_y, sensor.axis_x, -half, half)
        distance = distance * sensor.cone_cos
    ux = sensor.axis_x if unknown or is_anywhere else track.ux
    uy = sensor.axis_y if unknown or is_anywhere else track.uy
    return EchoObstacle(
        sensor.x + distance * ux,
        sensor.y + distance * uy,
        closing_speed(track),
        track.confirmations > 0 and track.expected > 0.0 and track.range < MAX_MONITORED_RANGE,
        unknown,
        ux,
        uy,
        distance,
        surface,
    )


def search_slots(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams, dt_ns: int) -> ParkingMemory:
    """Return the memory after a sample of the slot search; a slot found stays until a better estimate replaces it."""
    stands = abs(inputs.measured_speed) <= params.threshold.standstill
    distance = memory.search.distance + abs(inputs.measured_speed) * dt_ns * 1e-9
    if memory.perception.cycle.is_new:
        search = memory.search
        if inputs.external_slot.kind != SlotKind.NONE:
            search = _with_external(memory, inputs, params)
        else:
            search = _with_side(search, memory, 1.0, params)
            search = _with_side(search, memory, -1.0, params)
            number = number_of_choice(search.offered, inputs.driver_selection)
            search = search._replace(slot=search.offered[number - 1] if number > 0 else SlotCandidate(), shown=number)
        memory = memory._replace(search=search)
    waited = memory.search.waited + dt_ns if stands and memory.search.slot.type == SlotType.NONE else 0
    is_fast = abs(inputs.measured_speed) > params.slot.speed
    return memory._replace(search=memory.search._replace(distance=distance, waited=waited, is_fast=is_fast))


def _with_side(search: SearchProgress, memory: ParkingMemory, side: float, params: ParkingParams) -> SearchProgress:
    """Return the search with the slot on one side (1 left, -1 right) that the vehicle's front has passed, if any.

    It has passed the car ahead only where that would come as near to the path as the one behind does: what is seen of
    an oblique flank may end farther in. If the slot is rejected, a slot found before that overlaps it is none, either.
    """
    local_map = memory.perception.local_map
    rays = local_map.free_space.left if side > 0.0 else local_map.free_space.right
    row = find_angled_row(local_map.landmarks, rays, local_map.pose, side, params.mapping)
    if row.used == 0:
        bend = _bend(search, path_curvature(rays), local_map.pose, side)
        row = find_row(local_map.landmarks, local_map.pose, side, bend, params.mapping)
    outline = vehicle_outline(params.car, params.plan.curvature_fraction)
    found = find_slot(row, local_map.landmarks, rays, outline, params.slot, params.mapping)
    turn = found.row.frame.heading - local_map.pose.heading
    beside = found.behind.end_front - side * math.tan(turn) * (found.ahead.start - found.behind.end)
    corner = row_point(found.row, found.ahead.start, min(found.ahead.start_front, beside))
    ahead = point_to_frame(corner.x, corner.y, local_map.pose).x
    if found.type == SlotType.NONE or ahead >= params.car.wheelbase + params.car.front_overhang:
        return search
    if found.reason != Reason.NONE:
        offered = tuple(SlotCandidate() if is_overlapping(slot, found) else slot for slot in search.offered)
        return search._replace(offered=offered, rejected=found.reason, missing=found.missing)
    if is_same_gap(found, search.refused):
        return search
    return search._replace(offered=with_offer(search.offered, found))


def _bend(search: SearchProgress, curvature: float, vehicle: Pose, side: float) -> RoadBend:
    """Return the bend of a row beside a path of ``curvature`` [1/m], at the slot found last on this side, if any."""
    for slot in search.offered:
        if slot.type != SlotType.NONE and slot.row.side == side:
            middle = row_point(slot.row, middle_of(slot), slot.front)
            at = point_to_frame(middle.x, middle.y, vehicle)
            return RoadBend(curvature / (1.0 - curvature * at.y), at.x)
    return RoadBend(curvature)


def _with_external(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams) -> SearchProgress:
    """Return the search with the external slot, once the side sensors have passed it, or why it is rejected."""
    search = memory.search
    outline = vehicle_outline(params.car, params.plan.curvature_fraction)
    landmarks = memory.perception.local_map.landmarks
    found = external_candidate(inputs.external_slot, inputs.odometry, landmarks, outline, params.slot, params.mapping)
    sensor_x = params.car.ultrasonic.mounts[FRONT_LEFT_SIDE].x
    if found.type != SlotType.NONE and not has_passed_external(found, sensor_x, inputs.odometry):
        return search
    if found.reason != Reason.NONE:
        return search._replace(slot=SlotCandidate(), rejected=found.reason)
    return search._replace(slot=found, offered=with_offer((SlotCandidate(),) * MAX_OFFERS, found), shown=1)


def with_offer(offered: tuple[SlotCandidate, ...], found: SlotCandidate) -> tuple[SlotCandidate, ...]:
    """Return the slots that the driver may choose, the newest first; a better estimate replaces the one before."""
    for number in range(MAX_OFFERS):
        if is_overlapping(offered[number], found):
            return tuple(found if place == number else offered[place] for place in range(MAX_OFFERS))
    return (found,) + offered[: MAX_OFFERS - 1]


def number_of_choice(offered: tuple[SlotCandidate, ...], selection: DriverSelection) -> int:
    """Return the number, from 1, of the slot that the driver means: the newest on the side chosen; 0: none."""
    if selection.slot > 0:
        slot = offered[min(selection.slot, MAX_OFFERS) - 1]
        return selection.slot if selection.slot <= MAX_OFFERS and _is_meant(slot, selection.side) else 0
    for number in range(MAX_OFFERS):
        if _is_meant(offered[number], selection.side):
            return number + 1
    return 0


def _is_meant(slot: SlotCandidate, side: int) -> bool:
    """Return whether there is a slot, on the side of the road that the driver chose."""
    if slot.type == SlotType.NONE:
        return False
    return side == ChosenSide.ANY or (side == ChosenSide.LEFT) == (slot.row.side > 0.0)


def is_overlapping(slot: SlotCandidate, found: SlotCandidate) -> bool:
    """Return whether the middle of a slot found before lies in a gap found now, on the same side of the road."""
    if slot.type == SlotType.NONE or slot.row.side != found.row.side:
        return False
    middle = row_point(slot.row, middle_of(slot), slot.front)
    at = point_to_frame(middle.x, middle.y, found.row.frame)
    return found.behind.end < at.x < found.ahead.start


def is_same_gap(found: SlotCandidate, refused: SlotCandidate) -> bool:
    """Return whether a slot is the one refused, by where its neighbours are."""
    if refused.type == SlotType.NONE:
        return False
    a = row_point(found.row, found.behind.end, found.front)
    b = row_point(found.row, found.ahead.start, found.front)
    p = row_point(refused.row, refused.behind.end, refused.front)
    q = row_point(refused.row, refused.ahead.start, refused.front)
    return planar_distance(a.x, a.y, p.x, p.y) < SAME_GAP and planar_distance(b.x, b.y, q.x, q.y) < SAME_GAP


def search_reason(search: SearchProgress, is_external: bool, params: ParkingParams) -> int:
    """Return why a search ends without a slot, ``NONE`` while it goes on; an external slot is the only one."""
    if is_external and search.rejected != Reason.NONE:
        return search.rejected
    if search.distance > params.slot.distance and search.slot.type == SlotType.NONE:
        return search.rejected if search.rejected != Reason.NONE else Reason.NO_SLOT
    return Reason.NOT_MOVING if seconds(search.waited) > params.slot.confirm_time else Reason.NONE


def is_driving_state(state: int) -> bool:
    """Return whether the system drives, or is about to."""
    return state in (ParkingState.STEERING, ParkingState.DRIVING, ParkingState.STOPPING)
