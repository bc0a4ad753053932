"""The parking study: what stands in its scenes, outcomes by the scene alone."""

import itertools
import math
from typing import NamedTuple

import numpy as np
import pytest

from modelkit.geometry import Box, boxes_overlap, orient, outline, overlap_depth
from modelkit.vocabulary import Pose
from orchestrator.evaluation.verdict.truth import CAR_KEYS
from orchestrator.studies.parking.parking_world.bays import bay_count, in_bays, stands_in_a_bay
from orchestrator.studies.parking.parking_world.factors import FACTORS, HITCH
from orchestrator.studies.parking.parking_world.outcome import (
    DRIVER,
    EMPTY,
    FALSE,
    MOVING,
    PARKED,
    STANDING,
    end_of,
    is_unavoidable,
    is_valid,
)
from orchestrator.studies.parking.parking_world.pedestrian import FIRST_LEG, SECOND_LEG
from orchestrator.studies.parking.parking_world.scene import BIN, NEIGHBOUR, OVERHANG, ROWS, parameters
from orchestrator.studies.sweep.study.space import Space
from vehicle_fmu.scene import Obstacle, is_there, obstacle_box

SPACE = Space(FACTORS, lambda values, seeds: np.zeros((len(seeds), 1)))
PLACED = ("x", "y", "heading", "length", "width")
ROW = {"kind": 0, "outcome": "parked", "reason": "all checks passed", "steered": 1.0, "touched.speed": float("nan")}


def drawn(count: int = 200) -> dict[str, np.ndarray]:
    return SPACE.values_by_name(np.random.default_rng(5).random((count, len(FACTORS))))


def test_cars_of_a_row_stand_apart_by_their_gap() -> None:
    f = drawn() | {"bend": np.zeros(200), "angled": np.zeros(200)}
    found = parameters(f, np.arange(1, 201))
    along = np.where(f["kind"] == 0, f["length_b"], f["width_b"])
    first, second = (found[f"scene.boxes[{number}].x"] for number in ROWS["b"][:2])
    lined = in_bays(f)
    assert (second - first - along)[~lined] == pytest.approx(f["gap_b"][~lined])
    assert (second - first)[lined] == pytest.approx(f["bay"][lined])
    for place, number in enumerate(ROWS["a"]):
        length = found[f"scene.boxes[{number}].length"]
        assert (length[f["cars_a"] <= place] == 0.0).all()
        assert (length[f["cars_a"] > place] > 0.0).mean() > 0.8  # the others would be in the driver's way


def test_a_hitch_shortens_a_parallel_slot_and_a_bin_leaves_none() -> None:
    f = drawn() | {"bend": np.zeros(200), "angled": np.zeros(200)}
    found = parameters(f, np.arange(1, 201))
    valid = is_valid(f | found)
    short = (f["kind"] == 0) & (f["overhang"] >= HITCH) & (f["overhang_length"] > f["extra"]) & (f["pillar"] != 2)
    assert short.any()
    assert not valid[short].any()
    assert not valid[found[f"scene.boxes[{BIN}].length"] > 0.0].any()
    beside = (f["kind"] == 0) & (found[f"scene.boxes[{OVERHANG}].length"] > 0.0)
    x, length = (found[f"scene.boxes[{OVERHANG}].{name}"][beside] for name in ("x", "length"))
    assert x - 0.5 * length == pytest.approx(np.zeros(beside.sum()))
    assert valid.mean() > 0.5


class DrawnScene(NamedTuple):
    """The scene of one row: obstacles by number, the car's sizes, and the driver's pass."""

    obstacles: dict[int, Obstacle]
    car: list[float]
    start: Pose
    end: float
    speed: float
    acceleration: float
    curvature: float

    def driver_at(self, travelled: float) -> Pose:
        """The pose after ``travelled`` [m] on the arc that the driver follows."""
        x, y, heading = self.start
        turn = self.curvature * travelled
        chord = travelled * np.sinc(0.5 * turn / np.pi)
        along = heading + 0.5 * turn
        return Pose(x + chord * math.cos(along), y + chord * math.sin(along), heading + turn)

    def boxes(self, time: float) -> dict[int, Box]:
        time_ns = round(time * 1e9)
        return {n: obstacle_box(item, time_ns) for n, item in self.obstacles.items() if is_there(item, time_ns)}

    def moves(self, number: int) -> bool:
        return bool(self.obstacles[number].speed_x or self.obstacles[number].speed_y)


@pytest.fixture(scope="module")
def scenes() -> list[DrawnScene]:
    count = 120
    f = drawn(count)
    found = {name: np.broadcast_to(values, count) for name, values in parameters(f, np.arange(1, count + 1)).items()}
    slot = np.where(f["kind"] == 0, found["slot.length"], found["slot.width"])
    return [
        DrawnScene(
            {
                number: Obstacle(
                    *(
                        float(found.get(f"scene.boxes[{number}].{name}", {row: start})[row])
                        for name, start in EMPTY.items()
                    )
                )
                for number in range(1, SECOND_LEG + 1)
            },
            [float(found[key][row]) for key in CAR_KEYS],
            Pose(*(float(found[f"vehicle.start.{axis}"][row]) for axis in ("x", "y", "heading"))),
            float(slot[row] + 12.0),
            float(found["vehicle.driver.profile[1].speed"][row]),
            float(found["vehicle.drive.acceleration_limit"][row]),
            float(found["vehicle.driver.road_curvature"][row]),
        )
        for row in range(count)
    ]


def test_nothing_in_a_scene_overlaps(scenes: list[DrawnScene]) -> None:
    attached = {1, OVERHANG}
    for row, scene in enumerate(scenes):
        for time in np.arange(0.0, 65.0, 1.0):
            boxes = scene.boxes(time)
            for a, b in itertools.combinations(boxes, 2):
                if {a, b} != attached and (time == 0.0 or scene.moves(a) or scene.moves(b)):
                    assert overlap_depth(orient(boxes[a]), orient(boxes[b])) < 1e-6, (row, time, a, b)


def test_nothing_stands_in_the_drivers_pass(scenes: list[DrawnScene]) -> None:
    for row, scene in enumerate(scenes):
        standing = scene.boxes(0.0)
        for travelled in np.arange(0.0, scene.end - scene.start.x, 0.25):
            car = outline(scene.driver_at(travelled), *scene.car)
            assert not any(boxes_overlap(car, box) for box in standing.values()), (row, travelled)


def test_no_driver_meets_a_pedestrian(scenes: list[DrawnScene]) -> None:
    """Neither who searches as fast as the profile says, nor who slows down to 10 km/h from the begin."""
    for row, scene in enumerate(scenes):
        for speed in {scene.speed, min(scene.speed, 10.0 / 3.6)}:
            for time in np.arange(0.0, 40.0, 0.1):
                travelled = max(speed * time - 0.5 * speed**2 / scene.acceleration, 0.0)
                there = scene.boxes(time)
                if travelled < scene.end - scene.start.x and FIRST_LEG in there:
                    car = outline(scene.driver_at(travelled), *scene.car)
                    assert not boxes_overlap(car, there[FIRST_LEG]), (row, time)


def test_pedestrians_turn_where_they_are(scenes: list[DrawnScene]) -> None:
    turned = 0
    for scene in scenes:
        first, second = scene.obstacles[FIRST_LEG], scene.obstacles[SECOND_LEG]
        if first.length > 0.0 and second.length > 0.0:
            turned += 1
            walked = first.disappear_at - first.moves_at
            corner = (first.x + first.speed_x * walked, first.y + first.speed_y * walked)
            assert corner == pytest.approx((second.x, second.y))
            assert second.appear_at == first.disappear_at
    assert turned > 5


@pytest.mark.parametrize("bend", [3.0, 4.0])
def test_cars_in_a_bend_stand_along_its_arc(bend: float) -> None:
    """Their fronts touch the circle about the bend's centre, which is in the row's distance from the slot's mouth."""
    nominal = SPACE.values_by_name(SPACE.nominal()[None])
    for kind, side, radius in itertools.product((0.0, 1.0), (0.0, 1.0), (30.0, 60.0)):
        changed = {"kind": kind, "side": side, "bend": bend, "bend_radius": radius, "cars_a": 3.0, "cars_b": 3.0}
        f = nominal | {name: np.array([value]) for name, value in changed.items()}
        found = parameters(f, np.array([1]))
        slot = float(found["slot.length" if kind == 0.0 else "slot.width"][0])
        into = -1.0 if side == 0.0 else 1.0
        sense = into if bend == 3.0 else -into
        centre = (0.5 * slot, sense * radius * math.cos(math.asin(0.5 * slot / radius)))
        for number in (1, 2, *ROWS["a"], *ROWS["b"]):
            box = Obstacle(*(float(found.get(f"scene.boxes[{number}].{n}", {0: v})[0]) for n, v in EMPTY.items()))
            depth = 0.5 * box.width
            front = (box.x + into * depth * math.sin(box.heading), box.y - into * depth * math.cos(box.heading))
            assert math.dist(front, centre) == pytest.approx(radius, abs=0.12), (number, kind)
            tangent = math.atan((box.x - centre[0]) / (centre[1] - box.y))
            assert box.heading == pytest.approx(tangent, abs=0.02), (number, kind)
        driver = float(found["vehicle.driver.road_curvature"][0])
        assert 1.0 / driver == pytest.approx(sense * (radius + (2.0 if bend == 3.0 else -2.0)), abs=1.0)


@pytest.mark.parametrize("angled", [4.0, 5.0])
def test_cars_of_an_angled_row_leave_the_slot_its_width(angled: float) -> None:
    """Between the neighbours' flanks, in the middle of which the vehicle stands, flush with the row."""
    nominal = SPACE.values_by_name(SPACE.nominal()[None])
    for side, lean, extra in itertools.product((0.0, 1.0), (10.0, 45.0), (0.0, 2.0)):
        row = {"kind": 1.0, "angled": angled, "side": side, "lean": lean, "extra": extra, "cars_a": 3.0, "cars_b": 3.0}
        f = nominal | {name: np.array([value]) for name, value in row.items()}
        found = {name: float(np.broadcast_to(value, 1)[0]) for name, value in parameters(f, np.array([1])).items()}
        straight = parameters(f | {"angled": np.zeros(1)}, np.array([1]))
        into = 1.0 - 2.0 * side
        for number in (1, 2, *ROWS["a"], *ROWS["b"]):
            box = Obstacle(**{name: found.get(f"scene.boxes[{number}].{name}", 0.0) for name in PLACED})
            assert into * box.heading == pytest.approx(math.radians(lean if angled == 4.0 else -lean))
            assert _outermost(obstacle_box(box, 0), into) == pytest.approx(0.0)
        assert found["slot.width"] == float(straight["slot.width"][0])
        target = Pose(*(found[f"target.{axis}"] for axis in ("x", "y", "heading")))
        assert _outermost(outline(target, *(found[key] for key in CAR_KEYS)), into) == pytest.approx(0.0)
        assert (into * math.sin(target.heading) < 0.0) == (angled == 4.0)  # front first: away from the road
        for which, number in NEIGHBOUR.items():
            dx, dy = (found[f"scene.boxes[{number}].{axis}"] - found[f"target.{axis}"] for axis in "xy")
            aside = abs(dx * math.sin(target.heading) - dy * math.cos(target.heading))
            assert aside == pytest.approx(0.5 * (found["slot.width"] + f[f"width_{which}"][0]))


def _outermost(box: Box, into: float) -> float:
    """Return how far [m] a box stands out into the road; ``into``: 1 for a slot on the right, -1 on the left."""
    reach = box.length * abs(math.sin(box.heading)) + box.width * abs(math.cos(box.heading))
    return into * box.y + 0.5 * reach


def test_one_bay_is_a_slot_and_two_together_are_none() -> None:
    f = {name: values[:1] for name, values in drawn(1).items()}
    f |= {
        name: np.array([value])
        for name, value in {"kind": 1.0, "bays": 4.0, "bay": 2.5, "side": 0.0, "car": 0.0}.items()
    }
    f |= {f"{name}_{which}": np.zeros(1) for name in ("turn", "stagger") for which in "ab"}
    found = parameters(f, np.array([1]))
    assert bay_count(f) == 2.0
    columns = {**f, **{name: np.asarray(values) for name, values in found.items()}, "manoeuvres": np.array([1])}

    def stands(x: float, heading: float) -> bool:
        pose = {"x": found["target.x"] + x, "y": found["target.y"], "heading": found["target.heading"] + heading}
        return bool(stands_in_a_bay({**columns, **{f"final.{axis}": value for axis, value in pose.items()}})[0])

    assert stands(0.0, 0.0)
    assert stands(2.5, 0.0)
    assert not stands(1.25, 0.0)  # on the line
    assert not stands(5.0, 0.0)  # in the neighbour's bay
    assert not stands(1.25, -0.5 * math.pi)  # along the road across both


@pytest.mark.parametrize(("speed", "walks_at", "unavoidable"), [(0.0, 0.0, True), (1.0, 0.0, False), (1.0, 1e3, False)])
def test_what_would_have_been_touched_standing(speed: float, walks_at: float, unavoidable: bool) -> None:
    """A pedestrian crosses at x = 4 before a car that reaches up to x = 3.9; 1 m farther back it is clear of him."""
    person = {"x": 4.0, "y": -3.0, "length": 0.5, "width": 0.5, "speed_y": 1.0, "moves_at": walks_at}
    row = {f"vehicle.scene.boxes[{FIRST_LEG}].{name}": value for name, value in person.items()}
    row |= dict(zip(CAR_KEYS, (2.6, 0.9, 0.8, 1.8), strict=True))
    row |= {"touched.x": 0.4, "touched.y": 0.0, "touched.heading": 0.0, "touched.front_wheel_angle": 0.0}
    assert is_unavoidable({**row, "touched.speed": speed, "touched.time": 2.0}) == unavoidable


@pytest.mark.parametrize(
    ("changed", "end"),
    [
        ({}, PARKED),
        ({"within parallel": False}, FALSE),
        ({"touched.speed": -0.06}, MOVING),
        ({"touched.speed": 0.05}, STANDING),
        ({"touched.speed": 0.5, "touched.steering_active": 0.0}, DRIVER),
        ({"touched.speed": 0.5, "touched.takeover": 1.0}, DRIVER),
        ({"touched.speed": 0.0, "touched.steering_active": 0.0}, STANDING),
    ],
)
def test_how_a_run_ends(changed: dict[str, float], end: str) -> None:
    from orchestrator.studies.parking.parkings import GBT
    from orchestrator.studies.sweep.columns import WITHIN

    within = changed.get("within parallel", True)
    row = {**ROW, "touched.takeover": 0.0, "touched.steering_active": 1.0, **changed, WITHIN.format(GBT[1]): within}
    assert end_of(row) == end


def test_a_wheel_stop_that_is_detected_under_the_tail_leaves_no_slot() -> None:
    f = {name: values[:4] for name, values in drawn().items()}
    f |= {"kind": np.ones(4), "bays": np.zeros(4), "bin": np.zeros(4), "extra": np.ones(4)}
    f |= {"behind": np.array([2, 2, 2, 1]), "kerb_height": np.array([0.12, 0.05, 0.12, 0.12])}
    f |= {"depth": np.array([0.1, 0.1, 1.5, 0.1])}
    found = parameters(f, np.arange(1, 5))
    assert is_valid(f | found).tolist() == [False, True, True, True]


def test_factors_may_have_one_value_in_all_runs() -> None:
    from orchestrator.commands.sweep import select_study
    from orchestrator.inputs.text.errors import BadInput

    sets = ["runs=40", "mild=1", "kind=perpendicular", "bays=2", "bay=2.3", "overhang=hitch"]
    values = select_study("parking-world", sets).design.labels
    assert {name: set(values[name]) for name in ("kind", "bays", "overhang")} == {
        "kind": {1.0},
        "bays": {4.0},
        "overhang": {float(HITCH)},
    }
    assert values["bay"] == pytest.approx(np.full(40, 2.3))
    assert np.abs(values["heading"]).max() <= 4.0
    assert len(set(values["extra"])) == 40
    wrong_factors = ("bay=2.2", "bay=wide", "bay=2.5 deg", "kind=angled", "kind=0.5", "kind=2", "bays=4", "bays=0")
    for wrong in (*wrong_factors, "mild=7", "runs=0"):
        with pytest.raises(BadInput, match=r"expected|neither"):
            select_study("parking-world", [wrong])
    with pytest.raises(BadInput, match="expected a finite number"):
        select_study("parking-world", ["bay=nan"])
    assert set(select_study("parking-world", ["runs=2", "bay=250 cm"]).design.labels["bay"]) == {2.5}
    with pytest.raises(BadInput, match="no such key; did you mean bay"):
        select_study("parking-world", ["bey=2.5"])
