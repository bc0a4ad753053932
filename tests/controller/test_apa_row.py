"""The row that a slot lies in: the road's direction, the line between the corners, neighbours not heard, its kind."""

import math

import pytest

from controller_fmu.apa.around.closing import Track
from controller_fmu.apa.around.guard import GuardState, listen
from controller_fmu.apa.around.local_map import WALL as WALL_BEHIND
from controller_fmu.apa.around.local_map import begin_map, ear_at, expected, heard, moved
from controller_fmu.apa.around.row import (
    as_found,
    driven_on,
    is_certain,
    is_heard,
    is_in_the_middle,
    line_unsure,
    slot_heading,
    slot_of_map,
    without_gone,
)
from controller_fmu.apa.around.surroundings import Around, is_sure, settled_in, shape_of
from controller_fmu.apa.hearing.edge import Heard
from controller_fmu.apa.hearing.line_fit import Sums, add
from controller_fmu.apa.hearing.mute import MUTE
from controller_fmu.apa.hearing.search import SearchState, slot_of
from controller_fmu.apa.hearing.search_side import _in_gap
from controller_fmu.apa.hearing.side import GAP, NEXT_WALL, START, SideState
from controller_fmu.apa.params import MapParams
from controller_fmu.apa.slot import UNSEEN, Kind, Margins, Slot, line_of, target_of
from controller_fmu.registry import ControllerInput, ControllerParams
from modelkit.vocabulary import Pose
from tests.controller.test_apa_relocate import READINGS, SENSORS, inputs_at

PARAMS = ControllerParams()
MAP = MapParams()
FURTHEST = SENSORS.max_range
DEG = math.pi / 180.0


def between(kind: int = Kind.PARALLEL, length: float = 6.0, depth: float = UNSEEN) -> Slot:
    return Slot(kind, 0, Pose(), length, 0.0, depth)


@pytest.mark.parametrize(("wall", "least", "most"), [(0.0, 1.7, 2.4), (4.0, 3.0, 4.0), (30.0, 2.0, 6.0)])
def test_a_car_stands_half_way_between_the_road_and_neighbours_who_stand_askew(
    wall: float, least: float, most: float
) -> None:
    here = begin_map(between(depth=2.1), Pose(2.0, 1.5, 0.0), MAP)
    here = here._replace(
        a=here.a._replace(heading=4.0 * DEG, hh=1e-6),
        b=here.b._replace(heading=4.0 * DEG, hh=1e-6),
        wall=here.wall._replace(heading=wall * DEG, hh=1e-6),
    )
    assert least <= slot_heading(here, MAP) / DEG <= most


@pytest.mark.parametrize(
    ("heard_at", "kind", "gone"), [(1.9, 1, True), (0.6, 1, False), (MUTE, 1, False), (1.9, 2, False)]
)
def test_a_neighbour_behind_whom_the_rear_hears_past_has_gone(heard_at: float, kind: int, gone: bool) -> None:
    here = begin_map(between(kind), Pose(1.2, -0.9, 0.0), MAP)
    readings = (FURTHEST,) * 5 + (1.9, heard_at) + (FURTHEST,) * 5
    tracks = (Track(),) * 5 + (Track(1.9, 1.9), Track(heard_at, heard_at)) + (Track(),) * 5
    assert without_gone(here, tracks, readings, PARAMS).empty_a == gone


@pytest.mark.parametrize(
    ("one", "two", "kind", "by"),
    [(1.5, 1.6, 1, 0.9), (5.0, 5.0, 1, 1.2), (1.5, 0.6, 1, 0.0), (MUTE, 1.5, 1, 0.0), (1.5, 1.6, 2, 0.0)],
)
def test_a_neighbour_ahead_whom_the_front_hears_past_has_driven_on(
    one: float, two: float, kind: int, by: float
) -> None:
    front = PARAMS.car.wheelbase + PARAMS.car.front_overhang
    here = begin_map(between(kind), Pose(6.0 - front - 0.6, -0.9, 0.0), MAP)
    readings = (FURTHEST, one, two) + (FURTHEST,) * 9
    tracks = (Track(), Track(one, one), Track(two, two)) + (Track(),) * 9
    on = driven_on(here, tracks, readings, PARAMS)
    assert on.b.x - here.b.x == pytest.approx(by, abs=0.02)
    assert on.b.y == here.b.y
    assert (on.b.xx > here.b.xx) == (by > 0.0)


def test_echoes_of_a_flank_do_not_move_its_corner_across_the_road() -> None:
    pose, boxes = Pose(1.3, -0.9, 0.0), [(-4.4, 0.0, -1.8, 0.0), (6.0, 10.0, -1.8, 0.0)]
    believed = Pose(1.3, -0.9, 6.0 * DEG)
    here = begin_map(between(), believed, MAP)
    readings = inputs_at(pose, believed, boxes, 0).ultrasonic
    for _ in range(READINGS):
        here = heard(moved(here, believed, MAP), readings, SENSORS, MAP)
    assert here.a.hh < 0.5 * MAP.turned**2, "its flank is heard"
    assert here.a.y == 0.0


def test_a_corner_that_is_not_heard_goes_with_the_other_as_they_were_found() -> None:
    found = begin_map(between(), Pose(2.0, 1.5, 0.0), MAP)
    here = found._replace(a=found.a._replace(yy=0.15**2), b=found.b._replace(y=0.1, yy=0.015**2))
    line = as_found(here)
    assert 0.06 < line.a.y < 0.1
    assert line.b.y == pytest.approx(0.1, abs=0.002)
    assert line_unsure(here) < 0.7 * 0.5 * math.hypot(0.15, 0.015)
    assert as_found(found) == found._replace(
        a=found.a._replace(yy=line_part(found.a.yy, found.b.yy)),
        b=found.b._replace(yy=line_part(found.b.yy, found.a.yy)),
    )
    assert not is_certain(here._replace(b=here.b._replace(y=0.6)), MAP)


@pytest.mark.parametrize(
    ("a", "b", "sure"),
    [(0.7, 0.0, True), (0.1, 0.8, True), (0.0, -0.7, True), (-0.3, 0.0, True), (0.4, -0.3, False)],
)
def test_one_who_has_moved_in_a_row_across_the_road_tells_neither_direction_nor_line(
    a: float, b: float, sure: bool
) -> None:
    found = begin_map(between(Kind.PERPENDICULAR, 2.8), Pose(1.4, -3.0, 0.5 * math.pi), MAP)
    here = found._replace(a=found.a._replace(y=a), b=found.b._replace(y=b))
    assert is_certain(here, MAP) == sure
    if sure:
        slot = slot_of_map(here, between(Kind.PERPENDICULAR, 2.8), MAP)
        assert slot.a.heading == pytest.approx(0.0, abs=1e-9)
        assert slot.a.y + line_of(slot) == pytest.approx(min(a, b, key=abs), abs=0.02), "in line with the one who stays"


@pytest.mark.parametrize(("out", "least", "most"), [(0.3, 0.4, 3.0), (0.9, 0.0, 1e-9)])
def test_one_who_had_left_the_row_before_he_was_found_tells_no_direction(out: float, least: float, most: float) -> None:
    here = begin_map(between(Kind.PERPENDICULAR, 2.8)._replace(b_out=out), Pose(1.4, -3.0, 0.5 * math.pi), MAP)
    assert least <= slot_heading(here, MAP) / DEG <= most


@pytest.mark.parametrize(
    ("out", "kind", "surely", "enough"),
    [(0.08, 2, True, True), (0.115, 2, False, True), (0.115, 1, True, True), (0.135, 1, False, False)],
)
def test_a_car_across_the_road_that_stands_out_is_parked_if_nothing_leads_deeper(
    out: float, kind: int, surely: bool, enough: bool
) -> None:
    slot = between(kind, 2.8 if kind == Kind.PERPENDICULAR else 6.0)
    shape = shape_of(PARAMS)
    target = target_of(slot, shape, Margins())
    pose = target._replace(y=target.y + out)
    here = begin_map(slot, pose, MAP)
    readings = tuple(
        expected(ear_at(mount, pose, 1.0, SENSORS.half_angle), here).echo.distance for mount in SENSORS.mounts
    )
    settled = settled_in(ControllerInput(odometry=pose, ultrasonic=readings), Around(slot, here), PARAMS)
    assert settled == (surely, enough)


@pytest.mark.parametrize("gone", [0.0, 0.6])
def test_one_who_has_driven_off_along_the_road_stands_out_as_far_as_he_did(gone: float) -> None:
    found = begin_map(between(), Pose(2.0, 1.5, 0.0), MAP)
    here = found._replace(b=found.b._replace(x=found.b.x + gone, y=-0.3, yy=0.03**2), a=found.a._replace(yy=0.13**2))
    line = as_found(here)
    assert line.b.y == pytest.approx(-0.1 if gone else -0.3, abs=0.05)


@pytest.mark.parametrize(("off", "kind", "sure"), [(0.1, 1, True), (0.14, 1, False), (0.14, 2, True), (0.55, 2, False)])
@pytest.mark.parametrize("out", [1.0, -1.0])
def test_how_deep_a_car_stands_is_not_told_by_corners_that_contradict_each_other(
    off: float, kind: int, sure: bool, out: float
) -> None:
    """Further out against each other than they were found: the odometry has turned, or one was found badly."""
    found = begin_map(between(kind), Pose(2.0, 1.5, 0.0), MAP)
    a = found.a._replace(y=-0.5 * out * off)
    b = found.b._replace(y=0.5 * out * off)
    assert is_certain(found._replace(a=a, b=b), MAP) == sure


def line_part(own: float, other: float) -> float:
    """Return the variance of a corner that is heard on its own as ``own``, against 8 cm between both."""
    return own * (1.0 - own / (own + other + 0.08**2))


@pytest.mark.parametrize(
    ("silent", "stays"),
    [((), True), ((9,), True), ((8, 9), False), ((10, 11), False), ((9, 11), False), ((8, 10), True)],
)
def test_a_car_between_neighbours_that_are_not_there_is_not_parked(silent: tuple[int, ...], stays: bool) -> None:
    pose = Pose(1.6, -3.2, 0.5 * math.pi)
    here = begin_map(between(Kind.PERPENDICULAR, 3.2), pose, MAP)
    readings = [expected(ear_at(mount, pose, 1.0, SENSORS.half_angle), here).echo.distance for mount in SENSORS.mounts]
    readings = [SENSORS.max_range if number in silent else reading for number, reading in enumerate(readings)]
    assert is_heard(here, tuple(readings), PARAMS) == stays
    assert is_heard(here._replace(kind=Kind.PARALLEL), tuple(readings), PARAMS)


@pytest.mark.parametrize(("lost", "parked"), [(1, True), (2, True), (3, False)])
def test_echoes_lost_at_both_flanks_at_once_are_no_neighbours_gone(lost: int, parked: bool) -> None:
    slot = between(Kind.PERPENDICULAR, 2.8)
    pose = target_of(slot, shape_of(PARAMS), Margins())
    here = begin_map(slot, pose, MAP)
    readings = [expected(ear_at(mount, pose, 1.0, SENSORS.half_angle), here).echo.distance for mount in SENSORS.mounts]
    silent = tuple(SENSORS.max_range if number in (9, 11) else value for number, value in enumerate(readings))
    guard = GuardState()
    for heard_now in (tuple(readings),) * 5 + (silent,) * lost:
        guard = listen(guard, heard_now, here, PARAMS)
    around = Around(slot, here, guard)
    assert is_sure(ControllerInput(odometry=pose, ultrasonic=silent), around, PARAMS) == parked


def test_neighbours_are_heard_beside_a_wheel_stop_that_is_no_wall() -> None:
    """The map has a wall behind for a stop 1.6 m wide: the rear side sensors would hear it before the neighbours."""
    pose = Pose(2.4, -3.4, 0.5 * math.pi)
    here = begin_map(between(Kind.PERPENDICULAR, 4.8), pose, MAP)
    readings = tuple(
        expected(ear_at(mount, pose, 1.0, SENSORS.half_angle), here).echo.distance for mount in SENSORS.mounts
    )
    walled = here._replace(walled=True, wall=here.wall._replace(y=-4.1))
    rear = expected(ear_at(SENSORS.mounts[9], pose, 1.0, SENSORS.half_angle), walled)
    assert rear.who == WALL_BEHIND
    assert readings[9] > rear.echo.distance + 0.4
    assert is_heard(walled, readings, PARAMS)
    silent = tuple(SENSORS.max_range if number in (9, 11) else value for number, value in enumerate(readings))
    assert not is_heard(walled, silent, PARAMS)


@pytest.mark.parametrize(
    ("left", "right", "stays"),
    [
        ((1.0, 1.0), (1.2, 1.2), True),
        ((0.9, 0.9), (1.2, 1.2), False),
        ((1.2, 1.2), (0.9, 0.9), False),
        ((0.9, 1.2), (1.2, 0.9), True),
        ((0.9, 1.2), (1.2, 1.2), True),
        ((0.9, 0.9), (1.2, 5.0), True),
    ],
)
def test_a_car_that_hears_itself_aside_of_the_middle_is_not_parked(
    left: tuple[float, float], right: tuple[float, float], stays: bool
) -> None:
    """By front and rear, not where it is turned, where one pair hears past an end or one sensor hears nobody."""
    here = begin_map(between(Kind.PERPENDICULAR, 4.0), Pose(2.0, -3.0, 90.0 * DEG), MAP)
    readings = (5.0,) * 8 + left + right
    assert is_in_the_middle(here, readings, PARAMS) == stays
    assert is_in_the_middle(here._replace(kind=Kind.PARALLEL), readings, PARAMS)


def passed(behind: int) -> SideState:
    """Return a side after a neighbour 1.8 m long, a gap of 5 m with ``behind`` echoes 3 m deep in it, and another."""
    sums = [Sums(), Sums(), Sums()]
    for n in range(10):
        sums[0] = add(sums[0], -1.8 + 0.2 * n, 0.0, 1.0)
        sums[2] = add(sums[2], 5.0 + 0.1 * n, 0.0, 1.0)
    for n in range(behind):
        sums[1] = add(sums[1], 2.0 + 0.2 * n, 0.0, 4.0)
    return START._replace(before=sums[0], behind=sums[1], sums=sums[2], extent=1.8, edge=0.0, edge_b=5.0)


@pytest.mark.parametrize(
    ("behind", "kind"), [(0, Kind.PERPENDICULAR), (1, Kind.PERPENDICULAR), (2, Kind.PERPENDICULAR), (3, Kind.PARALLEL)]
)
def test_what_ends_a_slot_beside_a_narrow_neighbour_is_told_by_three_echoes(behind: int, kind: Kind) -> None:
    slot = slot_of(SearchState(), passed(behind), 0, shape_of(PARAMS), PARAMS.apa)
    assert slot.kind == kind
    assert (slot.depth < UNSEEN) == (behind == 3)


def test_the_end_of_a_neighbour_that_the_cone_leaves_is_not_the_next_one() -> None:
    side = passed(0)._replace(mode=GAP)
    sample = Heard(1.0, 0.0, 1.1)
    assert _in_gap(side, sample, False, SENSORS.half_angle, PARAMS.apa.search).mode == NEXT_WALL
    assert _in_gap(side, sample, True, SENSORS.half_angle, PARAMS.apa.search).mode == GAP
