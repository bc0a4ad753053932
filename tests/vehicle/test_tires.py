"""Tyre forces against CommonRoad's Magic Formula, and the carcass's own truths."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from vehiclemodels.parameters_vehicle1 import parameters_vehicle1
from vehiclemodels.utils import tire_model

from vehicle_fmu.bodies.tires import TireParams, magic, relax, secants, weight

TIRES = TireParams()
SLIP = st.floats(-0.4, 0.4)
ANGLE = st.floats(-0.25, 0.25)
"""At larger angles CommonRoad's cosine weighting leaves less than sliding rubber has, and from 0.5 rad turns
the longitudinal force round; ours ends at the sliding friction."""
LOAD = st.floats(1.0, 9000.0)


def without_shifts() -> Any:
    """CommonRoad's tyre with every shift set to zero, as ours has it."""
    tire = parameters_vehicle1().tire
    for name in ("p_hx1", "p_vx1", "r_hx1", "r_hy1", "r_by3", "r_vy1", "r_vy3", "p_hy1", "p_vy1", "p_hy3", "p_vy3"):
        setattr(tire, name, 0.0)
    return tire


THEIRS = without_shifts()


@given(SLIP, ANGLE, LOAD)
def test_equals_commonroads_magic_formula_without_its_shifts(kappa: float, angle: float, load: float) -> None:
    theirs = THEIRS
    pure_x = tire_model.formula_longitudinal(-kappa, 0.0, load, theirs)
    pure_y, mu = tire_model.formula_lateral(-angle, 0.0, load, theirs)
    x = tire_model.formula_longitudinal_comb(-kappa, -angle, pure_x, theirs)
    y = tire_model.formula_lateral_comb(-kappa, -angle, 0.0, mu, load, pure_y, theirs)
    slip_y = math.tan(angle)
    ours = secants(kappa, slip_y, load, 0.0, 1.0, TIRES)
    assert ours.x * kappa == pytest.approx(x, abs=1e-12 * load)
    assert ours.y * slip_y == pytest.approx(y, abs=1e-12 * load)


@given(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0), LOAD, st.floats(1e-3, 2.0))
def test_forces_oppose_sliding_and_are_even(kappa: float, slip_y: float, load: float, grip: float) -> None:
    one = secants(kappa, slip_y, load, 0.0, grip, TIRES)
    assert one.x >= 0.0
    assert one.y >= 0.0
    assert one == secants(-kappa, slip_y, load, 0.0, grip, TIRES)
    assert one == secants(kappa, -slip_y, load, 0.0, grip, TIRES)
    assert abs(one.x * kappa) <= 1.001 * grip * TIRES.friction_x * load
    assert abs(one.y * slip_y) <= 1.001 * grip * TIRES.friction_y * load


def test_small_slip_is_linear() -> None:
    force = secants(1e-7, 1e-7, 3000.0, 0.0, 1.0, TIRES)
    assert force.x == pytest.approx(22.303 * 3000.0, rel=1e-6)
    assert force.y == pytest.approx(21.92 * 3000.0, rel=1e-6)
    assert secants(0.0, 0.0, 3000.0, 0.0, 1.0, TIRES).x == pytest.approx(22.303 * 3000.0, rel=1e-15)


def test_no_load_or_no_grip_gives_no_force() -> None:
    assert secants(0.1, 0.1, 0.0, 0.0, 1.0, TIRES) == (0.0, 0.0)
    assert secants(0.1, 0.1, 3000.0, 0.0, 0.0, TIRES) == (0.0, 0.0)


def test_magic_formula_peaks_at_its_peak() -> None:
    best = max(magic(0.001 * n, 60000.0, 1.6, 0.4, 3000.0) for n in range(1000))
    assert best == pytest.approx(3000.0, rel=1e-3)
    assert weight(0.0, 13.0, 1.2, 0.6) == 1.0


def test_carcass_tends_to_its_steady_deflection_by_any_step() -> None:
    for h in (1e-4, 1e-2, 1.0):
        u = 0.0
        for _ in range(20000):
            u = relax(u, 0.02, 5.0, h)
        assert u == pytest.approx(0.02 / 5.0, rel=1e-4)
    assert relax(0.003, 0.0, 0.0, 1e6) == 0.003, "a wheel at rest holds"
