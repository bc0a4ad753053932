"""A slot from outside in the assist: which slot it becomes, why it is refused, what contradicts it."""

import math
from typing import Any

import pytest

from controller_fmu.apa.around.cone import ear_of
from controller_fmu.apa.around.local_map import WALL, B, begin_map, expected, moved
from controller_fmu.apa.around.row import is_certain
from controller_fmu.apa.around.surroundings import shape_of
from controller_fmu.apa.hearing.search import SearchState, number_chosen, without
from controller_fmu.apa.slot import UNSEEN, Kind, Side, Slot
from controller_fmu.apa.told import ToldWatch, reason_to_refuse, slot_of_told, watch_told
from controller_fmu.common.external_slot import ExternalSlot, SlotKind
from controller_fmu.interface import Reason
from controller_fmu.registry import ControllerInput, ControllerParams
from modelkit.vocabulary import Pose

PARAMS = ControllerParams(system=5)
CAR = shape_of(PARAMS)
RIGHT, LEFT = 10, 8


def told(
    kind: Any = SlotKind.PARALLEL, length: Any = 6.2, depth: Any = 2.0, turned: Any = 0.0, side: Any = -1.0
) -> ExternalSlot:
    """Return a slot along the x axis from the origin, on the right (``side`` -1) or left of a car that drives along."""
    into = side * (0.5 * math.pi - turned)
    dx, dy = depth * math.cos(into), depth * math.sin(into)
    return ExternalSlot(kind, 0.0, 0.0, length, 0.0, length + dx, dy, dx, dy, into)


def swapped(slot: ExternalSlot) -> ExternalSlot:
    return ExternalSlot(
        slot.kind, slot.bx, slot.by, slot.ax, slot.ay, slot.dx, slot.dy, slot.cx, slot.cy, heading=slot.heading
    )


def heard(slot: ExternalSlot, x: float, reading: float = 5.0, sensor: int = RIGHT) -> ControllerInput:
    """Return the inputs of a car beside the slot whose side sensor is at ``x`` [m] and hears ``reading`` [m]."""
    mount = PARAMS.car.ultrasonic.mounts[sensor]
    readings = tuple(reading if number == sensor else 5.0 for number in range(12))
    return ControllerInput(odometry=Pose(x - mount.x, 1.8, 0.0), external_slot=slot, ultrasonic=readings)


def seen(slot: ExternalSlot, search: SearchState | None = None) -> Slot:
    return slot_of_told(slot, search or SearchState(), heard(slot, 0.0), CAR, PARAMS)


def passed(slot: ExternalSlot, readings: dict[float, float]) -> ToldWatch:
    """Return what becomes of a slot that is driven past, with readings [m] of the side sensor by its place [m]."""
    state = ToldWatch()
    for number in range(90):
        x = -1.0 + 0.1 * number
        reading = next((r for at, r in readings.items() if abs(at - x) < 0.01), 5.0)
        state = watch_told(state, SearchState(), heard(slot, x, reading), True, CAR, PARAMS)
    return state


def test_corner_a_is_passed_first_in_whichever_order_the_corners_are_told() -> None:
    assert seen(told()) == seen(swapped(told()))
    slot = seen(told())
    assert (slot.kind, slot.side) == (Kind.PARALLEL, Side.RIGHT)
    assert slot.a == pytest.approx((0.0, 0.0, 0.0))
    assert (slot.length, slot.depth) == pytest.approx((6.2, 2.0))


def test_a_slot_on_the_left_is_one_on_the_left() -> None:
    slot = seen(told(SlotKind.TAIL_IN, 3.0, 5.0, side=1.0))
    assert (slot.kind, slot.side) == (Kind.PERPENDICULAR, Side.LEFT)


def test_a_depth_that_is_not_told_is_the_one_heard_at_the_same_place() -> None:
    bare = told(depth=0.0)
    assert seen(bare).depth == UNSEEN
    beside = Slot(Kind.PARALLEL, Side.RIGHT, Pose(0.2, 0.1, 0.0), 6.0, depth=1.9)
    assert seen(bare, SearchState(slots=(beside, Slot(), Slot()), valid=1)).depth == 1.9
    elsewhere = beside._replace(a=Pose(3.0, 0.1, 0.0))
    assert seen(bare, SearchState(slots=(elsewhere, Slot(), Slot()), valid=1)).depth == UNSEEN


@pytest.mark.parametrize(
    ("slot", "reason"),
    [
        (told(), Reason.NONE),
        (told(length=4.2), Reason.SLOT_TOO_SHORT),
        (told(depth=1.4), Reason.SLOT_TOO_SHALLOW),
        (told(SlotKind.TAIL_IN, 3.0, 4.5), Reason.NONE),
        (told(SlotKind.TAIL_IN, 2.2, 4.5), Reason.SLOT_TOO_SHORT),
        (told(SlotKind.TAIL_IN, 3.0, 3.0), Reason.SLOT_TOO_SHALLOW),
        (told(SlotKind.NOSE_IN, 3.0, 4.5), Reason.SLOT_NOT_SUPPORTED),
        (told(SlotKind.TAIL_IN, 3.0, 4.5, turned=0.2), Reason.SLOT_NOT_SUPPORTED),
        (told(SlotKind.TAIL_IN, 3.0, 4.5, turned=0.1), Reason.NONE),
    ],
)
def test_every_slot_that_cannot_be_has_its_reason(slot: ExternalSlot, reason: Reason) -> None:
    assert Reason(reason_to_refuse(slot, seen(slot), CAR, PARAMS)) == reason


def test_it_is_shown_once_it_is_passed_and_only_while_it_is_told() -> None:
    slot = told()
    before = watch_told(ToldWatch(), SearchState(), heard(slot, 6.6), True, CAR, PARAMS)
    assert before.slot.kind == Kind.NONE
    after = watch_told(before, SearchState(), heard(slot, 6.8), True, CAR, PARAMS)
    assert after.slot.kind == Kind.PARALLEL
    assert watch_told(after, SearchState(), heard(ExternalSlot(), 6.8), True, CAR, PARAMS) == ToldWatch()
    given = PARAMS._replace(apa=PARAMS.apa._replace(search=PARAMS.apa.search._replace(given=True)))
    assert watch_told(ToldWatch(), SearchState(), heard(slot, 0.0), True, CAR, given).slot.kind == Kind.PARALLEL


def test_what_is_not_finite_is_a_bad_input() -> None:
    bad = told()._replace(bx=math.nan)
    assert watch_told(ToldWatch(), SearchState(), heard(bad, 0.0), True, CAR, PARAMS).refused == Reason.BAD_INPUT


def test_two_echoes_from_where_the_car_would_stand_contradict_it() -> None:
    width = 1.8 - CAR.half_width
    assert passed(told(), {3.0: width}).refused == Reason.NONE
    assert passed(told(), {3.0: width, 3.1: width}).refused == Reason.SLOT_CONTRADICTED
    assert passed(told(), {3.0: width, 3.1: width}).slot.kind == Kind.NONE


@pytest.mark.parametrize("readings", [{0.1: 1.0, 0.2: 1.0}, {6.0: 1.0, 6.1: 1.0}, {3.0: 2.9, 3.1: 2.9}])
def test_neighbours_and_what_the_slot_ends_at_do_not(readings: dict[float, float]) -> None:
    assert passed(told(), readings).slot.kind == Kind.PARALLEL


@pytest.mark.parametrize(("at_a", "at_b"), [(True, True), (True, False), (False, True), (False, False)])
def test_who_is_not_heard_beside_a_corner_is_not_there(at_a: bool, at_b: bool) -> None:
    places = [-0.8, -0.7, -0.6] * at_a + [6.6, 6.7, 6.8] * at_b
    slot = passed(told(), dict.fromkeys(places, 1.0)).slot
    assert (slot.empty_a, slot.empty_b) == (not at_a, not at_b)
    kerb = passed(told(), dict.fromkeys([*places, -0.5, -0.4, 7.0, 7.1], 2.9)).slot
    assert (kerb.empty_a, kerb.empty_b) == (True, True)


def test_nobody_is_expected_at_an_empty_corner_and_it_stays_where_it_was_told() -> None:
    slot = seen(told())._replace(empty_b=True)
    here = begin_map(slot, Pose(5.0, 1.8, 0.0), PARAMS.apa.map)
    ear = ear_of(7.0, 1.0, -0.5 * math.pi, PARAMS.car.ultrasonic.half_angle)
    assert expected(ear, here).who == WALL
    assert expected(ear, here._replace(empty_b=False)).who == B
    far = moved(here, Pose(30.0, 1.8, 0.0), PARAMS.apa.map)
    assert not is_certain(far, PARAMS.apa.map)
    assert is_certain(far._replace(empty_a=True), PARAMS.apa.map)


def test_the_slot_chosen_is_the_newest_or_that_of_the_number_on_the_side_wanted() -> None:
    newest, older = Slot(Kind.PARALLEL, Side.RIGHT), Slot(Kind.PARALLEL, Side.LEFT)
    two = SearchState(slots=(newest, older, Slot()), valid=2)
    assert [number_chosen(two, side, 0) for side in (0, 1, 2)] == [1, 1, 2]
    assert [number_chosen(two, 0, number) for number in (1, 2, 3)] == [1, 2, 0]
    assert number_chosen(two, 1, 2) == 0
    assert number_chosen(SearchState(), 0, 0) == 0


@pytest.mark.parametrize("number", [1, 2, 3])
def test_a_slot_given_up_is_forgotten_and_the_others_are_not(number: int) -> None:
    slots = tuple(Slot(Kind.PARALLEL, length=float(at)) for at in (1, 2, 3))
    left = without(SearchState(slots=slots, valid=3), number)
    assert [slot.length for slot in left.slots[:2]] == [at for at in (1, 2, 3) if at != number]
    assert left.valid == 2
