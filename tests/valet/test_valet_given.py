"""Slots from outside as inputs: their goals, and why they are not taken."""

import math
from typing import Any

import pytest

from controller_fmu.common.external_slot import ExternalSlot, SlotKind, depth_of
from controller_fmu.interface import Reason
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.gap import DEEP, GapLayout
from controller_fmu.sensing.heard_store import put_heard
from controller_fmu.valet.given import as_parameter, gap_told, told_reason
from controller_fmu.valet.params import GivenSlot, SlotWish, ValetParams
from controller_fmu.valet.slot import body_of, goal_in, goal_of
from modelkit.maths import PI
from modelkit.store import new_store
from modelkit.vocabulary import Pose

PARAMS = ValetParams()
NOW = Pose(-5.0, 2.0, 0.0)


def across(
    turn: Any = 90.0, width: Any = 2.6, depth: Any = 4.5, kind: Any = SlotKind.TAIL_IN, swapped: bool = False
) -> Any:
    """A slot on the right of x whose opening's middle is the origin, ``turn`` [deg] off the way."""
    h = -math.radians(turn)
    c, s = math.cos(h), math.sin(h)
    a, b = (0.5 * width * s, -0.5 * width * c), (-0.5 * width * s, 0.5 * width * c)
    a, b = (b, a) if swapped else (a, b)
    return ExternalSlot(kind, *a, *b, b[0] + depth * c, b[1] + depth * s, a[0] + depth * c, a[1] + depth * s, heading=h)


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("turn", [45.0, 90.0, 135.0])
def test_a_car_stands_in_the_middle_of_what_is_told_however_its_corners_are_named(turn: float, swapped: bool) -> None:
    told = across(turn, swapped=swapped)
    assert depth_of(told) == pytest.approx(4.5)
    body = body_of(PARAMS)
    at_once = goal_of(PARAMS, as_parameter(told, GivenSlot()), NOW)
    searched = goal_in(gap_told(told, PARAMS), 0.0, SlotWish.TAIL_IN, PARAMS)
    for goal in (at_once, searched):
        middle = (goal.x + body.ahead * math.cos(goal.heading), goal.y + body.ahead * math.sin(goal.heading))
        assert middle == pytest.approx((2.25 * math.cos(told.heading), 2.25 * math.sin(told.heading)), abs=1e-9)
        assert math.cos(goal.heading - told.heading) == pytest.approx(-1.0)
    assert gap_told(told, PARAMS).layout == GapLayout.ACROSS


def test_without_c_and_d_the_depth_is_not_told_and_the_car_stands_flush() -> None:
    told = across()._replace(cx=1.3, cy=0.0, dx=-1.3, dy=0.0)
    assert depth_of(told) == DEEP
    goal = goal_in(gap_told(told, PARAMS), 0.0, SlotWish.NOSE_IN, PARAMS)
    assert goal.y - PARAMS.car.rear_overhang * math.sin(goal.heading) == pytest.approx(0.0, abs=1e-9)
    assert as_parameter(told, GivenSlot(depth=6.0)).depth == 6.0
    assert as_parameter(ExternalSlot(), GivenSlot(SlotKind.PARALLEL, ax=3.0)).ax == 3.0


@pytest.mark.parametrize(
    ("told", "reason"),
    [
        (across(), Reason.NONE),
        (across(45.0), Reason.NONE),
        (across(width=1.9), Reason.SLOT_TOO_SHORT),
        (across(depth=3.0), Reason.SLOT_TOO_SHALLOW),
        (across(width=4.0, depth=2.2, kind=SlotKind.PARALLEL), Reason.SLOT_TOO_SHORT),
        (across(width=5.0, depth=2.2, kind=SlotKind.PARALLEL), Reason.NONE),
        (across(width=5.0, depth=1.2, kind=SlotKind.PARALLEL), Reason.SLOT_TOO_SHALLOW),
        (across()._replace(cx=math.nan), Reason.BAD_INPUT),
    ],
)
def test_a_slot_that_the_car_does_not_fit_into_is_refused_with_its_reason(told: Any, reason: Any) -> None:
    assert told_reason(new_store(PlanStore), told, PARAMS) == reason


@pytest.mark.parametrize(("x", "y", "reason"), [
    (0.0, -1.0, Reason.SLOT_CONTRADICTED),
    (0.8, 0.0, Reason.SLOT_CONTRADICTED),
    (1.2, -1.0, Reason.NONE),
    (0.0, -4.6, Reason.NONE),
    (0.0, 0.5, Reason.NONE),
])  # fmt: skip
def test_two_echoes_from_where_the_car_would_stand_contradict_a_slot(x: Any, y: Any, reason: Any) -> None:
    store = new_store(PlanStore)
    assert put_heard(store, 0, 0, x, y, True) == 1
    assert told_reason(store, across(), PARAMS) == Reason.NONE
    assert put_heard(store, 0, 1, x, y + 0.01, False) == 1
    assert told_reason(store, across(), PARAMS) == reason


def test_a_parallel_slot_leads_along_the_way() -> None:
    told = across(width=5.0, depth=2.2, kind=SlotKind.PARALLEL)
    assert gap_told(told, PARAMS).layout == GapLayout.ALONG
    goal = goal_in(gap_told(told, PARAMS), 0.0, SlotWish.PARALLEL, PARAMS)
    assert math.sin(goal.heading) == pytest.approx(0.0, abs=1e-9)
    assert told.heading == pytest.approx(-0.5 * PI)
