"""The map of one drive: prediction, association, update, initialisation and deletion at each measurement cycle."""

from typing import NamedTuple

from controller_fmu.parking.geometry.frames import planar_distance
from controller_fmu.parking.map.chain_update import (
    MIN_ECHOES,
    REFIT_ECHOES,
    ChainUpdate,
    chain_ending,
    fit_chain,
    next_chain,
)
from controller_fmu.parking.map.echo_chain import EchoChain, Ending
from controller_fmu.parking.map.free_space import FreeSpace, Ray, is_next_ray
from controller_fmu.parking.map.landmark import MAX_LANDMARKS, Landmark, LandmarkType, free_index
from controller_fmu.parking.map.oblique_side import CONE_BOUNDARIES, ConeBoundaries, index_of_side, update_oblique_sides
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.map.prediction import predict_landmark
from controller_fmu.parking.map.visibility import (
    SIDE_DEVIATION,
    contradict,
    is_contradicted,
    is_in_reach,
    is_permanent,
    may_be_in_view,
    predict_range,
    with_open_ends_extended,
)
from controller_fmu.parking.measurement.predicted_range import PredictedRange
from controller_fmu.parking.measurement.sensor import (
    BUMPER_SENSORS,
    FRONT_LEFT_SIDE,
    FRONT_RIGHT_SIDE,
    MAX_SENSORS,
    Measurement,
    ReadingStatus,
    SensorPose,
    measurement_of,
)
from controller_fmu.parking.measurement.silent_sensor import MissedEchoes, count_missed_echo, is_credible_miss
from modelkit.car import CarUltrasonic
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

CONFIRMING_RANGE = 0.1
"""An echo this near [m] to the predicted one confirms a landmark: the expected echoes that it missed were dropouts."""
SIDE_SENSORS = MAX_SENSORS - BUMPER_SENSORS


class LandmarkMap(NamedTuple):
    """Landmarks, chains of echoes, free space, and the odometry pose of the last cycle."""

    landmarks: tuple[Landmark, ...] = (Landmark(),) * MAX_LANDMARKS
    chains: tuple[EchoChain, ...] = (EchoChain(),) * SIDE_SENSORS
    """Of the sensors on the flanks."""
    boundaries: tuple[ConeBoundaries, ...] = (ConeBoundaries(),) * SIDE_SENSORS
    """Of their cones, where oblique sides are measured."""
    free_space: FreeSpace = FreeSpace()
    missed: MissedEchoes = MissedEchoes()
    pose: Pose = Pose()
    begun: bool = False


def update_map(
    local_map: LandmarkMap, readings: tuple[float, ...], pose: Pose, sensors: CarUltrasonic, params: MappingParams
) -> LandmarkMap:
    """Return the map after one measurement cycle: ``readings`` [m] of all sensors of a vehicle at ``pose``."""
    driven = planar_distance(pose.x, pose.y, local_map.pose.x, local_map.pose.y) if local_map.begun else 0.0
    local_map = local_map._replace(pose=pose, begun=True)
    for number in range(MAX_LANDMARKS):
        if local_map.landmarks[number].type != LandmarkType.NONE:
            after = predict_landmark(local_map.landmarks[number], pose, driven, params)
            local_map = with_landmark(local_map, number, after)
    for number in range(MAX_SENSORS):
        measurement = measurement_of(number, readings[number], pose, sensors, params.range_noise)
        local_map = use_measurement(local_map, measurement, params)
    return local_map


def use_measurement(local_map: LandmarkMap, measurement: Measurement, params: MappingParams) -> LandmarkMap:
    """Return the map after one reading."""
    status = measurement.status
    if measurement.number >= BUMPER_SENSORS:
        local_map = _use_side(local_map, measurement, params)
    if status == ReadingStatus.ECHO or status == ReadingStatus.NO_ECHO:
        local_map = contradict_nearer(local_map, measurement, params)
        local_map = local_map._replace(free_space=_with_ray(local_map.free_space, measurement))
    else:
        missed = count_missed_echo(local_map.missed, measurement.number, status, status == ReadingStatus.INVALID)
        local_map = local_map._replace(missed=missed)
    return _without_deleted(local_map)


def _without_deleted(local_map: LandmarkMap) -> LandmarkMap:
    """Return the map whose chains refer to no deleted landmark: its place may be taken by another one."""
    for number in range(SIDE_SENSORS):
        index = local_map.chains[number].landmark
        if index >= 0 and local_map.landmarks[max(index, 0)].type == LandmarkType.NONE:
            local_map = local_map._replace(
                chains=local_map.chains[:number]
                + (local_map.chains[number]._replace(landmark=-1),)
                + local_map.chains[number + 1 :]
            )
    return local_map


def _with_chain(local_map: LandmarkMap, number: int, chain: EchoChain) -> LandmarkMap:
    """Return the map with the chain of a sensor on a flank replaced."""
    at = min(max(number, 0), SIDE_SENSORS - 1)
    return local_map._replace(chains=local_map.chains[:at] + (chain,) + local_map.chains[at + 1 :])


def _use_side(local_map: LandmarkMap, measurement: Measurement, params: MappingParams) -> LandmarkMap:
    """Return the map after a reading of a sensor on a flank, which passes sides: chains of echoes."""
    at = min(max(measurement.number - BUMPER_SENSORS, 0), SIDE_SENSORS - 1)
    oblique = update_oblique_sides(local_map.boundaries[at], measurement)
    local_map = local_map._replace(
        boundaries=local_map.boundaries[:at] + (oblique.boundaries,) + local_map.boundaries[at + 1 :]
    )
    for boundary in range(CONE_BOUNDARIES):
        index = index_of_side(local_map.landmarks, oblique.passed[boundary], params)
        if index >= 0:
            local_map = with_landmark(local_map, index, oblique.passed[boundary])
    ending = chain_ending(local_map.chains[at], measurement)
    if not oblique.is_oblique and ending != Ending.CONTINUES and local_map.chains[at].used >= MIN_ECHOES:
        ended = ChainUpdate(local_map.landmarks, local_map.chains[at])
        ended = fit_chain(ended, measurement, ending == Ending.EDGE, params)
        local_map = local_map._replace(landmarks=ended.landmarks)
    chain = EchoChain() if oblique.is_oblique else next_chain(local_map.chains[at], measurement, ending)
    local_map = _with_chain(local_map, at, chain)
    if measurement.status == ReadingStatus.ECHO and chain.used >= max(MIN_ECHOES, chain.fitted + REFIT_ECHOES):
        update = ChainUpdate(local_map.landmarks, local_map.chains[at])
        update = fit_chain(update, measurement, False, params)
        local_map = local_map._replace(landmarks=update.landmarks)
        local_map = _with_chain(local_map, at, update.chain)
    return local_map


def with_landmark(local_map: LandmarkMap, index: int, landmark: Landmark) -> LandmarkMap:
    """Return the map with the landmark at ``index`` replaced: written so, the compiler copies no other one."""
    at = min(max(index, 0), MAX_LANDMARKS - 1)
    return local_map._replace(landmarks=local_map.landmarks[:at] + (landmark,) + local_map.landmarks[at + 1 :])


def with_post(
    local_map: LandmarkMap, a: SensorPose, b: SensorPose, at: Point, variance: float, params: MappingParams
) -> LandmarkMap:
    """Return the map with a post where two ranges of ``variance`` [m2] meet, if both sensors may see it.

    While the vehicle moves the ranges of one body meet at one place, which confirms it, those of two bodies elsewhere.
    """
    if not may_be_in_view(a, at) or not may_be_in_view(b, at):
        return local_map
    ranges = planar_distance(at.x, at.y, a.x, a.y) * planar_distance(at.x, at.y, b.x, b.y)
    cross = (at.x - a.x) * (at.y - b.y) - (at.y - a.y) * (at.x - b.x)
    spread = variance * ranges * ranges / max(cross * cross, variance * ranges * ranges)
    for number in range(MAX_LANDMARKS):
        known = local_map.landmarks[number]
        dx = at.x - known.x
        dy = at.y - known.y
        if known.type == LandmarkType.POINT and dx * dx + dy * dy < params.gate * (known.xx + spread):
            count = known.confirmations + 1
            moved = known._replace(x=known.x + dx / count, y=known.y + dy / count, confirmations=count)
            return with_landmark(local_map, number, moved)
    post = Landmark(LandmarkType.POINT, at.x, at.y, xx=spread, yy=spread, confirmations=1)
    return with_landmark(local_map, free_index(local_map.landmarks), post)


def is_confirmed(landmark: Landmark, params: MappingParams) -> bool:
    """Return whether a landmark counts: it has been updated ``confirmations`` times."""
    return landmark.type != LandmarkType.NONE and landmark.confirmations >= params.confirmations


def range_by_map(
    landmarks: tuple[Landmark, ...], sensor: SensorPose, planned: PredictedRange, free: float, params: MappingParams
) -> PredictedRange:
    """Return the nearest point of a confirmed landmark in view, open ends extended; else ``planned`` if that is nearer.

    A side does not go on beyond an open end where the sensor measures at least ``free`` [m] through it. The plan's
    polygon of the same side ends at the open end: it counts only if it is nearer by three deviations of a side.
    """
    nearest = planned
    reach = planned.distance + 3.0 * SIDE_DEVIATION
    for landmark in landmarks:
        if is_confirmed(landmark, params) and is_in_reach(landmark, sensor, reach):
            predicted = predict_range(sensor, with_open_ends_extended(landmark))
            if predicted.distance < free:
                predicted = predict_range(sensor, landmark)
            if predicted.distance < reach:
                nearest = predicted
                reach = predicted.distance
    return nearest


def contradict_nearer(local_map: LandmarkMap, measurement: Measurement, params: MappingParams) -> LandmarkMap:
    """Return the map with those landmarks contradicted that had to be detected before this echo, or at all.

    A sensor that misses one expected echo after the other may be silent: then it contradicts nothing any more.
    """
    sensor = measurement.sensor
    is_echo = measurement.status == ReadingStatus.ECHO
    is_credible = is_echo or is_credible_miss(local_map.missed, measurement.number)
    is_missed = False
    for number in range(MAX_LANDMARKS):
        if is_in_reach(local_map.landmarks[number], sensor, measurement.range + CONFIRMING_RANGE):
            landmark = local_map.landmarks[number]
            after = landmark
            if landmark.contradictions > 0 and is_echo:
                innovation = measurement.range - predict_range(sensor, landmark).distance
                after = landmark._replace(contradictions=0) if abs(innovation) < CONFIRMING_RANGE else landmark
            if is_contradicted(landmark, measurement):
                is_missed = is_missed or (not is_echo and is_permanent(landmark))
                if is_credible:
                    after = contradict(landmark, predict_range(sensor, landmark), params)
            local_map = with_landmark(local_map, number, after)
    missed = count_missed_echo(local_map.missed, measurement.number, measurement.status, is_missed)
    return local_map._replace(missed=missed)


def _with_ray(free_space: FreeSpace, measurement: Measurement) -> FreeSpace:
    """Return free space with the ray of a flank's front sensor; other sensors add none."""
    ray = Ray(measurement.sensor, measurement.range, measurement.status == ReadingStatus.ECHO)
    if measurement.number == FRONT_RIGHT_SIDE and is_next_ray(free_space.right[-1], ray):
        return free_space._replace(right=free_space.right[1:] + (ray,))
    if measurement.number == FRONT_LEFT_SIDE and is_next_ray(free_space.left[-1], ray):
        return free_space._replace(left=free_space.left[1:] + (ray,))
    return free_space
