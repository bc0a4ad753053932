"""A slot that was found, as it turns out on the way in: turned as flanks and kerb are, its neighbours the other way."""

import math
from typing import Any

import pytest
from shapely.geometry import LineString, Polygon

from controller_fmu.planning.plan import PATH, Path, Piece
from controller_fmu.planning.plan_store import HEARD, SIDES, PlanStore
from controller_fmu.planning.task import CORNERS, Corner, drive
from controller_fmu.sensing.around import AroundGap, lay_around
from controller_fmu.sensing.ear import SideEar
from controller_fmu.sensing.find_gap import gap_across
from controller_fmu.sensing.gap import DEEP, Gap, GapLayout
from controller_fmu.sensing.heard_store import put_heard
from controller_fmu.sensing.in_gap import point_in_gap
from controller_fmu.valet.chart import Step
from controller_fmu.valet.driven import heard_on
from controller_fmu.valet.found.at_end import is_beside
from controller_fmu.valet.found.beside import SENSORS, SideEchoes, hear_beside, put_beside
from controller_fmu.valet.found.corrected import corrected, turned_gap
from controller_fmu.valet.found.nearby import Nearby, forget_under
from controller_fmu.valet.found.search import Search
from controller_fmu.valet.found.way_back import path_back, way_back
from controller_fmu.valet.params import ValetParams, ValetSearchParams
from controller_fmu.valet.sight import Sight, end_ahead, heard_again
from controller_fmu.valet.signals import ValetInput
from controller_fmu.valet.slot import is_in_place
from controller_fmu.valet.state import ValetState
from modelkit.store import new_store
from modelkit.vocabulary import Pose
from tests.planning.plan_model import Scene
from tests.valet.looks import look
from tests.valet.test_valet_search import WANTED, passed, row

LENGTH, WIDTH = 4.0, 1.8
ACROSS = Gap(GapLayout.ACROSS, Pose(0.0, 0.0), Pose(2.8, 0.0), -0.5 * math.pi, width=2.8)
ALONG = Gap(GapLayout.ALONG, Pose(0.0, 0.0), Pose(5.5, 0.0), -0.5 * math.pi, width=5.5)
OUTLINE = ((-0.9, -0.9), (-0.9, 0.9), (3.7, 0.9), (3.7, -0.9))


def heard(*lines: Any) -> Any:
    """Return a store whose first ears heard these lines, (x, y) to (x, y), every 15 cm, each place three times."""
    store, ears = new_store(PlanStore), []
    for number, (one, other) in enumerate(lines):
        places = 0
        count = int(math.dist(one, other) / 0.15)
        for step in range(count + 1):
            x, y = (a + (b - a) * step / count for a, b in zip(one, other, strict=True))
            for again in range(3):
                places = put_heard(store, SIDES + number, places, x, y, step == 0 and again == 0)
        ears.append(SideEar(places=places))
    return store, Nearby(tuple(ears) + (SideEar(),) * (4 - len(ears)))


@pytest.mark.parametrize(("a", "b", "turn"), [(3.0, 3.0, 3.0), (5.0, -1.0, 2.0), (-4.0, None, -2.0), (None, None, 0.0)])
def test_a_slot_is_turned_as_the_mean_of_its_neighbours_flanks(a: Any, b: Any, turn: Any) -> None:
    flanks = [(x, math.radians(angle)) for x, angle in ((0.0, a), (2.8, b)) if angle is not None]
    lines = [((x - 0.5 * t, -0.5), (x + 2.0 * t, -3.0)) for x, t in ((x, math.tan(angle)) for x, angle in flanks)]
    store, nearby = heard(*lines)
    gap = turned_gap(store, nearby, ACROSS, LENGTH)
    assert gap.into - ACROSS.into == pytest.approx(math.radians(turn), abs=math.radians(0.2))
    middle = point_in_gap(1.4, -0.5 * LENGTH, gap)
    assert (middle.across, middle.deep) == pytest.approx((1.4, 0.5 * LENGTH))
    again = corrected(store, nearby, gap, LENGTH, told=False)
    if a == b == 3.0:
        beside = (0.5 * again.width, point_in_gap(1.4 + 0.75 * math.tan(math.radians(3.0)), -2.5, again).across)
        assert beside[1] == pytest.approx(beside[0], abs=0.06)


def test_a_slot_along_the_road_is_turned_as_its_kerb() -> None:
    tan = math.tan(math.radians(2.5))
    store, nearby = heard(((1.5, -2.1 + 1.25 * tan), (4.0, -2.1 - 1.25 * tan)))
    gap = turned_gap(store, nearby, ALONG, WIDTH)
    assert gap.into - ALONG.into == pytest.approx(-math.radians(2.5), abs=math.radians(0.2))
    depth = corrected(store, nearby, gap, WIDTH, told=False).depth
    assert depth == pytest.approx(2.1, abs=0.06)


def test_a_post_makes_a_slot_as_wide_as_it_is_there() -> None:
    store, nearby = heard(((-0.3, -0.7), (-0.3, -1.1)), ((2.6, -0.7), (2.6, -1.1)))
    gap = corrected(store, nearby, ACROSS, LENGTH, told=False)
    assert gap.a.x == pytest.approx(-0.3, abs=0.01)
    assert gap.width == pytest.approx(2.9, abs=0.02)
    told = corrected(store, nearby, ACROSS, LENGTH, told=True)
    assert (told.a.x, told.width) == pytest.approx((0.0, 2.6), abs=0.02)


@pytest.mark.parametrize(("angle", "there"), [(45, True), (90, False)])
def test_cars_at_an_angle_may_stand_the_other_way(angle: Any, there: Any) -> None:
    store, ear, gap = passed(row(angle, 1, 3.4), 1, 0.01)
    at = Pose(8.0, 2.0, 0.0)
    assert gap.layout == GapLayout.ACROSS
    wrong = gap.into - 0.5 * math.pi if angle == 45 else gap.into
    other = gap_across(store, 0, ear.places, at, WANTED._replace(at_end=True), wrong)
    assert (other.layout == GapLayout.ACROSS) == there
    if there:
        assert other.into == pytest.approx(gap.into, abs=math.radians(2.0))


@pytest.mark.parametrize("heading", [0.0, -0.25])
def test_a_row_that_was_not_heard_is_not_where_the_car_has_driven(heading: float) -> None:
    store = new_store(PlanStore)
    places = 0
    for step in range(30):
        places = put_heard(store, 0, places, -3.0 + 0.1 * step, 0.0, step == 0)
    pose = Pose(4.5, 1.6, heading)
    what = AroundGap(0, places, 0, pose, 5.0, 0.9, 3.7, 0.9, 5.0, LENGTH)
    lines = lay_around(store, ACROSS._replace(row=0.0, out=0.2), what)
    c, s = math.cos(heading), math.sin(heading)
    corners = [(pose.x + x * c - y * s, pose.y + x * s + y * c) for x in (-0.9, 3.7) for y in (-0.9, 0.9)]
    car = Polygon([corners[n] for n in (0, 1, 3, 2)])
    ends = [(store.around_x[n], store.around_y[n]) for n in range(2 * lines)]
    assert lines > 5
    assert min(LineString(ends[2 * n : 2 * n + 2]).distance(car) for n in range(lines)) > 0.2
    assert store.heard_count[HEARD] == 0


def test_beside_one_neighbour_no_other_is_taken_to_stand_where_the_car_stands() -> None:
    store, places = new_store(PlanStore), 0
    for step in range(31):
        places = put_heard(store, 0, places, -3.0 + 0.1 * step, 0.0, step == 0)
    pose = Pose(1.9, 1.4, -0.25)
    lines = lay_around(store, ACROSS, AroundGap(0, places, 0, pose, 5.0, 0.9, 3.7, 0.9, 5.0, LENGTH))
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    car = Polygon([(pose.x + x * c - y * s, pose.y + x * s + y * c) for x, y in OUTLINE])
    ends = [(store.around_x[n], store.around_y[n]) for n in range(2 * lines)]
    assert min(LineString(ends[2 * n : 2 * n + 2]).distance(car) for n in range(lines)) > 0.2
    assert store.around_y[2] < -0.6


def test_a_move_that_ends_before_something_near_is_driven_to_its_end() -> None:
    params = ValetParams()._replace(search=ValetSearchParams()._replace(active=True))
    wall = params.car.wheelbase + params.car.front_overhang + 0.15
    corners = ((wall, -3.0), (wall, 3.0), (wall + 1.0, 3.0), (wall + 1.0, -3.0))
    scene = Scene(tuple(Corner(*corner, 1) for corner in corners) + (Corner(),) * (CORNERS - 4))
    near = [(5.0, reading, reading) + (5.0,) * 9 for reading in (0.15, 0.06)]
    blocked = [look(near[0], Pose(), Piece(way), 0.0, scene, False, params).blocked for way in (1.0, 0.1, 0.05)]
    assert blocked == [True, True, False]
    assert look(near[1], Pose(), Piece(0.05), 0.0, scene, False, params).blocked


def test_a_corner_that_is_as_good_as_touched_stops_the_car_though_the_map_has_it() -> None:
    params = ValetParams()._replace(search=ValetSearchParams()._replace(active=True))
    for reading, stops in ((0.20, True), (0.22, False)):
        mount = params.car.ultrasonic.mounts[0]
        x, y = mount.x + reading * math.cos(mount.yaw), mount.y + reading * math.sin(mount.yaw)
        corners = ((x, y - 0.01), (x, y + 0.01), (x + 0.01, y + 0.01), (x + 0.01, y - 0.01))
        scene = Scene(tuple(Corner(*corner, 1) for corner in corners) + (Corner(),) * (CORNERS - 4))
        assert look((reading,) + (5.0,) * 11, Pose(), Piece(1.0), 0.0, scene, False, params).blocked == stops


@pytest.mark.parametrize(("lost", "there"), [(0.1, True), (2.0, False)])
def test_what_a_slot_ends_at_is_so_though_one_of_two_sensors_misses_an_echo(lost: Any, there: Any) -> None:
    before = Sight(blocked=True, ahead=True, echo=Pose(5.0, 0.0, 0.0))
    now = before._replace(ahead=False, echo=Pose(5.0, lost, 0.0))
    assert heard_again(now, before).ahead == there
    assert not heard_again(now._replace(blocked=False), before).ahead
    assert not heard_again(now, before._replace(ahead=False)).ahead


@pytest.mark.parametrize(("piece", "left", "used"), [(2, 0.3, 2), (2, 0.7, 1), (1, 0.0, 1), (3, 0.1, 1), (3, 0.95, 0)])
def test_the_way_back_is_the_way_driven_to_the_last_change_of_gear(piece: Any, left: Any, used: Any) -> None:
    ways = ((0.9, 0.1), (-0.5, 0.2), (-0.7, 0.0), (1.0, -0.2))
    pieces = tuple(Piece(way, k) for way, k in ways) + (Piece(),) * (PATH - 4)
    back = path_back(way_back(Path(4, 0.12, 3.1, pieces), piece, left))
    assert back.used == used
    at = Pose()
    for way, k in ways[:piece]:
        at = drive(at, way, k)
    sense = math.copysign(1.0, ways[piece][0])
    at = drive(at, ways[piece][0] - sense * left, ways[piece][1])
    for number in range(back.used):
        at = drive(at, back.pieces[number].way, back.pieces[number].k)
    turned = {(2, 0.3): 1, (2, 0.7): 1, (1, 0.0): 1, (3, 0.1): 3}.get((piece, left))
    if turned is not None:
        there = Pose()
        for way, k in ways[:turned]:
            there = drive(there, way, k)
        assert at == pytest.approx(there, abs=1e-9)


def test_a_standing_car_is_put_right_by_the_nearer_of_its_neighbours_and_by_the_kerb() -> None:
    params = ValetParams()
    car = params.car
    middle = 0.5 * (car.wheelbase + car.front_overhang - car.rear_overhang)
    for gap, pose, sides in (
        (ACROSS, Pose(1.4, -2.0 + middle, -0.5 * math.pi), {SENSORS[0]: 0.7, SENSORS[3]: 0.3}),
        (ALONG, Pose(2.75 - middle, -1.0, 0.0), {SENSORS[0]: 0.5, SENSORS[1]: 0.5}),
    ):
        readings = tuple(sides.get(sensor, car.ultrasonic.max_range) for sensor in range(12))
        beside = SideEchoes()
        for _ in range(3):
            beside = hear_beside(beside, ValetInput(ultrasonic=readings), params)
        assert (beside.cycles, sum(beside.heard)) == (3, 6)
        store, nearby = heard()
        nearby = put_beside(store, nearby, beside, pose, Search(gap=gap), params)
        now = corrected(store, nearby, gap, LENGTH if gap is ACROSS else WIDTH, told=False)
        if gap is ACROSS:
            mount = car.ultrasonic.mounts[SENSORS[3]].y
            assert (now.a.x, now.width) == pytest.approx((0.0, 1.4 + mount + 0.3), abs=0.01)
        else:
            assert now.depth == pytest.approx(1.5 - car.ultrasonic.mounts[SENSORS[0]].y, abs=0.01)


def test_a_car_stands_where_nothing_else_does() -> None:
    params = ValetParams()
    half = 0.5 * params.car.width
    store, nearby = heard(((1.0, half - 0.2), (1.0, half + 0.2)))
    places = range(SIDES * HEARD, SIDES * HEARD + nearby.ears[0].places)
    forget_under(store, nearby, Pose(), params)
    assert [store.heard_count[place] for place in places] == [0, 0, 3]


def test_across_the_road_a_car_that_listens_stands_nearer_to_the_middle() -> None:
    params = ValetParams()._replace(search=ValetSearchParams()._replace(active=True))
    for gap, aside, stays in ((ACROSS, 0.06, False), (ACROSS, 0.04, True), (ALONG, 0.06, True)):
        state = ValetState(step=Step.STRAIGHTEN, search=Search(gap=gap), plans=2)
        assert is_in_place(Pose(0.0, aside), Pose(), params)
        assert is_beside(state, Pose(0.0, aside), Pose(), params) != stays
        assert not is_beside(state._replace(plans=7), Pose(0.0, aside), Pose(), params)


@pytest.mark.parametrize("degrees", [30.0, 45.0, 150.0])
def test_a_slot_at_an_angle_that_is_narrower_lies_on_along_its_row(degrees: float) -> None:
    into = -math.radians(degrees)
    e = Pose(-math.sin(into), math.cos(into))
    b = Pose(2.8 / abs(math.sin(into)), 0.0)
    gap = Gap(GapLayout.ACROSS, Pose(), b, into, width=2.8, depth=4.8, front=0.3, row=0.0)
    post = (0.5 * e.x + 1.0 * math.cos(into), 0.5 * e.y + 1.0 * math.sin(into))
    store, nearby = heard((post, (post[0] + 0.2 * math.cos(into), post[1] + 0.2 * math.sin(into))))
    now = corrected(store, nearby, gap, LENGTH, told=False)
    assert now.width == pytest.approx(2.3, abs=0.01)
    fronts = [one.a.y + one.front * math.sin(into) + 0.5 * one.width * e.y for one in (gap, now)]
    assert fronts[1] == pytest.approx(fronts[0], abs=0.01)
    assert now.front + now.depth == pytest.approx(gap.front + gap.depth)
    endless = corrected(store, nearby, gap._replace(depth=DEEP), LENGTH, told=False)
    assert endless.depth == DEEP


def test_what_is_heard_beside_a_slots_end_is_no_part_of_its_neighbours() -> None:
    store, nearby = heard(((0.4, -3.82), (0.4, -3.98)))
    widths = [corrected(store, nearby, ACROSS._replace(depth=d), LENGTH, told=False).width for d in (4.1, DEEP)]
    assert widths == pytest.approx([2.8, 2.4], abs=0.01)


@pytest.mark.parametrize("forward", [True, False])
def test_what_both_sensors_hear_ahead_is_what_a_slot_ends_at_though_a_corner_stops_the_car(forward: bool) -> None:
    params = ValetParams()._replace(search=ValetSearchParams()._replace(active=True))
    first = 0 if forward else 4
    mount = params.car.ultrasonic.mounts[first + 1]
    sense = 1.0 if forward else -1.0
    corners = [(mount.x + sense * deep, aside) for deep, aside in ((0.19, -0.3), (0.19, 0.3), (1.2, 0.3), (1.2, -0.3))]
    known = Scene(tuple(Corner(*corner, 1) for corner in corners) + (Corner(),) * (CORNERS - 4))
    for other, ahead in ((0.2, True), (5.0, False)):
        readings = [5.0] * 12
        readings[first : first + 4] = [0.28, 0.19, other, 0.28]
        seen = look(tuple(readings), Pose(), Piece(sense), 0.0, known, False, params)
        assert (seen.blocked, seen.ahead) == (True, ahead)
        end = end_ahead(ValetInput(ultrasonic=tuple(readings)), forward, params)
        assert end.heard == ahead
        if ahead:
            assert seen.echo == end.echo == pytest.approx(Pose(mount.x + 0.19 * sense, 0.25, mount.yaw))


def test_a_slot_is_known_to_end_at_what_is_heard_ahead_on_the_way_in() -> None:
    params = ValetParams()._replace(search=ValetSearchParams()._replace(active=True))
    reach = params.car.wheelbase + params.car.front_overhang
    path = Path(1, 0.1, 1.0, (Piece(1.0),) + (Piece(),) * (PATH - 1))
    gap = ACROSS._replace(depth=DEEP)
    state = ValetState(step=Step.DRIVE, search=Search(gap=gap), path=path, direction=1.0)
    pose = Pose(1.4, -1.0, -0.5 * math.pi)
    for reading, depth in ((0.5, 1.0 + reach + 0.5), (0.9, DEEP)):
        inputs = ValetInput(odometry=pose, ultrasonic=(5.0, reading, reading) + (5.0,) * 9)
        now = heard_on(new_store(PlanStore), state, inputs, params, 40_000_000)
        assert now.search.gap.depth == pytest.approx(depth)
