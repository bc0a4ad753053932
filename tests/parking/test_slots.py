"""Rows, gaps and slot types from maps of simulated passes, and the goal in a slot."""

import math

import pytest

from controller_fmu.common.external_slot import SlotKind
from controller_fmu.interface import Reason
from controller_fmu.parking.geometry.outline import vehicle_outline
from controller_fmu.parking.map.facing_surface import point_between
from controller_fmu.parking.map.free_space import MAX_RAYS, FreeSpace, Ray, path_curvature
from controller_fmu.parking.map.landmark import MAX_LANDMARKS, Landmark, LandmarkType
from controller_fmu.parking.map.local_map import LandmarkMap, update_map
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.measurement.sensor import SensorPose
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.path_planning import stands_in_slot
from controller_fmu.parking.slots.candidate import (
    LOG_TEN,
    SlotCandidate,
    SlotType,
    find_slot,
    log_likelihood_ratio,
    row_point,
)
from controller_fmu.parking.slots.correction import correct_slot
from controller_fmu.parking.slots.goal import goal_pose, overhang_of
from controller_fmu.parking.slots.params import SlotParams
from controller_fmu.parking.slots.row import (
    MAX_MEMBERS,
    RoadBend,
    RowMember,
    SlotRow,
    find_row,
    is_too_short_for_car,
    side_as_member,
)
from controller_fmu.parking.slots.slot_filter import begin_slot_filter, is_slot_corner, slot_of_filter
from modelkit.geometry import Box, Point, box_corners, cone_gap, cone_of, orient
from modelkit.vocabulary import Pose
from tests.parking.simulated_pass import CAR, drive_past

OUTLINE = vehicle_outline(CAR, 0.95)
DEEP = 2.0 * OUTLINE.half_length
"""A slot is needed so deep [m]."""
COS, SIN = math.cos(math.radians(30.0)), math.sin(math.radians(30.0))


def slot_after(
    boxes: list[Box], seed: int, end: float, lateral: float = 1.0, wanted: SlotKind = SlotKind.NONE
) -> SlotCandidate:
    local_map, params, pose = LandmarkMap(), MappingParams(), Pose()
    start = Pose(-9.0, CAR.width / 2 + lateral, 0.0)
    for _, pose, readings in drive_past(boxes, start, end + 9.0, seed):
        local_map = update_map(local_map, readings, pose, CAR.ultrasonic, params)
    row = find_row(local_map.landmarks, pose, -1.0, RoadBend(), params)
    slot = SlotParams(wanted=wanted)
    return find_slot(row, local_map.landmarks, local_map.free_space.right, OUTLINE, slot, params)


def bays(width: float, empty: int, cars: int = 2) -> list[Box]:
    """Cars of 1.8 m in bays of ``width``, ``empty`` bays free at the origin, ``cars`` on each side."""
    before = [Box(-width * (0.5 + number), -2.25, 0.0, 1.8, 4.5) for number in range(cars)]
    after = [Box(width * (empty + 0.5 + number), -2.25, 0.0, 1.8, 4.5) for number in range(cars)]
    return before + after


@pytest.mark.parametrize("width", [2.6, 2.7, 2.9])
def test_one_empty_bay_is_a_perpendicular_slot(width: float) -> None:
    slot = slot_after(bays(width, 1), 1, width + 2.0)
    assert (slot.type, slot.reason) == (SlotType.PERPENDICULAR, Reason.NONE)
    goal = goal_pose(slot, OUTLINE, SlotParams())
    assert goal.x == pytest.approx(width / 2, abs=0.2)
    assert math.degrees(goal.heading) % 360.0 == pytest.approx(90.0, abs=3.0)


def test_of_two_empty_bays_one_is_used() -> None:
    slot = slot_after(bays(2.6, 2), 2, 7.2)
    assert slot.type == SlotType.PERPENDICULAR
    goal = goal_pose(slot, OUTLINE, SlotParams())
    assert min(abs(goal.x - 1.3), abs(goal.x - 3.9)) < 0.4


def test_a_gap_between_cars_along_the_road_is_a_parallel_slot() -> None:
    kerb = Box(3.0, -1.9, 0.0, 40.0, 0.02)
    slot = slot_after([Box(-2.2, -0.9, 0.0, 4.4, 1.8), Box(8.4, -0.9, 0.0, 4.4, 1.8), kerb], 3, 5.5)
    assert (slot.type, slot.reason) == (SlotType.PARALLEL, Reason.NONE)
    assert math.degrees(goal_pose(slot, OUTLINE, SlotParams()).heading) == pytest.approx(0.0, abs=2.0)


@pytest.mark.parametrize(
    ("wanted", "kind", "reason"),
    [
        (SlotKind.NONE, SlotType.PARALLEL, Reason.SLOT_TOO_SHORT),
        (SlotKind.PARALLEL, SlotType.PARALLEL, Reason.SLOT_TOO_SHORT),
        (SlotKind.TAIL_IN, SlotType.PERPENDICULAR, Reason.NONE),
    ],
)
def test_between_walls_as_long_as_cars_the_driver_decides(wanted: SlotKind, kind: SlotType, reason: Reason) -> None:
    walls = [Box(-2.0, -2.5, 0.0, 4.0, 5.0), Box(5.2, -2.5, 0.0, 4.0, 5.0), Box(1.6, -4.8, 0.0, 3.2, 0.4)]
    slot = slot_after(walls, 1, 5.0, wanted=wanted)
    assert (slot.type, slot.reason) == (kind, reason)


def test_a_gap_that_is_too_short_is_rejected() -> None:
    kerb = Box(3.0, -1.9, 0.0, 40.0, 0.02)
    slot = slot_after([Box(-2.2, -0.9, 0.0, 4.4, 1.8), Box(6.2, -0.9, 0.0, 4.4, 1.8), kerb], 3, 5.5)
    assert slot.reason != Reason.NONE
    assert slot.missing == pytest.approx(CAR.wheelbase + CAR.front_overhang + CAR.rear_overhang + 0.5 - 4.0, abs=0.15)


def test_wide_open_space_is_no_slot() -> None:
    assert slot_after([Box(-6.0, -0.9, 0.0, 4.4, 1.8)], 1, 6.0).type == SlotType.NONE


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_of_a_car_that_is_being_passed_the_corner_behind_is_known(side: float) -> None:
    local_map, params, pose = LandmarkMap(), MappingParams(), Pose()
    boxes = [Box(x, 0.9 * side, 0.0, 4.4, 1.8) for x in (-2.2, 8.4)]
    for _, pose, readings in drive_past(boxes, Pose(-9.0, -side * (CAR.width / 2 + 1.0), 0.0), 14.2, 1, dropout=0.0):
        local_map = update_map(local_map, readings, pose, CAR.ultrasonic, params)
    row = find_row(local_map.landmarks, pose, side, RoadBend(), params)
    ends = [(member.start_known, member.end_known) for member in row.members[: row.used]]
    assert ends == [(True, False), (True, True)]


def test_a_wall_across_the_road_shows_its_direction() -> None:
    """Both cars stand turned by 4 deg, and as if in one line so turned; the wall is 12 m long."""
    turn = math.radians(4.0)
    cars = [Box(x, -2.25 + x * math.sin(turn), turn, 1.8, 4.5) for x in (-0.9, 3.9)]
    wall = Box(0.0, 4.5, 0.0, 24.0, 0.4)
    turns = []
    for boxes in (cars, [*cars, wall]):
        local_map, params, pose = LandmarkMap(), MappingParams(), Pose()
        for _, pose, readings in drive_past(boxes, Pose(-9.0, CAR.width / 2 + 1.0, 0.0), 14.0, 1, dropout=0.0):
            local_map = update_map(local_map, readings, pose, CAR.ultrasonic, params)
        turns.append(math.degrees(find_row(local_map.landmarks, pose, -1.0, RoadBend(), params).frame.heading))
    assert turns[0] > 2.5
    assert abs(turns[1]) < 0.5 * turns[0]


def row_of(lengths: tuple[float, ...], complete: bool) -> SlotCandidate:
    members = tuple(RowMember(-8.0 * n, -8.0 * n + length, 1.0, complete, complete) for n, length in enumerate(lengths))
    row = SlotRow(members=members + (RowMember(),) * (8 - len(lengths)), used=len(lengths))
    return SlotCandidate(row=row)


def test_type_follows_from_what_was_seen_in_full() -> None:
    assert log_likelihood_ratio(row_of((1.8, 1.7, 1.9), True)) < -2.3
    assert log_likelihood_ratio(row_of((4.4, 4.6), True)) > 2.3
    assert log_likelihood_ratio(row_of((1.5, 1.6), False)) == 0.0
    assert log_likelihood_ratio(row_of((3.9, 0.6), False)) > 1.0
    assert log_likelihood_ratio(row_of((20.0, 1.0), False)) == 0.0


@pytest.mark.parametrize(("evidence", "is_parallel"), [(-1.5, True), (0.0, True), (5.0, False)])
def test_a_gap_in_its_echoes_makes_a_side_two_cars(evidence: float, is_parallel: bool) -> None:
    """A side of 4.6 m is one car along the road, or two cars across it whose echoes rise over the gap between them."""
    seen = RowMember(-4.6, 0.0, 2.4, True, True, gap_evidence=evidence)
    begun = RowMember(4.1, 5.0, 2.4, True, False)
    row = SlotRow(members=(begun, seen, *(RowMember(),) * 6), used=2)
    ratio = log_likelihood_ratio(SlotCandidate(row=row, behind=seen, ahead=begun))
    assert (ratio > 0.0) == is_parallel
    assert abs(ratio) > 1.0


def test_a_gap_in_the_first_3_m_of_a_side_is_of_cars_across_the_road() -> None:
    """One along the road had to be longer before the next could begin, though the side goes on."""
    rows = [SlotRow(members=(RowMember(0.0, 2.9, 2.0, True, False, gap_evidence=e),), used=1) for e in (0.0, 5.0)]
    none, gap = (log_likelihood_ratio(SlotCandidate(row=row._replace(members=row.members * 8))) for row in rows)
    assert none == pytest.approx(0.0, abs=0.5)
    assert gap < -1.0


def test_cars_whose_gaps_are_not_observed_count_as_one_side() -> None:
    """Two cars along the road are 9.6 m long, three across it 7 m, each with gaps of 0.8 m; one of these shows."""
    begun = RowMember(6.0, 6.6, 2.8, True, False)
    for length, evidence, is_parallel in ((9.6, 0.0, True), (7.0, 3.0, False)):
        seen = RowMember(-length, 0.0, 2.8, True, True, gap_evidence=evidence)
        row = SlotRow(members=(begun, seen, *(RowMember(),) * 6), used=2)
        ratio = log_likelihood_ratio(SlotCandidate(row=row, behind=seen, ahead=begun))
        assert (ratio > 0.0) == is_parallel
        assert abs(ratio) > 1.0


def test_a_side_between_two_gaps_is_seen_in_full() -> None:
    """One of its ends was not, so 1 m of it counted as the next car's: too short for any car it showed nothing."""
    members = (RowMember(7.0, 7.8, 2.7, True, False), RowMember(-1.6, 0.0, 2.7, False, True))
    row = SlotRow(members=(*members, RowMember(-4.3, -2.7, 2.7, True, True), *(RowMember(),) * 5), used=3)
    assert log_likelihood_ratio(SlotCandidate(row=row)) < -3.0 * LOG_TEN


def test_a_pair_of_cars_that_is_still_being_passed_leaves_the_type_open() -> None:
    """3.7 m so far are a car along the road as well as two across it, of which the second ends farther on."""
    assert log_likelihood_ratio(row_of((3.7, 0.6), False)) <= LOG_TEN


@pytest.mark.parametrize("half_angle", [26.0, 30.0, 34.0])
@pytest.mark.parametrize(("depth", "kind"), [(1.8, SlotType.PARALLEL), (4.4, SlotType.PERPENDICULAR)])
@pytest.mark.parametrize("beside", [0.6, 1.1])
def test_flanks_beside_a_gap_tell_how_cars_stand(
    beside: float, depth: float, kind: SlotType, half_angle: float
) -> None:
    """Sides that leave the type open: 3.6 m are a small car along the road as well as two cars across it."""
    boxes = [orient(Box(x, -0.5 * depth, 0.0, 3.6, depth)) for x in (-1.8, 9.2)]
    rays = []
    for number in range(MAX_RAYS):
        at = Point(-4.0 + 0.2 * number, beside)
        cone = cone_of(at, -0.5 * math.pi, math.radians(half_angle))
        measured = min([5.0, *(cone_gap(cone, box, box_corners(box)) for box in boxes)])
        rays.append(Ray(SensorPose(at.x, at.y, 0.0, -1.0, COS, SIN), measured, measured < 5.0))
    members = [RowMember(x, x + 3.6, 2.0, True, True, 2.0, 2.0, gap_evidence=3.5) for x in (7.4, -3.6)]
    row = SlotRow(Pose(0.0, 2.0, 0.0), -1.0, (*members, *(RowMember(),) * (MAX_MEMBERS - 2)), 2)
    found = find_slot(row, (Landmark(),) * MAX_LANDMARKS, tuple(rays), OUTLINE, SlotParams(), MappingParams())
    assert abs(log_likelihood_ratio(found._replace(flank_ratio=0.0))) < 0.5 * LOG_TEN
    assert found.type == kind
    assert abs(found.flank_ratio) >= LOG_TEN


@pytest.mark.parametrize(("bays", "bay"), [(1, 2.3), (1, 2.9), (2, 2.5), (2, 2.9), (3, 2.4), (3, 2.8)])
@pytest.mark.parametrize(("of_a", "of_b"), [(1.6, 1.6), (2.0, 1.6), (2.0, 2.0)])
def test_the_last_of_several_empty_bays_is_found_by_its_cars(bays: int, bay: float, of_a: float, of_b: float) -> None:
    a = RowMember(end=0.5 * of_a, end_length=1.3)
    b = RowMember(start=bay * (bays + 1) - 0.5 * of_b, start_length=2.3)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=SlotRow(Pose(), -1.0), behind=a, ahead=b)
    assert goal_pose(slot, OUTLINE, SlotParams()).x == pytest.approx(bays * bay, abs=0.11), "whatever sides measure"


@pytest.mark.parametrize(("empty", "middle"), [(1, 2.6), (2, 5.2), (3, 5.2)])
def test_of_three_empty_bays_the_middle_one_is_used_in_a_row_that_stands_across(empty: int, middle: float) -> None:
    cars = [RowMember(x - 0.9, x + 0.9, 0.0, True, True) for x in (2.6 * (empty + 1), 0.0, -2.6, -5.2)]
    row = SlotRow(Pose(), -1.0, (*cars, *(RowMember(),) * (MAX_MEMBERS - 4)), 4)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, ahead=cars[0], behind=cars[1])
    assert goal_pose(slot, OUTLINE, SlotParams()).x == pytest.approx(middle, abs=0.01)


@pytest.mark.parametrize(("beyond", "edge"), [(0.15, 3.15), (0.5, 3.0), (-0.4, 2.6)])
def test_a_flank_behind_a_pillar_does_not_widen_the_gap(beyond: float, edge: float) -> None:
    """The corner seen from the road is the pillar's; one that stands in the gap narrows it."""
    row = SlotRow(Pose(), -1.0, used=2)
    ahead = RowMember(3.0, 3.4, 1.0, True, True, 1.0, 1.0, 0.05, 0.05, 0.4, 0.4)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, behind=RowMember(-1.8, 0.0), ahead=ahead, front=1.0)
    flank = side(3.0 + beyond, -3.5, 90.0, 3.0 if beyond > 0.0 else 0.3)
    corrected = correct_slot(slot, (flank,) + (Landmark(),) * (MAX_LANDMARKS - 1), OUTLINE, DEEP, MappingParams())
    assert corrected.ahead.start == pytest.approx(edge, abs=0.005)


def test_a_car_that_is_still_being_passed_is_no_pillar() -> None:
    begun = side(0.0, -1.5, 0.0, 0.8)
    passed = side_as_member(begun, SlotRow(), -1.0, MappingParams())
    assert passed.start_length == passed.end_length == pytest.approx(0.8)
    member = side_as_member(begun._replace(end_known=False), SlotRow(), -1.0, MappingParams())
    assert member.start_length == member.end_length == 0.0
    assert not is_too_short_for_car(member.start_length)


FREE_RAYS = tuple(Ray(SensorPose(-4.0 + 0.1 * n, 0.5, 0.0, -1.0, COS, SIN), 5.0) for n in range(MAX_RAYS))
"""Of a sensor on the road that measured nothing nearer than 5 m."""


@pytest.mark.parametrize(("front", "rays", "is_gap"), [(3.0, (), False), (3.0, FREE_RAYS, True), (2.8, (), True)])
def test_from_afar_two_edges_show_no_gap_that_was_not_observed_free(
    front: float, rays: tuple[Ray, ...], is_gap: bool
) -> None:
    """A pedestrian hides as much of a wall: the echoes of the wall end where they begin again behind the pedestrian."""
    ends = [RowMember(2.7, 8.0, front, True, False, front), RowMember(-9.0, 0.0, front, False, True, front, front)]
    row = SlotRow(side=-1.0, members=(*ends, *(RowMember(),) * (MAX_MEMBERS - 2)), used=2)
    rays = rays or FreeSpace().right
    found = find_slot(row, (Landmark(),) * MAX_LANDMARKS, rays, OUTLINE, SlotParams(), MappingParams())
    assert (found.type != SlotType.NONE) == is_gap


def test_a_pillar_too_short_for_a_side_bounds_the_gap() -> None:
    """Between the car passed first and the bay stands a pillar, of which only a corner was measured."""
    cars = [side(-1.8, -1.5, 0.0, 1.8), side(4.2, -1.5, 0.0, 1.8)]
    pillar = Landmark(LandmarkType.POINT, 0.0, -1.7, confirmations=20)
    behind = pillar._replace(y=-4.5)
    for posts, end in (([], -0.9), ([pillar], 0.0), ([behind], -0.9)):
        landmarks = (*cars, *posts, *(Landmark(),) * (MAX_LANDMARKS - 2 - len(posts)))
        row = find_row(landmarks, Pose(8.0, 0.0, 0.0), -1.0, RoadBend(), MappingParams())
        slot = find_slot(row, landmarks, FREE_RAYS, OUTLINE, SlotParams(), MappingParams())
        edge = row_point(slot.row, slot.behind.end, slot.front)
        assert edge.x == pytest.approx(end, abs=0.01)


def test_a_car_whose_front_a_hitch_hides_is_a_neighbour() -> None:
    """Only the hitch is measured, and the two corners of the front behind it; the car is the first of its row."""
    sensed = [(-1.9, -1.5), (-1.0, -1.05), (-0.1, -1.5)]
    points = [Landmark(LandmarkType.POINT, x, y, confirmations=20) for x, y in sensed]
    landmarks = (*points, side(4.1, -1.5, 0.0, 1.8), *(Landmark(),) * (MAX_LANDMARKS - 4))
    row = find_row(landmarks, Pose(8.0, 0.0, 0.0), -1.0, RoadBend(), MappingParams())
    assert row.used == 2
    car = row.members[1]
    assert (car.start + 8.0, car.end + 8.0, car.front) == pytest.approx((-1.9, -0.1, 1.5))


@pytest.mark.parametrize("seen", ["first", "last", "slanted side"])
def test_a_hitch_is_in_the_middle_of_a_car_of_which_one_corner_shows(seen: str) -> None:
    """The echoes of the hitch at -1.0 and of the corner at -0.1, 0.45 m deeper, may also make one side."""
    at = -1.9 if seen == "first" else -0.1
    points = [Landmark(LandmarkType.POINT, x, y, confirmations=20) for x, y in ((-1.0, -1.05), (at, -1.5))]
    seen_of_it = [side(-0.55, -1.275, -26.6, 1.006)] if seen == "slanted side" else points
    landmarks = (*seen_of_it, side(4.1, -1.5, 0.0, 1.8), *(Landmark(),) * (MAX_LANDMARKS - 1 - len(seen_of_it)))
    row = find_row(landmarks, Pose(8.0, 0.0, 0.0), -1.0, RoadBend(), MappingParams())
    assert row.used == 2
    car = row.members[1]
    assert (car.start + 8.0, car.end + 8.0, car.front) == pytest.approx((-1.9, -0.1, 1.5), abs=0.01)
    assert (car.start_known, car.end_known) == (seen == "first", seen != "first")


def test_a_post_beside_a_corner_hides_no_car() -> None:
    """A car that reaches as far to its other side would be narrower than any."""
    points = [Landmark(LandmarkType.POINT, x, y, confirmations=20) for x, y in ((-1.0, -1.05), (-0.6, -1.5))]
    landmarks = (*points, side(4.1, -1.5, 0.0, 1.8), *(Landmark(),) * (MAX_LANDMARKS - 3))
    assert find_row(landmarks, Pose(8.0, 0.0, 0.0), -1.0, RoadBend(), MappingParams()).used == 1


def test_of_the_parts_between_posts_the_one_passed_last_counts() -> None:
    """A hitch stands before a car that is not measured but for its nearer corner: the slot begins at the corner."""
    cars = [side(-3.7, -1.5, 0.0, 1.8), side(4.2, -1.5, 0.0, 1.8)]
    posts = [Landmark(LandmarkType.POINT, x, y, confirmations=20) for x, y in ((-1.0, -1.1), (0.4, -1.5))]
    landmarks = (*cars, *posts, *(Landmark(),) * (MAX_LANDMARKS - 4))
    row = find_row(landmarks, Pose(8.0, 0.0, 0.0), -1.0, RoadBend(), MappingParams())
    slot = find_slot(row, landmarks, FREE_RAYS, OUTLINE, SlotParams(), MappingParams())
    assert row_point(slot.row, slot.behind.end, slot.front).x == pytest.approx(0.4, abs=0.01)
    assert row_point(slot.row, slot.ahead.start, slot.front).x == pytest.approx(3.3, abs=0.01)


def side(x: float, y: float, turn: float, length: float) -> Landmark:
    """A car's side about (x, y), turned by ``turn`` [deg], seen in full."""
    half, sigma = 0.5 * length, math.radians(0.3)
    known = Landmark(LandmarkType.SEGMENT, x, y, math.radians(turn), hh=sigma * sigma, start=-half, end=half)
    return known._replace(start_known=True, end_known=True, confirmations=20)


def row_beside(sides: list[Landmark], heading: float) -> SlotRow:
    rest = (Landmark(),) * (MAX_LANDMARKS - len(sides))
    return find_row((*sides, *rest), Pose(0.0, 2.0, math.radians(heading)), -1.0, RoadBend(), MappingParams())


def test_a_row_is_found_on_a_slanting_pass() -> None:
    """10 m farther on a row lies 1.3 m deeper, seen from a pass at 7.5 deg: a wall counted as of the row."""
    wall = side(-18.5, -2.0, 0.0, 5.6)
    row = row_beside([side(0.0, 0.0, 1.0, 4.4), side(-10.0, 0.0, -1.0, 4.4), wall], 7.5)
    assert row.used == 2
    assert math.degrees(row.frame.heading) == pytest.approx(0.0, abs=0.5)


@pytest.mark.parametrize("curvature", [1.0 / 30.0, -1.0 / 30.0])
@pytest.mark.parametrize("at", [-4.0, 3.0])
def test_a_row_along_a_bend_has_the_direction_of_the_road_at_the_slot(curvature: float, at: float) -> None:
    """Three cars behind the vehicle and one ahead: their mean heading is that of the road far behind the slot."""
    sides = []
    for along in (-17.0, -11.5, -6.0, 5.0):
        turn = curvature * along
        sides.append(side(math.sin(turn) / curvature, (1.0 - math.cos(turn)) / curvature, math.degrees(turn), 4.4))
    rest = (Landmark(),) * (MAX_LANDMARKS - len(sides))
    bend = RoadBend(curvature, at)
    row = find_row((*sides, *rest), Pose(0.0, 2.0, 0.0), -1.0, bend, MappingParams())
    assert row.used == 4
    beside_slot = row_point(row, at, row.members[0].front)
    assert row.frame.heading == pytest.approx(math.asin(curvature * beside_slot.x), abs=math.radians(0.5))


def test_the_curvature_of_the_path_follows_from_the_rays() -> None:
    poses = [(math.sin(turn) * 30.0, 30.0 * (1.0 - math.cos(turn)), turn) for turn in (0.2, 0.3, 0.5)]
    rays = [Ray(SensorPose(x, y, math.sin(turn), -math.cos(turn)), 1.0) for x, y, turn in poses]
    assert path_curvature((*(Ray(),) * (MAX_RAYS - len(rays)), *rays)) == pytest.approx(1.0 / 30.0, rel=0.01)
    assert path_curvature((Ray(),) * MAX_RAYS) == 0.0


def test_a_car_that_has_left_its_row_does_not_turn_it() -> None:
    """One stands 1.2 m out of a perpendicular row: the line through both is turned by 15 deg, they are not."""
    row = row_beside([side(0.0, -1.2, 1.0, 1.8), side(-4.4, 0.0, -1.0, 1.8)], 0.0)
    assert math.degrees(row.frame.heading) == pytest.approx(0.0, abs=0.5)


def test_a_flank_in_the_gap_bounds_it_wherever_its_corner_was_seen() -> None:
    """The corner was seen 0.9 m too far away as the car moved during the pass."""
    members = (RowMember(3.5, 5.3, 2.0, True, True), RowMember(-1.8, 0.0, 2.0, True, True))
    row = SlotRow(Pose(), -1.0, members + (RowMember(),) * 6, 2)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, behind=members[1], ahead=members[0], front=2.0)
    flank = side(2.6, -3.5, 90.0, 2.0)
    corrected = correct_slot(slot, (flank,) + (Landmark(),) * (MAX_LANDMARKS - 1), OUTLINE, DEEP, MappingParams())
    assert corrected.ahead.start == pytest.approx(2.6, abs=0.05)
    assert corrected.behind.end == 0.0


@pytest.mark.parametrize(("deeper", "overhang"), [(0.0, 0.0), (0.2, -0.1), (0.8, -0.4)])
def test_a_vehicle_is_flush_with_the_neighbour_that_stands_further_in(deeper: float, overhang: float) -> None:
    """The bicycle rack of the other one may have been taken for its front."""
    ahead = RowMember(2.6, 4.4, 2.0 + deeper, True, True, 2.0 + deeper, 2.0 + deeper)
    behind = RowMember(-1.8, 0.0, 2.0, True, True, 2.0, 2.0)
    row = SlotRow(Pose(), -1.0, (ahead, behind) + (RowMember(),) * 6, 2)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, behind=behind, ahead=ahead, front=2.0 + 0.5 * deeper)
    goal = goal_pose(slot, OUTLINE, SlotParams())
    assert overhang_of(slot, OUTLINE, goal) == pytest.approx(overhang, abs=1e-6)


def test_a_row_runs_along_the_road() -> None:
    """Both cars are turned by 4 deg, the line through them by 0: the road is between."""
    row = row_beside([side(0.0, 0.0, 4.0, 4.4), side(-10.0, 0.0, 4.0, 4.4)], 0.0)
    alone = row_beside([side(0.0, 0.0, 4.0, 4.4)], 0.0)
    assert 1.0 < math.degrees(row.frame.heading) < 2.0
    assert 0.2 < math.degrees(row.heading_sigma) < math.degrees(alone.heading_sigma) < 1.6


@pytest.mark.parametrize(
    ("out", "turn", "front_sigma", "heading_sigma", "claims"),
    [
        (0.1, 0.0, 0.0, 0.0, True),
        (0.1, 0.0, 0.03, 0.0, False),
        (0.0, 2.5, 0.0, 0.0, True),
        (0.0, 2.5, 0.0, 0.6, False),
        (0.0, 1.5, 0.03, 0.6, True),
    ],
)
def test_parked_is_claimed_only_where_two_sigma_of_the_slot_allow_it(
    out: float, turn: float, front_sigma: float, heading_sigma: float, claims: bool
) -> None:
    members = (RowMember(2.6, 4.4, 2.0, True, True, 2.0, 2.0), RowMember(-1.8, 0.0, 2.0, True, True, 2.0, 2.0))
    row = SlotRow(Pose(), -1.0, members + (RowMember(),) * 6, 2, heading_sigma=math.radians(heading_sigma))
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, behind=members[1], ahead=members[0], front=2.0)
    slot = slot._replace(front_sigma=front_sigma)
    goal = goal_pose(slot, OUTLINE, SlotParams())
    heading = goal.heading + math.radians(turn)
    ahead = OUTLINE.centre_ahead
    centre = Pose(goal.x + ahead * math.cos(goal.heading), goal.y + ahead * math.sin(goal.heading) + out, heading)
    pose = centre._replace(x=centre.x - ahead * math.cos(heading), y=centre.y - ahead * math.sin(heading))
    assert stands_in_slot(slot, pose, 2.0, ParkingParams()) == claims
    assert stands_in_slot(slot, pose, 0.0, ParkingParams()), "where no path leads nearer the best estimate decides"


@pytest.mark.parametrize(("deeper", "claims"), [(0.08, True), (0.13, False)])
def test_beside_a_kerb_parked_is_claimed_by_the_neighbours_line(deeper: float, claims: bool) -> None:
    """The goal beside the kerb was 0.08 m deeper than the line, and 0.15 m about that counted as parked."""
    row = SlotRow(Pose(), -1.0, used=2)
    slot = SlotCandidate(SlotType.PARALLEL, row=row, depth=2.0 * OUTLINE.half_width + 0.37, front_sigma=0.02)
    slot = slot._replace(behind=RowMember(end=0.0), ahead=RowMember(start=6.0))
    pose = Pose(3.0 - OUTLINE.centre_ahead, -OUTLINE.half_width - deeper, 0.0)
    assert stands_in_slot(slot, pose, 2.0, ParkingParams()) == claims


@pytest.mark.parametrize("open_ended", [False, True])
def test_beside_one_car_there_is_a_slot_where_the_driver_takes_one(open_ended: bool) -> None:
    local_map, params, pose = LandmarkMap(), MappingParams(), Pose()
    start = Pose(-9.0, CAR.width / 2 + 1.0, 0.0)
    for _, pose, readings in drive_past(bays(2.6, 1)[:2], start, 13.0, 1):
        local_map = update_map(local_map, readings, pose, CAR.ultrasonic, params)
    row = find_row(local_map.landmarks, pose, -1.0, RoadBend(), params)
    wanted = SlotParams(open_ended=open_ended)
    slot = find_slot(row, local_map.landmarks, local_map.free_space.right, OUTLINE, wanted, params)
    assert slot.type == (SlotType.PERPENDICULAR if open_ended else SlotType.NONE)
    if open_ended:
        goal = goal_pose(slot, OUTLINE, wanted)
        assert goal.x == pytest.approx(-0.4 + wanted.room_across + OUTLINE.half_width, abs=0.2)


@pytest.mark.parametrize(("width", "middles"), [(2.9, (1.45,)), (4.2, (2.1,)), (5.7, (4.1,))])
def test_bays_of_the_usual_width_count(width: float, middles: tuple[float, ...]) -> None:
    row = SlotRow(Pose(), -1.0)
    behind, ahead = RowMember(-1.8, 0.0, 0.0, True, True), RowMember(width, width + 1.8, 0.0, True, True)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, behind=behind, ahead=ahead)
    assert min(abs(goal_pose(slot, OUTLINE, SlotParams()).x - middle) for middle in middles) < 0.1


@pytest.mark.parametrize(("pitch", "gap", "middle"), [(2.3, 5.1, 3.7), (2.3, 3.5, 1.75), (2.8, 5.1, 2.55)])
def test_how_wide_bays_are_shows_by_cars_beside_each_other(pitch: float, gap: float, middle: float) -> None:
    """Two bays of 2.3 m are 5.1 m between cars: one wide gap where cars stand 2.8 m from middle to middle."""
    cars = [RowMember(x, x + 1.8, start_known=True, end_known=True) for x in (gap, -1.8, -1.8 - pitch)]
    row = SlotRow(members=(*cars, *(RowMember(),) * (MAX_MEMBERS - 3)), used=3)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, ahead=cars[0], behind=cars[1])
    assert goal_pose(slot, OUTLINE, SlotParams()).x == pytest.approx(middle, abs=0.01)


@pytest.mark.parametrize(("side_length", "middle"), [(4.1, 3.7), (6.4, 3.7), (4.6, 2.55), (1.0, 2.55)])
def test_how_wide_bays_are_shows_by_cars_that_make_one_side(side_length: float, middle: float) -> None:
    """Of two or three cars in bays of 2.3 m, of two in bays of 2.8 m; a part of a car tells nothing."""
    behind = RowMember(-side_length, 0.0, start_known=True, end_known=True)
    ahead = RowMember(5.1, 6.9, start_known=True, end_known=True)
    row = SlotRow(members=(ahead, behind, *(RowMember(),) * (MAX_MEMBERS - 2)), used=2)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, ahead=ahead, behind=behind)
    assert goal_pose(slot, OUTLINE, SlotParams()).x == pytest.approx(middle, abs=0.01)


@pytest.mark.parametrize(("start", "sigma"), [(-1.8, 0.02), (-1.3, 0.07)])
def test_how_wide_bays_are_shows_by_cars_of_which_one_edge_is_known(start: float, sigma: float) -> None:
    """Bays of 2.3 m: of two cars beyond the start is known, and how far the neighbour reaches is known less well."""
    ahead = RowMember(5.1, 6.9, 0.0, True, True)
    behind = RowMember(start, 0.0, 0.0, True, True, start_sigma=sigma, end_sigma=0.01)
    beyond = RowMember(-6.4, -2.7, 0.0, True, False, end_sigma=0.5)
    row = SlotRow(members=(ahead, behind, beyond, *(RowMember(),) * (MAX_MEMBERS - 3)), used=3)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, ahead=ahead, behind=behind)
    assert goal_pose(slot, OUTLINE, SlotParams()).x == pytest.approx(3.7, abs=0.1)


def test_a_rack_on_the_car_beside_two_bays_leaves_the_bay_where_it_is() -> None:
    """It hides both corners of the car behind: the gap measured is 0.3 m longer than two bays of 2.6 m."""
    for hidden in (0.0, 0.3):
        behind = RowMember(-1.8 + hidden, -hidden, start_known=True, end_known=True)
        ahead = RowMember(6.0, 7.8, start_known=True, end_known=True)
        slot = SlotCandidate(SlotType.PERPENDICULAR, row=SlotRow(Pose(), -1.0), behind=behind, ahead=ahead)
        assert goal_pose(slot, OUTLINE, SlotParams()).x == pytest.approx(4.3, abs=0.06)


@pytest.mark.parametrize("order", [1, -1])
def test_a_pillar_bounds_the_gap_though_the_car_behind_it_is_mapped_too(order: int) -> None:
    """The flank of a pillar 0.5 m inside the gap that was seen from the road, and of its car; or only its corner."""
    row = SlotRow(Pose(), -1.0, used=2)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, behind=RowMember(-1.8, 0.0), ahead=RowMember(3.2, 5.0))
    post = Landmark(LandmarkType.POINT, 2.7, -0.7, confirmations=20)
    face = side(2.7, -0.8, 90.0, 0.4)
    for inner in (face, face._replace(start_known=False, end_known=False), post):
        landmarks = (inner, side(3.22, -2.5, 90.0, 2.0))[::order]
        corrected = correct_slot(slot, landmarks + (Landmark(),) * (MAX_LANDMARKS - 2), OUTLINE, DEEP, MappingParams())
        assert corrected.ahead.start == pytest.approx(2.7)


@pytest.mark.parametrize(("deep", "edge"), [(DEEP - 0.2, 2.0), (DEEP - 0.05, 3.2)])
def test_a_post_at_the_end_of_a_slot_no_deeper_than_the_vehicle_does_not_narrow_it(deep: float, edge: float) -> None:
    """Two sensors of the bumper measure a wall as a post; 0.1 m before the wall the vehicle may stand."""
    row = SlotRow(Pose(), -1.0, used=2)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, behind=RowMember(-1.8, 0.0), ahead=RowMember(3.2, 5.0))
    landmarks = (Landmark(LandmarkType.POINT, 2.0, -deep, confirmations=20),) + (Landmark(),) * (MAX_LANDMARKS - 1)
    corrected = correct_slot(slot, landmarks, OUTLINE, DEEP - 0.1, MappingParams())
    assert corrected.ahead.start == pytest.approx(edge)


def test_a_car_that_has_moved_away_leaves_its_flank_to_bound_the_gap() -> None:
    row = SlotRow(Pose(), -1.0, used=2)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, behind=RowMember(-1.3, 0.5), ahead=RowMember(3.5, 5.3))
    flank = side(0.0, -2.5, 90.0, 2.0)
    corrected = correct_slot(slot, (flank,) + (Landmark(),) * (MAX_LANDMARKS - 1), OUTLINE, DEEP, MappingParams())
    assert corrected.behind.end == pytest.approx(0.0)


def test_a_front_that_a_hitch_hides_does_not_turn_the_row() -> None:
    """Of one of three cars 1 m shows, turned by 15 deg."""
    cars = [side(0.0, 0.0, 0.0, 1.8), side(-2.6, 0.3, 15.0, 1.0), side(-5.2, 0.0, 0.0, 1.8)]
    assert math.degrees(row_beside(cars, 0.0).frame.heading) == pytest.approx(0.0, abs=1.0)


def test_two_sides_of_one_car_count_as_one_car() -> None:
    """One car is turned by 4 deg, the other by -4 deg; of the first there are two sides in the map."""
    cars = [side(0.0, 0.0, 4.0, 1.8), side(-4.4, 0.0, -4.0, 1.8)]
    once, twice = (row_beside(sides, 0.0).frame.heading for sides in (cars, [*cars, side(0.3, 0.02, 4.0, 1.2)]))
    assert math.degrees(twice - once) == pytest.approx(0.0, abs=0.1)


def test_posts_beside_cars_narrow_a_slot_but_move_no_front() -> None:
    """Pillars stand 0.6 m behind the line of the fronts: the slot is between them, the vehicle flush with the cars."""
    width, off = 3.4, 0.3
    cars = [RowMember(x - 0.9, x + 0.9, 0.0, True, True) for x in (0.5 * width + 0.9, -0.5 * width - 0.9)]
    row = SlotRow(side=-1.0, members=(*cars, *(RowMember(),) * (MAX_MEMBERS - 2)), used=2)
    posts = [Landmark(LandmarkType.POINT, sense * (0.5 * width - off), -0.6, confirmations=9) for sense in (-1.0, 1.0)]
    landmarks = (*posts, *(Landmark(),) * (MAX_LANDMARKS - 2))
    slot = find_slot(row, landmarks, FREE_RAYS, OUTLINE, SlotParams(), MappingParams())
    assert slot.ahead.start - slot.behind.end == pytest.approx(width - 2.0 * off)
    assert slot.front == pytest.approx(0.0)
    known = slot_of_filter(slot, begin_slot_filter(slot), OUTLINE)
    assert known.front == pytest.approx(0.0)


def test_two_sensors_that_measure_a_corner_of_the_slot_show_no_surface() -> None:
    slot = slot_after(bays(2.9, 1), 1, 4.9)
    slot_filter = begin_slot_filter(slot)
    corner = row_point(slot.row, slot.ahead.start, slot.ahead.start_front)
    for at, is_corner in ((corner, True), (Point(corner.x - 1.0, corner.y - 1.0), False)):
        pair = tuple(SensorPose(at.x + 0.2 + off, at.y + 0.9, 0.0, -1.0) for off in (-0.25, 0.25))
        ranges = tuple(math.hypot(at.x - sensor.x, at.y - sensor.y) for sensor in pair)
        point = point_between(pair[0], ranges[0], pair[1], ranges[1])
        assert (point.x, point.y) == (pytest.approx(at.x), pytest.approx(at.y))
        assert is_slot_corner(slot_filter, point) == is_corner


def test_a_turned_car_bounds_the_gap_where_the_vehicle_will_stand_however_much_of_its_flank_is_mapped() -> None:
    """A car turned by 5 deg, whose corner is 3 m along the row: of its flank the mouth, the middle or the end."""
    row = SlotRow(Pose(), -1.0, used=2)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, behind=RowMember(-1.8, 0.0), ahead=RowMember(3.0, 4.8))
    lean = math.tan(math.radians(5.0))
    edges = []
    for deep in (0.6, 2.2, 3.6):
        flank = side(3.0 + deep * lean, -deep, -85.0, 1.0)
        edges.append(correct_slot(slot, (flank,) * MAX_LANDMARKS, OUTLINE, DEEP, MappingParams()).ahead.start)
    assert edges == pytest.approx([3.0 + OUTLINE.half_length * lean] * 3, abs=0.005)


def test_a_short_piece_of_a_flank_does_not_narrow_the_gap_by_what_its_direction_errs() -> None:
    """0.7 m of a flank at the mouth, turned by 9 deg and known to 8 deg: half a vehicle deep it may be anywhere."""
    row = SlotRow(Pose(), -1.0, used=2)
    slot = SlotCandidate(SlotType.PERPENDICULAR, row=row, behind=RowMember(-1.8, 0.0), ahead=RowMember(3.0, 4.8))
    sigma = math.radians(8.0)
    piece = side(3.03, -0.3, 261.0, 0.7)._replace(hh=sigma * sigma)
    landmarks = (side(3.0, -2.5, 90.0, 2.0), piece) + (Landmark(),) * (MAX_LANDMARKS - 2)
    corrected = correct_slot(slot, landmarks, OUTLINE, DEEP, MappingParams())
    assert corrected.ahead.start == pytest.approx(3.0, abs=0.02)
