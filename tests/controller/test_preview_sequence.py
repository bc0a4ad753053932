"""The sequence of the two preview points, stage by stage."""

from typing import Any

import pytest

from controller_fmu.preview.params import PreviewParams
from controller_fmu.preview.sequence import Sequence, advance, curve_distance, straight_distance
from controller_fmu.preview.stage import PreviewStage

P = PreviewParams()


@pytest.mark.parametrize(("speed", "length"), [(5.0, 4.5), (7.0, 4.5), (8.0, 5.72), (16.0, 15.48), (30.0, 15.5)])
def test_distance_on_straights(speed: float, length: float) -> None:
    assert straight_distance(speed, P) == pytest.approx(length)


@pytest.mark.parametrize(
    ("kappa", "length"), [(0.01, 4.0), (-0.02, 3.5), (0.04, 2.5), (-0.05, 2.0), (0.2, 2.0), (0.001, 4.0)]
)
def test_distance_on_curves(kappa: float, length: float) -> None:
    assert curve_distance(kappa, P) == pytest.approx(length)


def test_alternation_is_far_for_a_fifth_of_the_period() -> None:
    sequence, far = Sequence(), 0
    for _ in range(1000):
        sequence = advance(sequence, 0.0, 0.0, 8.0, P, 0.01)
        far += sequence.l2 == pytest.approx(25.72)
        assert sequence.l2 in (pytest.approx(7.72), pytest.approx(25.72))
    assert far == pytest.approx(200, abs=2)


def test_the_whole_sequence_on_curve_two() -> None:
    straight = advance(Sequence(), 0.0, 0.0, 8.0, P, 0.01)
    assert (straight.stage, straight.l1, straight.l2) == (
        PreviewStage.STRAIGHT,
        pytest.approx(5.72),
        pytest.approx(25.72),
    )
    a = advance(straight, 0.0, 0.02, 8.0, P, 0.01)
    assert (a.stage, a.l2, a.set_speed) == (PreviewStage.SLOWING, pytest.approx(7.72), pytest.approx(5.376, abs=1e-3))
    slowing = advance(a, 0.0, 0.0, 6.0, P, 0.01)
    assert (slowing.stage, slowing.l1, slowing.l2) == (PreviewStage.SLOWING, 4.5, 6.5)
    b = advance(slowing, 0.0, 0.02, 5.4, P, 0.01)
    assert (b.stage, b.l1, b.l2) == (PreviewStage.SHORTENED, 3.5, 6.5)
    assert advance(b, 0.0, 0.02, 5.4, P, 0.01) == b
    c = advance(b, 0.02, 0.02, 5.4, P, 0.01)
    assert (c.stage, c.l1, c.l2) == (PreviewStage.CURVE, 3.5, 5.5)
    assert advance(c, 0.02, 0.02, 5.4, P, 0.01) == c
    d = advance(c, 0.02, 0.0, 5.4, P, 0.01)
    assert (d.stage, d.l1, d.l2) == (PreviewStage.LEAVING, 3.5, 5.5)
    e = advance(d, 0.0, 0.0, 5.4, P, 0.01)
    assert (e.stage, e.l1, e.l2, e.set_speed) == (PreviewStage.STRAIGHT, 4.5, 24.5, P.set_speed)


def test_near_point_alone_also_starts_the_curve() -> None:
    near = Sequence(int(PreviewStage.STRAIGHT), 4.5, 6.5, 8.3, 0.5, 0.0)
    found = advance(near, 0.0, 0.05, 5.0, P, 0.01)
    assert (found.stage, found.l1, found.set_speed) == (PreviewStage.SHORTENED, 2.0, pytest.approx(3.4, abs=1e-3))


def test_curves_without_a_straight_between() -> None:
    curve = Sequence(int(PreviewStage.CURVE), 3.5, 5.5, 5.4, 0.0, 0.02)
    sharper = advance(curve, 0.02, -0.05, 5.4, P, 0.01)
    assert (sharper.stage, sharper.l1, sharper.l2) == (PreviewStage.CURVE, 2.0, 4.0)
    assert sharper.set_speed == pytest.approx(3.4, abs=1e-3)
    leaving = Sequence(int(PreviewStage.LEAVING), 3.5, 5.5, 5.4, 0.0, 0.02)
    assert advance(leaving, 0.02, 0.02, 5.4, P, 0.01).stage == PreviewStage.CURVE


@pytest.mark.parametrize("stage", list(PreviewStage))
@pytest.mark.parametrize("kappa1", [0.0, 0.02])
@pytest.mark.parametrize("kappa2", [0.0, 0.02, -0.05])
def test_every_stage_and_sight_gives_distances_in_range(stage: Any, kappa1: float, kappa2: float) -> None:
    after = advance(Sequence(int(stage), 3.5, 5.5, 5.4, 0.0, 0.02), kappa1, kappa2, 8.0, P, 0.01)
    assert after.stage in set(PreviewStage)
    assert P.curve_shortest <= after.l1 <= P.straight_longest
    assert after.l2 - after.l1 >= 1.0
    assert 0.0 < after.set_speed <= P.set_speed
