"""The stop time follows the controller's limit and the driver's speed; a creeping car's time counts by its way."""

import pytest

from controller_fmu.common.monitor import SLOW_DRIVING_SPEED, time_counted
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.pace import TIMED_SPEED


@pytest.mark.parametrize(
    ("sets", "expected"),
    [
        ([], 125.0),
        (["vehicle.driver.profile[1].speed=0.05"], 725.0),
        (["vehicle.driver.profile[2].speed=0.1"], 365.0),
        (["vehicle.driver.profile[1].speed=0.1", "vehicle.driver.speed_error=-0.5"], 725.0),
        (["vehicle.driver.profile[1].speed=0.0001"], 3605.0),
        (["vehicle.driver.profile[1].speed=0", "vehicle.driver.profile[2].speed=0"], 125.0),
        (["controller.limit.duration=40"], 45.0),
        (["controller.limit.duration=3600"], 3605.0),
        (["vehicle.driver.profile[1].speed=0.05", "stop_time=20"], 20.0),
    ],
)
def test_the_stop_time_is_beyond_the_controller_s_limit_at_the_driver_s_speed(sets: list[str], expected: float) -> None:
    assert load_scenario("guo2015-case4", sets).longest == pytest.approx(expected)


@pytest.mark.parametrize(
    ("speed", "share"), [(0.0, 1.0), (0.01, 1.0), (-0.06, 0.2), (0.15, 0.5), (SLOW_DRIVING_SPEED, 1.0), (-2.0, 1.0)]
)
def test_time_is_counted_by_the_way_of_a_creeping_car(speed: float, share: float) -> None:
    assert time_counted(10_000_000, speed, 0.01) == pytest.approx(share * 1e7, abs=1.0)


def test_stop_times_and_controllers_count_by_distance_below_the_same_speed() -> None:
    assert TIMED_SPEED == SLOW_DRIVING_SPEED
