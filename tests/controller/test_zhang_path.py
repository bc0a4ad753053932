"""Key points, quintics and path of Zhang 2022 against their defining equations."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller_fmu.common.arc_line_arc import arc_line_arc, largest_radius
from controller_fmu.zhang2022.path import PathStatus, at, nearest, plan, through
from controller_fmu.zhang2022.quintic import quintic, shape
from modelkit.vocabulary import Pose

LIMIT = 0.235


@given(st.floats(6.0, 14.0), st.floats(1.0, 4.0), st.floats(0.2, 1.0))
def test_arc_line_arc_meets_equations_two_and_three(s: Any, h: Any, share: Any) -> None:
    arcs = arc_line_arc(s, h, share * largest_radius(s, h))
    both = 2.0 * arcs.radius
    assert both * math.sin(arcs.angle) + arcs.line * math.cos(arcs.angle) == pytest.approx(s, abs=1e-9)
    assert both * (1 - math.cos(arcs.angle)) + arcs.line * math.sin(arcs.angle) == pytest.approx(h, abs=1e-9)


def test_a_radius_too_large_does_not_fit() -> None:
    assert arc_line_arc(8.0, 2.5, 1.01 * largest_radius(8.0, 2.5)).line < 0.0


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(-3, 3), st.floats(1, 6))
def test_quintic_meets_its_six_conditions(slope0: Any, slope1: Any, rise: Any, length: Any) -> None:
    piece = quintic(2.0, 1.0, slope0, 2.0 + length, 1.0 + rise, slope1)
    first, last = shape(piece, 2.0), shape(piece, 2.0 + length)
    assert first == (pytest.approx(1.0), pytest.approx(slope0), pytest.approx(0.0, abs=1e-12))
    assert last.y == pytest.approx(1.0 + rise, abs=1e-9)
    assert last.slope == pytest.approx(slope1, abs=1e-9)
    assert last.curvature == pytest.approx(0.0, abs=1e-8)


def test_curvature_is_that_of_the_numbers() -> None:
    piece, x, h = quintic(0.0, 0.0, 0.0, 4.0, 1.5, 0.9), 1.7, 1e-4
    slope = (shape(piece, x + h).y - shape(piece, x - h).y) / (2 * h)
    bend = (shape(piece, x + h).y - 2 * shape(piece, x).y + shape(piece, x - h).y) / h**2
    assert shape(piece, x).slope == pytest.approx(slope, abs=1e-7)
    assert shape(piece, x).curvature == pytest.approx(bend / (1 + slope**2) ** 1.5, abs=1e-6)


def test_path_is_continuous_in_place_slope_and_curvature() -> None:
    path = plan(Pose(8.5, 2.8, 0.0), 5.0, LIMIT)
    assert path.status == PathStatus.FOUND
    for i in range(1700):
        a, b = at(path, i * 0.005), at(path, (i + 1) * 0.005)
        assert abs(b.y - a.y) < 0.005
        assert abs(b.slope - a.slope) < 0.005
        assert abs(b.curvature - a.curvature) < 0.005
        assert abs(a.curvature) <= LIMIT + 1e-3


def test_refused_with_the_reason() -> None:
    refused = plan(Pose(7.0, 2.8, 0.0), 5.0, LIMIT)
    assert refused.status == PathStatus.CURVATURE_LIMIT
    assert refused.largest_curvature > LIMIT
    assert plan(Pose(-1.0, 2.8, 0.0), 5.0, LIMIT).status == PathStatus.BAD_START
    assert plan(Pose(8.5, 2.8, 0.9), 5.0, LIMIT).status == PathStatus.BAD_START
    assert plan(Pose(float("nan"), 2.8, 0.0), 5.0, LIMIT).status == PathStatus.BAD_START


@given(st.floats(0.5, 8.0), st.floats(-0.3, 0.3), st.floats(-0.2, 0.2))
def test_nearest_finds_the_foot_and_the_errors(x: Any, left: Any, turned: Any) -> None:
    path = plan(Pose(8.5, 2.8, 0.0), 5.0, LIMIT)
    on = at(path, x)
    heading = math.atan(on.slope)
    pose = Pose(x - left * math.sin(heading), on.y + left * math.cos(heading), heading + turned)
    found = nearest(path, pose)
    assert found.lateral_error == pytest.approx(left, abs=1e-4)
    assert found.heading_error == pytest.approx(turned, abs=1e-3)


def test_radii_between_those_tried_first_are_tried_where_none_of_these_keeps_the_limit() -> None:
    start = Pose(8.0, 2.8, 0.0)
    widest = largest_radius(start.x, start.y)

    def smallest_peak(radii: Any) -> Any:
        tried = [through(start, arc_line_arc(start.x, start.y, radius)) for radius in radii]
        return min(path.largest_curvature for path in tried)

    first = smallest_peak(5.0 + number / 8.0 * (widest - 5.0) for number in range(9))
    finer = smallest_peak(5.0 + number / 800.0 * (widest - 5.0) for number in range(800))
    assert finer < first - 1e-6
    found = plan(start, 5.0, 0.5 * (first + finer))
    assert found.status == PathStatus.FOUND
    assert found.largest_curvature <= 0.5 * (first + finer)
