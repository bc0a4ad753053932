"""What Zhang 2022 prints, typed from the source: Table 1, equations (2) to (8) and the numbers the page states."""

import math

import pytest

from controller_fmu.common.arc_line_arc import arc_line_arc, largest_radius
from controller_fmu.zhang2022.mpc import FrontAxle, prediction, weights
from controller_fmu.zhang2022.params import ZhangParams
from controller_fmu.zhang2022.path import QuinticPath, Reference, at, through
from controller_fmu.zhang2022.pid import PidState, pid
from controller_fmu.zhang2022.quintic import quintic, shape
from modelkit.vocabulary import Pose
from orchestrator.inputs.scenario.load_scenario import load_scenario

PARAMS = ZhangParams()
AXLE = FrontAxle(2.62, 0.6, 0.5)


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("car.width", 1.820),
        ("car.wheelbase", 2.620),
        ("car.front_overhang", 0.966),
        ("car.rear_overhang", 0.850),
        ("chassis.mass", 1370.0),
    ],
)
def test_table_1(name: str, printed: float) -> None:
    scenario = load_scenario("zhang2022")
    assert scenario.parameters_of("vehicle")[name] == printed
    if name.startswith("car."):
        assert scenario.parameters_of("controller")[name] == printed


@pytest.mark.parametrize(
    ("group", "name", "stated"),
    [
        (PARAMS, "speed", 1.0),
        (PARAMS, "ramp", 0.5),
        (PARAMS, "stop_distance", 0.01),
        (PARAMS.quintic, "radius", 5.0),
        (PARAMS.quintic, "curvature_share", 0.95),
        (PARAMS.mpc, "period", 0.05),
        (PARAMS.mpc, "step_time", 0.1),
        (PARAMS.mpc, "horizon", 12),
        (PARAMS.mpc, "lateral", 100.0),
        (PARAMS.mpc, "heading", 20.0),
        (PARAMS.mpc, "angle", 0.1),
        (PARAMS.mpc, "increment", 1.0),
        (PARAMS.mpc, "corridor", 0.05),
        (PARAMS.mpc, "slack_weight", 1000.0),
        (PARAMS.mpc, "max_iterations", 40),
        (PARAMS.pid, "proportional", 6000.0),
        (PARAMS.pid, "integral", 1000.0),
        (PARAMS.pid, "derivative", 0.0),
        (PARAMS.pid, "limit", 2000.0),
    ],
)
def test_stated_and_chosen_numbers(group: object, name: str, stated: float) -> None:
    assert getattr(group, name) == stated


@pytest.mark.parametrize(("s", "h", "radius"), [(8.5, 2.8, 5.0), (7.0, 2.2, 4.5), (10.0, 3.4, 6.0)])
def test_equations_2_and_3(s: float, h: float, radius: float) -> None:
    found = arc_line_arc(s, h, radius)
    th, line = found.angle, found.line
    assert 2.0 * radius * math.sin(th) + line * math.cos(th) == pytest.approx(s)
    assert 2.0 * radius * (1.0 - math.cos(th)) + line * math.sin(th) == pytest.approx(h)
    assert arc_line_arc(s, h, largest_radius(s, h) * (1.0 - 1e-12)).line == pytest.approx(0.0, abs=1e-4)


def test_equations_4_and_5_with_zero_curvature_at_both_ends() -> None:
    piece = quintic(1.0, 0.5, 0.2, 4.0, 2.0, -0.1)
    for x, y, slope in ((1.0, 0.5, 0.2), (4.0, 2.0, -0.1)):
        assert shape(piece, x) == pytest.approx((y, slope, 0.0), abs=1e-12)
    step = 1e-4
    near = [shape(piece, 2.2 + k * step) for k in (-1, 0, 1)]
    assert near[1].slope == pytest.approx((near[2].y - near[0].y) / (2.0 * step), abs=1e-6)
    bend = (near[2].slope - near[0].slope) / (2.0 * step)
    assert near[1].curvature == pytest.approx(bend / (1.0 + near[1].slope ** 2) ** 1.5, abs=1e-6)


def at_distance(path: QuinticPath, x: float, way: float) -> float:
    """Return x [m] after ``way`` [m] in reverse along the path, in steps of 1 mm."""
    for _ in range(round(way / 1e-3)):
        x -= 1e-3 / math.sqrt(1.0 + at(path, x).slope ** 2)
    return x


def test_equation_6_linearised_over_a_step() -> None:
    path = through(Pose(8.5, 2.8, 0.0), arc_line_arc(8.5, 2.8, 6.0))
    stages = prediction(path, Reference(Pose(7.0, 2.6, 0.2)), -0.8, AXLE, PARAMS.mpc)
    x, way = 7.0, 0.08
    for number, stage in enumerate(stages):
        middle = at_distance(path, x, (number + 0.5) * way)
        assert stage.r == pytest.approx(math.atan(2.62 * at(path, middle).curvature), abs=2e-3)
        g = -0.08 / (2.62 * math.cos(stage.r) ** 2)
        assert (stage.a, stage.g, stage.c, stage.on) == pytest.approx((-0.08, g, -0.04 * g, 1.0))
    slow = prediction(path, Reference(Pose(7.0, 2.6, 0.2)), 0.0, AXLE, PARAMS.mpc)
    assert slow[0].a == pytest.approx(-0.02)
    assert len(stages) == 12
    assert weights(AXLE, PARAMS.mpc)[:8] == pytest.approx((100.0, 20.0, 0.1, 1.0, 1000.0, 0.05, 0.6, 0.05))


def test_equations_7_and_8() -> None:
    p = PARAMS.pid._replace(derivative=300.0)
    state = pid(PidState(), 0.1, p, 0.01)
    assert state.force == pytest.approx(6000.0 * 0.1 + 1000.0 * 0.001)
    state = pid(state, 0.12, p, 0.01)
    assert state.force == pytest.approx(6000.0 * 0.12 + 1000.0 * 0.0022 + 300.0 * 2.0)
    assert pid(state, 1.0, p, 0.01).force == 2000.0
    assert pid(state, -9.0, p, 0.01).force == -2000.0
