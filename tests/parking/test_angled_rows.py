"""Angled rows in maps of simulated passes: direction, which way they lean, the goal, and how it is entered."""

import math
from typing import NamedTuple

import pytest

from controller_fmu.common.external_slot import SlotKind
from controller_fmu.interface import Reason
from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.geometry.outline import pose_along_arc, vehicle_outline
from controller_fmu.parking.map.free_space import MAX_RAYS, RAY_SPACING, Ray
from controller_fmu.parking.map.landmark import (
    MAX_LANDMARKS,
    Landmark,
    LandmarkType,
    end_point,
    length_of,
    start_point,
)
from controller_fmu.parking.map.local_map import LandmarkMap, update_map
from controller_fmu.parking.map.oblique_side import ObliqueUpdate, update_oblique_sides
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.measurement.sensor import Measurement, SensorPose, reading_status, sensor_pose
from controller_fmu.parking.slots.angled_row import find_angled_row
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType, find_slot
from controller_fmu.parking.slots.goal import goal_pose
from controller_fmu.parking.slots.params import SlotParams
from controller_fmu.parking.slots.row import SlotRow
from modelkit.geometry import Box
from modelkit.vocabulary import Pose
from tests.parking.simulated_pass import CAR, drive_past, exact_ranges

OUTLINE = vehicle_outline(CAR, 0.95)
LENGTH, WIDTH = 4.4, 1.8
OPENING, GAP = 2.8, 0.7
"""Width of the slot, and between the other cars [m]."""


class Passed(NamedTuple):
    """The map after a pass, where the vehicle is, and the row found."""

    local_map: LandmarkMap
    pose: Pose
    row: SlotRow


def angled_cars(degrees: float) -> list[Box]:
    """Three cars on each side of a slot whose middle is at x = 0 on the row's line y = 0, to the right of the road."""
    turn = math.radians(degrees)
    pitch, first = (WIDTH + GAP) / math.sin(turn), 0.5 * (OPENING + WIDTH) / math.sin(turn)
    x = 0.5 * LENGTH * math.cos(turn)
    y = -0.5 * (LENGTH * math.sin(turn) + WIDTH * abs(math.cos(turn)))
    places = [sense * (first + number * pitch) for number in range(3) for sense in (-1.0, 1.0)]
    return [Box(x + place, y, -turn, LENGTH, WIDTH) for place in places]


def passed(boxes: list[Box], end: float, side: float = -1.0, heading: float = 0.0, beside: float = 1.2) -> Passed:
    """Pass cars ``side`` of the road until ``end``, at an angle of ``heading`` [rad] to their row.

    At the middle of the row the vehicle is ``beside`` [m] off it.
    """
    local_map, params, pose = LandmarkMap(), MappingParams(), Pose()
    boxes = boxes if side < 0.0 else [box._replace(y=-box.y, heading=-box.heading) for box in boxes]
    start = Pose(-11.0, -side * (CAR.width / 2 + beside + 11.0 * math.tan(heading)), heading * side)
    for _, pose, readings in drive_past(boxes, start, end + 11.0, 1, speed=1.5):
        local_map = update_map(local_map, readings, pose, CAR.ultrasonic, params)
    rays = local_map.free_space.left if side > 0.0 else local_map.free_space.right
    return Passed(local_map, pose, find_angled_row(local_map.landmarks, rays, pose, side, params))


def slot_in(found: Passed, wanted: int = SlotKind.NONE) -> SlotCandidate:
    free = found.local_map.free_space
    rays = free.right if found.row.side < 0.0 else free.left
    params = SlotParams(wanted=wanted)
    return find_slot(found.row, found.local_map.landmarks, rays, OUTLINE, params, MappingParams())


@pytest.mark.parametrize(
    ("degrees", "end", "side"),
    [
        (45, 8.9, 1.0),
        (75, 8.9, 1.0),
        (105, 8.9, 1.0),
        (120, 8.9, 1.0),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in ((30, 12.5, -1.0), (60, 8.9, -1.0), (135, 8.9, -1.0), (150, 8.9, 1.0))
        ),
    ],
)
def test_a_slot_in_an_angled_row_is_found_with_its_direction(degrees: float, end: float, side: float) -> None:
    slot = slot_in(passed(angled_cars(degrees), end, side))
    assert (slot.type, slot.reason) == (SlotType.PERPENDICULAR, Reason.NONE)
    assert slot.is_nose_in == (degrees < 90)
    goal = goal_pose(slot, OUTLINE, SlotParams())
    into = side * math.radians(degrees)
    heading = into if slot.is_nose_in else into + math.pi
    off = math.remainder(goal.heading - heading, 2.0 * math.pi)
    assert abs(off) < math.radians(6.0)
    ahead, turn = OUTLINE.centre_ahead, math.radians(degrees)
    x, y = goal.x + ahead * math.cos(goal.heading), goal.y + ahead * math.sin(goal.heading)
    middle = Pose(0.5 * LENGTH * math.cos(turn), -side * angled_cars(degrees)[0].y, into)
    assert abs(point_to_frame(x, y, middle).y) < 0.35


@pytest.mark.parametrize("degrees", [45, 135])
def test_a_row_is_found_on_a_way_past_that_is_oblique_to_it(degrees: float) -> None:
    slot = slot_in(passed(angled_cars(degrees), 8.9, -1.0, math.radians(-8.0)))
    assert (slot.type, slot.reason) == (SlotType.PERPENDICULAR, Reason.NONE)
    assert slot.is_nose_in == (degrees < 90)


@pytest.mark.parametrize(
    ("degrees", "end", "heading", "beside"),
    [(30, 12.5, 12.0, 3.2), pytest.param(60, 8.9, -11.0, 2.8, marks=pytest.mark.slow)],
)
def test_a_row_is_angled_by_its_road_whatever_the_way_past_is(
    degrees: float, end: float, heading: float, beside: float
) -> None:
    """The cars' sides are along the path or across it, within 20 deg, and yet oblique to the line of their corners."""
    found = passed(angled_cars(degrees), end, -1.0, math.radians(heading), beside)
    slot = slot_in(found)
    assert (slot.type, slot.reason, slot.is_nose_in) == (SlotType.PERPENDICULAR, Reason.NONE, True)
    into = found.row.frame.heading - 0.5 * math.pi
    assert abs(into + math.radians(degrees)) < math.radians(3.0)


@pytest.mark.parametrize("places", [(-15.2, -11.2, -2.4), (-16.0, -6.4)])
@pytest.mark.parametrize("bend", [30.0, -30.0])
def test_cars_along_a_road_that_bends_are_no_angled_row(bend: float, places: tuple[float, ...]) -> None:
    """They are turned by where they stand; the vehicle has driven 2 m beside their arc."""
    cars = [arc_pose(bend, place, 0.0) for place in places]
    sides = [
        Landmark(LandmarkType.SEGMENT, x, y, turn, hh=3e-5, start=-0.5 * LENGTH, end=0.5 * LENGTH, confirmations=20)
        for x, y, turn in cars
    ]
    known = [side._replace(start_known=True, end_known=True) for side in sides]
    driven = [arc_pose(bend, -RAY_SPACING * number, 2.0) for number in reversed(range(MAX_RAYS))]
    rays = tuple(Ray(SensorPose(x, y, math.sin(turn), -math.cos(turn)), 2.0, True) for x, y, turn in driven)
    landmarks = (*known, *(Landmark(),) * (MAX_LANDMARKS - len(known)))
    assert find_angled_row(landmarks, rays, driven[-1], -1.0, MappingParams()).used == 0


def arc_pose(radius: float, along: float, beside: float) -> Pose:
    """The pose ``beside`` an arc of ``radius`` [m], left positive, that passes the origin along x."""
    turn = along / radius
    return Pose((radius - beside) * math.sin(turn), radius - (radius - beside) * math.cos(turn), turn)


def test_the_sides_of_oblique_cars_are_mapped_where_the_boundary_of_the_cone_meets_them() -> None:
    """Neither side of a car at 45 deg has the foot of a perpendicular in a cone of 30 deg."""
    turn = math.radians(45.0)
    cars = angled_cars(45)
    landmarks = passed(cars, 8.9).local_map.landmarks
    sides = [one for one in landmarks if one.type == LandmarkType.SEGMENT and length_of(one) > 0.6]
    assert len(sides) >= 6
    for side in sides:
        off = math.remainder(side.heading + turn, 0.5 * math.pi)
        assert abs(off) < math.radians(3.0)
        for end in (start_point(side), end_point(side)):
            inside = [point_to_frame(end.x, end.y, Pose(car.x, car.y, car.heading)) for car in cars]
            distance = min(max(abs(at.x) - 0.5 * LENGTH, abs(at.y) - 0.5 * WIDTH) for at in inside)
            assert abs(distance) < 0.2


def test_a_pillar_before_a_car_narrows_the_slot_by_no_more_than_it_is_wide() -> None:
    """Of a pillar a corner is seen as of a car; what was observed free behind it tells that it is none."""
    turn, off, back = math.radians(45.0), 0.5 * OPENING + 0.2, 0.5 * LENGTH - 0.8
    cars = [car._replace(x=car.x + math.copysign(0.6 / math.sin(turn), car.x - 1.5)) for car in angled_cars(45)]
    x, y = 0.5 * LENGTH * math.cos(turn), cars[0].y
    pillars = [
        Box(
            x - back * math.cos(turn) + sense * off * math.sin(turn),
            y + back * math.sin(turn) + sense * off * math.cos(turn),
            -turn,
            0.4,
            0.4,
        )
        for sense in (-1.0, 1.0)
    ]
    slot = slot_in(passed(cars + pillars, 9.6))
    assert (slot.type, slot.reason) == (SlotType.PERPENDICULAR, Reason.NONE)
    assert slot.is_nose_in
    assert OPENING - 0.5 < slot.ahead.start - slot.behind.end < OPENING + 0.7
    goal = goal_pose(slot, OUTLINE, SlotParams())
    half = OUTLINE.half_length * abs(math.sin(goal.heading)) + OUTLINE.half_width * abs(math.cos(goal.heading))
    assert abs(goal.y + OUTLINE.centre_ahead * math.sin(goal.heading) + half) < 0.2, "flush with the cars"


def test_the_driver_chooses_how_to_enter() -> None:
    found = passed(angled_cars(60), 8.9)
    assert slot_in(found).is_nose_in
    assert not slot_in(found, SlotKind.TAIL_IN).is_nose_in
    assert slot_in(found, SlotKind.NOSE_IN).is_nose_in


def test_cars_that_stand_square_are_no_angled_row() -> None:
    square = [Box(place, -2.2, -0.5 * math.pi, LENGTH, WIDTH) for place in (-4.8, -2.3, 2.3, 4.8)]
    along = [Box(place, -0.9, 0.0, LENGTH, WIDTH) for place in (-5.0, 5.0)]
    for boxes in (square, along):
        assert passed(boxes, 8.0).row.used == 0


def test_a_turning_sensor_shows_no_oblique_side() -> None:
    """A car that turns at a radius of 1.5 m beside a car's end: the cone sweeps through what is free."""
    update, sensors = ObliqueUpdate(), CAR.ultrasonic
    for step in range(50):
        vehicle = pose_along_arc(Pose(), -0.04 * step, -0.66)
        measured = exact_ranges(vehicle, [Box(3.8, -2.5, 0.0, 4.0, 1.8)], sensors)[11]
        sensor = sensor_pose(sensors.mounts[11], sensors.half_angle, vehicle)
        reading = Measurement(sensor, reading_status(measured, sensors), measured, 1e-4)
        update = update_oblique_sides(update.boundaries, reading)
        assert not any(side.type for side in update.passed)
