"""A neighbour who moves though the map has him is heard to, one who stands is not; a sensor gone silent is found."""

import random

import pytest

from controller_fmu.apa.around.course import HeldCourse
from controller_fmu.apa.around.guard import GuardState, listen, watch_way
from controller_fmu.apa.around.local_map import A, B, LocalMap, begin_map, ear_at, expected, heard, moved
from controller_fmu.apa.around.shifted import shifted
from controller_fmu.apa.around.surroundings import shape_of
from controller_fmu.apa.hearing.deaf import SILENCES, without_deaf
from controller_fmu.apa.hearing.mute import is_mute
from controller_fmu.apa.hearing.stir import QUIET
from controller_fmu.apa.outline import Obstacles
from controller_fmu.apa.params import MapParams
from controller_fmu.apa.slot import UNSEEN, Kind, Slot
from controller_fmu.registry import ControllerParams
from modelkit.vocabulary import Pose

MAP = MapParams()
PARAMS = ControllerParams()
SENSORS = PARAMS.car.ultrasonic
CAR = shape_of(PARAMS)
SLOT = Slot(Kind.PARALLEL, 0, Pose(), 6.5, 0.0, UNSEEN)
BEGIN = Pose(1.7, -0.6, 0.4)
CYCLE = SENSORS.cycle


def backed(number: int, speed: float) -> Pose:
    """Return where a car is that reverses into the slot, after so many readings."""
    way = speed * CYCLE * number
    return Pose(BEGIN.x - 0.92 * way, BEGIN.y - 0.39 * way, BEGIN.heading)


def drive(
    comes: float, speed: float, count: int, noise: float = 0.0, lost: int = -1, who: int = A, only: int = -1
) -> tuple[GuardState, LocalMap]:
    """Return the guard of a car that goes back at ``speed`` [m/s] while one neighbour comes into the slot."""
    draw = random.Random(7)
    here = begin_map(SLOT, BEGIN, MAP)
    state = GuardState(pose=BEGIN, speed=-speed)
    for number in range(count):
        pose = backed(number, speed)
        here = moved(here, pose, MAP)
        truth = shifted(here, who, comes * CYCLE * number)
        ears = [ear_at(mount, pose, 1.0, SENSORS.half_angle) for mount in SENSORS.mounts]
        distances = [expected(ear, truth).echo.distance + draw.gauss(0.0, noise) for ear in ears]
        readings = [min(SENSORS.max_range, max(SENSORS.min_range, distance)) for distance in distances]
        if only >= 0:
            readings = [reading if place == only else SENSORS.max_range for place, reading in enumerate(readings)]
        if lost >= 0:
            readings[lost] = SENSORS.max_range
        here = heard(here, tuple(readings), SENSORS, MAP)
        state = listen(state, tuple(readings), here, PARAMS)
    return state, here


@pytest.mark.parametrize("speed", [0.0, 0.4, 0.8])
@pytest.mark.parametrize("noise", [0.0, 0.03])
def test_who_stands_is_not_heard_to_move(speed: float, noise: float) -> None:
    state, _ = drive(0.0, speed, round(0.6 / (CYCLE * max(speed, 0.2))), noise)
    assert state.quiet >= QUIET


@pytest.mark.parametrize("speed", [0.0, 0.4, 0.8])
@pytest.mark.parametrize("comes", [0.3, 0.9])
def test_who_comes_is_stood_still_for(speed: float, comes: float) -> None:
    state, here = drive(comes, speed, round(0.7 / CYCLE), 0.01)
    assert state.quiet < QUIET
    silent = (SENSORS.max_range,) * 12
    course = HeldCourse(here.pose, -1, 0.0, -speed, CAR)
    assert watch_way(state, silent, here, Obstacles(), course, PARAMS).blocked


@pytest.mark.parametrize("speed", [0.0, 0.8])
def test_one_sensor_tells_it_where_no_other_hears_him(speed: float) -> None:
    """The rear sensor of the flank hears the corner of A go by: nobody else does."""
    count = round(0.7 / CYCLE)
    assert drive(0.9, speed, count, 0.01, only=5)[0].quiet < QUIET
    assert drive(0.0, speed, count, 0.03, only=5)[0].quiet >= QUIET


def test_a_car_stands_until_who_moved_has_been_quiet_for_a_while() -> None:
    state, here = drive(0.9, 0.0, round(0.6 / CYCLE))
    course = HeldCourse(here.pose, -1, 0.0, 0.0, CAR)
    silent = (SENSORS.max_range,) * 12
    for number in range(round(2.0 * QUIET / CYCLE)):
        blocked = watch_way(state, silent, here, Obstacles(), course, PARAMS).unknown
        assert blocked or number * CYCLE > 0.5 * QUIET
        state = listen(state, silent, here, PARAMS)
    assert state.quiet >= QUIET


def test_a_sensor_that_hears_nothing_where_others_hear_a_neighbour_is_lost() -> None:
    count = 4 + 2 * SILENCES
    working, _ = drive(0.0, 0.3, count, 0.02)
    assert max(working.silences) < SILENCES
    silent, _ = drive(0.0, 0.3, count, 0.02, lost=5)
    assert silent.silences[5] >= SILENCES
    assert max(count for number, count in enumerate(silent.silences) if number != 5) == 0
    readings = without_deaf((1.0,) * 12, silent.silences)
    assert [number for number, reading in enumerate(readings) if is_mute(reading)] == [5]
    assert listen(silent, (1.0,) * 12, LocalMap(), PARAMS).silences[4] == 0
    assert listen(silent, readings, begin_map(SLOT, BEGIN, MAP), PARAMS).silences[5] >= SILENCES, "it stays lost"


def test_nobody_is_missed_who_has_driven_off() -> None:
    """All sensors lose him at once: then it is he who is gone."""
    state, here = drive(0.0, 0.0, 5)
    nothing = (SENSORS.max_range,) * 12
    for _ in range(4 * SILENCES):
        state = listen(state, nothing, here, PARAMS)
    assert max(state.silences) < SILENCES
    assert expected(ear_at(SENSORS.mounts[5], here.pose, 1.0, SENSORS.half_angle), here).who in (A, B)
