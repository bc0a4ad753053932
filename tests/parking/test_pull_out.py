"""Pulling out: neighbours as the sensors at rest measure them, the pose on the road, when the front is clear."""

import math

import pytest

from controller_fmu.common.driver_selection import ChosenSide, ChosenTask, DriverSelection
from controller_fmu.parking.chart import Condition, ParkingState, Strategy, next_parking_state
from controller_fmu.parking.geometry.outline import vehicle_outline
from controller_fmu.parking.map.landmark import MAX_LANDMARKS, Landmark, LandmarkType, offset_of
from controller_fmu.parking.map.local_map import range_by_map
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.measurement.predicted_range import predict_range_to_segment
from controller_fmu.parking.measurement.sensor import SensorPose
from controller_fmu.parking.monitor.collision_monitor import landmark_distance
from controller_fmu.parking.outputs import prompt_of
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.path_planning import max_manoeuvres
from controller_fmu.parking.pull_out import (
    MAX_STAND_OUT,
    free_box,
    is_clear_ahead,
    pose_on_road,
    road_side,
    with_neighbours,
)
from controller_fmu.parking.signals import ParkingSystemInput
from controller_fmu.parking.state import ParkingMemory
from controller_fmu.parking.system import conditions_of, enter_state
from modelkit.car import Car
from modelkit.geometry import Point
from modelkit.vocabulary import Pose, Prompt

CAR = Car()
OUTLINE = vehicle_outline(CAR, 0.95)
NOWHERE = (Landmark(),) * MAX_LANDMARKS
BETWEEN_CARS = (0.9, 0.9, 0.9, 0.9, 0.4, 0.4, 0.4, 0.4, 5.0, 5.0, 0.2, 0.2)
"""Ranges [m] of a vehicle with a car 0.9 m ahead, one 0.4 m behind, and a kerb 0.2 m to its right."""


def mirrored(readings: tuple[float, ...]) -> tuple[float, ...]:
    return (*readings[:8], *readings[10:], *readings[8:10])


def test_bumpers_are_where_the_sensors_that_look_along_measure_them() -> None:
    box = free_box(BETWEEN_CARS, CAR)
    front, rear = OUTLINE.centre_ahead + OUTLINE.half_length, OUTLINE.centre_ahead - OUTLINE.half_length
    assert (box.front, box.rear) == pytest.approx((front + 0.9, rear - 0.4), abs=1e-6)
    assert box.right == pytest.approx(-0.5 * CAR.width - 0.2, abs=0.06)
    assert box.left > 5.0


@pytest.mark.parametrize("side", [ChosenSide.ANY, ChosenSide.LEFT, ChosenSide.RIGHT])
def test_landmarks_stand_around_the_vehicle_and_leave_the_road_free(side: ChosenSide) -> None:
    readings = mirrored(BETWEEN_CARS) if side == ChosenSide.RIGHT else BETWEEN_CARS
    pose = Pose(10.0, 4.0, 0.3)
    road = road_side(side)
    box = free_box(readings, CAR)
    found = with_neighbours(NOWHERE, box, road, pose, CAR, MappingParams())
    segments = [landmark for landmark in found if landmark.type != LandmarkType.NONE]
    assert len(segments) == 5
    goal = pose_on_road(box, road, pose, OUTLINE)
    for segment in segments:
        assert offset_of(segment, pose.x, pose.y) > 0.0, "the vehicle is on its left, as a sensor would have seen it"
        assert landmark_distance(segment, pose, OUTLINE) > 0.1
        assert landmark_distance(segment, goal, OUTLINE) > 0.2
    dx, dy = goal.x - pose.x, goal.y - pose.y
    across = dy * math.cos(pose.heading) - dx * math.sin(pose.heading)
    assert road * across > CAR.width + MAX_STAND_OUT
    assert goal.heading == pose.heading


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("ahead", [1.0, -1.0])
def test_a_bumper_may_go_on_towards_the_road_until_a_sensor_measures_past_it(side: float, ahead: float) -> None:
    """Although the plan's polygon of it ends where it is taken to end."""
    params = MappingParams()
    box = free_box(BETWEEN_CARS if side > 0.0 else mirrored(BETWEEN_CARS), CAR)
    found = with_neighbours(NOWHERE, box, side, Pose(), CAR, params)
    bumper = box.front if ahead > 0.0 else box.rear
    corner = Point(bumper, side * (0.5 * CAR.width + MAX_STAND_OUT))
    sensor = SensorPose(bumper - 0.3 * ahead, corner.y - 0.05 * side, ahead, 0.0, 0.5, math.sqrt(0.75))
    planned = predict_range_to_segment(sensor, Point(bumper, 0.0), corner)
    near = range_by_map(found, sensor, planned, 0.1, params).surface
    past = range_by_map(found, sensor, planned, 0.5, params).surface
    assert min(near.high, -near.low) > 1.0
    assert min(past.high, -past.low) == pytest.approx(0.05)


def test_the_front_is_clear_when_no_sensor_of_its_bumper_measures_anything_near() -> None:
    assert is_clear_ahead((5.0,) * 4 + (0.3,) * 8)
    assert not any(is_clear_ahead(tuple(3.9 if number == near else 5.0 for number in range(12))) for near in range(4))


@pytest.mark.parametrize("speed", [0.0, 0.5])
def test_a_driver_who_wants_out_is_asked_to_confirm_and_to_take_over(speed: float) -> None:
    params = ParkingParams()
    chosen = DriverSelection(task=ChosenTask.PULL_OUT, side=ChosenSide.LEFT)
    inputs = ParkingSystemInput(apa_switch=True, driver_selection=chosen, measured_speed=speed)
    memory = ParkingMemory()
    perception = memory.perception
    cycle = perception.cycle._replace(readings=BETWEEN_CARS)
    local_map = perception.local_map._replace(begun=True)
    memory = memory._replace(perception=perception._replace(cycle=cycle, local_map=local_map))
    after = next_parking_state(memory.state, conditions_of(memory, inputs, params))
    assert after == (ParkingState.STANDBY if speed else ParkingState.CONFIRMING)
    if not speed:
        memory = enter_state(memory, after, inputs, params)
        assert memory.strategy == Strategy.PULL_OUT
        assert not conditions_of(memory, inputs, params) >> Condition.DRIVEN_ON & 1
        failed = memory._replace(reason=3)
        assert next_parking_state(failed.state, conditions_of(failed, inputs, params)) == ParkingState.FAILED
        assert prompt_of(memory._replace(state=ParkingState.PARKED), params) == Prompt.TAKE_OVER


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_behind_a_row_without_kerb_nothing_is_taken_for_free(side: float) -> None:
    readings = (*BETWEEN_CARS[:8], 5.0, 5.0, 5.0, 5.0)
    found = with_neighbours(NOWHERE, free_box(readings, CAR), side, Pose(), CAR, MappingParams())
    along = (
        landmark for landmark in found if landmark.type != LandmarkType.NONE and abs(math.sin(landmark.heading)) < 0.1
    )
    behind = [landmark for landmark in along if side * landmark.y < -0.5 * CAR.width]
    assert [round(side * landmark.y, 6) for landmark in behind] == [-round(0.5 * CAR.width + MAX_STAND_OUT, 6)]


def test_the_way_out_may_take_more_manoeuvres_than_the_way_in() -> None:
    params = ParkingParams()
    memory = ParkingMemory(strategy=Strategy.PULL_OUT)
    assert max_manoeuvres(memory, params) == params.plan.max_manoeuvres > params.limit.manoeuvres
    assert max_manoeuvres(memory._replace(strategy=Strategy.SLOT), params) == params.limit.manoeuvres
