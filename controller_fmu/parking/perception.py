"""One sample of perception: the map, the slot search on it, and echoes that the planned obstacles do not explain."""

import math

from controller_fmu.interface import Reason
from controller_fmu.parking.chart import ParkingState
from controller_fmu.parking.geometry.outline import vehicle_outline
from controller_fmu.parking.geometry.polygons import ObstacleMap
from controller_fmu.parking.map.local_map import expected_range, update_map
from controller_fmu.parking.measurement.cycle import next_cycle
from controller_fmu.parking.measurement.sensor import (
    SENSORS,
    ReadingStatus,
    range_variance,
    reading_status,
    sensor_pose,
)
from controller_fmu.parking.monitor.collision_monitor import EchoObstacle
from controller_fmu.parking.monitor.expected_range import range_in_map
from controller_fmu.parking.objects.track import ObjectTrack, closing_speed, update_track
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.signals import ParkingSystemInput
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType, find_slot
from controller_fmu.parking.slots.row import find_row
from controller_fmu.parking.state import ParkingMemory, Perception, SearchProgress

MAX_MONITORED_RANGE = 1.5
"""Echoes farther [m] than this are left to later: twice the stopping distance from top speed with a slow brake."""


def perceive(
    perception: Perception,
    is_driving: bool,
    obstacles: ObstacleMap,
    inputs: ParkingSystemInput,
    params: ParkingParams,
    dt_ns: int,
) -> Perception:
    """Return perception ``dt_ns`` later; while driving each echo is compared with the planned obstacles."""
    sensors = params.car.ultrasonic
    time = perception.time + dt_ns
    cycle = next_cycle(perception.cycle, inputs.ultrasonic, time, dt_ns, sensors.cycle)
    perception = perception._replace(cycle=cycle, time=time)
    if not cycle.is_new:
        return perception
    local_map = update_map(perception.local_map, cycle.readings, inputs.odometry, sensors, params.mapping)
    if is_driving:
        tracks = tuple(_track(perception, number, obstacles, inputs, params) for number in range(SENSORS))
        echoes = tuple(_echo_obstacle(tracks[number], number, inputs, params) for number in range(SENSORS))
        perception = perception._replace(tracks=tracks, echoes=echoes)
    return perception._replace(local_map=local_map, pose=inputs.odometry)


def _track(
    perception: Perception, number: int, obstacles: ObstacleMap, inputs: ParkingSystemInput, params: ParkingParams
) -> ObjectTrack:
    """Return the track of one sensor after its reading."""
    sensors = params.car.ultrasonic
    reading = perception.cycle.readings[number]
    status = reading_status(reading, sensors)
    sensor = sensor_pose(sensors.mounts[number], sensors.half_angle, inputs.odometry)
    before = sensor_pose(sensors.mounts[number], sensors.half_angle, perception.pose)
    approach = (sensor.x - before.x) * sensor.axis_x + (sensor.y - before.y) * sensor.axis_y
    is_echo = status in (ReadingStatus.ECHO, ReadingStatus.BLIND_ZONE) and reading < MAX_MONITORED_RANGE
    unexplained = False
    if is_echo:
        planned = range_in_map(sensor, obstacles, sensors.max_range)
        expected = min(planned, expected_range(perception.local_map.landmarks, sensor, planned, params.mapping))
        unexplained = reading < expected - params.monitor.unexplained
    variance = range_variance(params.mapping.range_noise, sensors.resolution)
    return update_track(perception.tracks[number], unexplained, reading, approach, variance, sensors.cycle)


def _echo_obstacle(track: ObjectTrack, number: int, inputs: ParkingSystemInput, params: ParkingParams) -> EchoObstacle:
    """Return what the monitor must keep clear of, from the track of one sensor."""
    sensors = params.car.ultrasonic
    sensor = sensor_pose(sensors.mounts[number], sensors.half_angle, inputs.odometry)
    distance = max(track.range, 0.0)
    return EchoObstacle(
        sensor.x + distance * sensor.axis_x,
        sensor.y + distance * sensor.axis_y,
        closing_speed(track),
        track.confirmations > 0,
    )


def search_slots(memory: ParkingMemory, inputs: ParkingSystemInput, params: ParkingParams, dt_ns: int) -> ParkingMemory:
    """Return the memory after a sample of the slot search; a slot found stays until a better estimate replaces it."""
    search = memory.search
    search = search._replace(distance=search.distance + abs(inputs.measured_speed) * dt_ns * 1e-9)
    if memory.perception.cycle.is_new:
        search = _with_side(search, memory, 1.0, params)
        search = _with_side(search, memory, -1.0, params)
    stands = abs(inputs.measured_speed) <= params.threshold.standstill
    waits = stands and search.slot.type == SlotType.NONE
    return memory._replace(search=search._replace(waited=search.waited + dt_ns if waits else 0))


def _with_side(search: SearchProgress, memory: ParkingMemory, side: float, params: ParkingParams) -> SearchProgress:
    """Return the search with the slot found on one side (1 left, -1 right), or why the one there is rejected."""
    if search.slot.type != SlotType.NONE and search.slot.row.side != side:
        return search
    local_map = memory.perception.local_map
    row = find_row(local_map.landmarks, local_map.pose, side, params.mapping)
    rays = local_map.free_space.left if side > 0.0 else local_map.free_space.right
    outline = vehicle_outline(params.car, params.plan.curvature_fraction)
    found = find_slot(row, local_map.landmarks, rays, outline, params.slot, params.mapping)
    if found.type == SlotType.NONE or not _has_passed(found, params):
        return search
    if found.reason != Reason.NONE:
        return search._replace(rejected=found.reason)
    return search._replace(slot=found)


def _has_passed(slot: SlotCandidate, params: ParkingParams) -> bool:
    """Return whether the vehicle's front has passed the gap; the row's frame is the vehicle's."""
    return slot.ahead.start < params.car.wheelbase + params.car.front_overhang


def search_reason(search: SearchProgress, params: ParkingParams) -> int:
    """Return why a search ends without a slot, ``NONE`` while it goes on."""
    if search.distance > params.slot.distance and search.slot.type == SlotType.NONE:
        return search.rejected if search.rejected != Reason.NONE else Reason.NO_SLOT
    return Reason.NOT_MOVING if search.waited * 1e-9 > params.slot.confirm_time else Reason.NONE


def is_driving_state(state: int) -> bool:
    """Return whether the system drives, or is about to."""
    return state in (ParkingState.STEERING, ParkingState.DRIVING, ParkingState.STOPPING)


def planar_distance(ax: float, ay: float, bx: float, by: float) -> float:
    """Return the distance [m] of two points."""
    return math.sqrt((ax - bx) * (ax - bx) + (ay - by) * (ay - by))
