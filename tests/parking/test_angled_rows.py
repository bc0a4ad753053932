"""Angled rows in maps of simulated passes: direction, which way they lean, the goal, and how it is entered."""

import math
from typing import NamedTuple

import pytest

from controller_fmu.common.external_slot import SlotKind
from controller_fmu.interface import Reason
from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.geometry.outline import vehicle_outline
from controller_fmu.parking.map.local_map import LandmarkMap, update_map
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.slots.angled_row import find_angled_row
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType, find_slot
from controller_fmu.parking.slots.goal import goal_pose
from controller_fmu.parking.slots.params import SlotParams
from controller_fmu.parking.slots.row import SlotRow
from modelkit.geometry import Box
from modelkit.vocabulary import Pose
from tests.parking.simulated_pass import CAR, drive_past

OUTLINE = vehicle_outline(CAR, 0.95)
LENGTH, WIDTH = 4.4, 1.8
OPENING, GAP = 2.8, 0.7
"""Width of the slot, and between the other cars [m]."""


class Passed(NamedTuple):
    """The map after a pass, where the vehicle is, and the row found."""

    local_map: LandmarkMap
    pose: Pose
    row: SlotRow


def angled_cars(degrees: float) -> list[Box]:
    """Three cars on each side of a slot whose middle is at x = 0 on the row's line y = 0, to the right of the road."""
    turn = math.radians(degrees)
    pitch, first = (WIDTH + GAP) / math.sin(turn), 0.5 * (OPENING + WIDTH) / math.sin(turn)
    x = 0.5 * LENGTH * math.cos(turn)
    y = -0.5 * (LENGTH * math.sin(turn) + WIDTH * abs(math.cos(turn)))
    places = [sense * (first + number * pitch) for number in range(3) for sense in (-1.0, 1.0)]
    return [Box(x + place, y, -turn, LENGTH, WIDTH) for place in places]


def passed(boxes: list[Box], end: float, side: float = -1.0) -> Passed:
    local_map, params, pose = LandmarkMap(), MappingParams(), Pose()
    boxes = boxes if side < 0.0 else [box._replace(y=-box.y, heading=-box.heading) for box in boxes]
    start = Pose(-11.0, -side * (CAR.width / 2 + 1.2), 0.0)
    for _, pose, readings in drive_past(boxes, start, end + 11.0, 1, speed=1.5):
        local_map = update_map(local_map, readings, pose, CAR.ultrasonic, params)
    return Passed(local_map, pose, find_angled_row(local_map.landmarks, pose, side, params))


def slot_in(found: Passed, wanted: int = SlotKind.NONE) -> SlotCandidate:
    free = found.local_map.free_space
    rays = free.right if found.row.side < 0.0 else free.left
    params = SlotParams(wanted=wanted)
    return find_slot(found.row, found.local_map.landmarks, rays, OUTLINE, params, MappingParams())


@pytest.mark.parametrize(
    ("degrees", "end", "side"),
    [
        (45, 8.9, 1.0),
        (120, 8.9, 1.0),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in ((30, 12.5, -1.0), (60, 8.9, -1.0), (135, 8.9, -1.0), (150, 8.9, 1.0))
        ),
    ],
)
def test_a_slot_in_an_angled_row_is_found_with_its_direction(degrees: float, end: float, side: float) -> None:
    slot = slot_in(passed(angled_cars(degrees), end, side))
    assert (slot.type, slot.reason) == (SlotType.PERPENDICULAR, Reason.NONE)
    assert slot.is_nose_in == (degrees < 90)
    goal = goal_pose(slot, OUTLINE, SlotParams())
    into = side * math.radians(degrees)
    heading = into if slot.is_nose_in else into + math.pi
    off = math.remainder(goal.heading - heading, 2.0 * math.pi)
    assert abs(off) < math.radians(6.0)
    ahead, turn = OUTLINE.centre_ahead, math.radians(degrees)
    x, y = goal.x + ahead * math.cos(goal.heading), goal.y + ahead * math.sin(goal.heading)
    middle = Pose(0.5 * LENGTH * math.cos(turn), -side * angled_cars(degrees)[0].y, into)
    assert abs(point_to_frame(x, y, middle).y) < 0.35


def test_the_driver_chooses_how_to_enter() -> None:
    found = passed(angled_cars(60), 8.9)
    assert slot_in(found).is_nose_in
    assert not slot_in(found, SlotKind.TAIL_IN).is_nose_in
    assert slot_in(found, SlotKind.NOSE_IN).is_nose_in


def test_cars_that_stand_square_are_no_angled_row() -> None:
    square = [Box(place, -2.2, -0.5 * math.pi, LENGTH, WIDTH) for place in (-4.8, -2.3, 2.3, 4.8)]
    along = [Box(place, -0.9, 0.0, LENGTH, WIDTH) for place in (-5.0, 5.0)]
    for boxes in (square, along):
        assert passed(boxes, 8.0).row.used == 0
