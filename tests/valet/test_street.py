"""The road's other side tells how the row goes where little of it was heard; what is free beside one neighbour."""

import math
from itertools import pairwise
from typing import Any

import pytest
from shapely.geometry import LineString, Point

from controller_fmu.planning.plan_store import RAYS, PlanStore
from controller_fmu.sensing import find_gap as module_of_gaps
from controller_fmu.sensing.around import SWUNG, SWUNG_DEEP, AroundGap, lay_around
from controller_fmu.sensing.find_gap import gap_across
from controller_fmu.sensing.gap import UNHEARD, Gap, GapLayout
from controller_fmu.sensing.heard_store import put_heard, put_ray
from controller_fmu.sensing.places import frame_of
from controller_fmu.sensing.row_line import RowLine, row_of
from controller_fmu.sensing.rows import Sides
from controller_fmu.sensing.street import street_of
from controller_fmu.valet.found import search
from controller_fmu.valet.params import ValetParams
from modelkit.store import new_store
from modelkit.vocabulary import Pose
from tests.valet.test_valet_search import LENGTH, WANTED

RIGHT, LEFT = 0, 1


def with_places(side: int, *things: tuple[float, float, int]) -> tuple[PlanStore, int]:
    """Return a store with things heard on a side: where [m], by how many echoes."""
    store, places = new_store(PlanStore), 0
    for x, y, count in things:
        for number in range(count):
            places = put_heard(store, side, places, x, y, number == 0)
    return store, places


def with_wall(length: float, turn: float) -> tuple[PlanStore, int]:
    """Return a store with a straight wall heard on the left, turned [rad], its middle 4 m away."""
    store, places = new_store(PlanStore), 0
    for number in range(int(length / 0.2) + 1):
        along = 0.2 * number - 0.5 * length
        places = put_heard(store, LEFT, places, along * math.cos(turn), 4.0 + along * math.sin(turn), number == 0)
    return store, places


@pytest.mark.parametrize("way", [0.0, 0.2, -0.2])
@pytest.mark.parametrize("turn", [0.0, 0.1, -0.1])
def test_what_is_longer_than_any_car_across_the_road_tells_how_it_goes(turn: float, way: float) -> None:
    store, places = with_wall(7.0, turn)
    heard = street_of(store, LEFT, places, Pose(0.0, 0.0, way), WANTED.half_angle)
    assert heard == pytest.approx(turn, abs=0.01)


@pytest.mark.parametrize(("length", "turn"), [(5.4, 0.0), (7.0, 0.4)])
def test_a_car_across_the_road_or_what_lies_across_it_tells_nothing(length: float, turn: float) -> None:
    store, places = with_wall(length, turn)
    assert street_of(store, LEFT, places, Pose(), WANTED.half_angle) == UNHEARD


PARTLY_HEARD = ((-5.8, -2.35, 6), (-1.3, -2.0, 20))
"""A corner of a car, and what was heard first of the side of the one before it, whose corner was not."""
ROW_OF_FOUR = ((-10.0, -2.0, 20), (-5.5, -2.0, 20), (-1.0, -2.0, 20), (3.5, -2.0, 20))
WITH_POST = ((-7.0, -2.0, 20), (-2.3, -2.0, 20), (4.0, -1.5, 20))


@pytest.mark.parametrize("way", [0.0, 0.1])
@pytest.mark.parametrize(
    ("things", "street", "row"),
    [
        (PARTLY_HEARD, UNHEARD, math.atan(0.35 / 4.5)),
        (PARTLY_HEARD, 0.0, 0.0),
        (PARTLY_HEARD, -0.05, -0.05),
        (WITH_POST, 0.0, 0.0),
        (ROW_OF_FOUR, 0.05, 0.0),
    ],
)
def test_a_row_of_few_things_goes_along_the_roads_other_side(
    things: tuple[tuple[float, float, int], ...], street: float, row: float, way: float
) -> None:
    store, places = with_places(RIGHT, *things)
    at = Pose(5.0, 0.0, way)
    line = row_of(store, frame_of(RIGHT, places, at, WANTED.half_angle), street)
    assert way - line.turn == pytest.approx(row, abs=1e-6)
    x, y = 5.0 - line.behind * math.sin(-row), -line.behind * math.cos(row)
    best = Point(things[1][0], things[1][1])
    assert LineString([(x - 20.0 * math.cos(row), y - 20.0 * math.sin(row)), (x, y)]).distance(best) < 0.005


@pytest.mark.parametrize(("side", "other"), [(RIGHT, LEFT), (LEFT, RIGHT)])
def test_the_side_that_tells_how_the_road_goes_is_the_other_one(
    monkeypatch: pytest.MonkeyPatch, side: int, other: int
) -> None:
    asked: list[int] = []

    def hearing(store: PlanStore, which: int, *_: Any) -> float:
        asked.append(which)
        return 0.25

    monkeypatch.setattr(search, "street_of", hearing)
    want = search.wanted_beside(new_store(PlanStore), search.begin_search(0), side, Pose(), ValetParams())
    assert asked == [other]
    assert want.street == 0.25


@pytest.mark.parametrize(("along", "across", "there"), [(2.6, 1.4, False), (2.6, 2.2, True), (2.0, 1.4, True)])
def test_cars_that_showed_a_long_side_are_not_taken_to_stand_the_other_way(
    monkeypatch: pytest.MonkeyPatch, along: float, across: float, there: bool
) -> None:
    found = Gap(layout=GapLayout.ACROSS, width=2.5)
    where = module_of_gaps.__name__
    monkeypatch.setattr(f"{where}.turn_of", lambda *_: 0.7)
    monkeypatch.setattr(f"{where}.row_of", lambda *_: RowLine(0.0, 1.0, 3))
    sides = {0.7: Sides(along), 0.7 + 0.5 * math.pi: Sides(across)}
    monkeypatch.setattr(f"{where}.sides_along", lambda _, __, angle: sides[angle])
    monkeypatch.setattr(f"{where}.corridor", lambda *_: found)
    gap = gap_across(new_store(PlanStore), RIGHT, 0, Pose(), WANTED, -0.7)
    assert gap == (found if there else Gap())


BESIDE_ONE = Gap(GapLayout.ACROSS, Pose(0.0, 0.0), Pose(2.6, 0.0), into=-0.5 * math.pi, width=2.6, depth=4.0)


def lines_around(free: float, heard: bool) -> list[LineString]:
    """Return the map of a slot beside one neighbour, known to be free so far [m] beyond it."""
    store, places = with_places(RIGHT, *((2.7, -0.1, 3),) * heard, (-3.0, 0.0, 5))
    for ray in range(min(RAYS, int((free + 0.6) / 0.1))):
        x = 2.3 + 0.1 * ray
        put_ray(store, RIGHT, ray, Pose(x, 1.0), Pose(x, -3.0))
    pose = Pose(6.0, 2.0, 0.0)
    what = AroundGap(RIGHT, places, 0, pose, 5.0, 0.9, 3.7, 0.9, 5.0, LENGTH, half_angle=0.08)
    count = lay_around(store, BESIDE_ONE, what)
    ends = [(store.around_x[n], store.around_y[n]) for n in range(2 * count)]
    return [LineString(pair) for pair in list(pairwise(ends))[::2]]


@pytest.mark.parametrize(
    ("free", "heard", "beyond"), [(3.0, False, SWUNG), (1.1, False, 1.25), (0.0, False, 0.0), (3.0, True, 0.0)]
)
def test_beside_one_neighbour_what_is_known_to_be_free_is_of_use_on_the_way_in(
    free: float, heard: bool, beyond: float
) -> None:
    lines = lines_around(free, heard)

    def nearest(x: float, y: float) -> float:
        return min(line.distance(Point(x, y)) for line in lines)

    deep = 0.5 * SWUNG_DEEP
    for step in range(12):
        x = 2.65 + 0.15 * step
        if x < 2.6 + beyond - 0.3:
            assert nearest(x, -deep) > 0.15
    side = 2.6 + max(beyond - 0.1, 0.0)
    assert nearest(side, -deep) < 0.06
    assert nearest(2.6, -SWUNG_DEEP - 0.5) < 0.01
