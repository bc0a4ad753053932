"""What comes nearer than the map has it, and who comes by himself: by sensors' readings alone."""

import random

import pytest

from controller_fmu.apa.around.closing import (
    GAP,
    SILENCES,
    TAIL_GAP,
    Track,
    own_reach,
    room_at_tail,
    room_to_strange,
    tracked_on,
)
from controller_fmu.apa.around.closing import turned_round as turned
from controller_fmu.apa.around.comer import BRIDGED, STEADY, Comer, followed, is_odd, somebody_comes
from controller_fmu.apa.around.near import FREE, nearest_told
from controller_fmu.apa.around.surroundings import shape_of
from controller_fmu.apa.hearing.mute import MUTE
from controller_fmu.registry import ControllerParams
from modelkit.car import CarUltrasonic

PARAMS = ControllerParams()
CAR = shape_of(PARAMS)
SENSORS = CarUltrasonic()
FURTHEST = SENSORS.max_range
REAR_CORNER, REAR, FLANK, REAR_FLANK = 4, 5, 8, 9


def tracks(number: int, readings: list[float], expected: float, way: float = 0.01) -> tuple[Track, ...]:
    """Return the tracks of sensors of which one has heard this, the others nothing."""
    track = Track()
    for reading in readings:
        track = tracked_on(track, reading, way, expected, FURTHEST)
    return tuple(track if place == number else Track() for place in range(12))


def falling(least: float) -> list[float]:
    """Return readings of a car that drives straight at something, each 1 cm of way."""
    return [least + 0.01 * number for number in range(40, -1, -1)]


@pytest.mark.parametrize("number", [REAR_CORNER, REAR, FLANK])
def test_who_goes_on_stands_before_what_comes_nearer_is_at_the_outline(number: int) -> None:
    reach = own_reach(SENSORS.mounts[number], CAR, SENSORS.half_angle)
    least = max(reach + GAP, nearest_told(SENSORS))
    room = room_to_strange(tracks(number, falling(0.3), 1.5), CAR, SENSORS)
    assert 0.3 - least <= room < 0.3 - least + 0.02
    known = room_to_strange(tracks(number, falling(0.3), 0.3), CAR, SENSORS)
    assert known == FREE if reach == 0.0 else known > room + 0.05, "the map has it there"
    assert room_to_strange(tracks(number, falling(0.3)[::-1], 1.5), CAR, SENSORS) == FREE, "it is left behind"
    assert room_to_strange(tracks(number, [0.3] * 40, 1.5), CAR, SENSORS) == FREE, "driven along"
    back = tuple(turned(track) for track in tracks(number, falling(0.3), 1.5))
    assert room_to_strange(back, CAR, SENSORS) == FREE, "the way out is free"


def test_a_corner_of_the_car_is_as_far_from_its_sensor_as_it_is() -> None:
    mount = SENSORS.mounts[REAR_CORNER]
    far = ((CAR.rear + mount.x) ** 2 + (CAR.half_width - mount.y) ** 2) ** 0.5
    assert own_reach(mount, CAR, SENSORS.half_angle) == pytest.approx(far)
    assert own_reach(SENSORS.mounts[FLANK], CAR, SENSORS.half_angle) == 0.0
    assert own_reach(SENSORS.mounts[REAR], CAR, SENSORS.half_angle) == 0.0


@pytest.mark.parametrize("slant", [0.3, 0.6])
def test_the_flank_tells_how_far_the_tail_may_go_whose_corner_tells_nothing(slant: float) -> None:
    readings = [0.4 + slant * 0.01 * number for number in range(60, -1, -1)]
    heard, known = tracks(REAR_FLANK, readings, 1.5), tracks(REAR_FLANK, readings, 0.4)
    mute = (FURTHEST,) * REAR_CORNER + (MUTE,) + (FURTHEST,) * (11 - REAR_CORNER)
    room = room_at_tail(heard, mute, CAR, SENSORS)
    at_corner = 0.4 - slant * (SENSORS.mounts[REAR_FLANK].x + CAR.rear + room)
    assert at_corner == pytest.approx(TAIL_GAP, abs=0.02), "a side that slants towards the tail goes on straight"
    assert room_at_tail(known, mute, CAR, SENSORS) > room, "the map has it there"
    assert room_at_tail(heard, (FURTHEST,) * 12, CAR, SENSORS) == FREE, "the corner's own sensor tells"


def test_a_lost_reading_is_bridged_and_silence_is_not() -> None:
    track = tracks(FLANK, falling(0.3), 1.5)[FLANK]
    for _ in range(SILENCES - 1):
        track = tracked_on(track, FURTHEST, 0.01, 1.5, FURTHEST)
    assert track.strange
    assert not tracked_on(track, FURTHEST, 0.01, 1.5, FURTHEST).strange


def comes(
    rate: float,
    speed: float,
    *,
    off: float = 3.0,
    lost: int = -1,
    cycle: float = 0.04,
    place: int = REAR,
) -> bool:
    """Return whether somebody is found to come who changes his distance by ``rate`` [m/s], from 2 m for 0.8 s.

    The map has something ``off`` [m].
    """
    comer = Comer()
    for number in range(round(0.8 / cycle)):
        reading = FURTHEST if number == lost else 2.0 + rate * number * cycle
        comer = followed(comer, reading, cycle, FURTHEST, off)
    return somebody_comes(tuple(comer if number == place else Comer() for number in range(12)), abs(speed))


@pytest.mark.parametrize("cycle", [0.04, 0.08])
def test_who_comes_by_himself_is_stood_still_for(cycle: float) -> None:
    assert comes(-1.5, 0.0, cycle=cycle)
    assert comes(-2.0, -0.8, cycle=cycle)
    assert comes(-1.5, 0.0, lost=9, cycle=cycle)
    assert comes(-1.5, 0.0, cycle=cycle, place=FLANK), "beside the car, where the map has nobody"
    assert not comes(-1.5, 0.0, cycle=cycle, place=FLANK, off=1.7), "along a flank that the map has there"
    assert not comes(-0.8, -0.8, cycle=cycle), "the car's own way"
    assert not comes(-1.5, 0.0, off=1.1, cycle=cycle), "the map has it there"
    assert not comes(-2.2, 0.0, cycle=cycle), "faster than anybody: another thing heard each time"
    assert not comes(0.5, 0.0, cycle=cycle)
    assert not comes(-0.5, 0.0, cycle=cycle), "not here for a while"


def test_who_is_not_heard_any_more_comes_no_longer() -> None:
    comer = Comer()
    for number in range(40):
        comer = followed(comer, 3.0 - 0.06 * number, 0.04, FURTHEST, 4.0)
    heard_last = comer
    for number in range(BRIDGED + 2):
        assert somebody_comes((comer,) * 12, 0.0) == (number <= BRIDGED), "a lost reading or two is bridged"
        comer = followed(comer, FURTHEST, 0.04, FURTHEST, 4.0)
    assert heard_last.fits > 30


def test_noise_alone_is_nobody_who_comes() -> None:
    draw = random.Random(3)
    comers: tuple[Comer, ...] = (Comer(),) * 12
    for _ in range(400):
        comers = tuple(followed(comer, draw.gauss(0.8, 0.03), 0.04, FURTHEST, 3.0) for comer in comers)
        assert comers[0].fits < STEADY or not somebody_comes(comers, 0.0)
    assert not is_odd(comers), "of something of which the map has nothing"
    assert is_odd(tuple(comer._replace(nearer=0.3) for comer in comers))
    assert not is_odd(tuple(comer._replace(nearer=0.3, fits=3) for comer in comers))
