"""The study of ways out: where its cars stand, what is known of the ways, held against polygons of shapely."""

import math

import pytest
from shapely.geometry import Polygon, box

from modelkit.car import Car
from modelkit.vocabulary import Pose
from orchestrator.inputs.scenario.slot_sizes import ParkingType
from orchestrator.studies.parking.cases import CARS, KINDS
from orchestrator.studies.parking.pull_out_cases import cases, footprints_of, start_of
from orchestrator.studies.parking.pull_out_feasibility import free_ahead, goal_of, is_path
from orchestrator.studies.parking.pull_out_study import study


def outline(pose: Pose, car: Car) -> Polygon:
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    front, half = car.wheelbase + car.front_overhang, 0.5 * car.width
    corners = [(front, half), (-car.rear_overhang, half), (-car.rear_overhang, -half), (front, -half)]
    return Polygon([(pose.x + x * c - y * s, pose.y + x * s + y * c) for x, y in corners])


def test_every_car_stands_free_between_its_neighbours() -> None:
    chosen = cases(100)
    assert {case.kind for case in chosen} == set(KINDS)
    for case in chosen:
        body = outline(Pose(*start_of(case)), CARS[case.car])
        things = {name: box(item.x0, item.y0, item.x1, item.y1) for name, item in footprints_of(case).items()}
        nearest = {name: body.distance(thing) for name, thing in things.items()}
        assert min(nearest.values()) > 0.0
        assert nearest["first"] + nearest["second"] == pytest.approx(case.extra, abs=0.2)


def test_what_is_free_ahead_is_what_the_row_leaves() -> None:
    along = next(case for case in cases(20) if case.kind == ParkingType.PARALLEL)
    x, y, heading = start_of(along)
    car = CARS[along.car]
    ahead = footprints_of(along)["second"].x0 - x - car.wheelbase - car.front_overhang
    assert free_ahead(along, Pose(x, along.side * y, along.side * heading)) == pytest.approx(ahead, abs=0.15)
    assert free_ahead(along, Pose(x, along.side * (y + 4.0), 0.0)) >= 5.0


def test_with_more_room_there_is_a_path_and_with_none_there_is_none() -> None:
    case = next(case for case in cases(20) if case.kind == ParkingType.PARALLEL)._replace(behind="nothing", share=0.5)
    wide, narrow = case._replace(extra=2.0), case._replace(extra=0.2)
    assert is_path(wide, goal_of(wide, 5.0, 1.5))
    assert not is_path(narrow, goal_of(narrow, 5.0, 1.5))


def test_the_driver_selects_the_side_of_the_case() -> None:
    chosen, design = cases(12), study(12).design
    selected = design.values[:, [field.key for field in design.fields].index("faults[2].value")]
    assert [{2.0: 1, 1.0: -1}[value] for value in selected] == [case.side for case in chosen]
