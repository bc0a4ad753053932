"""The parking system in the world: the scenes are as said, a run's end is what it touched, rows come back."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from controller_fmu.parking.chart import ParkingState
from modelkit.geometry import Box, boxes_gap, corners, outline
from modelkit.vocabulary import Pose
from orchestrator.commands.sweep import select_study
from orchestrator.evaluation.verdict.outcome import BEYOND
from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.parking.world import ends
from orchestrator.studies.parking.world.factors import FACTORS
from orchestrator.studies.parking.world.feasibility import DETECTED_HEIGHT, feasibility_columns
from orchestrator.studies.parking.world.scene import MAX_ROW_CARS
from orchestrator.studies.parking.world.study import fields, space, study
from orchestrator.studies.sweep.repeat import repeat_row
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.sweep import Options, sweep
from orchestrator.studies.sweep.table import Table


def columns(made: Study) -> dict[str, np.ndarray]:
    return {field.key: column for field, column in zip(made.design.fields, made.design.values.T, strict=True)}


def box(values: dict[str, np.ndarray], number: int, run: int) -> Box:
    return Box(*(values[f"vehicle.scene.boxes[{number}].{name}"][run] for name in Box._fields))


def test_neighbours_leave_the_slot_free_however_they_stand() -> None:
    made = study(200, 3)
    values, labels = columns(made), made.design.labels
    for run in range(200):
        sides = [list(corners(box(values, number, run))) for number in (1, 2)]
        slot = sides[1][0].x - sides[0][0].x
        assert max(p.x for p in sides[0]) == pytest.approx(0.0, abs=1e-9)
        length = values["slot.length" if labels["kind"][run] == 0 else "slot.width"][run]
        assert min(p.x for p in sides[1]) == pytest.approx(length, abs=1e-9)
        assert slot > 0.0


def test_cars_stand_in_a_row_beyond_the_neighbours() -> None:
    """All else is as without them, but for where the driver starts; they keep clear of each other and of the start."""
    alone, made = columns(study(50, 3)), study(50, 3, row_cars=2)
    values = columns(made)
    starts = {"vehicle.start.x", "vehicle.start.y"}
    assert all(
        np.array_equal(values[name], column, equal_nan=True) for name, column in alone.items() if name not in starts
    )
    for run in range(50):
        row = [box(values, number, run) for number in (7, 5, 1, 2, 6, 8)]
        car = [values[f"vehicle.car.{name}"][run] for name in ("wheelbase", "front_overhang", "rear_overhang", "width")]
        pose = Pose(*(values[f"vehicle.start.{axis}"][run] for axis in ("x", "y", "heading")))
        assert min(boxes_gap(outline(pose, *car), other) for other in row) > 0.3
        for number in (0, 1, 3, 4):
            behind, ahead = corners(row[number]), corners(row[number + 1])
            assert 0.4 <= min(p.x for p in ahead) - max(p.x for p in behind) <= 1.2


def test_a_row_has_as_many_cars_as_the_scene_has_boxes() -> None:
    assert len(columns(study(1, 3, row_cars=MAX_ROW_CARS))) > 0
    with pytest.raises(BadInput, match=f"row_cars: {MAX_ROW_CARS + 1} is more than {MAX_ROW_CARS}"):
        study(1, 3, row_cars=MAX_ROW_CARS + 1)


def test_a_parked_car_touches_nothing_where_it_is_to_stand() -> None:
    """Flush, half way between the neighbours' directions: free in slots of half a metre more than the shortest."""
    made = study(400, 4)
    values, labels = columns(made), made.design.labels
    gaps = []
    for run in range(400):
        wheelbase, front, rear, width = (
            values[f"vehicle.car.{name}"][run] for name in ("wheelbase", "front_overhang", "rear_overhang", "width")
        )
        pose = [values[f"target.{axis}"][run] for axis in ("x", "y", "heading")]
        ahead = 0.5 * (wheelbase + front - rear)
        middle = (pose[0] + ahead * math.cos(pose[2]), pose[1] + ahead * math.sin(pose[2]))
        car = Box(*middle, pose[2], wheelbase + front + rear, width)
        if labels["extra"][run] > 0.5:
            gaps += [boxes_gap(car, box(values, number, run)) for number in (1, 2)]
        slot = Box(*(values[f"slot.{name}"][run] for name in Box._fields))
        assert boxes_gap(car, slot) == 0.0
    assert min(gaps) > 0.25


def test_nobody_is_there_all_at_once() -> None:
    """Who sets out is far from where a car may be: across the road, between cars, or behind a slot without wall."""
    made = study(3000, 5)
    values, labels = columns(made), made.design.labels
    sign = 1.0 - 2.0 * labels["side"]
    person = {name: values[f"vehicle.scene.boxes[4].{name}"] for name in ("x", "y", "length", "width", "speed_y")}
    begun: dict[str, int] = {"across": 0, "between": 0, "behind": 0}
    for run in np.flatnonzero(person["length"] > 0.0).tolist():
        y, walled = sign[run] * person["y"][run], values["vehicle.scene.boxes[3].length"][run] > 0.0
        there = Box(person["x"][run], person["y"][run], 0.0, person["length"][run], person["width"][run])
        slot = Box(*(values[f"slot.{name}"][run] for name in Box._fields))
        where = "across" if y > 7.0 else "between" if y > -1.5 else "behind"
        begun[where] += 1
        assert (sign[run] * person["speed_y"][run] < 0.0) == (where == "across")
        assert not (where == "behind" and walled), "through the wall"
        if where == "behind":
            assert boxes_gap(there, slot) > 2.5
        if where == "between":
            nearest = min(boxes_gap(there, box(values, number, run)) for number in (1, 2))
            assert y + 0.25 < -0.5
            assert nearest == 0.0 or boxes_gap(there, slot) > 1.0, "hidden by a neighbour, or beyond him"
    assert min(begun.values()) > 50, begun


def test_at_the_nominal_point_nothing_is_disturbed() -> None:
    world = space(list(FACTORS))
    named = world.values_by_name(world.nominal()[None])
    assert {factor.name: named[factor.name][0] for factor in FACTORS} == pytest.approx(
        {factor.name: factor.nominal for factor in FACTORS}
    )
    mild = [factor.mild() for factor in FACTORS]
    assert all(
        own.low <= half.low <= half.nominal <= half.high <= own.high for own, half in zip(FACTORS, mild, strict=True)
    )


def test_fewer_runs_are_the_first_of_more() -> None:
    few, many = study(5, 7), study(9, 7)
    assert (many.design.values[:5] == few.design.values).all()
    assert (many.design.seeds[:5] == few.design.seeds).all()
    assert (study(5, 8).design.values != few.design.values).any()
    assert len(fields()) == few.design.values.shape[1]


def test_a_contact_is_the_end_whatever_is_said_after_it() -> None:
    row = {"touched.state": 5.0, "touched.takeover": 0.0, "outcome": "parked", "reason": "", "kind": 0.0}
    row["within GB/T 41630, parallel"] = True
    assert ends.end_of({**row, "outcome": "not_parked", "reason": f"{BEYOND}: final heading"}, None) == ends.PARKED
    wall, person = ends.InitialContact("wall behind", False), ends.InitialContact("person", True)
    assert ends.end_of(row, wall) == ends.CONTACT
    assert ends.end_of({**row, "touched.state": float(ParkingState.SEARCHING)}, wall) == ends.DRIVER
    assert ends.end_of(row, person) == ends.WALKED_INTO
    kerb = ends.InitialContact("kerb behind", False)
    assert ends.end_of({**row, "vehicle.scene.kerbs[1].height": 0.08}, kerb) == ends.CONTACT
    assert ends.end_of({**row, "vehicle.scene.kerbs[1].height": 0.079}, kerb) == ends.LOW_KERB
    assert ends.end_of(row, None) == ends.PARKED
    assert ends.end_of({**row, "within GB/T 41630, parallel": False}, None) == ends.FALSE
    assert ends.end_of({**row, "outcome": "failed", "reason": "no_slot"}, None) == ends.FAILED
    assert ends.end_of({**row, "outcome": "not_parked"}, None) == ends.ENDLESS


def test_a_neighbour_who_has_moved_moves_the_line_of_a_row_across_the_road() -> None:
    """The car, 4 m long and 1.7 m wide, stands 30 cm out of a slot of its length, and of 4.5 m with the mouth at 0."""
    row: dict[str, Any] = {
        "outcome": "parked", "reason": "", "within GB/T 41630, perpendicular": False, "kind": 1.0, "manoeuvres": 3,
        "duration": 40.0, "final.heading_error": 0.01, "final.lateral_error": 0.1, "final.outline_margin": -0.3,
        "mover": 4, "mover_at": 10.0, "mover_speed": 0.5, "mover_travel": 0.4,
        "vehicle.car.wheelbase": 2.5, "vehicle.car.front_overhang": 0.8, "vehicle.car.rear_overhang": 0.7,
        "vehicle.car.width": 1.7, "final.x": 0.0, "final.y": -3.0, "final.heading": 0.5 * math.pi,
        "slot.x": 0.0, "slot.y": -2.25, "slot.heading": 0.5 * math.pi, "slot.length": 4.5, "slot.width": 2.5,
    }  # fmt: skip
    assert ends.end_of(row, None) == ends.PARKED, "20 cm further out"
    assert ends.end_of({**row, "mover_at": 39.9}, None) == ends.FALSE, "he has only set out"
    assert ends.end_of({**row, "mover_travel": -0.4}, None) == ends.FALSE
    assert ends.end_of({**row, "mover": 0}, None) == ends.FALSE
    deep = {**row, "final.y": -4.2}
    assert ends.end_of({**deep, "mover_travel": -0.6}, None) == ends.PARKED, "30 cm further in: 10 cm too deep"
    assert ends.end_of({**deep, "mover_travel": -0.3}, None) == ends.FALSE, "25 cm too deep"
    left = {name: -row[name] for name in ("final.y", "final.heading", "slot.y", "slot.heading")}
    assert ends.end_of({**row, **left}, None) == ends.PARKED


def test_what_is_valid_and_what_is_asked_for_follows_from_the_factors_alone() -> None:
    world = space(list(FACTORS))
    nominal = {name: values[0] for name, values in world.values_by_name(world.nominal()[None]).items()}
    nominal["vehicle.car.rear_overhang"] = 0.6

    def said(**factors: float) -> tuple[float, float]:
        found = feasibility_columns({name: np.array([value]) for name, value in {**nominal, **factors}.items()})
        return float(found["valid"][0]), float(found["asked"][0])

    stop = {"kind": 1, "behind": 2, "kerb_height": 0.08}
    assert said() == (1.0, 1.0)
    assert said(**stop, depth=0.29) == (0.0, 1.0)  # under the tail: 0.6 m of it, a tyre of 0.3 m
    assert said(**stop, depth=0.31) == (1.0, 1.0)
    assert said(**{**stop, "kerb_height": 0.079}, depth=0.29) == (1.0, 1.0)
    assert said(**{**stop, "kind": 0}, depth=0.0) == (1.0, 1.0)
    assert said(kind=1, behind=1, depth=0.0) == (1.0, 1.0)
    assert said(speed=20.1) == said(lost=8) == said(lost=9) == (1.0, 0.0)
    assert said(mover=4, mover_travel=0.9, extra=0.8) == (1.0, 0.0)
    assert said(mover=5, mover_travel=0.7, extra=0.8) == said(mover=4, mover_travel=-0.9, extra=0.8) == (1.0, 1.0)
    assert said(mover=4, mover_travel=0.9, extra=0.8, kind=1) == (1.0, 1.0)
    assert said(person=4, person_place=0.5) == said(person=5, person_place=0.5) == (1.0, 0.0)
    assert said(person=4, person_place=-0.3) == said(person=3, person_place=0.5) == (1.0, 1.0)


def test_a_heard_wheel_stop_is_where_it_is_said_to_be() -> None:
    """In a valid slot no detectable stop lies under a car that stands at its target; else one does."""
    made = study(2000, 5)
    values, labels = columns(made), made.design.labels
    said = feasibility_columns({**values, **labels})["valid"]
    half_turn = np.where(labels["side"] == 0, 1.0, -1.0)
    tail = half_turn * values["target.y"] - values["vehicle.car.rear_overhang"] * np.cos(
        np.radians(0.25 * (labels["turn_a"] + labels["turn_b"]))
    )
    stop = np.where(labels["kerb_height"] >= DETECTED_HEIGHT, half_turn * values["vehicle.scene.kerbs[1].y1"], -np.inf)
    under = (labels["kind"] == 1) & (labels["behind"] == 2) & (stop > tail)
    assert (said == 0.0).sum() > 50
    assert (under != (said == 0.0)).sum() <= 3  # a car turned by 2 deg is 1 cm shorter across


@pytest.mark.parametrize(
    ("speed", "walker", "name", "came"),
    [
        ((0.0, -1.0), (1.0, 1.07), "person", True),  # into the side of a car that stands or drives
        ((0.0, -1.0), (3.45, 0.0), "person", False),  # in front of a car that drives
        ((0.0, 0.0), (1.0, 1.07), "person", False),
    ],
)
def test_who_brought_a_contact_about(speed: Any, walker: Any, name: str, came: bool) -> None:
    """The car of Guo 2015 at the origin, 0.8 m/s ahead; it is touched at 10 s."""
    row = {f"vehicle.car.{key}": value for key, value in CAR.items()} | {
        "step": 0.01,
        "vehicle.scene.kerbs[1].height": 0.0,
    }
    row |= {"touched.x": 0.0, "touched.y": 0.0, "touched.heading": 0.0, "touched.speed": 0.8, "touched.time": 10.0}
    row |= {f"vehicle.scene.boxes[1].{key}": 3.0 for key in ("x", "y", "length", "width")}
    box = {
        "x": walker[0],
        "y": walker[1] - speed[1] * 5.0,
        "length": 0.5,
        "width": 0.5,
        "moves_at": 5.0,
        "speed_y": speed[1],
    }
    row |= {f"vehicle.scene.boxes[4].{key}": value for key, value in box.items()}
    first = ends.first_contact(row)
    assert first == ends.InitialContact(name, came)
    assert not ends.is_driven_into(row, first), "it drives"
    assert ends.is_driven_into({**row, "touched.speed": 0.005}, first) == (speed[1] != 0.0)
    assert not ends.is_driven_into({**row, "touched.speed": 0.0}, ends.InitialContact("kerb behind", False))


CAR = {"wheelbase": 2.405, "front_overhang": 0.8, "rear_overhang": 0.6, "width": 1.65}


def test_a_contact_of_the_table_comes_back(tmp_path: Path) -> None:
    """The first runs of a draw: each row says how it ended and who was touched; one that touched is run again."""
    made = select_study("apa-world", ["runs=60", "seed=1"])
    swept = sweep(made, tmp_path, Options())
    assert swept.table is not None
    table = Table(swept.table)
    ended, touched = table.column("end"), table.column("touched")
    assert set(ended.tolist()) <= set(ends.ENDS)
    assert ends.PARKED in ended
    assert {0.0, 1.0} == set(table.column("asked").tolist()) == set(table.column("valid").tolist())
    assert ((touched != "") == np.isfinite(table.column("touched.x"))).all()
    again = repeat_row(table, int(np.flatnonzero(ended == ends.PARKED)[0]), tmp_path / "again", "none", pages=False)
    assert again.different == []
