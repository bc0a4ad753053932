"""Eq. (6) and (17): linear error dynamics over distance, as the paper derives them, and the printed signs' failure."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller_fmu.guo2015.path import Reference
from controller_fmu.guo2015.path_tracking import path_tracking_angle
from controller_fmu.guo2015.point_tracking import point_error, point_tracking_angle
from modelkit.vocabulary import Pose

L = 2.405
small = st.floats(-0.4, 0.4)


@given(y=small, heading=st.floats(-1.0, 1.0), y_r=small, heading_r=st.floats(-1.0, 1.0), curvature=st.floats(-0.2, 0.2))
def test_path_errors_obey_their_linear_equation(
    y: float, heading: float, y_r: float, heading_r: float, curvature: float
) -> None:
    """x1'' = -k1 x1 - k2 x1' over s = -x, eq. (7)."""
    k1, k2 = 1.0, 0.8
    reference = Reference(0.0, y_r, heading_r, curvature, 0)
    phi = path_tracking_angle(Pose(0.0, y, heading), reference, k1, k2, L)
    x1 = y_r - y
    x2 = -(math.tan(heading_r) - math.tan(heading))
    # d(tan h)/ds = sec^2 h * dh/dx * dx/ds, dh/dx = tan(phi) / (L cos h), dx/ds = -1
    x2_rate = curvature / math.cos(heading_r) ** 3 - math.tan(phi) / (L * math.cos(heading) ** 3)
    assert x2_rate == pytest.approx(-k1 * x1 - k2 * x2, abs=1e-9)


@given(y=small, heading=st.floats(-1.2, 1.2), direction=st.sampled_from([1.0, -1.0]))
def test_point_errors_obey_their_linear_equation(y: float, heading: float, direction: float) -> None:
    """y'' = -k3 y - k4 y' over the distance travelled towards the point, eq. (15)."""
    k3, k4 = 1.0, 4.0
    error = point_error(Pose(-direction, y, heading), Pose(0.0, 0.0, 0.0))
    phi = point_tracking_angle(error, direction, k3, k4, L)
    second = math.tan(phi) / (L * math.cos(heading) ** 3)  # d2y/dx2; even in the direction of x
    first = direction * math.tan(heading)  # dy/ds, s = direction * x
    assert second == pytest.approx(-k3 * y - k4 * first, abs=1e-9)


@given(x=st.floats(-50, 50), y=st.floats(-50, 50), h=st.floats(-3, 3), turn=st.floats(-3, 3), dx=st.floats(-9, 9))
def test_point_error_does_not_depend_on_the_world_frame(x: float, y: float, h: float, turn: float, dx: float) -> None:
    point, pose = Pose(1.0, 2.0, 0.3), Pose(x, y, h)

    def moved(p: Pose) -> Pose:
        c, s = math.cos(turn), math.sin(turn)
        return Pose(p.x * c - p.y * s + dx, p.x * s + p.y * c - dx, p.heading + turn)

    here, there = point_error(pose, point), point_error(moved(pose), moved(point))
    assert there[:2] == pytest.approx(here[:2], abs=1e-9)
    assert math.cos(there.heading - here.heading) == pytest.approx(1.0, abs=1e-12)


def _follow_parabola(law_sign: float) -> float:
    """Return the largest distance from the straight line y = 0 when starting 0.2 m beside it, reversing 20 m."""
    x, y, heading, worst = 0.0, 0.2, 0.0, 0.0
    for _ in range(20000):
        reference = Reference(x, 0.0, 0.0, 0.0, 0)
        phi = path_tracking_angle(Pose(x, y, heading), reference, law_sign * 1.0, law_sign * 0.8, L)
        h = -0.001
        x += h * math.cos(heading)
        y += h * math.sin(heading)
        heading += h * math.tan(phi) / L
        worst = max(worst, abs(y))
        if abs(heading) > 1.5:
            return math.inf
    return max(abs(y), worst - 0.2)


def test_the_printed_signs_diverge_and_the_corrected_ones_converge() -> None:
    assert _follow_parabola(1.0) < 0.1
    assert _follow_parabola(-1.0) > 1.0
