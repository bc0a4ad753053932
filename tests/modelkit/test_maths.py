"""Small functions over everything that may come in."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from modelkit.maths import clamp, is_finite, move_towards, sign, wrap_angle

finite = st.floats(-1e9, 1e9)
anything = st.floats()


@given(finite, finite, finite)
def test_clamp_is_the_middle_of_three(value: float, one: float, two: float) -> None:
    low, high = min(one, two), max(one, two)
    assert clamp(value, low, high) == sorted((value, low, high))[1]


def test_clamp_hands_nan_on() -> None:
    assert math.isnan(clamp(math.nan, -1.0, 1.0))


@given(anything)
def test_sign_is_minus_one_zero_or_one(value: float) -> None:
    expected = 0.0 if math.isnan(value) or value == 0.0 else math.copysign(1.0, value)
    assert sign(value) == expected


@given(st.floats(-1e4, 1e4))
def test_a_wrapped_angle_points_the_same_way(angle: float) -> None:
    wrapped = wrap_angle(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-11)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-11)


@pytest.mark.parametrize("angle", [math.pi, -math.pi, 3.0 * math.pi, -3.0 * math.pi])
def test_half_a_turn_is_plus_pi(angle: float) -> None:
    assert wrap_angle(angle) == pytest.approx(math.pi)


@given(st.floats(-math.pi, math.pi, exclude_min=True))
def test_an_angle_in_range_keeps_its_bits(angle: float) -> None:
    assert wrap_angle(angle) == angle


@given(finite, finite, st.floats(0.0, 1e9))
def test_a_move_reaches_its_target_or_goes_all_it_may(value: float, target: float, most: float) -> None:
    moved = move_towards(value, target, most)
    assert moved == target if abs(target - value) <= most else moved == value + math.copysign(most, target - value)


@given(anything)
def test_finite_is_neither_nan_nor_infinite(value: float) -> None:
    assert is_finite(value) == math.isfinite(value)
