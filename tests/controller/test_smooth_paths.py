"""NBTPT on paths that are no arcs: the law is the same, the path another one."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BSpline

from controller_fmu.guo2015.path import reference_at
from controller_fmu.guo2015.path_tracking import path_tracking_angle
from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.guo2015.planner import path_from
from controller_fmu.guo2015.smooth_path import PathShape, curve, leaning, on_curve, rising, way_left
from controller_fmu.interface import Reason
from controller_fmu.registry import System
from modelkit.vocabulary import Pose
from tests.controller.closed_loop import drive

L = 2.405
SMALLEST = 4.37
SMOOTH = [shape for shape in PathShape if shape != PathShape.TWO_ARCS]
START = Pose(11.6, 3.056, 0.03)
TARGET = (-7.608, -3.056)
each = pytest.mark.parametrize("shape", SMOOTH, ids=lambda shape: shape.name.lower())


@each
def test_ends_and_derivatives(shape: Any) -> None:
    for function, first, last in ((rising, (0.0, 0.0), (1.0, 0.0)), (leaning, (0.0, 0.0), (0.0, 1.0))):
        assert function(shape, 0.0)[:2] == pytest.approx(first, abs=1e-12)
        assert function(shape, 1.0)[:2] == pytest.approx(last, abs=1e-12)
        for t in (0.1, 0.26, 0.4, 0.7, 0.9):
            near, far = function(shape, t - 1e-5), function(shape, t + 1e-5)
            here = function(shape, t)
            assert here.slope == pytest.approx((far.value - near.value) / 2e-5, abs=1e-6)
            assert here.bend == pytest.approx((far.slope - near.slope) / 2e-5, abs=1e-5)


def test_the_b_spline_is_the_one_of_scipy() -> None:
    knots, ordinates = np.array([0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1]), np.array([0, 0, 0, 0.5, 1, 1, 1])
    oracle = BSpline(knots, ordinates, 3)
    for t in np.linspace(0.0, 1.0, 33):
        ours = rising(PathShape.B_SPLINE, float(t))
        assert ours == pytest.approx([float(oracle.derivative(k)(t)) if k else float(oracle(t)) for k in range(3)])


@each
def test_what_the_curve_asks_of_the_car(shape: Any) -> None:
    path = curve(shape, START, L)
    xs = np.linspace(0.0, START.x, 4001)
    points = [on_curve(path, float(x)) for x in xs]
    assert path.curvature == pytest.approx(max(abs(p.curvature) for p in points), rel=0.01)
    length = np.hypot(np.diff(xs), np.diff([p.y for p in points]))
    assert way_left(path, START.x) == pytest.approx(length.sum(), rel=2e-3)
    near = xs[1:] <= 2.0
    assert way_left(path, float(xs[1:][near][-1])) == pytest.approx(length[near].sum(), rel=1e-5)
    angles = np.arctan(L * np.array([p.curvature for p in points]))
    swing = np.abs(np.diff(angles)) / length
    assert path.swing == pytest.approx(swing[5:-5].max(), rel=0.06)
    assert on_curve(path, path.inflection.x - 0.2).curvature > 0.0 > on_curve(path, path.inflection.x + 0.2).curvature


@each
def test_errors_obey_the_same_linear_equation(shape: Any) -> None:
    """x1'' = -k1 x1 - k2 x1' over s = -x, whatever the path; integrated apart from the law and solved by hand."""
    k1, k2, offset = 1.0, 0.8, 0.1
    path = path_from(START, 5.5, SMALLEST, shape, L)
    assert path.found
    x, y, heading = START.x, START.y + offset, START.heading
    decay, wave = 0.5 * k2, math.sqrt(k1 - 0.25 * k2 * k2)
    h = 1e-3
    while x > 1.0:
        reference = reference_at(path, x, 0)
        s = START.x - x
        expected = -offset * math.exp(-decay * s) * (math.cos(wave * s) + decay / wave * math.sin(wave * s))
        assert reference.y - y == pytest.approx(expected, abs=2e-3)
        phi = path_tracking_angle(Pose(x, y, heading), reference, k1, k2, L)
        x -= h * math.cos(heading)
        y -= h * math.sin(heading)
        heading -= h * math.tan(phi) / L


@each
def test_a_car_parks_on_it(shape: Any) -> None:
    """Reversing at up to 0.8 m/s with Table 1's wheel; the driver obeys."""
    vehicle = {"start.x": START.x + TARGET[0], "start.heading": START.heading, "driver.profile[1].speed": 0.8}
    run = drive(vehicle, {"system": int(System.NTBPT), "guo2015.path": int(shape)})
    assert run.phases[-1] == GuoPhase.PARKED
    assert max(abs(out.lateral_error) for out in run.controller) < 0.03
    end = run.vehicle[-1].pose
    assert (end.x, end.y, end.heading) == pytest.approx((*TARGET, 0.0), abs=0.06)


@each
def test_a_start_too_near_is_refused(shape: Any) -> None:
    run = drive({}, {"system": int(System.NTBPT), "guo2015.path": int(shape), "guo2015.radius_reserve": 1.5})
    assert (run.phases[-1], run.controller[-1].reason) == (GuoPhase.FAILED, Reason.NO_PATH)
