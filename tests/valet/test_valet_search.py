"""What the side sensors hear becomes places, places a gap, at any angle, on either side; and the assist's switch."""

import math
import random
from typing import Any

import pytest
from shapely.geometry import LineString, Point

from controller_fmu.planning.plan import Piece
from controller_fmu.planning.plan_store import HEARD, PlanStore
from controller_fmu.planning.task import CORNERS, Corner
from controller_fmu.sensing import find_gap as module_of_gaps
from controller_fmu.sensing.ear import SideEar, listen
from controller_fmu.sensing.find_gap import TwoWays, find_gap
from controller_fmu.sensing.gap import UNHEARD, Gap, GapLayout, Wanted
from controller_fmu.sensing.heard_store import put_heard, put_ray
from controller_fmu.sensing.places import along, frame_of
from controller_fmu.sensing.row_line import row_of
from controller_fmu.valet.found import search
from controller_fmu.valet.params import ValetParams, ValetSearchParams
from controller_fmu.valet.sight import CLOSE
from controller_fmu.valet.signals import ValetInput
from controller_fmu.valet.slot import stands_in_road, stands_out
from modelkit.car import Car
from modelkit.store import new_store
from modelkit.vocabulary import Pose
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.obstacle_map import box_corners
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from tests.planning.plan_model import Scene
from tests.valet.looks import look
from vehicle_fmu.scene import Obstacle, SceneParams
from vehicle_fmu.ultrasonic import range_measurements

CAR = Car()
LENGTH, WIDTH = 3.805, 1.65
WANTED = Wanted(LENGTH, WIDTH, 0.7, 0.5, along=True, across=True, half_angle=math.pi / 6.0, deep=3.5, open_ended=False)


def row(angle: Any, side: Any, gap: Any = 2.6) -> Any:
    """Cars on both sides of a gap, at ``angle`` [deg] against the way; the gap's middle is at x = 0."""
    turn = math.radians(angle)
    pitch = 0.5 * (gap + WIDTH) / math.sin(turn)
    depth = 0.5 * (LENGTH * math.sin(turn) + WIDTH * abs(math.cos(turn)))
    further = pitch + (WIDTH + 0.7) / math.sin(turn)
    return [
        {"x": x, "y": -side * depth, "heading": -side * turn, "length": LENGTH, "width": WIDTH}
        for x in (-further, -pitch, pitch, further)
    ]


def passed(boxes: Any, side: Any, noise: Any, heading: Any = 0.0) -> Any:
    """Return the store and the gap that was found on the way past, if any."""
    scene = SceneParams(boxes=tuple(Obstacle(**box) for box in boxes))
    store, ear, draw, gap = new_store(PlanStore), SideEar(), random.Random(3), Gap()
    number = 10 if side > 0 else 8
    mount, which = CAR.ultrasonic.mounts[number], 0 if side > 0 else 1
    for step in range(260):
        way = -11.0 + 0.08 * step
        pose = Pose(way, side * (2.0 + way * math.sin(heading)), side * heading)
        c, s = math.cos(pose.heading), math.sin(pose.heading)
        at = Pose(pose.x + mount.x * c - mount.y * s, pose.y + mount.x * s + mount.y * c, pose.heading + mount.yaw)
        reading = range_measurements(pose, scene, CAR.ultrasonic, 0.08, 0)[number]
        reading = 5.0 if reading >= 5.0 or draw.random() < 0.01 * (noise > 0.0) else reading + draw.gauss(0.0, noise)
        ear = listen(store, ear, which, at, reading, CAR.ultrasonic)
        if at.x > 0.0 and step % 10 == 0:
            gap = find_gap(store, which, ear.places, at._replace(heading=pose.heading), WANTED)
        if gap.layout != GapLayout.NONE and at.x > 4.0:
            break
    return store, ear, gap


@pytest.mark.parametrize(("pieces", "layout"), [(1, GapLayout.ACROSS), (2, GapLayout.NONE)])
def test_cars_are_square_to_the_road_where_a_whole_front_was_heard(pieces: int, layout: int) -> None:
    store, places = new_store(PlanStore), 0
    for begin in (-3.2, 1.3):
        for step in range(20):
            broken = step % (20 // pieces) == 0
            places = put_heard(store, 0, places, begin + 0.11 * step, -1.0, broken)
    for step in range(41):
        x = -2.0 + 0.1 * step
        put_ray(store, 0, step, Pose(x, 0.0), Pose(x, -5.0 if abs(x) < 1.0 else -1.0))
    want = WANTED._replace(along=False)
    assert find_gap(store, 0, places, Pose(4.0, 0.0), want).layout == layout
    assert find_gap(store, 0, places, Pose(4.0, 0.0), want._replace(at_end=True)).layout == GapLayout.ACROSS


@pytest.mark.parametrize("angle", [45, 90, 120])
def test_places_lie_on_what_stands_there(angle: int) -> None:
    boxes = row(angle, 1)
    store, ear, _ = passed(boxes, 1, 0.0)
    lines = [LineString([*box_corners(box), box_corners(box)[0]]) for box in boxes]
    off = [min(line.distance(Point(store.heard_x[n], store.heard_y[n])) for line in lines) for n in range(ear.places)]
    assert ear.places > 30
    assert sorted(off)[int(0.9 * len(off))] < 0.08
    assert store.heard_count[HEARD] == 0


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("angle", "wide"), [(45, 3.4), (60, 2.6), (90, 2.6), (120, 2.6)])
def test_a_gap_is_found_at_any_angle_on_either_side(angle: int, wide: float, side: int) -> None:
    _, _, gap = passed(row(angle, side, wide), side, 0.01)
    assert gap.layout == GapLayout.ACROSS
    assert gap.into == pytest.approx(-side * math.radians(angle), abs=math.radians(2.5))
    assert gap.width == pytest.approx(wide, abs=0.2)
    across = (-math.sin(gap.into), math.cos(gap.into))
    middle = (0.5 * (gap.a.x + gap.b.x), 0.5 * (gap.a.y + gap.b.y))
    centre = row(angle, side, wide)[0]["y"]
    off = middle[0] * across[0] + (middle[1] - centre) * across[1]
    assert abs(off) < 0.15


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("angle", "askew"), [(45, 0.1), (45, -0.15), (60, -0.15)])
def test_a_row_is_seen_along_its_own_line_whatever_way_it_is_passed(angle: int, askew: float, side: int) -> None:
    store, ear, gap = passed(row(angle, side, 3.4), side, 0.01, askew)
    frame = frame_of(0 if side > 0 else 1, ear.places, Pose(4.0, 0.0, side * askew), WANTED.half_angle)
    assert row_of(store, frame, UNHEARD).turn == pytest.approx(askew, abs=math.radians(2.5))
    assert gap.layout == GapLayout.ACROSS
    assert gap.into == pytest.approx(-side * math.radians(angle), abs=math.radians(2.5))
    front = (gap.a.x + gap.front * math.cos(gap.into), gap.a.y + gap.front * math.sin(gap.into))
    neighbour = row(angle, side, 3.4)[1]
    off = (front[0] - neighbour["x"]) * math.cos(gap.into) + (front[1] - neighbour["y"]) * math.sin(gap.into)
    pitch = 0.5 * (3.4 + WIDTH) / math.tan(math.radians(angle))
    assert off + 0.5 * LENGTH == pytest.approx(pitch, abs=0.3)


@pytest.mark.parametrize("angle", [30, 150])
def test_a_pillar_that_stands_before_a_row_does_not_turn_its_line(angle: int) -> None:
    pillar = {"x": 1.6, "y": 0.3, "heading": 0.0, "length": 0.4, "width": 0.4}
    store, ear, _ = passed([*row(angle, 1, 3.4), pillar], 1, 0.01)
    end = Pose(8.0, 2.0, 0.0)
    line = row_of(store, frame_of(0, ear.places, end, WANTED.half_angle), UNHEARD)
    assert line.things >= 3
    assert abs(line.turn) < math.radians(1.0)
    assert line.behind == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(("x", "y"), [(-2.9, -2.2), (-2.0, -2.81)])
def test_what_a_slot_ends_at_does_not_make_it_narrower(x: float, y: float) -> None:
    wall = {"x": x, "y": y, "heading": -math.radians(150), "length": 0.8, "width": 2.2}
    _, _, gap = passed([*row(150, 1, 2.9), wall], 1, 0.0)
    assert gap.layout == GapLayout.ACROSS
    assert gap.width == pytest.approx(2.9, abs=0.3)


def test_a_slot_at_an_angle_is_deep_enough_if_the_car_stands_no_farther_into_the_road() -> None:
    turn, deep = math.radians(30), 3.3 - 0.5 * LENGTH + 0.2
    y = -0.5 * (LENGTH * math.sin(turn) + WIDTH * math.cos(turn)) - deep * math.sin(turn)
    wall = {"x": deep * math.cos(turn), "y": y, "heading": -turn, "length": 0.4, "width": 1.6}
    store, ear, gap = passed([*row(30, 1, 3.0), wall], 1, 0.0)
    assert gap.shallow
    assert gap.depth == pytest.approx(3.3, abs=0.1)
    gap = find_gap(store, 0, ear.places, Pose(8.0, 2.0 - 0.825), WANTED._replace(deep=WANTED.deep + 0.5, stand_out=0.5))
    assert not gap.shallow
    params = ValetParams()
    short = stands_out(gap, params)
    assert stands_in_road(gap, params) == pytest.approx(0.5 * short, abs=0.05 * short)
    assert short > 0.5


def test_a_gap_across_the_one_that_the_car_stops_at_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    params = ValetParams()
    dt_ns = int(params.car.ultrasonic.cycle * 1e9)
    told = [Gap(GapLayout.ACROSS, into=into) for into in (0.5, 0.5 + 0.5 * math.pi, 0.6)]
    monkeypatch.setattr(search, "listen", lambda store, ear, *_: ear._replace(rays=ear.rays + 1))
    monkeypatch.setattr(search, "find_gap", lambda *_: told.pop(0))
    state, found = search.begin_search(0), []
    for _ in range(3):
        state = search.search(new_store(PlanStore), state, ValetInput(measured_speed=1.0), params, dt_ns)
        found.append(state.gap.into)
    assert found == [0.5, 0.5, 0.6]


def test_cars_without_a_gap_between_them_are_none() -> None:
    boxes = row(90, 1, gap=0.8)
    assert passed(boxes, 1, 0.01)[2].layout == GapLayout.NONE


def test_a_place_heard_twice_at_most_between_the_neighbours_is_no_end_of_a_gap() -> None:
    store, ear, gap = passed(row(90, 1, wide := 2.6), 1, 0.0)
    assert gap.width == pytest.approx(wide, abs=0.1)
    places = put_heard(store, 0, ear.places, 0.0, -1.0, True)
    at = Pose(7.0, 2.0 - 0.825, 0.0)
    assert find_gap(store, 0, places, at, WANTED).width == pytest.approx(gap.width, abs=0.05)
    store.heard_count[places - 1] = 2
    assert find_gap(store, 0, places, at, WANTED).width == pytest.approx(gap.width, abs=0.05)
    store.heard_count[places - 1] = 3
    assert find_gap(store, 0, places, at, WANTED).layout == GapLayout.NONE


def test_at_45_degrees_a_post_among_cars_hides_no_body() -> None:
    """Cars that lean back by 135 deg, two posts between them, passed from 6 m away to 3 m: the second is not heard."""
    spots = tuple((x, -3.85, 3.81, 1.65) for x in (-6.54, -3.22, 4.37, 7.69))
    posts = ((0.25, -1.96, 0.4, 0.4), (2.46, -4.17, 0.4, 0.4))
    turn = math.radians(-135.0)
    boxes = [{"x": x, "y": y, "heading": turn, "length": long, "width": wide} for x, y, long, wide in spots + posts]
    store, ear, _ = passed(boxes, 1, 0.0, -0.24)
    at = Pose(9.0, 2.0 - 0.825 + 9.0 * math.sin(-0.24), -0.24)
    gap = find_gap(store, 0, ear.places, at, WANTED._replace(at_end=True))
    assert gap.layout == GapLayout.ACROSS
    assert gap.into == pytest.approx(turn, abs=math.radians(2.0))
    assert 2.7 < gap.width < 3.4


@pytest.mark.parametrize("shorter", ["one", "other"])
@pytest.mark.parametrize(("by", "free", "taken"), [(0.29, 30, True), (0.31, 2, True), (0.31, 3, False)])
def test_a_gap_across_much_longer_sides_is_none_where_no_cars_stand(
    monkeypatch: pytest.MonkeyPatch, shorter: str, by: float, free: int, taken: bool
) -> None:
    frames = {name: along(frame_of(0, 0, Pose(), 0.5), 0.0, into) for name, into in (("one", 2.4), ("other", 0.8))}
    ways = TwoWays(**frames, longer=-by if shorter == "one" else by, both_show=True)
    found = Gap(layout=GapLayout.ACROSS, width=2.5)
    where = module_of_gaps.__name__
    monkeypatch.setattr(f"{where}._passed", lambda _, frame, *__: found if frame is frames[shorter] else Gap())
    monkeypatch.setattr(f"{where}.free_of_bodies", lambda *_: free)
    assert module_of_gaps._likelier(new_store(PlanStore), ways, WANTED) == (found if taken else Gap())


@pytest.mark.parametrize(("echoes", "turn"), [(9, 0.0), (20, 12.0)])
def test_of_two_lines_heard_nearly_as_well_the_less_turned_is_the_rows(echoes: int, turn: float) -> None:
    """Corners of two cars, and what ends the slot behind them: on a line with the second car."""
    store, places = new_store(PlanStore), 0
    for x, y, count in ((-10.9, -1.2, 8), (-6.2, -1.2, 15), (1.3, -2.8, echoes)):
        for number in range(count):
            places = put_heard(store, 0, places, x, y, number == 0)
    row = row_of(store, frame_of(0, places, Pose(), WANTED.half_angle), UNHEARD)
    assert row.things == 2
    assert math.degrees(row.turn) == pytest.approx(turn, abs=0.5)


@pytest.mark.parametrize("farther", [0.9, 1.1])
def test_a_slot_too_narrow_for_the_cone_is_open_if_it_is_free_just_inside(farther: float) -> None:
    boxes = [box | {"y": box["y"] - farther} for box in row(90, 1, 2.5)]
    store, ear, _ = passed(boxes, 1, 0.0)
    at = Pose(7.0, 2.0 - 0.825, 0.0)
    gap = find_gap(store, 0, ear.places, at, WANTED._replace(along=False))
    assert gap.layout == GapLayout.ACROSS
    assert gap.width == pytest.approx(2.5, abs=0.3)


@pytest.mark.parametrize(("tail_in", "into"), [(True, -135.0), (False, -45.0)])
def test_cars_that_may_stand_either_way_do_so_as_the_driver_wants_it_at_the_end(tail_in: bool, into: float) -> None:
    boxes = [box | {"y": box["y"] - 0.6} for box in row(135, 1, 2.5)]
    store, ear, _ = passed(boxes, 1, 0.0)
    at = Pose(7.0, 2.0 - 0.825, 0.0)
    assert find_gap(store, 0, ear.places, at, WANTED).layout == GapLayout.NONE
    gap = find_gap(store, 0, ear.places, at, WANTED._replace(at_end=True, tail_in=tail_in))
    assert math.degrees(gap.into) == pytest.approx(into, abs=2.0)


def test_the_end_of_a_slot_is_heard_by_both_sensors_that_look_straight_at_it() -> None:
    params = ValetParams()._replace(search=ValetSearchParams()._replace(active=True))
    silent = (5.0,) * 12
    for first, direction in ((0, 1.0), (4, -1.0)):
        one = silent[: first + 1] + (0.4,) + silent[first + 2 :]
        both = silent[: first + 1] + (0.4, 0.5) + silent[first + 3 :]
        heard = [look(readings, Pose(), Piece(direction), 0.3, Scene(), False, params) for readings in (one, both)]
        assert [(sight.blocked, sight.ahead) for sight in heard] == [(True, False), (True, True)]


@pytest.mark.parametrize(("between", "known", "stops"), [(False, True, True), (True, True, False), (True, False, True)])
def test_a_car_that_leaves_what_is_known_along_the_road_is_not_stopped_by_it(
    between: bool, known: bool, stops: bool
) -> None:
    params = ValetParams()._replace(search=ValetSearchParams()._replace(active=True))
    mount = params.car.ultrasonic.mounts[3]
    wall = mount.x + 0.15
    corners = ((wall, mount.y - 1.0), (wall, mount.y + 1.0), (wall + 1.0, mount.y + 1.0), (wall + 1.0, mount.y - 1.0))
    first = tuple(Corner(*corner, 1) for corner in corners) if known else ()
    scene = Scene(first + (Corner(),) * (CORNERS - len(first)))
    readings = (5.0,) * 3 + (0.15,) + (5.0,) * 8
    assert look(readings, Pose(), Piece(-1.0, 0.2), 0.1, scene, between, params).blocked == stops
    assert look(readings, Pose(), Piece(1.0), 0.1, scene, between, params).blocked


def test_what_is_near_a_leading_corner_or_one_that_swings_out_slows_the_car() -> None:
    params = ValetParams()._replace(search=ValetSearchParams()._replace(active=True))
    silent = (5.0,) * 12
    near = silent[:3] + (0.25,) + silent[4:]
    bends = [Piece(1.0), Piece(-1.0, 0.2), Piece(-1.0, -0.2), Piece(-1.0)]
    sights = [look(near, Pose(), piece, 0.3, Scene(), False, params) for piece in bends]
    assert [sight.blocked for sight in sights] == [True, True, False, False]
    assert [sight.speed < 0.3 for sight in sights] == [True, True, False, False]
    assert not look(near, Pose(), Piece(-1.0, 0.2), 0.3, Scene(), False, ValetParams()).blocked


@pytest.mark.parametrize("sensor", [0, 3])
def test_a_corner_is_nearer_to_what_its_sensor_hears_than_a_bumper(sensor: int) -> None:
    params = ValetParams()._replace(search=ValetSearchParams()._replace(active=True))
    readings = [5.0] * 12
    readings[sensor] = 0.5
    speed = look(tuple(readings), Pose(), Piece(1.0), 0.3, Scene(), False, params).speed
    assert speed == pytest.approx(math.sqrt(2.0 * params.drive.deceleration * (0.5 - 0.05 - CLOSE)))


@pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")
def test_switched_off_on_the_way_in_it_is_over_and_without_a_slot_it_says_so() -> None:
    files = fmu_files("native", lambda text: None)
    scenario = load_scenario("valet-search-perpendicular", ["vehicle.driver.apa_switch_off_time=25"])
    ran = run_scenario(scenario, files, kind="native").recording
    assert max(ran.signals["controller.valet.step"]) == 10
    assert ran.signals["controller.phase"].max() == 11
    scenario = load_scenario("valet-search-perpendicular", ["vehicle.start.y=4.5", "controller.search.way=15"])
    ran = run_scenario(scenario, files, kind="native").recording
    assert ran.signals["controller.reason"][-1] == 23
