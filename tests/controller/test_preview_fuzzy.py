"""The fuzzy controllers against scikit-fuzzy and against their own symmetry."""

from typing import Any

import numpy as np
import pytest
import skfuzzy
from hypothesis import given
from hypothesis import strategies as st

from controller_fmu.preview import rule_tables
from controller_fmu.preview.control import drive_force, steering_angle
from controller_fmu.preview.fuzzy import cell_moment, centroid, infer
from controller_fmu.preview.membership import membership
from controller_fmu.preview.params import PreviewParams, RuleTable
from controller_fmu.preview.preview import PreviewErrors

UNIFORM5 = (-3.0, -1.5, 0.0, 1.5, 3.0)
UNIFORM7 = (-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0)
TABLES = {
    "steering symmetric": rule_tables.STEERING_SYMMETRIC,
    "steering printed": rule_tables.STEERING_PRINTED,
    "force": rule_tables.FORCE,
}


class Oracle:
    """The same controller in scikit-fuzzy, its centroid on a sampled universe."""

    def __init__(self, inputs: Any, outputs: Any, rules: Any, samples: Any = 6001) -> None:
        self.x = np.linspace(outputs[0], outputs[-1], samples)
        self.inputs = [self._triangles(peaks, np.linspace(peaks[0], peaks[-1], 2401)) for peaks in inputs]
        self.grids = [np.linspace(peaks[0], peaks[-1], 2401) for peaks in inputs]
        self.outputs = self._triangles(outputs, self.x)
        self.rules = rules

    @staticmethod
    def _triangles(peaks: Any, x: Any) -> Any:
        corners = (peaks[0], *peaks, peaks[-1])
        return [skfuzzy.trimf(x, corners[i : i + 3]) for i in range(len(peaks))]

    def __call__(self, row: Any, column: Any) -> Any:
        degrees = [
            [skfuzzy.interp_membership(grid, mf, np.clip(v, grid[0], grid[-1])) for mf in sets]
            for grid, sets, v in zip(self.grids, self.inputs, (row, column), strict=True)
        ]
        joined = np.zeros_like(self.x)
        for i, a in enumerate(degrees[0]):
            for j, b in enumerate(degrees[1]):
                joined = np.fmax(joined, np.fmin(min(a, b), self.outputs[self.rules[5 * i + j]]))
        return skfuzzy.defuzz(self.x, joined, "centroid")


@pytest.mark.parametrize("name", TABLES)
def test_grid_against_scikit_fuzzy(name: Any) -> None:
    oracle = Oracle((UNIFORM5, UNIFORM5), UNIFORM7, TABLES[name])
    worst = 0.0
    for row in np.linspace(-3.6, 3.6, 11):
        for column in np.linspace(-3.6, 3.6, 11):
            ours = infer(float(row), float(column), UNIFORM5, UNIFORM5, UNIFORM7, TABLES[name])
            worst = max(worst, abs(ours - oracle(row, column)))
    assert worst < 1e-5


def test_force_sets_as_shipped_against_scikit_fuzzy() -> None:
    p = PreviewParams()
    oracle = Oracle((p.speed_peaks, p.rate_peaks), p.force_peaks, rule_tables.FORCE, 7001)
    for error in np.linspace(-0.8, 0.8, 23):
        for rate in (-900.0, -20.0, 0.0, 5.0, 700.0):
            ours = drive_force(float(error), rate, p)
            assert ours == pytest.approx(250.0 * oracle(error / 2.0, rate * 3.0 / 1000.0), abs=5e-3)


def test_exact_centroid_is_the_limit_of_the_sampled_one() -> None:
    level = (0.0, 0.3, 0.8, 0.65, 0.1, 0.0, 1.0)
    exact = centroid(UNIFORM7, level)

    def sampled(samples: Any) -> Any:
        x = np.linspace(-3.0, 3.0, samples)
        sets = Oracle._triangles(UNIFORM7, x)
        joined = np.max([np.fmin(a, mf) for a, mf in zip(level, sets, strict=True)], axis=0)
        return float(np.sum(joined * x) / np.sum(joined))

    errors = [abs(sampled(n) - exact) for n in (61, 601, 6001, 60001)]
    assert errors[0] > errors[1] > errors[2] > errors[3]
    assert errors[3] < 1e-4


@given(st.floats(0, 1), st.floats(0, 1))
def test_cell_moment_against_quadrature(falling: Any, rising: Any) -> None:
    t = (np.arange(20000) + 0.5) / 20000
    height = np.maximum(np.minimum(falling, 1 - t), np.minimum(rising, t))
    piece = cell_moment(falling, rising)
    assert piece.area == pytest.approx(height.mean(), abs=1e-7)
    assert piece.first == pytest.approx((height * t).mean(), abs=1e-7)


@given(st.floats(-5, 5))
def test_membership_is_a_partition(value: Any) -> None:
    found = membership(value, UNIFORM5)
    assert 0 <= found.lower <= 3
    assert 0.0 <= found.degree_lower <= 1.0
    if -3 <= value <= 3:
        mean = found.degree_lower * UNIFORM5[found.lower] + (1 - found.degree_lower) * UNIFORM5[found.lower + 1]
        assert mean == pytest.approx(value, abs=1e-12)


@given(st.floats(-0.3, 0.3), st.floats(-0.7, 0.7))
def test_symmetric_rules_give_mirrored_steering(y: Any, eps: Any) -> None:
    p = PreviewParams()
    assert steering_angle(PreviewErrors(-y, -eps), p) == pytest.approx(
        -steering_angle(PreviewErrors(y, eps), p), abs=1e-12
    )


def test_printed_rules_break_the_symmetry_in_four_cells() -> None:
    cells = [
        i
        for i, (a, b) in enumerate(zip(rule_tables.STEERING_PRINTED, rule_tables.STEERING_SYMMETRIC, strict=True))
        if a != b
    ]
    assert cells == [3, 4, 15, 16]
    printed = PreviewParams()._replace(rules=int(RuleTable.PRINTED))
    assert (
        steering_angle(PreviewErrors(-0.2, 0.4), printed)
        < 0
        < steering_angle(PreviewErrors(-0.2, 0.4), PreviewParams())
    )


def test_force_sign_and_limits() -> None:
    p = PreviewParams()
    assert drive_force(-6.0, 0.0, p) == pytest.approx(750.0)
    assert drive_force(6.0, 0.0, p) == pytest.approx(-750.0)
    assert drive_force(0.0, 0.0, p) == pytest.approx(0.0, abs=1e-9)
    assert drive_force(0.15, 0.0, p) < 0 < drive_force(-0.15, 0.0, p)


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), -float("inf")])
def test_bad_inputs_do_not_raise(bad: Any) -> None:
    p = PreviewParams()
    assert not abs(steering_angle(PreviewErrors(bad, 0.0), p)) > p.steering_range
    assert not abs(drive_force(bad, bad, p)) > 750.0 + 1e-9
