"""How deep a car stands in a perpendicular slot, and how near it comes to what ends it."""

import math

import pytest

from controller_fmu.apa.around.local_map import LocalMap, begin_map
from controller_fmu.apa.around.straight import WALL_GAP, room_straight
from controller_fmu.apa.around.surroundings import shape_of
from controller_fmu.apa.outline import clearance
from controller_fmu.apa.params import MapParams
from controller_fmu.apa.parking import site_for
from controller_fmu.apa.slot import (
    BEHIND,
    DEEPER,
    LESS_OUT,
    UNSEEN,
    Kind,
    Side,
    Slot,
    site_of,
    stands_out_by,
    target_of,
)
from controller_fmu.apa.ways.fit import margins_of
from controller_fmu.registry import ControllerParams
from modelkit.vocabulary import Pose

PARAMS = ControllerParams()
SHAPE = shape_of(PARAMS)
LENGTH = SHAPE.front + SHAPE.rear
CLOSEST = 8
REAR = 5


def slot_of(depth: float) -> Slot:
    return Slot(Kind.PERPENDICULAR, Side.RIGHT, Pose(0.0, 0.0, 0.0), 3.2, 0.0, depth)


@pytest.mark.parametrize("deeper", [-0.02, 0.0, 0.05, 0.5])
def test_a_car_that_is_parked_stands_out_no_further_than_it_may(deeper: float) -> None:
    slot = slot_of(LENGTH + deeper)
    margins = margins_of(CLOSEST, PARAMS.apa)
    target = target_of(slot, SHAPE, margins)
    site = site_of(slot, SHAPE, margins)
    out = stands_out_by(target, slot, SHAPE) + site.x_high
    assert out <= PARAMS.apa.end.out - LESS_OUT + 1e-12
    assert target.y - SHAPE.rear + slot.depth >= BEHIND - 1e-12, "and no nearer to the wall"
    assert site.x_high >= 0.0


def test_in_a_slot_that_is_too_shallow_no_place_is_left() -> None:
    assert site_of(slot_of(LENGTH - 0.1), SHAPE, margins_of(CLOSEST, PARAMS.apa)).x_high < 0.0


@pytest.mark.parametrize("depth", [UNSEEN, LENGTH + 3.0])
def test_where_nothing_is_heard_behind_no_move_goes_much_deeper_than_the_car_stands(depth: float) -> None:
    slot = slot_of(depth)
    site = site_for(slot, 0, False, PARAMS)
    assert site.frame == site_of(slot, SHAPE, margins_of(0, PARAMS.apa)).frame, "it is to stand at the same place"
    free = [clearance(Pose(-deeper, 0.0, 0.0), SHAPE, site.obstacles) > 0.0 for deeper in (0.0, DEEPER, DEEPER + 0.05)]
    assert free == [True, True, depth < UNSEEN]


def before_a_wall(gap: float, sure: float) -> tuple[tuple[float, ...], LocalMap]:
    """Return what a car hears that stands square ``gap`` [m] before the wall of its slot, and its map."""
    slot = slot_of(LENGTH + 0.3)
    here = begin_map(slot, Pose(1.6, gap + SHAPE.rear - slot.depth, 0.5 * math.pi), MapParams())
    here = here._replace(wall=here.wall._replace(yy=sure * sure))
    readings = [PARAMS.car.ultrasonic.max_range] * 12
    readings[REAR] = readings[REAR + 1] = max(gap, PARAMS.car.ultrasonic.min_range)
    return tuple(readings), here


@pytest.mark.parametrize("gap", [0.1, 0.15, 0.3, 0.6])
def test_a_wall_that_is_surely_known_may_come_nearer(gap: float) -> None:
    room = room_straight(*before_a_wall(gap, 0.02), -1, PARAMS)
    assert room == pytest.approx(gap - WALL_GAP, abs=1e-9)


@pytest.mark.parametrize("gap", [0.15, 0.3, 0.6])
def test_one_that_is_not_may_not(gap: float) -> None:
    assert room_straight(*before_a_wall(gap, 0.05), -1, PARAMS) == pytest.approx(gap - 0.15, abs=1e-9)


@pytest.mark.parametrize("nearer", [0.15, 0.25])
def test_nor_something_before_it(nearer: float) -> None:
    readings, here = before_a_wall(0.6, 0.02)
    readings = (*readings[:REAR], 0.6 - nearer, *readings[REAR + 1 :])
    assert room_straight(readings, here, -1, PARAMS) == pytest.approx(0.6 - nearer - 0.15, abs=1e-9)


def test_a_wall_ahead_of_the_slot_is_none() -> None:
    readings, here = before_a_wall(0.6, 0.02)
    assert room_straight(readings, here, 1, PARAMS) == 100.0
