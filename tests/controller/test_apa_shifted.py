"""A neighbour who stands elsewhere than on the map: found by echoes that tell the same, not where somebody walks."""

import pytest

from controller_fmu.apa.around.local_map import A, B, LocalMap, begin_map, ear_at, expected, heard, moved
from controller_fmu.apa.around.shifted import ENOUGH, LEAST, Shifts, followed, relocated, shifted
from controller_fmu.apa.params import MapParams
from controller_fmu.apa.slot import UNSEEN, Kind, Slot
from modelkit.car import CarUltrasonic
from modelkit.vocabulary import Pose

MAP = MapParams()
SENSORS = CarUltrasonic()
INTO = [Pose(4.6 - 0.03 * k, 1.1 - 0.025 * k, 0.65) for k in range(40)]
DEEPER = [Pose(2.6 - 0.03 * k, -0.3 - 0.01 * k, 0.4) for k in range(40)]


def listened(truth: LocalMap, here: LocalMap, way: list[Pose]) -> LocalMap:
    """Return the map of a car that hears on its way what truly stands there."""
    shifts = Shifts()
    for pose in way:
        true = truth._replace(pose=pose)
        ears = [ear_at(mount, pose, 1.0, SENSORS.half_angle) for mount in SENSORS.mounts]
        readings = tuple(
            min(SENSORS.max_range, max(SENSORS.min_range, expected(ear, true).echo.distance)) for ear in ears
        )
        here = heard(moved(here, pose, MAP), readings, SENSORS, MAP)
        shifts = followed(shifts, here, readings, SENSORS)
        here, shifts = relocated(here, shifts, readings, SENSORS)
    return here


@pytest.mark.parametrize(("who", "by"), [(B, 0.6), (B, 0.9), (A, 0.5)])
def test_a_neighbour_who_has_moved_into_the_slot_is_found_there(who: int, by: float) -> None:
    way = INTO if who == B else DEEPER
    here = begin_map(Slot(Kind.PARALLEL, 0, Pose(), 6.0, 0.0, UNSEEN), way[0], MAP)
    truth = shifted(here, who, by)
    found = listened(truth, here, way)
    assert found.a.x == pytest.approx(truth.a.x, abs=0.12)
    assert found.b.x == pytest.approx(truth.b.x, abs=0.12)
    still = listened(here, here, way)
    assert (still.a.x, still.b.x) == pytest.approx((here.a.x, here.b.x), abs=0.03), "who stands as he was found"


def test_who_walks_is_no_neighbour_and_who_is_heard_past_neither() -> None:
    pose = INTO[10]
    here = begin_map(Slot(Kind.PARALLEL, 0, Pose(), 6.0, 0.0, UNSEEN), pose, MAP)
    silent = [SENSORS.max_range] * 12
    ear = ear_at(SENSORS.mounts[11], pose, 1.0, SENSORS.half_angle)
    near = expected(ear, shifted(here, B, 0.6)).echo.distance
    shifts = Shifts()
    for _ in range(ENOUGH):
        shifts = followed(shifts, here, (*silent[:11], near), SENSORS)
    assert relocated(here, shifts, (*silent[:11], near), SENSORS).map.b.x == pytest.approx(6.0 - 0.6, abs=0.05)
    assert relocated(here, shifts, tuple(silent), SENSORS).map == here, "heard past"
    walking = Shifts()
    for number in range(3 * ENOUGH):
        reading = near + 0.05 * (number % 12)
        walking = followed(walking, here, (*silent[:11], reading), SENSORS)
        assert relocated(here, walking, (*silent[:11], reading), SENSORS).map == here
    assert all(shift.by >= LEAST for shift in walking if shift.echoes)
