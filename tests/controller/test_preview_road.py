"""The road against closed forms, and the views of it."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller_fmu.preview.params import DEFAULT_ROAD, PreviewParams
from controller_fmu.preview.preview import Displacement, PreviewErrors, integrate_sight, look, motion
from controller_fmu.preview.road import along, curvature_at, project, road_at, road_length
from controller_fmu.preview.safe_speed import safe_speed
from modelkit.vocabulary import Pose


def test_curve_two_lies_where_the_paper_prints_it() -> None:
    assert curvature_at(DEFAULT_ROAD, 357.0) == 0.0
    assert curvature_at(DEFAULT_ROAD, 357.1) == 0.02
    assert curvature_at(DEFAULT_ROAD, 514.1) == 0.02
    assert curvature_at(DEFAULT_ROAD, 514.2) == 0.0


def test_a_half_circle_turns_back() -> None:
    pose = along(Pose(0.0, 0.0, 0.0), 0.02, 50 * math.pi)
    assert (pose.x, pose.y) == (pytest.approx(0.0, abs=1e-9), pytest.approx(100.0))
    assert abs(pose.heading) == pytest.approx(math.pi)


@given(st.floats(-20.0, 980.0), st.floats(-3.0, 3.0))
def test_projection_finds_the_foot(s: Any, left: Any) -> None:
    pose = road_at(DEFAULT_ROAD, s).pose
    x, y = pose.x - left * math.sin(pose.heading), pose.y + left * math.cos(pose.heading)
    assert project(DEFAULT_ROAD, s + 0.5, x, y) == pytest.approx(s, abs=1e-3)


@given(st.floats(1.0, 900.0))
def test_curvature_is_the_heading_rate(s: Any) -> None:
    if curvature_at(DEFAULT_ROAD, s - 1e-3) == curvature_at(DEFAULT_ROAD, s + 1e-3):
        turned = math.remainder(
            road_at(DEFAULT_ROAD, s + 1e-3).pose.heading - road_at(DEFAULT_ROAD, s - 1e-3).pose.heading, 2 * math.pi
        )
        assert turned / 2e-3 == pytest.approx(curvature_at(DEFAULT_ROAD, s), abs=1e-9)


def test_road_goes_straight_on_past_its_end() -> None:
    end = road_length(DEFAULT_ROAD)
    first, second = road_at(DEFAULT_ROAD, end).pose, road_at(DEFAULT_ROAD, end + 7.0).pose
    assert math.dist((first.x, first.y), (second.x, second.y)) == pytest.approx(7.0)
    assert curvature_at(DEFAULT_ROAD, end + 1.0) == 0.0


@pytest.mark.parametrize(("kappa", "printed", "within"), [(0.01, 7.6, 0.05), (-0.02, 5.4, 0.05), (0.04, 3.8, 0.05)])
def test_safe_speeds_as_printed(kappa: float, printed: float, within: float) -> None:
    assert safe_speed(kappa, 0.578, 40.0) == pytest.approx(printed, abs=within)


def test_safe_speed_of_curve_four_is_not_the_printed_one() -> None:
    assert safe_speed(0.05, 0.578, 40.0) == pytest.approx(3.4, abs=0.001)


def test_geometry_and_kinematics_agree_at_constant_distance() -> None:
    """A car on a circle of the road's curvature but turned and shifted: (2) integrates what it sees, to first order."""
    p = PreviewParams()
    l1, s, dt = 3.5, 400.0, 0.01
    on_road = road_at(p.road, s).pose
    centre = Pose(on_road.x, on_road.y, on_road.heading + 0.002)
    sight = first = look(s, centre, l1, p)
    for _ in range(100):
        after = along(centre, 0.0202, 5.0 * dt)
        sight = integrate_sight(sight, motion(centre, after), 0.02, l1)
        centre = after
        s = s + 5.0 * dt
    seen = look(s, centre, l1, p)
    assert sight.y_l - first.y_l == pytest.approx(seen.y_l - first.y_l, abs=2e-3)
    assert sight.eps_l == pytest.approx(seen.eps_l, abs=1e-3)


def test_motion_of_pure_translation_and_rotation() -> None:
    moved = motion(Pose(1.0, 2.0, math.pi / 2), Pose(1.0, 3.0, math.pi / 2))
    assert moved == (pytest.approx(1.0), pytest.approx(0.0), pytest.approx(0.0))
    turned = motion(Pose(0.0, 0.0, 3.1), Pose(0.0, 0.0, -3.1))
    assert turned.turned == pytest.approx(2 * math.pi - 6.2)


def test_steady_curve_of_equation_two_gives_curvature_times_distance_plus_sideslip() -> None:
    """vx epsL - vy - r L1 = 0 with r = vx kappa: epsL = kappa L1 + beta."""
    vx, vy, kappa, l1, dt = 5.4, 0.05, 0.02, 3.5, 0.01
    eps = kappa * l1 + vy / vx
    sight = integrate_sight(PreviewErrors(0.0, eps), Displacement(vx * dt, vy * dt, vx * kappa * dt), kappa, l1)
    assert sight == (pytest.approx(0.0, abs=1e-12), pytest.approx(eps))
