"""Sensors that tell nothing: which readings these are, who is waited for, and what can be gone without."""

import math

import pytest

from controller_fmu.apa.hearing.mute import MUTE, SLOWLY, WAIT, count_mute, is_waited_for, spared, usable
from controller_fmu.apa.watch import Duty, Watch, watch
from controller_fmu.common.monitor import Command
from controller_fmu.common.sensors import LEFT_SENSOR, RIGHT_SENSOR, RangeSample, update_sample
from controller_fmu.registry import ControllerInput, ControllerParams

PARAMS = ControllerParams()
SENSORS = PARAMS.car.ultrasonic
REAR_CORNER = 7
SECOND = 1_000_000_000


def told(*mute: int) -> tuple[float, ...]:
    return tuple(MUTE if number in mute else 1.0 for number in range(12))


@pytest.mark.parametrize(
    ("reading", "is_told"),
    [(SENSORS.max_range, True), (SENSORS.min_range, True), (0.0, False), (math.nan, False), (math.inf, False)],
)
def test_a_reading_that_is_no_distance_tells_nothing(reading: float, is_told: bool) -> None:
    readings = usable((1.0, reading) + (2.0,) * 10, SENSORS.min_range)
    assert readings == (1.0, reading if is_told else MUTE) + (2.0,) * 10
    assert count_mute(readings) == (0 if is_told else 1)


def test_a_car_stands_for_a_sensor_that_may_come_back_and_not_for_ever() -> None:
    blind = PARAMS.apa.sensors.blind_time
    seconds = [0.0, 0.9 * blind, 1.1 * blind, 0.9 * (blind + WAIT), 1.1 * (blind + WAIT)]
    waited = [is_waited_for(round(since * SECOND), PARAMS.apa.sensors) for since in seconds]
    assert waited == [False, False, True, True, False]
    assert 0.0 < SLOWLY < PARAMS.apa.drive.speed


def test_the_search_needs_the_sensors_that_find_slots_and_the_way_in_one_less_than_all() -> None:
    assert [spared(told(number), True) for number in range(12)] == [
        0 if number in (LEFT_SENSOR, RIGHT_SENSOR) else 1 for number in range(12)
    ]
    assert {spared(told(number), False) for number in range(12)} == {1}


@pytest.mark.parametrize(
    ("mute", "spare", "blind"), [((), 0, False), ((7,), 1, False), ((7,), 0, True), ((6, 7), 1, True)]
)
def test_the_clock_of_what_is_missed_runs_where_more_is_mute_than_can_be_spared(
    mute: tuple[int, ...], spare: int, blind: bool
) -> None:
    inputs = ControllerInput(ultrasonic=told(*mute))
    clocks = watch(Watch(blind=3, mute=5), Command(0, 0.0, False), inputs, Duty(True, spare), PARAMS, SECOND)
    assert clocks.blind == (3 + SECOND if blind else 0)
    assert clocks.mute == (5 + SECOND if mute else 0)


@pytest.mark.parametrize(
    ("exchange", "cycle"), [(0.01, 0.05), (0.02, 0.05), (0.02, 0.053), (0.02, 0.07), (0.005, 0.041)]
)
def test_each_measurement_is_listened_to_once_however_seldom_data_is_exchanged(exchange: float, cycle: float) -> None:
    """A controller that samples every 10 ms reads what was measured up to the last exchange."""
    state = RangeSample()
    heard = []
    for sample in range(2000):
        exchanged = math.floor(sample * 0.01 / exchange + 1e-9) * exchange
        measured = math.floor(exchanged / cycle + 1e-9)
        state = update_sample(state, (float(measured),) * 12, sample * 10_000_000, 10_000_000, cycle)
        if state.fresh:
            heard.append(measured)
    assert heard[1:-1] == list(range(heard[1], heard[1] + len(heard) - 2))
    assert len(heard) > 20.0 / cycle - 3


def test_readings_that_stay_the_same_are_listened_to_too() -> None:
    """A car that stands hears the same again: then they are new after what an exchange may take."""
    state = RangeSample()
    times = []
    for sample in range(100):
        state = update_sample(state, (1.0,) * 12, sample * 10_000_000, 10_000_000, 0.05)
        times += [sample * 10] if state.fresh else []
    assert times == [0, *range(60, 1000, 50)]
