"""The way out of a parallel slot, held against polygons of shapely."""

import math

import pytest
from shapely.geometry import Polygon
from shapely.geometry import box as rectangle

from controller_fmu.apa.around.surroundings import shape_of
from controller_fmu.apa.out.moves import CLEAR, TURNED
from controller_fmu.apa.out.pull_out import OutSearch, plan_out
from controller_fmu.apa.out.standing_in import STANDS_OUT, UNSURE, slot_around
from controller_fmu.apa.outline import Shape
from controller_fmu.apa.slot import UNSEEN, Kind, Margins, Side, Site, Slot, site_of
from controller_fmu.apa.ways.move import end_of, length_of, point_at
from controller_fmu.apa.ways.planner import FOUND, NOTHING, SEARCHING, PlanSearch
from controller_fmu.common.driver_selection import ChosenSide, ChosenTask, DriverSelection
from controller_fmu.common.slot_frame import SlotFrame, to_slot, to_world
from controller_fmu.registry import ControllerInput, ControllerParams
from modelkit.vocabulary import Pose

PARAMS = ControllerParams(system=5)
CAR = shape_of(PARAMS)
MARGIN = 0.1


def outline(pose: Pose, car: Shape) -> Polygon:
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    corners = [(car.front, car.half_width), (-car.rear, car.half_width), (-car.rear, -car.half_width)]
    corners.append((car.front, -car.half_width))
    return Polygon([(pose.x + x * c - y * s, pose.y + x * s + y * c) for x, y in corners])


def planned(start: Pose, site: Site, car: Shape = CAR) -> PlanSearch:
    search, plan = OutSearch(), PlanSearch(SEARCHING)
    while plan.status == SEARCHING:
        search, plan = plan_out(search, start, site, car, 16)
    return plan


def scene(length: float, depth: float = 2.1) -> tuple[Site, Slot]:
    slot = Slot(Kind.PARALLEL, Side.RIGHT, Pose(), length, depth=depth)
    return site_of(slot, CAR, Margins(MARGIN, MARGIN, 0.0)), slot


@pytest.mark.parametrize("spare", [0.9, 1.2, 1.8, 3.0])
@pytest.mark.parametrize("share", [0.3, 0.7])
def test_the_way_out_touches_nothing_and_ends_with_the_front_clear(spare: float, share: float) -> None:
    length = CAR.front + CAR.rear + spare
    site, slot = scene(length)
    things = [rectangle(-8.0, -30.0, 0.0, 0.0), rectangle(length, -30.0, length + 8.0, 0.0)]
    things.append(rectangle(-50.0, -50.0, 50.0, -slot.depth))
    pose = to_slot(Pose(share * spare + CAR.rear, -CAR.half_width - 0.1, 0.0), site.frame)
    nearest, before = 1e9, 99
    for _ in range(12):
        plan = planned(pose, site)
        assert plan.status == FOUND
        assert plan.moves < before
        if plan.moves == 0:
            break
        for number in range(40):
            at = point_at(plan.move, length_of(plan.move) * number / 39).pose
            body = outline(to_world(at, site.frame), CAR)
            nearest = min(nearest, *(body.distance(thing) for thing in things))
        pose, before = end_of(plan.move), plan.moves
    assert nearest > MARGIN - 0.02
    ahead = outline(to_world(pose, site.frame), CAR._replace(front=CAR.front + CLEAR))
    assert ahead.distance(things[1]) > 0.0
    at_first = outline(Pose(share * spare + CAR.rear, -CAR.half_width, 0.0), CAR._replace(front=CAR.front + CLEAR))
    assert at_first.distance(things[1]) == 0.0


def test_out_of_a_slot_that_is_too_short_there_is_no_way() -> None:
    site, _ = scene(CAR.front + CAR.rear + 0.3)
    pose = to_slot(Pose(0.15 + CAR.rear, -CAR.half_width, 0.0), site.frame)
    assert planned(pose, site).status == NOTHING


def test_beside_a_near_kerb_the_car_first_gains_room() -> None:
    _, slot = scene(CAR.front + CAR.rear + 1.2, 2.0 * CAR.half_width + 0.24)
    site = site_of(slot, CAR, Margins(0.05, 0.05, 0.0))
    kerb = rectangle(-50.0, -50.0, 50.0, -slot.depth)
    pose = to_slot(Pose(0.6 + CAR.rear, -CAR.half_width - 0.12, 0.0), site.frame)
    gap = outline(to_world(pose, site.frame), CAR).distance(kerb)
    assert gap == pytest.approx(0.12)
    for _ in range(12):
        plan = planned(pose, site)
        assert plan.status == FOUND
        if plan.moves == 0:
            break
        ways = [length_of(plan.move) * number / 60 for number in range(61)]
        bodies = [outline(to_world(point_at(plan.move, way).pose, site.frame), CAR) for way in ways]
        assert min(body.distance(kerb) for body in bodies) > 0.03
        pose = end_of(plan.move)
    assert plan.moves == 0


def test_out_of_a_slot_across_the_road_it_turns_to_the_left_and_touches_nothing() -> None:
    width, street = 2.0 * CAR.half_width + 0.8, 6.0
    slot = Slot(Kind.PERPENDICULAR, Side.RIGHT, Pose(), width, opposite=street)
    site = site_of(slot, CAR, Margins(MARGIN, MARGIN, 0.0))
    things = [rectangle(-5.0, -30.0, 0.0, 0.0), rectangle(width, -30.0, width + 5.0, 0.0)]
    things.append(rectangle(-50.0, street, 50.0, street + 1.0))
    pose = to_slot(Pose(0.5 * width, -CAR.front, 0.5 * math.pi), site.frame)
    plan = planned(pose, site)
    while plan.moves > 0:
        ways = [length_of(plan.move) * number / 80 for number in range(81)]
        bodies = [outline(to_world(point_at(plan.move, way).pose, site.frame), CAR) for way in ways]
        assert min(body.distance(thing) for body in bodies for thing in things) > MARGIN - 0.02
        pose = end_of(plan.move)
        plan = planned(pose, site)
    assert plan.status == FOUND
    world = to_world(pose, site.frame)
    assert world.heading > 0.5 * math.pi + TURNED
    ahead = outline(world, CAR._replace(front=CAR.front + CLEAR))
    assert min(ahead.distance(thing) for thing in things) > 0.0


def heard_at(pose: Pose, **near: float) -> ControllerInput:
    """Readings of a car among things on its left and right, and 0.5 m ahead and behind unless said otherwise."""
    readings = [5.0] * 12
    for number, name in ((1, "ahead"), (2, "ahead"), (5, "behind"), (6, "behind")):
        readings[number] = near.get(name, 0.5)
    for number, name in ((8, "left"), (9, "left"), (10, "right"), (11, "right"), (3, "corner"), (7, "corner")):
        readings[number] = near.get(name, 5.0)
    return ControllerInput(
        odometry=pose, ultrasonic=tuple(readings), driver_selection=DriverSelection(ChosenTask.PULL_OUT)
    )


def test_the_slot_lies_along_the_kerb_that_both_sensors_hear() -> None:
    inputs = heard_at(Pose(), right=0.3)
    tilt = 0.02
    mounts = PARAMS.car.ultrasonic.mounts
    readings = [*inputs.ultrasonic]
    readings[10] += tilt * (mounts[10].x - mounts[11].x)
    slot = slot_around(inputs._replace(ultrasonic=tuple(readings)), CAR, PARAMS)
    assert slot.a.heading == pytest.approx(-tilt, rel=1e-3)
    wall = to_world(Pose(2.0, -slot.depth, 0.0), SlotFrame(slot.a, 1.0))
    straight = -CAR.half_width - 0.3 - tilt * (wall.x - mounts[11].x)
    assert wall.y == pytest.approx(straight, abs=2e-3)


@pytest.mark.parametrize("gap", [0.08, 0.1, 0.14])
def test_a_kerb_nearer_than_the_sensors_tell_is_told_by_the_corners(gap: float) -> None:
    mount = PARAMS.car.ultrasonic.mounts[3]
    reach = (gap + CAR.half_width - abs(mount.y)) / math.sin(math.radians(60.0))
    slot = slot_around(heard_at(Pose(), right=PARAMS.car.ultrasonic.min_range, corner=reach), CAR, PARAMS)
    assert slot.depth == pytest.approx(2.0 * CAR.half_width + STANDS_OUT + gap - UNSURE, abs=0.01)


def test_something_near_on_the_side_wished_for_is_a_neighbour_of_a_slot_across_the_road() -> None:
    slot = slot_around(heard_at(Pose(), left=0.4, right=0.6, ahead=5.0, behind=0.3), CAR, PARAMS)
    assert (slot.kind, slot.side, slot.opposite, slot.empty_b) == (Kind.PERPENDICULAR, Side.RIGHT, UNSEEN, False)
    assert slot.length == pytest.approx(2.0 * CAR.half_width + 1.0)
    corner = Pose(CAR.front + STANDS_OUT, CAR.half_width + 0.4, -0.5 * math.pi)
    assert slot.a == pytest.approx(corner)
    assert slot.depth == pytest.approx(CAR.front + STANDS_OUT + CAR.rear + 0.3)
    alone = slot_around(heard_at(Pose(), left=0.4, ahead=4.8, behind=5.0), CAR, PARAMS)
    assert (alone.depth, alone.empty_b) == (UNSEEN, True)
    assert alone.opposite == pytest.approx(4.8 - STANDS_OUT)
    somebody = slot_around(heard_at(Pose(), left=0.4, ahead=2.0, behind=5.0), CAR, PARAMS)
    assert somebody.opposite == UNSEEN


@pytest.mark.parametrize(("wish", "side"), [(ChosenSide.ANY, Side.RIGHT), (ChosenSide.RIGHT, Side.LEFT)])
def test_the_slot_around_a_parked_car_is_what_it_hears(wish: ChosenSide, side: Side) -> None:
    kerb, road = (10, 8) if side == Side.RIGHT else (8, 10)
    readings = [5.0] * 12
    readings[1] = readings[2] = 0.5
    readings[5] = readings[6] = 0.4
    readings[kerb] = readings[kerb + 1] = 0.3
    inputs = ControllerInput(
        odometry=Pose(3.0, 2.0, 0.5 * math.pi),
        ultrasonic=tuple(readings),
        driver_selection=DriverSelection(ChosenTask.PULL_OUT, wish),
    )
    slot = slot_around(inputs, CAR, PARAMS)
    assert (slot.kind, slot.side, slot.opposite) == (Kind.PARALLEL, side, UNSEEN)
    assert slot.length == pytest.approx(CAR.front + CAR.rear + 0.9)
    assert slot.a.y == pytest.approx(2.0 - CAR.rear - 0.4)
    out = -1.0 if side == Side.RIGHT else 1.0
    assert (slot.a.x - 3.0) * out == pytest.approx(CAR.half_width + STANDS_OUT)
    assert slot.depth == pytest.approx(2.0 * CAR.half_width + STANDS_OUT + 0.3)
    readings[road] = 3.0
    beside = slot_around(inputs._replace(ultrasonic=tuple(readings)), CAR, PARAMS)
    assert beside.opposite == pytest.approx(3.0 - STANDS_OUT)
