"""Moves: where pieces lead, continuity, turns between lines, S-bends onto circles."""

import itertools
import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from controller_fmu.apa.ways.move import Move, end_of, length_of, point_at
from controller_fmu.apa.ways.turns import reverse_s, reverse_turn, turn_of, two_arcs
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


def curvature_is_continuous(move: Move, rate: float) -> bool:
    points = [point_at(move, 0.01 * n).curvature for n in range(int(length_of(move) / 0.01))]
    return all(abs(b - a) <= 0.01 * rate * (1.0 + 1e-9) for a, b in itertools.pairwise(points))


@pytest.mark.parametrize("straight", [0.0, 1.7])
def test_the_s_bend_ends_where_it_should_with_continuous_curvature(straight: float) -> None:
    turn = turn_of(0.2, 0.2, 0.8)
    start, end = Pose(9.5, 2.9, 0.05), Pose(-0.3, -0.1, 0.2)
    move = reverse_s(start, end, straight, turn, turn)
    assert move.direction == -1
    assert end_of(move) == pytest.approx(end, abs=1e-8)
    assert curvature_is_continuous(move, 0.2 / 0.8)
    assert max(abs(point_at(move, 0.01 * n).curvature) for n in range(900)) <= 0.2


@pytest.mark.parametrize("heading", [-1.6, -1.2, -0.7])
def test_the_turn_ends_at_the_origin(heading: float) -> None:
    move = reverse_turn(Pose(9.0, -9.0 * math.tan(-0.5 * heading), heading), turn_of(0.2, 0.2, 0.8))
    assert move.direction == -1
    assert end_of(move) == pytest.approx((0.0, 0.0, 0.0), abs=1e-8)
    assert curvature_is_continuous(move, 0.2 / 0.8)


def test_no_path_is_refused_not_bent() -> None:
    turn = turn_of(0.2, 0.2, 0.8)
    assert reverse_s(Pose(2.0, 3.0, 0.0), Pose(0.0, 0.0, 0.0), 0.0, turn, turn).direction == 0
    assert reverse_turn(Pose(1.0, -1.0, -1.2), turn).direction == 0


def test_what_is_left_of_a_move_falls_as_it_is_driven() -> None:
    move = two_arcs(Pose(1.0, 2.0, 0.1), -1, 0.1, 1.5, 1.0, 0.5)
    for way in (-0.2, 0.0, 1.0, length_of(move), length_of(move) + 0.3):
        assert point_at(move, way).left == pytest.approx(length_of(move) - way)
