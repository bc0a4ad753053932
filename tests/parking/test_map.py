"""The map: estimates with their covariance over simulated passes."""

import math
import re
from typing import Any

import numpy as np
import pytest

from controller_fmu import APA
from controller_fmu.parking.map.facing_surface import FACING_ECHOES
from controller_fmu.parking.map.free_space import is_free
from controller_fmu.parking.map.landmark import (
    MAX_LANDMARKS,
    Landmark,
    LandmarkType,
    along_of,
    length_of,
    offset_of,
    offset_variance,
    segment_point,
)
from controller_fmu.parking.map.local_map import LandmarkMap, range_by_map, update_map
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.map.prediction import predict_landmark
from controller_fmu.parking.map.visibility import contradict
from controller_fmu.parking.measurement.predicted_range import EchoOrigin, PredictedRange
from controller_fmu.parking.measurement.sensor import sensor_pose
from controller_fmu.parking.measurement.silent_sensor import MISSED_ECHOES
from fmus.native.sources import fmu_sources
from modelkit.geometry import Box
from modelkit.maths import wrap_angle
from modelkit.vocabulary import Pose
from tests.parking.simulated_pass import CAR, Odometry, drive_past

PARAMS = MappingParams()
PERPENDICULAR = [Box(x, -2.25, 0.0, 1.8, 4.5) for x in (-3.6, -0.9, 4.5, 7.2)]
PARALLEL = [Box(x, -0.9, 0.0, 4.4, 1.8) for x in (-2.2, 8.4)]


def covariance(landmark: Landmark) -> Any:
    return np.array(
        [
            [landmark.xx, landmark.xy, landmark.xh],
            [landmark.xy, landmark.yy, landmark.yh],
            [landmark.xh, landmark.yh, landmark.hh],
        ]
    )


SEGMENT = Landmark(
    LandmarkType.SEGMENT, 1.0, 2.0, 0.3, xx=0.02, xy=0.004, xh=0.001, yy=0.03, yh=-0.002, hh=0.005, start=-1.0, end=1.0
)


def test_prediction_turns_a_landmark_about_the_vehicle() -> None:
    vehicle = Pose(-2.0, 1.0, 0.5)
    predicted = predict_landmark(SEGMENT, vehicle, 4.0, PARAMS)
    u = np.array([math.cos(0.5), math.sin(0.5), 0.0])
    g = np.array([-(SEGMENT.y - vehicle.y), SEGMENT.x - vehicle.x, 1.0])
    q = 4.0 * (PARAMS.distance_variance * np.outer(u, u) + PARAMS.heading_variance * np.outer(g, g))
    assert covariance(predicted) == pytest.approx(covariance(SEGMENT) + q)


def map_after(boxes: list[Box], seed: int, **drive: Any) -> tuple[LandmarkMap, Pose, Pose]:
    local_map, true, believed = LandmarkMap(), Pose(), Pose()
    start = Pose(-9.0, CAR.width / 2 + drive.pop("lateral", 1.0), 0.0)
    for step in drive_past(boxes, start, drive.pop("distance", 20.0), seed, **drive):
        true, believed, readings = step
        local_map = update_map(local_map, readings, believed, CAR.ultrasonic, PARAMS)
    return local_map, true, believed


def sides(local_map: LandmarkMap) -> list[Landmark]:
    found = [
        item
        for item in local_map.landmarks
        if item.type == LandmarkType.SEGMENT and item.confirmations >= 10 and length_of(item) > 0.6
    ]
    return sorted(found, key=lambda item: segment_point(item, item.start).x)


def test_a_row_is_as_many_sides_as_cars() -> None:
    for seed in range(4):
        found = sides(map_after(PERPENDICULAR, seed)[0])
        assert len(found) == 4, [(segment_point(item, item.start).x, length_of(item)) for item in found]
        for side, box in zip(found, PERPENDICULAR, strict=True):
            assert segment_point(side, side.start).x == pytest.approx(box.x - 0.9, abs=0.25)
            assert segment_point(side, side.end).x == pytest.approx(box.x + 0.9, abs=0.45)


def test_a_gap_between_cars_is_known_free_and_cars_are_not() -> None:
    local_map = map_after(PERPENDICULAR, 1, distance=14.0)[0]
    rays = local_map.free_space.right
    assert is_free(rays, 1.8, -1.5)
    assert not is_free(rays, 4.5, -1.0)


def in_odometry(x: float, y: float, true: Pose, believed: Pose) -> tuple[float, float]:
    turn = believed.heading - true.heading
    c, s = math.cos(turn), math.sin(turn)
    dx, dy = x - true.x, y - true.y
    return believed.x + c * dx - s * dy, believed.y + s * dx + c * dy


def squared_errors(runs: int) -> tuple[list[float], list[float]]:
    """Normalised squared errors of offset and heading of the best known side of each car."""
    rng = np.random.default_rng(11)
    offsets, headings, missed = [], [], 0
    for seed in range(runs):
        odometry = Odometry(rng.uniform(-0.004, 0.004), rng.uniform(-0.0008, 0.0008))
        boxes = PARALLEL if seed % 2 else PERPENDICULAR
        lateral, speed = rng.uniform(0.6, 1.6), rng.uniform(1.0, 2.7)
        local_map, true, believed = map_after(boxes, seed, odometry=odometry, lateral=lateral, speed=speed)
        turn = believed.heading - true.heading
        for box in boxes:
            x, y = in_odometry(box.x, 0.0, true, believed)
            near = [side for side in sides(local_map) if abs(offset_of(side, x, y)) < 0.5]
            near = [side for side in near if side.start - 0.2 <= along_of(side, x, y) <= side.end + 0.2]
            if not near:
                missed += 1
                continue
            side = max(near, key=lambda item: item.confirmations)
            middle = 0.5 * (side.start + side.end)
            at = segment_point(side, middle)
            error = (at.y - y) * math.cos(turn) - (at.x - x) * math.sin(turn)
            offsets.append(error * error / offset_variance(side, middle))
            error = wrap_angle(side.heading - turn)
            headings.append(error * error / side.hh)
    assert missed <= 0.02 * len(offsets)
    return offsets, headings


@pytest.mark.parametrize("passes", [8, pytest.param(40, marks=pytest.mark.release)])
def test_estimates_are_as_good_as_their_covariance_says(passes: int) -> None:
    """Mean normalised squared error: 1 if the covariance is right; the offset is stated too wide rather than too
    narrow, since the odometry model allows for more drift than these passes have."""
    offsets, headings = squared_errors(passes)
    band = 1.96 * math.sqrt(2.0 / len(headings))
    assert np.mean(headings) < 1.0 + band
    assert 0.2 < np.mean(offsets) < 1.0 + band


def test_a_wall_that_is_gone_is_forgotten() -> None:
    """Sensors that detect something else now and then work: what they miss is not there."""
    local_map, true, _ = map_after([Box(0.0, -1.0, 0.0, 30.0, 0.2)], 1)
    assert sides(local_map)
    for number in range(200):
        pose = Pose(true.x - 0.1 * number, true.y, true.heading)
        readings = (CAR.ultrasonic.max_range if number % 3 else 4.5,) * 12
        local_map = update_map(local_map, readings, pose, CAR.ultrasonic, PARAMS)
    assert sum(length_of(item) for item in sides(local_map) if abs(item.y - true.y) < 3.0) < 3.0
    assert local_map.missed.counts.count(MISSED_ECHOES) == 0


def test_silent_sensors_forget_no_wall() -> None:
    local_map, true, _ = map_after([Box(0.0, -1.0, 0.0, 30.0, 0.2)], 1)
    before = sum(length_of(item) for item in sides(local_map))
    for number in range(100):
        pose = Pose(true.x - 0.1 * number, true.y, true.heading)
        local_map = update_map(local_map, (CAR.ultrasonic.max_range,) * 12, pose, CAR.ultrasonic, PARAMS)
    assert sum(length_of(item) for item in sides(local_map)) > before - 1.0
    assert local_map.missed.counts.count(MISSED_ECHOES) >= 2, "those of the flank that passes the wall"


def test_what_is_in_the_blind_zone_is_kept() -> None:
    near = Landmark(LandmarkType.POINT, 3.25, 0.25, xx=1e-4, yy=1e-4, confirmations=9)
    local_map = LandmarkMap(landmarks=(near,) + (Landmark(),) * (MAX_LANDMARKS - 1), begun=True)
    for _ in range(20):
        local_map = update_map(local_map, (CAR.ultrasonic.max_range,) * 12, Pose(), CAR.ultrasonic, PARAMS)
    assert local_map.landmarks[0].type == LandmarkType.POINT


def test_a_narrow_body_that_came_between_two_cones_is_kept() -> None:
    """A hitch in the middle of the bumper is outside both cones nearer than 0.4 m: without an echo it may be there."""
    surface = Landmark(
        LandmarkType.SEGMENT, -0.95, 0.0, math.pi / 2, xx=1e-4, hh=1e-3, start=-0.25, end=0.25, confirmations=9
    )
    for heading in (math.pi / 2, -math.pi / 2):
        landmarks = (surface._replace(heading=heading),) + (Landmark(),) * (MAX_LANDMARKS - 1)
        local_map = LandmarkMap(landmarks=landmarks, begun=True)
        for _ in range(20):
            local_map = update_map(local_map, (CAR.ultrasonic.max_range,) * 12, Pose(), CAR.ultrasonic, PARAMS)
        assert local_map.landmarks[0].type == LandmarkType.SEGMENT
        away = Pose(1.5, 0.0, 0.0)
        for _ in range(20):
            local_map = update_map(local_map, (CAR.ultrasonic.max_range,) * 12, away, CAR.ultrasonic, PARAMS)
        assert local_map.landmarks[0].type == LandmarkType.NONE, "from afar it must be heard"


def test_a_side_does_not_go_on_where_the_sensor_measures_through() -> None:
    """A pedestrian's surface behind the car, 0.5 m long, with open ends; the sensor beside it measures the kerb."""
    mount = CAR.ultrasonic.mounts[7]
    sensor = sensor_pose(mount, CAR.ultrasonic.half_angle, Pose())
    x, y = sensor.x + 1.2 * sensor.axis_x, sensor.y + 1.2 * sensor.axis_y
    across = math.atan2(sensor.axis_y, sensor.axis_x) + math.pi / 2
    person = Landmark(LandmarkType.SEGMENT, x, y, across, start=-1.5, end=-1.0, confirmations=9)
    kerb = PredictedRange(2.0, EchoOrigin.INTERIOR, sensor.x + 2.0 * sensor.axis_x, sensor.y + 2.0 * sensor.axis_y)
    landmarks = (person, *(Landmark(),) * (MAX_LANDMARKS - 1))
    unknown = range_by_map(landmarks, sensor, kerb, 0.0, PARAMS)
    assert unknown.distance == pytest.approx(1.2, abs=0.1), "it may go on before the kerb"
    assert range_by_map(landmarks, sensor, kerb, 1.8, PARAMS) == kerb


@pytest.mark.parametrize(
    ("confirmations", "half", "silent"),
    [(FACING_ECHOES, 2.0, False), (2 * FACING_ECHOES, 2.0, True), (2 * FACING_ECHOES, 0.2, False)],
)
def test_a_pedestrian_who_left_proves_no_sensor_silent(confirmations: int, half: float, silent: bool) -> None:
    """A surface 1 m behind the car that one of two sensors does not detect."""
    mount = CAR.ultrasonic.mounts[5]
    surface = Landmark(
        LandmarkType.SEGMENT, mount.x - 1.0, mount.y, math.pi / 2, xx=1e-4, yy=1e-4, start=-half, end=half
    )
    known = (surface._replace(confirmations=confirmations), *(Landmark(),) * (MAX_LANDMARKS - 1))
    local_map = LandmarkMap(landmarks=known, begun=True)
    for _ in range(MISSED_ECHOES):
        readings = tuple(CAR.ultrasonic.max_range if number == 5 else 1.0 for number in range(12))
        local_map = update_map(local_map, readings, Pose(), CAR.ultrasonic, PARAMS)
    assert (local_map.missed.counts[5] == MISSED_ECHOES) == silent


@pytest.mark.parametrize(("confirmations", "left"), [(FACING_ECHOES, 0), (2 * FACING_ECHOES, 1)])
def test_of_what_two_sensors_took_for_one_surface_nothing_is_left(confirmations: int, left: int) -> None:
    """From a pedestrian to the kerb behind the car: where the pedestrian was there is nothing any more."""
    surface = Landmark(LandmarkType.SEGMENT, start=-0.5, end=0.6, confirmations=confirmations)
    gone = PredictedRange(1.0, EchoOrigin.INTERIOR, -0.4, 0.0)
    for _ in range(PARAMS.contradictions):
        surface = contradict(surface, gone, PARAMS)
    assert (surface.type == LandmarkType.SEGMENT) == (left == 1)
    assert left == 0 or (surface.start > -0.2 and surface.end == 0.6), "a side that was passed is shortened"


def test_the_c_code_writes_a_landmark_and_copies_no_other_one() -> None:
    text = "".join(fmu_sources(APA, "{token}", 2).values())
    (body,) = re.findall(r"^static [^;]* with_landmark\([^;]*?\)\n\{\n(.*?)^\}", text, re.MULTILINE | re.DOTALL)
    assert "->landmarks[at] = *landmark;" in body
    assert "for (" not in body
    assert "replace_landmark" not in body
