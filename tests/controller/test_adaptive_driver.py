"""What is learnt of a driver: from drives of the vehicle's own driver model, whose numbers are known."""

from typing import Any

import pytest

from controller_fmu.adaptive.driver import (
    Driver,
    deceleration_of,
    on_stop_prompt,
    reaction_of,
    shortest_drive,
    stopping_distance,
    update_at_standstill,
    update_prompt,
    update_while_driving,
    update_while_stopping,
)
from controller_fmu.adaptive.params import BeliefParams

BELIEF = BeliefParams()
DT = 10_000_000


UNKNOWN = Driver()


def drive(speeds: Any, driver: Any = UNKNOWN, advised: Any = 2.5) -> Any:
    driver = update_prompt(driver, 0.0)
    for speed in speeds:
        driver = update_while_driving(driver, speed, advised, 0.005, BELIEF, DT)
    return driver


def stop(driver: Any, reaction: Any, deceleration: Any, advised: Any = 2.5) -> Any:
    """Return the driver after a stop, and the way it took [m]."""
    speed, way = driver.speed, 0.0
    driver = on_stop_prompt(driver, speed, advised, BELIEF)
    for k in range(1000):
        if k * 0.01 >= reaction:
            speed = max(0.0, speed - deceleration * 0.01)
        way += speed * 0.01
        if speed == 0.0:
            return update_at_standstill(driver, BELIEF), way
        driver = update_while_stopping(driver, speed, 0.005, DT)
    raise AssertionError


def test_what_nobody_has_seen_is_believed() -> None:
    assert reaction_of(Driver(), BELIEF) == BELIEF.reaction
    assert deceleration_of(Driver(), BELIEF) == BELIEF.deceleration


@pytest.mark.parametrize("reaction", [0.2, 0.7, 1.4])
def test_setting_out_shows_the_reaction(reaction: float) -> None:
    driver = drive([0.0] * round(100 * reaction) + [0.5] * 100)
    assert reaction_of(driver, BELIEF) == pytest.approx(reaction + 0.05, abs=0.02)


@pytest.mark.parametrize("reaction", [0.2, 0.7, 1.4])
@pytest.mark.parametrize("deceleration", [1.0, 2.0, 3.5])
def test_a_stop_shows_reaction_and_deceleration_and_the_next_is_foreseen(reaction: float, deceleration: float) -> None:
    driver = drive([0.0] * round(100 * reaction) + [1.2] * 200)
    driver, _ = stop(driver, reaction, deceleration)
    assert reaction_of(driver, BELIEF) == pytest.approx(reaction, abs=0.06)
    assert deceleration_of(driver, BELIEF) == pytest.approx(deceleration, rel=0.15)
    driver = drive([0.0] * round(100 * reaction) + [0.9] * 200, driver)
    foreseen = stopping_distance(driver, BELIEF)
    _, way = stop(driver, reaction, deceleration)
    assert foreseen == pytest.approx(way, abs=0.07)


def test_a_stop_from_a_crawl_teaches_nothing() -> None:
    driver, _ = stop(drive([0.0] * 20 + [0.1] * 100), 0.2, 3.0)
    assert driver.stops == 0
    assert deceleration_of(driver, BELIEF) == BELIEF.deceleration


def test_who_drives_faster_than_advised_does_not_obey() -> None:
    assert drive([0.0] * 20 + [0.5] * 300, advised=0.5).obeys
    assert not drive([0.0] * 20 + [0.7] * 300, advised=0.5).obeys
    assert drive([0.0] * 20 + [0.7] * 20, advised=0.5).obeys, "he has had no time to slow down yet"


def test_who_comes_down_with_the_advice_slows_down() -> None:
    driver = drive([0.0] * 20 + [1.0] * 200)
    assert not on_stop_prompt(driver, 1.0, 1.0, BELIEF).slows
    assert not on_stop_prompt(driver, 1.0, 0.5, BELIEF).slows
    assert on_stop_prompt(driver, 0.5, 0.5, BELIEF).slows


def test_the_shortest_way_is_that_of_a_stop_asked_for_when_he_sets_out() -> None:
    driver = drive([0.0] * 50 + [1.0] * 400)
    driver, _ = stop(driver, 0.5, 2.0)
    assert shortest_drive(driver, BELIEF) == pytest.approx(1.0 * 0.5 + 1.0 / 4.0, abs=0.12)
