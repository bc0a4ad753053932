"""The slot is found again where the sensors hear it: drift of the odometry, walls not heard from the road."""

import math
from typing import Any

import pytest

from controller_fmu.apa.around.arcs import Unknown
from controller_fmu.apa.around.guard import GuardState, listen
from controller_fmu.apa.around.local_map import begin_map, heard, moved
from controller_fmu.apa.around.nearer import explained, nearer_than_thought, pressed
from controller_fmu.apa.around.relocate import braked, walled
from controller_fmu.apa.around.row import is_certain, slot_of_map
from controller_fmu.apa.around.surroundings import Around
from controller_fmu.apa.hearing.mute import MUTE
from controller_fmu.apa.outline import Box, Obstacles, Shape
from controller_fmu.apa.params import MapParams
from controller_fmu.apa.parking import Parking
from controller_fmu.apa.slot import UNSEEN, Kind, Side, Slot
from controller_fmu.apa.system import ApaState, _no_way
from controller_fmu.apa.ways.move import is_move_free
from controller_fmu.apa.ways.turns import straight_move
from controller_fmu.interface import Reason
from controller_fmu.registry import ControllerInput, ControllerParams
from modelkit.car import CarUltrasonic
from modelkit.vocabulary import Pose
from vehicle_fmu.scene import Obstacle, SceneParams
from vehicle_fmu.ultrasonic import UltrasonicParams, range_measurements

PARAMS = ControllerParams()
SENSORS = CarUltrasonic()
MAP = MapParams()
DRIFT = 0.08
READINGS = 60


def scene_of(boxes: Any, side: Any) -> Any:
    """Return a scene of (x0, x1, y0, y1) or (x0, x1, y0, y1, heading), mirrored for a slot on the left."""
    mirror = -1.0 if side == Side.LEFT else 1.0
    obstacles = [
        Obstacle(0.5 * (a + b), mirror * 0.5 * (c + d), mirror * sum(turn), b - a, d - c) for a, b, c, d, *turn in boxes
    ]
    missing = len(SceneParams().boxes) - len(obstacles)
    return SceneParams(boxes=(*obstacles, *(Obstacle() for _ in range(missing))))


def inputs_at(true: Any, believed: Any, boxes: Any, side: Any) -> Any:
    distances = range_measurements(true, scene_of(boxes, side), SENSORS, UltrasonicParams().kerb_height, 0)
    return ControllerInput(odometry=believed, ultrasonic=distances)


def followed(slot: Any, true: Any, believed: Any, boxes: Any) -> Any:
    """Return the map and the slot after a while at a pose, of which the car believes another."""
    here = begin_map(slot, believed, MAP)
    readings = inputs_at(true, believed, boxes, slot.side).ultrasonic
    for _ in range(READINGS):
        here = heard(moved(here, believed, MAP), readings, SENSORS, MAP)
    return here, slot_of_map(here, slot, MAP)


@pytest.mark.parametrize("side", [0, 1])
def test_neighbours_of_a_perpendicular_slot_are_followed(side: int) -> None:
    mirror = -1.0 if side == Side.LEFT else 1.0
    slot = Slot(Kind.PERPENDICULAR, side, Pose(0.0, 0.0, 0.0), 2.9, 0.0, UNSEEN)
    true = Pose(1.4, mirror * -2.5, mirror * (0.5 * math.pi + 0.1))
    boxes = [(-2.0, 0.0, -5.0, 0.0), (2.9, 5.0, -5.0, 0.0)]
    here, found = followed(slot, true, Pose(true.x + DRIFT, true.y, true.heading), boxes)
    assert found.a.x == pytest.approx(DRIFT, abs=0.021)
    assert found.length == pytest.approx(2.9, abs=0.02)
    assert is_certain(here, MAP)


def askew(corner: Any, middle: Any, turn: Any) -> Any:
    """Return a box of 1.8 m x 4.6 m whose corner at the slot's mouth is at x = ``corner``, y = 0."""
    c, s = math.cos(turn), math.sin(turn)
    x, y = corner + middle * c + 2.3 * s, middle * s - 2.3 * c
    return (x - 0.9, x + 0.9, y - 2.3, y + 2.3, turn)


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("degrees", [-4.0, 4.0])
def test_neighbours_that_stand_askew_are_given_their_own_heading(side: int, degrees: float) -> None:
    mirror = -1.0 if side == Side.LEFT else 1.0
    turn = math.radians(degrees)
    slot = Slot(Kind.PERPENDICULAR, side, Pose(0.0, 0.0, 0.0), 3.2, 0.0, UNSEEN)
    boxes = [askew(0.0, -0.9, turn), askew(3.2, 0.9, turn)]
    true = Pose(1.6 + 2.4 * math.sin(turn), mirror * -3.6, mirror * (0.5 * math.pi + turn))
    found = followed(slot, true, true, boxes)[1]
    assert mirror * found.a.heading == pytest.approx(turn, abs=math.radians(0.8))


@pytest.mark.parametrize("side", [0, 1])
def test_the_wall_of_a_parallel_slot_is_followed(side: int) -> None:
    mirror = -1.0 if side == Side.LEFT else 1.0
    slot = Slot(Kind.PARALLEL, side, Pose(0.0, 0.0, 0.0), 6.0, 0.0, 2.1)
    true = Pose(1.6, mirror * -0.7, mirror * 0.2)
    boxes = [(-4.0, 0.0, -2.0, 0.0), (6.0, 10.0, -2.0, 0.0), (-9.0, 15.0, -3.0, -2.1)]
    found = followed(slot, true, Pose(true.x, true.y + mirror * DRIFT, true.heading), boxes)[1]
    assert mirror * found.a.y - found.depth == pytest.approx(DRIFT - 2.1, abs=0.02)


def test_the_map_is_less_sure_the_farther_the_car_drives_unheard() -> None:
    slot = Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), 6.0, 0.0, 2.1)
    here = begin_map(slot, Pose(8.0, 1.6, 0.0), MAP)
    after = here
    for number in range(1, 20):
        after = moved(after, Pose(8.0 + number, 1.6, 0.0), MAP)
    assert after.a.xx > here.a.xx
    assert after.b.hh > here.b.hh
    assert not is_certain(after, MAP)
    assert slot_of_map(after, slot, MAP).unsure > 0.0
    assert slot_of_map(here, slot, MAP) == slot


def test_a_wall_moves_a_neighbour_the_less_the_surer_he_is() -> None:
    pose = Pose(1.6, -0.9, 0.0)
    slot = Slot(Kind.PARALLEL, 0, Pose(), 6.0, depth=2.1)
    here = begin_map(slot, pose, MAP)
    sure = here._replace(
        a=here.a._replace(yy=0.15**2), b=here.b._replace(yy=0.015**2), wall=here.wall._replace(yy=0.02**2)
    )
    nearer = inputs_at(pose, pose, [(-5.0, 11.0, -2.5, -2.07)], 0).ultrasonic
    after = heard(sure, nearer, SENSORS, MAP)
    assert after.wall.y > sure.wall.y + 0.005
    assert 0.7 * (after.wall.y - sure.wall.y) < after.a.y < 0.8 * (after.wall.y - sure.wall.y)
    assert 0.0 < after.b.y < 0.25 * after.a.y


def test_a_wall_not_heard_from_the_road_is_entered() -> None:
    slot = Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), 4.9, 0.0, UNSEEN)
    pose = Pose(1.3, -0.83, math.radians(26.0))
    boxes = [(-4.0, 0.0, -2.0, 0.0), (4.9, 9.0, -2.0, 0.0), (-9.0, 15.0, -3.0, -2.05)]
    here = walled(begin_map(slot, pose, MAP), slot, inputs_at(pose, pose, boxes, 0), False, PARAMS)
    assert slot_of_map(here, slot, MAP).depth == pytest.approx(2.05, abs=0.02)


@pytest.mark.parametrize("side", [0, 1])
def test_a_wall_behind_a_perpendicular_slot_is_entered_where_the_car_stops_before_it(side: int) -> None:
    mirror = -1.0 if side == Side.LEFT else 1.0
    slot = Slot(Kind.PERPENDICULAR, side, Pose(0.0, 0.0, 0.0), 3.2, 0.0, UNSEEN)
    pose = Pose(1.6, mirror * -3.6, mirror * 0.5 * math.pi)
    beside = [(-4.0, 0.0, -5.0, 0.0), (3.2, 7.0, -5.0, 0.0)]
    before = begin_map(slot, pose, MAP)
    closed = inputs_at(pose, pose, [*beside, (0.0, 3.2, -5.0, -4.6)], side)
    assert slot_of_map(walled(before, slot, closed, True, PARAMS), slot, MAP).depth == pytest.approx(4.6, abs=0.01)
    one_mute = tuple(MUTE if number == 5 else reading for number, reading in enumerate(closed.ultrasonic))
    entered = walled(before, slot, closed._replace(ultrasonic=one_mute), True, PARAMS)
    assert slot_of_map(entered, slot, MAP).depth == pytest.approx(4.6, abs=0.01), "the other has to do"
    assert walled(before, slot, closed, False, PARAMS) == before
    assert walled(before, slot, inputs_at(pose, pose, beside, side), True, PARAMS) == before


def test_the_way_that_braking_slips_is_made_up_for() -> None:
    slot = Slot(Kind.PARALLEL, 0, Pose(1.0, 2.0, 0.5), 6.0, 0.0, 2.1, unsure=0.02)
    after = braked(slot, 5.0, PARAMS)
    missed = 0.5 * PARAMS.apa.search.slip * 25.0
    assert (after.a.x, after.a.y) == pytest.approx((1.0 - missed * math.cos(0.5), 2.0 - missed * math.sin(0.5)))
    assert (after.length, after.unsure) == pytest.approx((6.0, 0.02))
    assert braked(slot, 0.0, PARAMS).a == pytest.approx(slot.a)


def test_a_move_may_lead_out_of_a_margin_but_not_further_in() -> None:
    car = Shape()
    obstacles = Obstacles(ahead=Box(0.0, 60.0, -60.0, 0.0))
    within = Pose(5.0, 0.825 + 0.3, math.radians(-5.0))
    assert is_move_free(straight_move(within, -1, 2.0), car, obstacles)
    assert not is_move_free(straight_move(within, 1, 2.0), car, obstacles)


NEARER = 0.6
BESIDE = Slot(Kind.PARALLEL, Side.RIGHT, Pose(0.0, 0.0, 0.0), 6.6, 0.0, UNSEEN)
"""As the search found it; who stands nearer does so by ``NEARER``."""
STANDS = Pose(2.3, -0.8, 0.1)


def standing(side: int, a: float, b: float, lost: tuple[int, ...] = ()) -> Any:
    """Return map and readings of a car in a slot whose neighbours stand nearer than found by ``a`` and ``b`` [m]."""
    mirror = -1.0 if side == Side.LEFT else 1.0
    pose = Pose(STANDS.x, mirror * STANDS.y, mirror * STANDS.heading)
    here = begin_map(BESIDE._replace(side=side), pose, MAP)
    boxes = [(a - 4.4, a, -1.8, 0.0), (6.6 - b, 11.0 - b, -1.8, 0.0)]
    readings = list(inputs_at(pose, pose, boxes, side).ultrasonic)
    for number in lost:
        readings[number] = SENSORS.max_range
    return here, tuple(readings)


@pytest.mark.parametrize("side", [Side.RIGHT, Side.LEFT])
@pytest.mark.parametrize(("a", "b"), [(NEARER, 0.0), (0.0, 0.8)])
@pytest.mark.parametrize("lost", [(), (5,), (2, 6)])
def test_a_neighbour_nearer_than_the_search_found_him_is_placed_where_he_is_heard(
    side: int, a: float, b: float, lost: tuple[int, ...]
) -> None:
    here, readings = standing(side, a, b, lost)
    found = nearer_than_thought(here, readings, PARAMS)
    assert found.found
    assert found.map.a.x == pytest.approx(a, abs=0.07 if b == 0.0 else 1e-9)
    assert found.map.b.x == pytest.approx(6.6 - b, abs=0.07 if a == 0.0 else 1e-9)
    assert not is_certain(found.map, MAP)


@pytest.mark.parametrize("side", [Side.RIGHT, Side.LEFT])
@pytest.mark.parametrize("kind", [Kind.PERPENDICULAR, Kind.PARALLEL])
def test_who_has_come_out_of_a_row_across_the_road_is_placed_there(kind: int, side: int) -> None:
    mirror = -1.0 if side == Side.LEFT else 1.0
    pose = Pose(4.3, mirror * 1.95, mirror * 0.5)
    here = begin_map(Slot(kind, side, Pose(), 3.0), pose, MAP)
    boxes = [(-1.8, 0.0, -4.6, 0.0), (3.0, 4.8, -3.9, 0.7)]
    readings = inputs_at(pose, pose, boxes, side).ultrasonic
    found = nearer_than_thought(here, readings, PARAMS)
    if kind == Kind.PERPENDICULAR:
        on_its_way_out = nearer_than_thought(here._replace(within=True), readings, PARAMS)
        assert on_its_way_out.map.b.y == 0.0, "before a car that comes out itself it is a person"
        assert (found.map.b.x, found.map.b.y) == pytest.approx((3.0, 0.7), abs=0.07)
        assert found.map.a == here.a
    assert found.map.b.y == 0.0 or kind == Kind.PERPENDICULAR, "cars along the road do not drive across it"


@pytest.mark.parametrize("lost", [(), (5,), (0, 4)])
def test_who_stands_where_the_map_has_him_stays_there(lost: tuple[int, ...]) -> None:
    here, readings = standing(Side.RIGHT, 0.0, 0.0, lost)
    assert not nearer_than_thought(here, readings, PARAMS).found


@pytest.mark.parametrize("side", [Side.RIGHT, Side.LEFT])
def test_a_neighbour_who_is_wider_than_most_is_no_stranger(side: int) -> None:
    mirror = -1.0 if side == Side.LEFT else 1.0
    pose = Pose(0.85, mirror * -1.3, 0.0)
    here = begin_map(BESIDE._replace(side=side), pose, MAP)
    for stranger in (0.0, 0.3):
        boxes = [(-4.4, stranger, -2.0, -1.85), (-4.4, 0.0, -1.85, 0.0)]
        kept = listen(GuardState(), inputs_at(pose, pose, boxes, side).ultrasonic, here, PARAMS).unknown
        assert any(item.there for item in kept) == (stranger > 0.0), "what stands out of his flank is one"


def test_what_a_better_map_explains_is_strange_no_more_and_the_rest_is() -> None:
    here, readings = standing(Side.RIGHT, NEARER, 0.0)
    strange = GuardState(unknown=(Unknown(True),) * 12)
    before = explained(strange, readings, here, PARAMS)
    after = explained(strange, readings, nearer_than_thought(here, readings, PARAMS).map, PARAMS)
    assert before.unknown[5].there
    assert before.unknown[6].there
    assert not after.unknown[5].there
    assert not after.unknown[6].there
    silent = [number for number in range(12) if readings[number] >= SENSORS.max_range]
    assert silent
    assert all(after.unknown[number].there for number in silent)


def test_who_is_heard_nearest_is_taken_for_nearer() -> None:
    here, readings = standing(Side.RIGHT, NEARER, 0.0)
    closer = pressed(here, (*readings[:5], 0.2, *readings[6:]), PARAMS)
    assert closer == here._replace(a=here.a._replace(x=closer.a.x))
    assert 0.0 < closer.a.x < 0.1
    assert pressed(here, (SENSORS.max_range,) * 12, PARAMS) == here


@pytest.mark.parametrize(("depth", "reason"), [(3.6, Reason.SLOT_TOO_SHALLOW), (4.2, Reason.NO_PATH)])
def test_a_slot_that_turns_out_too_shallow_is_no_missing_path(depth: float, reason: Reason) -> None:
    """A car of 3.8 m that stands out by 12 cm and 8 cm before what ends the slot needs 3.76 m."""
    slot = Slot(Kind.PERPENDICULAR, Side.RIGHT, Pose(), 3.0, 0.0, depth)
    assert _no_way(ApaState(around=Around(slot)), PARAMS) == reason
    assert _no_way(ApaState(around=Around(slot), parking=Parking(out=True)), PARAMS) == Reason.NO_PATH
