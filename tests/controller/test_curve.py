"""Where a piece of path leads, held against the integral of its curvature."""

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from controller_fmu.common.curve import advance
from modelkit.vocabulary import Pose

CURVATURE = st.floats(-0.25, 0.25)


@given(st.floats(0.01, 3.0), CURVATURE, CURVATURE, st.sampled_from([1.0, -1.0]), st.floats(-3.0, 3.0))
@example(length=1.5, k0=5e-324, k1=5e-324, direction=1.0, heading=0.0)
def test_a_piece_is_the_integral_of_its_curvature(
    length: float, k0: float, k1: float, direction: float, heading: float
) -> None:
    def rates(s: float, pose: list[float]) -> list[float]:
        k = k0 + (k1 - k0) * s / length
        return [direction * math.cos(pose[2]), direction * math.sin(pose[2]), direction * k]

    end = solve_ivp(rates, (0.0, length), [1.0, 2.0, heading], rtol=1e-11, atol=1e-12).y[:, -1]
    assert advance(Pose(1.0, 2.0, heading), direction, length, k0, k1) == pytest.approx(end, abs=1e-8)


@given(st.floats(0.1, 3.0), CURVATURE, CURVATURE, st.sampled_from([1.0, -1.0]))
def test_driving_back_undoes_a_piece(length: float, k0: float, k1: float, direction: float) -> None:
    there = advance(Pose(0.0, 0.0, 0.5), direction, length, k0, k1)
    assert advance(there, -direction, length, k1, k0) == pytest.approx((0.0, 0.0, 0.5), abs=1e-8)
