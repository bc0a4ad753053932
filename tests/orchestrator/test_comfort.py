"""Peak jerk and steering at standstill: what physics says of simple drives."""

import numpy as np
import pytest

from orchestrator.evaluation.verdict.comfort import DrySteering, PeakJerk

STEPS = [0.005, 0.01, 0.05]


def peak_jerk(t: np.ndarray, speed: np.ndarray) -> float:
    found = PeakJerk()
    found.add(t, speed)
    return found.value


def dry_steering_count(speed: np.ndarray, wheel: np.ndarray) -> float:
    found = DrySteering()
    found.add(speed, wheel)
    return found.value


def times(step: float, end: float = 10.0) -> np.ndarray:
    return np.arange(round(end / step) + 1) * step


@pytest.mark.parametrize("step", STEPS)
def test_no_jerk_at_constant_acceleration(step: float) -> None:
    t = times(step)
    assert peak_jerk(t, 1.3 * t - 4.0) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("step", STEPS)
def test_constant_jerk_is_itself(step: float) -> None:
    t = times(step)
    assert peak_jerk(t, 0.5 * -0.7 * t**2) == pytest.approx(0.7)


@pytest.mark.parametrize("step", STEPS)
def test_a_jump_of_the_acceleration_is_spread_over_half_a_second(step: float) -> None:
    t = times(step)
    assert peak_jerk(t, np.maximum(0.0, 2.0 * (t - 5.0))) == pytest.approx(2.0 / 0.5)


def test_direction_does_not_matter_and_a_short_run_has_none() -> None:
    t = times(0.01)
    speed = np.sin(t)
    assert peak_jerk(t, -speed) == peak_jerk(t, speed)
    assert np.isnan(peak_jerk(t[:100], speed[:100]))
    assert np.isnan(peak_jerk(t[:1], speed[:1]))
    assert np.isfinite(peak_jerk(t[:101], speed[:101]))


def test_standstills_with_a_turned_wheel_are_counted() -> None:
    #                 stands and turns | drives and turns | stands, hardly turns | stands and turns twice
    speed = np.array([0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0])
    wheel = np.array([0.0, 0.1, 0.2, 0.2, 0.9, 1.5, 1.5, 1.55, 1.6, 1.6, 1.0, 1.0, 1.5])
    assert dry_steering_count(speed, wheel) == 2.0
    assert dry_steering_count(np.ones(5), np.arange(5.0)) == 0.0
    assert dry_steering_count(np.zeros(1), np.zeros(1)) == 0.0
