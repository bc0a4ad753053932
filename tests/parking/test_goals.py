"""Where the vehicle is to go: an external slot checked against the map, the driver's choice, a pose on a known map."""

import math

import pytest

from controller_fmu.common.driver_selection import MAX_OFFERS, ChosenSide, DriverSelection
from controller_fmu.common.external_slot import ExternalSlot, SlotKind
from controller_fmu.interface import Reason
from controller_fmu.parking.chart import Condition, ParkingState, next_parking_state
from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.geometry.outline import vehicle_outline
from controller_fmu.parking.geometry.polygons import LOCAL_VERTICES, MAP_VERTICES, ObstacleMap, Vertex
from controller_fmu.parking.map.landmark import MAX_LANDMARKS, Landmark, LandmarkType
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.obstacle_map import is_on_map, obstacle_map
from controller_fmu.parking.perception import number_of_choice, with_offer
from controller_fmu.parking.planning.planner import store_request
from controller_fmu.parking.planning.problem import PlanningRequest
from controller_fmu.parking.planning.work import PlanCount, PlanningWork
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType
from controller_fmu.parking.slots.external import external_candidate, external_pose, has_passed_external
from controller_fmu.parking.slots.goal import goal_pose, least_depth, most_overhang, overhang_of
from controller_fmu.parking.slots.params import SlotParams
from controller_fmu.parking.slots.row import RowMember, SlotRow
from modelkit.car import Car
from modelkit.geometry import Point
from modelkit.store import new_store
from modelkit.vocabulary import Pose

OUTLINE = vehicle_outline(Car(), 0.95)
SLOT, MAPPING = SlotParams(), MappingParams()
NOWHERE = (Landmark(),) * MAX_LANDMARKS
ROAD = Pose(9.0, 1.8, 0.0)


def square(kind: SlotKind, length: float, depth: float, side: float = -1.0) -> ExternalSlot:
    """Return a slot along x from the origin, on the right (-1) or left (1) of a road in the direction of x."""
    y = side * depth
    return ExternalSlot(kind, 0.0, 0.0, length, 0.0, length, y, 0.0, y, side * 0.5 * math.pi)


def judged(given: ExternalSlot, landmarks: tuple[Landmark, ...] = NOWHERE, vehicle: Pose = ROAD) -> SlotCandidate:
    return external_candidate(given, vehicle, landmarks, OUTLINE, SLOT, MAPPING)


def wall(x: float, y: float, length: float) -> tuple[Landmark, ...]:
    """Return a map with a confirmed segment along x whose middle is at (x, y)."""
    half = 0.5 * length
    segment = Landmark(LandmarkType.SEGMENT, x, y, 0.0, start=-half, end=half, confirmations=99)
    return (segment, *NOWHERE[1:])


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("kind", [SlotKind.PARALLEL, SlotKind.TAIL_IN, SlotKind.NOSE_IN])
def test_the_goal_in_an_external_slot_is_the_pose_in_its_middle(kind: SlotKind, side: float) -> None:
    """Both ways from the corners to a pose agree, and swapped corners are the same slot."""
    length, depth = (6.0, 2.0 * OUTLINE.half_width) if kind == SlotKind.PARALLEL else (2.6, 2.0 * OUTLINE.half_length)
    slot = square(kind, length, depth, side)
    swapped = slot._replace(ax=slot.bx, ay=slot.by, bx=slot.ax, by=slot.ay, cx=slot.dx, dx=slot.cx)
    pose = external_pose(slot, OUTLINE, ROAD)
    for given in (slot, swapped):
        candidate = judged(given)._replace(depth=50.0)
        assert candidate.reason in (Reason.NONE, Reason.SLOT_TOO_SHALLOW)
        goal = goal_pose(candidate, OUTLINE, SLOT)
        assert math.cos(goal.heading - pose.heading) == pytest.approx(1.0)
        assert (goal.x, goal.y) == pytest.approx((pose.x, pose.y), abs=1e-9)
    across = 0.0 if kind == SlotKind.PARALLEL else 1.0
    assert abs(math.sin(pose.heading)) == pytest.approx(across, abs=1e-9)


@pytest.mark.parametrize("slope", [30, 45, 60])
def test_the_road_has_a_slope_in_the_frame_of_an_angled_slot(slope: int) -> None:
    heading = -math.radians(slope)
    width = 2.6 / math.sin(math.radians(slope))
    candidate = judged(ExternalSlot(SlotKind.NOSE_IN, 0.0, 0.0, width, 0.0, width, 0.0, 0.0, 0.0, heading))
    assert candidate.reason == Reason.NONE
    assert candidate.ahead.start == pytest.approx(2.6)
    a, b = (point_to_frame(x, 0.0, candidate.row.frame) for x in (0.0, width))
    assert (b.y - a.y) / (b.x - a.x) == pytest.approx(candidate.row.slope)
    assert goal_pose(candidate, OUTLINE, SLOT).heading == pytest.approx(heading)


@pytest.mark.parametrize(
    ("given", "landmarks", "reason"),
    [
        (square(SlotKind.PARALLEL, 4.2, 1.9), NOWHERE, Reason.SLOT_TOO_SHORT),
        (square(SlotKind.TAIL_IN, 1.9, 4.3), NOWHERE, Reason.SLOT_TOO_SHORT),
        (square(SlotKind.TAIL_IN, 2.6, 3.0), NOWHERE, Reason.SLOT_TOO_SHALLOW),
        (square(SlotKind.PARALLEL, 6.0, 1.2), NOWHERE, Reason.SLOT_TOO_SHALLOW),
        (square(SlotKind.PARALLEL, 6.0, 1.9), wall(3.0, -0.5, 2.0), Reason.SLOT_CONTRADICTED),
        (square(SlotKind.TAIL_IN, 2.6, 4.3), wall(1.3, -1.0, 0.5), Reason.SLOT_CONTRADICTED),
        (square(SlotKind.PARALLEL, 6.0, 1.9), wall(3.0, -1.9, 20.0), Reason.NONE),
        (square(SlotKind.PARALLEL, 6.0, 1.9), wall(-2.0, 0.0, 4.0), Reason.NONE),
        (square(SlotKind.PARALLEL, 6.0, 1.9)._replace(ax=math.nan), NOWHERE, Reason.BAD_INPUT),
    ],
)
def test_an_external_slot_is_judged_by_its_size_and_the_map(
    given: ExternalSlot, landmarks: tuple[Landmark, ...], reason: Reason
) -> None:
    assert judged(given, landmarks).reason == reason


def test_an_external_slot_is_shown_when_the_side_sensor_has_passed_it() -> None:
    slot = square(SlotKind.PARALLEL, 6.0, 1.9)
    passed = [has_passed_external(judged(slot), 3.0, Pose(x, 1.8, 0.0)) for x in (2.0, 3.1, 3.2, 9.0)]
    assert passed == [False, False, True, True]


def gap(x: float, side: float) -> SlotCandidate:
    """Return a slot of 6 m that begins at x [m] on one side of the road."""
    return SlotCandidate(
        type=SlotType.PARALLEL, row=SlotRow(Pose(), side), behind=RowMember(end=x), ahead=RowMember(start=x + 6.0)
    )


def test_the_driver_chooses_among_the_slots_offered() -> None:
    offered = (SlotCandidate(),) * MAX_OFFERS
    for found in (gap(0.0, -1.0), gap(0.5, -1.0), gap(1.0, 1.0), gap(12.0, -1.0)):
        offered = with_offer(offered, found)
    assert [slot.behind.end for slot in offered] == [12.0, 1.0, 0.5], "the newest first, a better estimate in place"
    chosen = {
        (side, number): number_of_choice(offered, DriverSelection(side=side, slot=number))
        for side in ChosenSide
        for number in range(MAX_OFFERS + 1)
    }
    assert [chosen[ChosenSide.ANY, number] for number in range(4)] == [1, 1, 2, 3]
    assert [chosen[ChosenSide.LEFT, number] for number in range(4)] == [2, 0, 2, 0]
    assert [chosen[ChosenSide.RIGHT, number] for number in range(4)] == [1, 1, 0, 3]
    assert number_of_choice(with_offer((SlotCandidate(),) * MAX_OFFERS, gap(0.0, 1.0)), DriverSelection(slot=2)) == 0


def test_the_polygons_of_a_map_stand_behind_those_of_the_landmarks() -> None:
    corners = ((0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (0.0, 2.0))
    known = tuple(Vertex(x, y, 1) for x, y in corners) + (Vertex(),) * (MAP_VERTICES - 4)
    own = ObstacleMap()
    own = own._replace(vertices=(Vertex(9.0, 9.0, 1), *own.vertices[1:]))
    work, request = new_store(PlanningWork), PlanningRequest(has_map=True)
    assert not store_request(work, own, known, request)
    assert store_request(work, own, known, request)
    assert not store_request(work, own, (Vertex(0.1, 0.0, 1), *known[1:]), request)
    assert not store_request(work, own, known, request)
    assert list(work.corner_x[:2]) == [9.0, 0.0]
    whole = list(zip(work.corner_x, work.corner_y, work.corner_of, strict=True))
    assert [v[:2] for v in whole[LOCAL_VERTICES : LOCAL_VERTICES + 5]] == [*corners, (0.0, 0.0)]
    assert len({v[2] for v in whole if v[2]}) == 2
    assert not store_request(work, own, known, request._replace(has_map=False))
    assert work.counts[PlanCount.VERTEX_COUNT] == LOCAL_VERTICES
    sides = {y: is_on_map(wall(2.0, y, 3.0)[0], known, 0.2) for y in (0.1, 1.0, 1.9, 2.3)}
    assert sides == {0.1: True, 1.0: False, 1.9: True, 2.3: False}
    assert not is_on_map(wall(4.0, 0.0, 3.0)[0], known, 0.2), "half of it goes on beyond the polygon"


@pytest.mark.parametrize("switched_on", [False, True])
def test_a_known_goal_is_planned_to_without_a_search(switched_on: bool) -> None:
    bits = 1 << Condition.GOAL_KNOWN | (1 << Condition.SWITCHED_ON if switched_on else 0)
    assert next_parking_state(ParkingState.STANDBY, bits) == ParkingState.PLANNING


@pytest.mark.parametrize(
    ("beyond", "shift"),
    [(0.08, -0.02), (0.2, 0.0), (0.29, 0.0), (0.36, 0.06), (0.44, 0.1), (0.5, 0.0), (0.9, 0.0)],
)
def test_the_vehicle_stands_beside_a_kerb_as_gbt_wants(beyond: float, shift: float) -> None:
    """Flush with its neighbours it is ``beyond`` [m] from the kerb: nearest to that it stands 5 to 35 cm off by 5 cm.

    Their line is known to 2.5 cm: two sigma less than GB/T's 0.15 m.
    """
    row = SlotRow(Pose(), -1.0, used=2)
    depth = 2.0 * OUTLINE.half_width + beyond
    slot = SlotCandidate(type=SlotType.PARALLEL, row=row, depth=depth, front=1.0, front_sigma=0.025)
    slot = slot._replace(behind=RowMember(end=0.0), ahead=RowMember(start=6.0))
    assert -goal_pose(slot, OUTLINE, SLOT).y == pytest.approx(1.0 + OUTLINE.half_width + shift)


@pytest.mark.parametrize("left", [-0.02, 0.0, 0.06, 0.5])
def test_in_a_slot_hardly_deeper_than_the_vehicle_it_keeps_the_same_room_behind_and_before(left: float) -> None:
    length = 2.0 * OUTLINE.half_length
    slot = judged(square(SlotKind.TAIL_IN, 2.6, length))._replace(depth=length + left, front_sigma=0.04)
    pose = goal_pose(slot, OUTLINE, SLOT)
    overhang = overhang_of(slot, OUTLINE, pose)
    behind = left + overhang
    if left == 0.5:
        assert (overhang, behind) == pytest.approx((0.0, 0.5)), "flush with its neighbours"
    elif left == 0.06:
        assert behind == pytest.approx(SLOT.distance_behind)
    else:
        assert behind - SLOT.least_behind == pytest.approx(most_overhang(slot, OUTLINE, SLOT) - overhang)
    assert least_depth(slot, OUTLINE, SLOT) == pytest.approx(
        length + SLOT.least_behind - most_overhang(slot, OUTLINE, SLOT)
    )


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_what_the_vehicle_stands_in_was_wrongly_taken_for_occupied(side: float) -> None:
    """A rectangle about a slot that the vehicle cuts is left out; all stay that it only stands beside."""
    slot = judged(square(SlotKind.TAIL_IN, 2.6, 5.0, side))

    def numbers(x: float, y: float) -> set[int]:
        pose = Pose(x, y, -side * 0.5 * math.pi)
        polygons = obstacle_map(NOWHERE, slot, OUTLINE, pose, Point(20.0, -9.0), MAPPING)
        return {vertex.polygon for vertex in polygons.vertices} - {0}

    rear = side * OUTLINE.half_length
    inside = numbers(1.3, side * OUTLINE.centre_ahead + rear)
    assert len(inside) == 7
    assert inside - numbers(0.8, side * OUTLINE.centre_ahead + rear) == {MAX_LANDMARKS + 1}, "the neighbour behind"
    assert inside - numbers(1.8, side * OUTLINE.centre_ahead + rear) == {MAX_LANDMARKS + 2}, "the one ahead"
