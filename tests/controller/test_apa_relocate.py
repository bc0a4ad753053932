"""The slot is found again where the sensors hear it: drift of the odometry, walls not heard from the road."""

import math

import pytest

from controller_fmu.apa.move import is_move_free
from controller_fmu.apa.outline import Box, Obstacles, Shape
from controller_fmu.apa.relocate import OUT, along, between, braked, relocated
from controller_fmu.apa.slot import UNSEEN, Kind, Side, Slot
from controller_fmu.apa.supervisor import look
from controller_fmu.apa.turns import straight_move
from controller_fmu.interface import ControllerInput, ControllerParams
from modelkit.car import CarUltrasonic
from modelkit.vocabulary import Pose
from vehicle_fmu.scene import Obstacle, SceneParams
from vehicle_fmu.ultrasonic import UltrasonicParams, heard_distances

PARAMS = ControllerParams()
DRIFT = 0.08
READINGS = 60


def scene_of(boxes, side):
    """Return a scene of (x0, x1, y0, y1), mirrored for a slot on the left."""
    mirror = -1.0 if side == Side.LEFT else 1.0
    obstacles = [Obstacle(0.5 * (a + b), mirror * 0.5 * (c + d), 0.0, b - a, d - c) for a, b, c, d in boxes]
    missing = len(SceneParams().boxes) - len(obstacles)
    return SceneParams(boxes=(*obstacles, *(Obstacle() for _ in range(missing))))


def inputs_at(true, believed, boxes, side):
    heard = heard_distances(true, scene_of(boxes, side), CarUltrasonic(), UltrasonicParams().kerb_height, 0)
    return ControllerInput(odometry=believed, ultrasonic=heard)


@pytest.mark.parametrize("side", [0, 1])
def test_neighbours_of_a_perpendicular_slot_are_followed(side):
    mirror = -1.0 if side == Side.LEFT else 1.0
    slot = Slot(Kind.PERPENDICULAR, side, Pose(0.0, 0.0, 0.0), 2.9, 0.0, UNSEEN)
    true = Pose(1.4, mirror * -2.5, mirror * (0.5 * math.pi + 0.1))
    boxes = [(-2.0, 0.0, -5.0, 0.0), (2.9, 5.0, -5.0, 0.0)]
    heard = inputs_at(true, Pose(true.x + DRIFT, true.y, true.heading), boxes, side)
    for _ in range(READINGS):
        slot = between(slot, heard, PARAMS)
    assert slot.a.x == pytest.approx(DRIFT, abs=0.01)
    assert slot.length == pytest.approx(2.9, abs=0.01)


@pytest.mark.parametrize("side", [0, 1])
def test_the_wall_of_a_parallel_slot_is_followed(side):
    mirror = -1.0 if side == Side.LEFT else 1.0
    slot = Slot(Kind.PARALLEL, side, Pose(0.0, 0.0, 0.0), 6.0, 0.0, 2.1)
    true = Pose(1.6, mirror * -0.7, mirror * 0.2)
    boxes = [(-4.0, 0.0, -2.0, 0.0), (6.0, 10.0, -2.0, 0.0), (-9.0, 15.0, -3.0, -2.1)]
    heard = inputs_at(true, Pose(true.x, true.y + mirror * DRIFT, true.heading), boxes, side)
    for _ in range(READINGS):
        slot = along(slot, heard, PARAMS)
    assert slot.a.y == pytest.approx(mirror * (DRIFT + OUT), abs=0.005)
    assert (slot.length, slot.depth) == (6.0, 2.1)


def test_nothing_moves_on_the_road():
    slot = Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), 6.0, 0.0, 2.1)
    heard = inputs_at(Pose(8.0, 1.6, 0.0), Pose(8.0, 1.6, 0.0), [(6.0, 10.0, -2.0, 0.0)], 0)
    assert along(slot, heard, PARAMS) == slot
    assert between(slot, heard, PARAMS) == slot
    assert relocated(slot, heard, False, PARAMS) == slot


def test_a_wall_not_heard_from_the_road_is_entered():
    slot = Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), 4.9, 0.0, UNSEEN)
    pose = Pose(1.3, -0.83, math.radians(26.0))
    boxes = [(-4.0, 0.0, -2.0, 0.0), (4.9, 9.0, -2.0, 0.0), (-9.0, 15.0, -3.0, -2.05)]
    assert relocated(slot, inputs_at(pose, pose, boxes, 0), False, PARAMS).depth == pytest.approx(2.05, abs=0.02)


@pytest.mark.parametrize("side", [0, 1])
def test_a_wall_behind_a_perpendicular_slot_is_entered_where_the_car_stops_before_it(side):
    mirror = -1.0 if side == Side.LEFT else 1.0
    slot = Slot(Kind.PERPENDICULAR, side, Pose(0.0, 0.0, 0.0), 3.2, 0.0, UNSEEN)
    pose = Pose(1.6, mirror * -3.6, mirror * 0.5 * math.pi)
    heard = inputs_at(pose, pose, [(-4.0, 0.0, -5.0, 0.0), (3.2, 7.0, -5.0, 0.0), (0.0, 3.2, -5.0, -4.6)], side)
    assert relocated(slot, heard, True, PARAMS).depth == pytest.approx(4.6, abs=0.01)
    assert relocated(slot, heard, False, PARAMS) == slot
    nothing = inputs_at(pose, pose, [(-4.0, 0.0, -5.0, 0.0), (3.2, 7.0, -5.0, 0.0)], side)
    assert relocated(slot, nothing, True, PARAMS) == slot


def test_the_way_that_braking_slips_is_made_up_for():
    slot = Slot(Kind.PARALLEL, 0, Pose(1.0, 2.0, 0.5), 6.0, 0.0, 2.1, unsure=0.02)
    moved = braked(slot, 5.0, PARAMS)
    missed = 0.5 * PARAMS.apa.search.slip * 25.0
    assert (moved.a.x, moved.a.y) == pytest.approx((1.0 - missed * math.cos(0.5), 2.0 - missed * math.sin(0.5)))
    assert (moved.length, moved.unsure) == pytest.approx((6.0, 0.02))
    assert braked(slot, 0.0, PARAMS).a == pytest.approx(slot.a)


def test_a_move_may_lead_out_of_a_margin_but_not_further_in():
    car = Shape()
    obstacles = Obstacles(ahead=Box(0.0, 60.0, -60.0, 0.0))
    within = Pose(5.0, 0.825 + 0.3, math.radians(-5.0))
    assert is_move_free(straight_move(within, -1, 2.0), car, obstacles)
    assert not is_move_free(straight_move(within, 1, 2.0), car, obstacles)


def test_the_edge_of_a_cone_on_a_known_neighbour_is_no_unknown_thing():
    pose = Pose(0.0, 0.0, 0.0)
    readings = (0.38, *(5.0,) * 11)
    beside = Obstacles(ahead=Box(3.4, 8.0, -2.0, 0.83))
    assert not look(readings, pose, 1.0, 1, 0.1, beside, PARAMS).unknown
    assert look(readings, pose, 1.0, 1, 0.1, Obstacles(), PARAMS).unknown
