"""The way out of a parallel slot, held against polygons of shapely."""

import math

import pytest
from shapely.geometry import Polygon
from shapely.geometry import box as rectangle

from controller_fmu.apa.around.standing_in import slot_around
from controller_fmu.apa.around.surroundings import shape_of
from controller_fmu.apa.choice import Choice, ChosenSide, ChosenTask
from controller_fmu.apa.outline import Shape
from controller_fmu.apa.slot import UNSEEN, Kind, Margins, Side, Site, Slot, site_of
from controller_fmu.apa.ways.move import end_of, length_of, point_at
from controller_fmu.apa.ways.planner import FOUND, NOTHING
from controller_fmu.apa.ways.pull_out import CLEAR, plan_out
from controller_fmu.common.slot_frame import to_slot, to_world
from controller_fmu.interface import ControllerInput, ControllerParams
from modelkit.vocabulary import Pose

PARAMS = ControllerParams(system=5)
CAR = shape_of(PARAMS)
MARGIN = 0.1


def outline(pose: Pose, car: Shape) -> Polygon:
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    corners = [(car.front, car.half_width), (-car.rear, car.half_width), (-car.rear, -car.half_width)]
    corners.append((car.front, -car.half_width))
    return Polygon([(pose.x + x * c - y * s, pose.y + x * s + y * c) for x, y in corners])


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
        plan = plan_out(pose, site, CAR)
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
    assert plan_out(pose, site, CAR).status == NOTHING


@pytest.mark.parametrize(("wish", "side"), [(ChosenSide.ANY, Side.RIGHT), (ChosenSide.RIGHT, Side.LEFT)])
def test_the_slot_around_a_parked_car_is_what_it_hears(wish: ChosenSide, side: Side) -> None:
    kerb, road = (10, 8) if side == Side.RIGHT else (8, 10)
    readings = [5.0] * 12
    readings[1] = readings[2] = 0.5
    readings[5] = readings[6] = 0.4
    readings[kerb] = 0.3
    inputs = ControllerInput(
        odometry=Pose(3.0, 2.0, 0.5 * math.pi), ultrasonic=tuple(readings), choice=Choice(ChosenTask.PULL_OUT, wish)
    )
    slot = slot_around(inputs, CAR, PARAMS)
    assert (slot.kind, slot.side, slot.opposite) == (Kind.PARALLEL, side, UNSEEN)
    assert slot.length == pytest.approx(CAR.front + CAR.rear + 0.9)
    assert slot.a.y == pytest.approx(2.0 - CAR.rear - 0.4)
    out = -1.0 if side == Side.RIGHT else 1.0
    assert (slot.a.x - 3.0) * out == pytest.approx(CAR.half_width + 0.2)
    assert slot.depth == pytest.approx(2.0 * CAR.half_width + 0.2 + 0.3)
    readings[road] = 3.0
    beside = slot_around(inputs._replace(ultrasonic=tuple(readings)), CAR, PARAMS)
    assert beside.opposite == pytest.approx(2.8)
