"""A belief about a thing and what an echo does to it: numpy's covariance and Kalman update beside the controller's."""

import numpy as np
import pytest

from controller_fmu.apa.around.thing import Slope, Thing, learnt, spread_along

SPREAD = np.array([[0.04, 0.006, -0.002], [0.006, 0.03, 0.004], [-0.002, 0.004, 0.01]])
BELIEF = Thing(1.0, -2.0, 0.1, SPREAD[0, 0], SPREAD[0, 1], SPREAD[0, 2], SPREAD[1, 1], SPREAD[1, 2], SPREAD[2, 2])
SLOPES = [Slope(0.6, -0.8, 0.7), Slope(-0.28, 0.96, -1.3), Slope(1.0, 0.0, 0.0)]


@pytest.mark.parametrize("slope", SLOPES)
def test_an_expected_distance_is_as_unsure_as_the_thing_along_its_slope(slope: Slope) -> None:
    along = np.array(slope)
    assert spread_along(BELIEF, slope) == pytest.approx(along @ SPREAD @ along, rel=1e-12)


@pytest.mark.parametrize("slope", SLOPES)
def test_an_echo_is_learnt_from_as_kalman_has_it(slope: Slope) -> None:
    along, noise, error = np.array(slope), 0.002, 0.05
    gain = SPREAD @ along / (along @ SPREAD @ along + noise)
    means = np.array(BELIEF[:3]) + gain * error
    spread = SPREAD - np.outer(gain, along @ SPREAD)
    told = learnt(BELIEF, slope, error, noise, 0.0)
    upper = spread[np.triu_indices(3)]
    assert told == pytest.approx([*means, upper[0], upper[1], upper[2], upper[3], upper[4], upper[5]], rel=1e-9)


def test_no_place_becomes_surer_than_sensors_are_mounted() -> None:
    told = learnt(BELIEF, SLOPES[0], 0.0, 1e-6, 0.19)
    assert (told.xx, told.yy) == (0.19 * 0.19, 0.19 * 0.19)
