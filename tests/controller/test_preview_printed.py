"""What the preview paper prints, typed from the source: distances, period, ranges, rule tables, safe speeds, road."""

import math

import pytest

from controller_fmu.preview.control import drive_force, steering_angle
from controller_fmu.preview.params import DEFAULT_ROAD, PreviewParams
from controller_fmu.preview.preview import Displacement, PreviewErrors, integrate_sight
from controller_fmu.preview.rule_tables import FORCE, STEERING_PRINTED, STEERING_SYMMETRIC
from controller_fmu.preview.safe_speed import safe_speed
from controller_fmu.preview.sequence import curve_distance, straight_distance
from orchestrator.inputs.scenario.load_scenario import load_scenario

PARAMS = PreviewParams()
TABLE_1 = "NB NB NM NB NB / NM NM NS PS PB / NM NS ZE PS PM / PB PS PS PM PM / NB NB PM PB PB"
TABLE_2 = "PB PB PB PM ZE / PB PM PS PS NM / PB PS ZE NS NB / PM ZE NS NM NB / ZE NM NB NB NB"
SYMMETRIC = "NB NB NM PB PB / NM NM NS PS PB / NM NS ZE PS PM / NB NS PS PM PM / NB NB PM PB PB"
SETS = ("NB", "NM", "NS", "ZE", "PS", "PM", "PB")


@pytest.mark.parametrize(
    ("ours", "printed"), [(STEERING_PRINTED, TABLE_1), (FORCE, TABLE_2), (STEERING_SYMMETRIC, SYMMETRIC)]
)
def test_rule_tables_cell_by_cell(ours: tuple[int, ...], printed: str) -> None:
    assert [SETS[cell] for cell in ours] == printed.replace("/", " ").split()


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("straight_slope", 1.22),
        ("straight_offset", -4.04),
        ("straight_shortest", 4.5),
        ("straight_longest", 15.5),
        ("curve_slope", -50.0),
        ("curve_offset", 4.5),
        ("curve_shortest", 2.0),
        ("curve_longest", 4.0),
        ("near_gap", 2.0),
        ("far_gap", 20.0),
        ("period", 1.0),
        ("far_time", 0.2),
        ("set_speed", 8.3),
        ("lateral_range", 0.2),
        ("heading_range", math.radians(30.0)),
        ("steering_range", math.radians(34.5)),
        ("speed_range", 6.0),
        ("rate_range", 1000.0),
        ("force_range", 750.0),
        ("safe_acceleration", 0.578),
        ("lateral_gain", 2.0),
        ("heading_gain", 1.0),
        ("lateral_peaks", (-3.0, -1.5, 0.0, 1.5, 3.0)),
        ("heading_peaks", (-3.0, -1.5, 0.0, 1.5, 3.0)),
        ("steering_peaks", (-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0)),
        ("speed_peaks", (-0.3, -0.1, 0.0, 0.1, 0.3)),
        ("rate_peaks", (-3.0, -1.5, 0.0, 1.5, 3.0)),
        ("force_peaks", (-3.5, -2.0, -1.0, 0.0, 1.0, 2.0, 3.5)),
    ],
)
def test_numbers_as_printed_or_as_the_page_says_they_were_chosen(name: str, printed: object) -> None:
    assert getattr(PARAMS, name) == printed


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("chassis.mass", 560.0),
        ("chassis.yaw_inertia", 1040.0),
        ("car.wheelbase", 1.13 + 0.76),
        ("car.cg_to_rear", 0.76),
        ("single_track.stiffness_front", 32e3),
        ("single_track.stiffness_rear", 32e3),
    ],
)
def test_table_3(name: str, printed: float) -> None:
    assert load_scenario("preview").parameters_of("vehicle")[name] == pytest.approx(printed, rel=1e-12)


@pytest.mark.parametrize(("v", "l1"), [(6.9, 4.5), (7.0, 4.5), (8.0, 5.72), (12.0, 10.6), (16.0, 15.48), (17.0, 15.5)])
def test_equation_5(v: float, l1: float) -> None:
    assert straight_distance(v, PARAMS) == pytest.approx(l1, abs=1e-9)


@pytest.mark.parametrize(
    ("kappa", "l1"), [(0.005, 4.0), (0.01, 4.0), (-0.02, 3.5), (0.04, 2.5), (-0.05, 2.0), (0.06, 2.0)]
)
def test_equation_6(kappa: float, l1: float) -> None:
    assert curve_distance(kappa, PARAMS) == pytest.approx(l1, abs=1e-9)


def test_equation_2() -> None:
    seen = integrate_sight(PreviewErrors(0.01, 0.02), Displacement(0.5, 0.003, 0.004), 0.04, 2.5)
    assert seen.eps_l == pytest.approx(0.02 + 0.5 * 0.04 - 0.004)
    assert seen.y_l == pytest.approx(0.01 + 0.5 * 0.5 * (0.02 + seen.eps_l) - 0.003 - 0.004 * 2.5)


@pytest.mark.parametrize(("kappa", "printed"), [(0.01, 7.6), (0.02, 5.4), (-0.04, 3.8)])
def test_safe_speeds(kappa: float, printed: float) -> None:
    assert safe_speed(kappa, PARAMS.safe_acceleration, 100.0) == pytest.approx(printed, abs=0.05)
    assert safe_speed(kappa, PARAMS.safe_acceleration, 3.0) == 3.0


def test_curvatures_and_places_of_the_curves() -> None:
    assert [piece.curvature for piece in DEFAULT_ROAD if piece.length > 0.0] == [
        0.0,
        -0.01,
        0.0,
        0.02,
        0.0,
        -0.04,
        0.0,
        0.05,
        0.0,
    ]
    starts = [sum(piece.length for piece in DEFAULT_ROAD[:number]) for number in range(9)]
    assert (starts[3], starts[4]) == pytest.approx((357.1, 514.2), abs=0.06)
    assert [DEFAULT_ROAD[number].length for number in (0, 2, 4, 6, 8)] == [100.0, 100.0, 102.0, 102.0, 100.0]
    turned = [abs(DEFAULT_ROAD[number].length * DEFAULT_ROAD[number].curvature) / math.pi for number in (1, 3, 5, 7)]
    assert turned == pytest.approx([0.5, 1.0, 1.0, 1.0])


def test_signs_of_steering_and_force() -> None:
    assert steering_angle(PreviewErrors(0.05, 0.0), PARAMS) > 0.0 > steering_angle(PreviewErrors(-0.05, 0.0), PARAMS)
    assert steering_angle(PreviewErrors(0.0, 0.1), PARAMS) > 0.0 > steering_angle(PreviewErrors(0.0, -0.1), PARAMS)
    assert drive_force(-1.0, 0.0, PARAMS) > 700.0
    assert drive_force(1.0, 0.0, PARAMS) < -700.0
