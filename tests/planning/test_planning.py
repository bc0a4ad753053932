"""The planner against closed forms, against shapely, and against itself."""

import math
import random

import pytest
from shapely.geometry import LineString

from controller_fmu.parking.following.params import FollowingParams
from controller_fmu.parking.following.rolling_steering import MARGIN_FRACTION, ROOMY_FACTOR
from controller_fmu.parking.geometry.outline import pose_along_arc
from controller_fmu.parking.geometry.outline_distance import edge_distance_squared
from controller_fmu.parking.planning.analytic_expansion import cheapest_word
from controller_fmu.parking.planning.collision import MAX_CLEARANCE
from controller_fmu.parking.planning.grids import UNREACHABLE_COST
from controller_fmu.parking.planning.planner import PlanningStatus, path_of_plan
from controller_fmu.parking.planning.problem import SearchGrid, SearchProblem, SearchRegion
from controller_fmu.parking.planning.reeds_shepp import WordRequest, least_word_cost, list_words, turn_of
from controller_fmu.parking.planning.search_schedule import SEARCH_SCHEDULE
from controller_fmu.parking.planning.work import MAX_WORDS, WORD_SEGMENTS, PlanCount, PlanningWork, word_length
from modelkit.store import new_store, size_of
from modelkit.vocabulary import Pose
from tests.planning.scenes import (
    CAR,
    bits_of,
    kept,
    least_clearance,
    outline_of,
    plan,
    poses_along,
    read_case,
    request_of,
    scene_of,
    search,
    tpcap_folder,
)

ORIGIN = Pose(0.0, 0.0, 0.0)
BOXES = [[(-9.0, -3.0), (-3.5, -3.0), (-3.5, -1.0), (-9.0, -1.0)], [(5.0, -3.0), (9.0, -3.0), (9.0, -1.0), (5.0, -1.0)]]


def test_distance_to_an_edge_is_that_of_shapely() -> None:
    draw = random.Random(1)
    box = outline_of(Pose(-CAR.centre_ahead, 0.0, 0.0), CAR)
    for _ in range(500):
        ends = [draw.uniform(-6.0, 6.0) for _ in range(4)]
        gap = math.sqrt(edge_distance_squared(ends[0], ends[1], ends[2], ends[3], CAR, 1e6))
        assert gap == pytest.approx(box.distance(LineString([ends[:2], ends[2:]])), abs=1e-9)


def word_problem() -> SearchProblem:
    """Return a problem of which words need the outline and the costs alone."""
    region = SearchRegion(0.0, 0.0, 1.0, SearchGrid(1.0, 1), SearchGrid(1.0, 1))
    return SearchProblem(ORIGIN, ORIGIN, CAR, region, True, 0.1, SEARCH_SCHEDULE[0])


def test_every_word_ends_where_it_should() -> None:
    draw = random.Random(2)
    store, problem = new_store(PlanningWork), word_problem()
    for _ in range(60):
        end = Pose(draw.uniform(-12.0, 12.0), draw.uniform(-12.0, 12.0), draw.uniform(-3.1, 3.1))
        count = list_words(store, ORIGIN, end, WordRequest(0.0, 0.0, UNREACHABLE_COST), problem)
        assert 24 <= count <= MAX_WORDS
        for word in range(count):
            pose = ORIGIN
            for piece in range(WORD_SEGMENTS):
                turn = turn_of(store.word_code[word], piece) - 1
                pose = pose_along_arc(pose, word_length(store, word, piece), turn * CAR.max_curvature)
            assert math.hypot(pose.x - end.x, pose.y - end.y) < 1e-4
            assert abs(math.remainder(pose.heading - end.heading, 2.0 * math.pi)) < 1e-5
        least = sum(abs(word_length(store, cheapest_word(store, count), piece)) for piece in range(WORD_SEGMENTS))
        assert least >= math.hypot(end.x, end.y) - 1e-9


def test_words_that_cost_too_much_are_left_out_and_no_others() -> None:
    draw = random.Random(3)
    store, problem = new_store(PlanningWork), word_problem()
    for _ in range(200):
        reach = draw.choice((1.0, 4.0, 12.0))
        end = Pose(
            draw.uniform(-reach, reach), draw.uniform(-reach, reach), draw.choice((0.0, draw.uniform(-6.0, 6.0)))
        )
        gear, lock = draw.choice((-1.0, 0.0, 1.0)), draw.choice((-1.0, -0.5, 0.0, 0.5, 1.0))
        any_cost = WordRequest(gear, lock, UNREACHABLE_COST)
        words = _words(store, end, any_cost, problem)
        least = min(words)[0]
        assert least_word_cost(store, ORIGIN, end, any_cost, problem) == least
        limited = any_cost._replace(limit=draw.choice(words)[0])
        assert _words(store, end, limited, problem) == [word for word in words if word[0] < limited.limit]
        assert least_word_cost(store, ORIGIN, end, limited, problem) == min(limited.limit, least)


def _words(store: PlanningWork, end: Pose, request: WordRequest, problem: SearchProblem) -> list[tuple[float, ...]]:
    """Return cost, turns and lengths of the words from the origin to ``end``."""
    count = list_words(store, ORIGIN, end, request, problem)
    return [
        (
            store.word_cost[word],
            store.word_code[word],
            *(word_length(store, word, piece) for piece in range(WORD_SEGMENTS)),
        )
        for word in range(count)
    ]


@pytest.mark.parametrize("run_in", [-0.7, 0.7])
@pytest.mark.parametrize("y", [3.0, -2.0])
def test_a_path_ends_with_the_straight_line_that_is_requested(y: float, run_in: float) -> None:
    """From the road the tree is rooted at the goal, from beside it at the start."""
    request = request_of(Pose(1.0, y, 0.0), Pose(-1.2, -2.0, 0.0), 0.1)._replace(run_in=run_in)
    store = plan(request, scene_of(BOXES))
    assert store.counts[PlanCount.STATUS] == PlanningStatus.PLANNED
    path = path_of_plan(store, request)
    last = path.segments[path.used - 1]
    assert last[:2] == (run_in, 0.0)
    end = poses_along(request.start, kept(store))[-1]
    assert (end.x, end.y, math.remainder(end.heading, 2.0 * math.pi)) == pytest.approx((-1.2, -2.0, 0.0), abs=1e-3)
    assert least_clearance(poses_along(request.start, kept(store)), BOXES, CAR) > 0.09


def test_parks_between_two_boxes_with_the_margin_it_states() -> None:
    request = request_of(Pose(1.0, 3.0, 0.0), Pose(-1.2, -2.0, 0.0), 0.1)
    store = plan(request, scene_of(BOXES))
    assert store.counts[PlanCount.STATUS] == PlanningStatus.PLANNED
    poses = poses_along(request.start, kept(store))
    assert math.dist(poses[-1][:2], request.goal[:2]) < 1e-4
    assert least_clearance(poses, BOXES, CAR) >= 0.1 - 1e-3


def test_steering_while_rolling_leaves_the_margin_at_cusps_and_most_of_it_between() -> None:
    request = request_of(Pose(1.0, 3.0, 0.0), Pose(-1.2, -2.0, 0.0), 0.1)
    store = plan(request, scene_of(BOXES))
    path = path_of_plan(store, request)
    pieces = [(piece.distance, piece.curvature) for piece in path.segments[: path.used]]
    begin, cusps, joints = request.start, 0, 0
    offset = min(FollowingParams().rolling_offset, MARGIN_FRACTION * path.margin)
    for number, piece in enumerate(path.segments[: path.used]):
        way, k = pieces[number - 1]
        if number > 0 and way * piece.distance < 0.0:
            on = [pose_along_arc(begin, math.copysign(share * piece.overrun, way), k) for share in (0.25, 0.5, 1.0)]
            assert least_clearance(on, BOXES, CAR) >= path.margin - 1e-3
            farther = pose_along_arc(begin, math.copysign(piece.overrun + 0.02, way), k)
            assert piece.overrun == MAX_CLEARANCE or least_clearance([farther], BOXES, CAR) < path.margin + 0.01
            cusps += 1
        elif number > 0 and piece.curvature != k:
            ramp = ramp_poses(begin, pieces[number - 1 : number + 1], ROOMY_FACTOR * offset)
            assert least_clearance(ramp, BOXES, CAR) >= 0.7 * path.margin
            joints += 1
        begin = pose_along_arc(begin, piece.distance, piece.curvature)
    assert cusps > 0 < joints


def ramp_poses(joint: Pose, pieces: list[tuple[float, float]], off: float) -> list[Pose]:
    """Return poses of a car that comes along the first of two pieces and changes its curvature over a ramp."""
    (way, k0), (after, k1) = pieces
    length = min(math.sqrt(24.0 * off / abs(k1 - k0)), 2.0 * abs(way), 2.0 * abs(after))
    direction, count = math.copysign(1.0, way), 200
    pose = pose_along_arc(joint, -direction * 0.5 * length, k0)
    poses = [pose]
    for number in range(count):
        pose = pose_along_arc(pose, direction * length / count, k0 + (k1 - k0) * (number + 0.5) / count)
        poses.append(pose)
    return poses


def test_a_search_done_anew_is_the_same_to_the_bit_however_it_is_split() -> None:
    request = request_of(Pose(1.0, 3.0, 0.2), Pose(-1.2, -2.0, 0.0), 0.1)
    other = request_of(Pose(1.0, 3.0, 0.0), Pose(-1.2, -2.0, 0.0), 0.1)
    scene = scene_of(BOXES)
    once = plan(request, scene, at_a_time=60, max_steps=61)
    again = new_store(PlanningWork)
    search(again, scene, other, 25)  # something else stands in the store
    for count in (3, 17, 41, 60):
        search(again, scene, request, count)
    assert again.counts[PlanCount.COUNT] == once.counts[PlanCount.COUNT] == 60
    assert bits_of(again) == bits_of(once)
    search(again, scene, request, 70)
    search(again, scene, request, 60)  # back in time: done anew
    assert bits_of(again) == bits_of(once)
    search(again, scene_of(BOXES[:1]), request, 10)
    search(again, scene, request, 60)  # another scene meanwhile: done anew
    assert bits_of(again) == bits_of(once)


def test_start_or_goal_on_an_obstacle_is_said() -> None:
    scene = scene_of(BOXES)
    free, blocked = Pose(1.0, 3.0, 0.0), Pose(-6.0, -2.0, 0.0)
    assert plan(request_of(blocked, free, 0.1), scene).counts[PlanCount.STATUS] == PlanningStatus.START_BLOCKED
    assert plan(request_of(free, blocked, 0.1), scene).counts[PlanCount.STATUS] == PlanningStatus.GOAL_BLOCKED


def test_the_store_is_small() -> None:
    assert size_of(PlanningWork) < 2_000_000


@pytest.mark.skipif(tpcap_folder() is None, reason="TPCAP's cases are not here")
@pytest.mark.parametrize("number", [6, 12, 17])
def test_easy_cases_of_tpcap(number: int) -> None:
    start, goal, polygons = read_case(number)
    store = plan(request_of(start, goal, 0.1), scene_of(polygons))
    assert store.counts[PlanCount.STATUS] == PlanningStatus.PLANNED
    poses = poses_along(start, kept(store))
    assert math.dist(poses[-1][:2], goal[:2]) < 1e-4
    assert least_clearance(poses, polygons, CAR) >= 0.1 - 1e-3
