"""From echoes to places: what was lost or is of two things is no place, and what was lost frees nothing."""

import math

import pytest

from controller_fmu.planning.plan_store import RAYS, PlanStore
from controller_fmu.sensing.ear import SideEar, listen
from modelkit.car import Car
from modelkit.store import new_store
from modelkit.vocabulary import Pose

SENSORS = Car().ultrasonic
SILENT = SENSORS.max_range
STEP = 0.08
RIGHT = 0


def heard(readings: list[float]) -> tuple[PlanStore, SideEar]:
    """Return what a sensor that looks to the right knows after it has heard this on its way, a reading a step."""
    store, ear = new_store(PlanStore), SideEar()
    for number, reading in enumerate(readings):
        ear = listen(store, ear, RIGHT, Pose(STEP * number, 0.0, -0.5 * math.pi), reading, SENSORS)
    return store, ear


def reaches(store: PlanStore, ear: SideEar) -> list[float]:
    """Return how far nothing was heard."""
    rays = range(min(ear.rays, RAYS))
    return [math.hypot(store.ray_end_x[n] - store.ray_x[n], store.ray_end_y[n] - store.ray_y[n]) for n in rays]


@pytest.mark.parametrize(("lost", "free"), [(1, False), (2, False), (3, True)])
def test_one_echo_lost_or_two_on_a_side_free_nothing_behind_it(lost: int, free: bool) -> None:
    store, ear = heard([1.5] * 15 + [SILENT] * lost + [1.5] * 15)
    assert (max(reaches(store, ear)) > 2.0) == free
    joints = [store.heard_joint[place] for place in range(ear.places)]
    assert (sum(joints) == ear.places - 1) == (not free)
    assert all(store.heard_y[place] == pytest.approx(-1.5, abs=0.02) for place in range(ear.places))


@pytest.mark.parametrize(
    ("between", "after", "reach"), [([SILENT, SILENT], 2.5, SILENT), ([1.8, 2.08, 1.75], 1.5, 2.08)]
)
def test_what_is_heard_between_two_things_or_comes_and_goes_by_and_by_was_not_lost(
    between: list[float], after: float, reach: float
) -> None:
    store, ear = heard([1.5] * 15 + between + [after] * 15)
    assert max(reaches(store, ear)) == pytest.approx(reach, abs=1e-9)


@pytest.mark.parametrize(
    ("opening", "places"),
    [
        ([3.2, 3.4, 3.4, 3.2], False),
        ([3.2, 3.35, 3.5, 3.35, 3.2], False),
        ([3.4, 3.3, 3.3, 3.4], True),
        ([3.3] * 5, True),
    ],
)
def test_what_comes_and_goes_in_a_narrow_opening_is_of_its_two_sides(opening: list[float], places: bool) -> None:
    """The distance to one convex thing never grows and then shrinks."""
    store, ear = heard([2.0] * 12 + opening + [2.0] * 12)
    deep = [place for place in range(ear.places) if store.heard_y[place] < -2.8]
    assert bool(deep) == places
