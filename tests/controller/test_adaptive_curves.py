"""Curves onto the x axis: they end there, their curvature is continuous, and the wheel can follow at their speed."""

import itertools
import math
from typing import Any

import pytest

from controller_fmu.adaptive.curves import SteeringLimits, arc_in, bend_of, line_in, s_curve, swing_distance
from controller_fmu.adaptive.route import curvature_at, drivable, foot_on, mirror_route, point_at
from modelkit.vocabulary import Pose

WHEEL = SteeringLimits(2.405, math.radians(30.0), 4.3)
SPEEDS = (0.0, 0.3, 0.6)


def length_of(route: Any) -> float:
    return sum(piece.length for piece in route.pieces)


def assert_ends_on_axis(route: Any) -> None:
    assert route.direction == -1
    end = point_at(route, length_of(route)).pose
    assert end.y == pytest.approx(0.0, abs=1e-5)
    assert end.heading == pytest.approx(0.0, abs=1e-9)
    assert end.x == pytest.approx(0.0, abs=1e-6)


def assert_wheel_follows(route: Any, speed: Any) -> None:
    """From sample to sample the wheel turns no faster than it can."""
    step = 0.01 * speed
    angles = [math.atan(WHEEL.wheelbase * curvature_at(route, k * step)) for k in range(int(length_of(route) / step))]
    fastest = max(abs(b - a) for a, b in itertools.pairwise(angles)) / 0.01
    assert fastest <= 1.35 * WHEEL.rate


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("pose", [(6.6, 1.6, 0.55), (4.6, 1.5, 0.7), (4.6, 1.5, 0.78)])
def test_an_arc_leads_in(pose: Any, speed: Any) -> None:
    route = arc_in(Pose(*pose), speed, WHEEL, 0.0)
    assert_ends_on_axis(route)
    if speed > 0.0:
        assert drivable(route) == length_of(route)
        assert_wheel_follows(route, speed)
    else:
        assert drivable(route) < length_of(route)


def test_an_arc_that_is_too_tight_or_too_wide_is_none() -> None:
    assert arc_in(Pose(4.6, 0.8, 0.8), 0.0, WHEEL, 0.0).direction == 0
    assert arc_in(Pose(2.0, 1.8, 0.8), 0.0, WHEEL, 0.0).direction == 0
    assert arc_in(Pose(4.6, 1.5, -0.1), 0.0, WHEEL, 0.0).direction == 0


def test_a_line_before_the_arc() -> None:
    bend = bend_of(4.3, swing_distance(0.3, 4.3, WHEEL))
    route = line_in(Pose(6.0, 3.0, 0.7), bend, 0.0)
    assert_ends_on_axis(route)
    assert drivable(route) == length_of(route)
    assert_wheel_follows(route, 0.3)


@pytest.mark.parametrize("lead", [0.0, 0.8])
@pytest.mark.parametrize(("speed", "radius"), [(0.0, 5.0), (0.3, 4.3), (0.3, 5.0), (0.6, 4.3)])
def test_an_s_curve_leads_in(lead: float, speed: float, radius: float) -> None:
    bend = bend_of(radius, swing_distance(speed, radius, WHEEL))
    route = s_curve(Pose(9.0, 3.0, 0.05), lead, bend, bend, 0.2)
    assert_ends_on_axis(route)
    assert max(abs(curvature_at(route, 0.01 * k)) for k in range(int(100 * length_of(route)))) <= 1.0 / radius + 1e-9
    if speed > 0.0:
        assert_wheel_follows(route, speed)


def test_without_clothoids_it_is_the_path_of_guo() -> None:
    """Radius 5.499 m, the tangent point at Q1 of Table 2."""
    bend = bend_of(5.499, 0.0)
    route = s_curve(Pose(7.608, 3.056, 0.0), 0.0, bend, bend, 0.0)
    q1 = point_at(route, route.pieces[2].length).pose
    assert (q1.x - 7.608, q1.y - 3.056, q1.heading) == pytest.approx((-3.798, -1.522, 0.765), abs=0.03)


def test_a_clothoid_moves_the_circle_away_from_the_line() -> None:
    bend = bend_of(5.0, 1.0)
    assert bend.angle == pytest.approx(0.1)
    assert bend.rho - 5.0 == pytest.approx(1.0 / (24.0 * 5.0), rel=0.01)
    assert bend.tangent == pytest.approx(0.5, rel=0.01)


def test_the_mirror_image_and_the_foot() -> None:
    bend = bend_of(4.5, 0.5)
    start = Pose(9.0, 3.0, 0.1)
    route = s_curve(start, 0.0, bend, bend, 0.0)
    image = mirror_route(route, -1.0, Pose(9.0, -3.0, -0.1), -1)
    for s in (0.5, 3.0, 6.0):
        here, there = point_at(route, s).pose, point_at(image, s).pose
        assert (there.x, -there.y, -there.heading) == pytest.approx(here)
        aside = Pose(
            here.x - 0.05 * math.sin(here.heading), here.y + 0.05 * math.cos(here.heading), here.heading + 0.02
        )
        foot = foot_on(route, s - 0.02, aside)
        assert foot.s == pytest.approx(s, abs=2e-3)
        assert foot.lateral_error == pytest.approx(0.05, abs=1e-3)
        assert foot.heading_error == pytest.approx(0.02, abs=1e-3)
