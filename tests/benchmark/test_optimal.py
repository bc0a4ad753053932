"""The time-optimal motion: distances against shapely, motions whose optimum is known, what makes an optimum invalid."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from shapely.geometry import LineString, Polygon

from orchestrator.cli import main
from orchestrator.evaluation.verdict.geometry import edges
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from orchestrator.studies.benchmark.driving import KINEMATIC, drive_scene
from orchestrator.studies.benchmark.optimal import reference
from orchestrator.studies.benchmark.optimal.motion import (
    MotionLimits,
    TimedMotion,
    derivatives,
    drive_through,
    integrate_motion,
)
from orchestrator.studies.benchmark.optimal.outline_distance import measure_gaps
from orchestrator.studies.benchmark.optimal.reference import find_optimum
from orchestrator.studies.benchmark.optimal.search import optimize, violations
from orchestrator.studies.benchmark.parkbench import read_parkbench
from tests.benchmark.parkbench_scene import scene, write
from tests.report.test_page import data_of

LIMITS = MotionLimits(
    speed=0.8,
    acceleration=1.5,
    deceleration=0.5,
    wheel_angle=0.7,
    wheel_rate=0.5,
    wheelbase=2.8,
    clearance=0.1,
    half_length=2.3,
    half_width=0.95,
    ahead=1.4,
)
NO_EDGES = np.empty((0, 2, 2))
NATIVE = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")


def straight(length: float, duration: float, count: int = 40) -> TimedMotion:
    """Return a motion at constant speed along x, which neither starts nor ends at standstill."""
    states = np.zeros((count + 1, 5))
    states[:, 0] = np.linspace(0.0, length, count + 1)
    states[1:-1, 3] = length / duration
    return TimedMotion(states, np.zeros((count, 2)), np.array([duration]), np.zeros(count, dtype=int), np.array([1.0]))


def test_distances_are_those_of_shapely_and_their_derivatives_those_of_differences() -> None:
    draw = np.random.default_rng(1)
    poses = np.column_stack([draw.uniform(-3.0, 3.0, (60, 2)), draw.uniform(-3.0, 3.0, 60)])
    edges = draw.uniform(-6.0, 6.0, (60, 6, 1, 2)) + draw.uniform(-1.0, 1.0, (60, 6, 2, 2))
    found = measure_gaps(poses, edges, LIMITS)
    front, rear, half = LIMITS.ahead + LIMITS.half_length, LIMITS.half_length - LIMITS.ahead, LIMITS.half_width
    for (x, y, h), own, distances in zip(poses, edges, found.distance, strict=True):
        c, s = math.cos(h), math.sin(h)
        corners = [(front, half), (-rear, half), (-rear, -half), (front, -half)]
        outline = Polygon([(x + u * c - v * s, y + u * s + v * c) for u, v in corners])
        for edge, distance in zip(own, distances, strict=True):
            assert max(distance, 0.0) == pytest.approx(LineString(edge).distance(outline), abs=1e-9)
            assert (distance < 0.0) == LineString(edge).intersects(outline)
    assert 20 < (found.distance < 0.0).sum() < 120
    for axis in range(3):
        step = 1e-6 * np.eye(3)[axis]
        ends = [measure_gaps(poses + sign * step, edges, LIMITS).distance for sign in (1.0, -1.0)]
        assert (ends[0] - ends[1]) / 2e-6 == pytest.approx(found.gradient[..., axis], abs=1e-6)


def test_a_wall_is_one_side_and_a_polygon_is_closed() -> None:
    assert [side[:4] for side in edges([[(0.0, 1.0), (2.0, 1.0)]])] == [(0.0, 1.0, 2.0, 1.0)]
    assert [side[:2] for side in edges([[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]])] == [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]


def test_derivatives_by_the_duration_of_a_move_leave_the_others_alone() -> None:
    motion = straight(4.0, 10.0, 10)._replace(
        durations=np.array([4.0, 6.0]), move_of=np.repeat([0, 1], 5), gears=np.array([1.0, 1.0])
    )
    slopes = derivatives(motion, LIMITS.wheelbase)[-1, :, 0, -1]
    assert slopes == pytest.approx(motion.states[:-1, 3] / 5.0, abs=1e-6)
    longer = motion._replace(durations=motion.durations + np.array([0.0, 0.5]))
    moved = integrate_motion(longer, LIMITS.wheelbase)[-1, :, 0] - integrate_motion(motion, LIMITS.wheelbase)[-1, :, 0]
    assert moved[:5].tolist() == [0.0] * 5
    assert moved[5:] == pytest.approx(0.5 * slopes[5:])


def test_a_straight_line_takes_what_its_limits_leave() -> None:
    """Speed up at 1.5, cruise at 0.8, slow down at 0.5: length over speed plus half of both ramps."""
    found = optimize(straight(8.0, 30.0), NO_EDGES, LIMITS)
    expected = 8.0 / 0.8 + 0.5 * 0.8 / 1.5 + 0.5 * 0.8 / 0.5
    assert expected <= found.duration <= expected + 0.35, "an interval cannot change its input within"
    assert violations(found, NO_EDGES, LIMITS)[0] < 1e-4
    path = drive_through(found, LIMITS.wheelbase, 10)
    assert path[-1] == pytest.approx([8.0, 0.0, 0.0, 0.0, 0.0], abs=1e-3)
    assert path[:, 3].max() <= 0.8 + 1e-9
    rates = np.diff(found.states[:, 3]) / found.intervals[:, 0]
    assert rates.max() <= 1.5 + 1e-6
    assert rates.min() >= -0.5 - 1e-6


def test_the_optimum_passes_an_obstacle_at_the_margin() -> None:
    """A wall reaches 5 cm into the swept lane: the path bends around its end, and no more than that."""
    wall = np.array([[[6.0, -3.0], [6.0, -LIMITS.half_width + 0.05]]])
    found = optimize(straight(12.0, 30.0, 60), wall, LIMITS)
    path = drive_through(found, LIMITS.wheelbase, 10)
    gaps = measure_gaps(path[:, :3], np.broadcast_to(wall, (len(path), 1, 2, 2)), LIMITS).distance
    assert 0.09 <= gaps.min() <= 0.12
    assert path[-1, :3] == pytest.approx([12.0, 0.0, 0.0], abs=2e-3)
    assert 0.1 < path[:, 1].max() < 0.4
    straight_on = optimize(straight(12.0, 30.0, 60), NO_EDGES, LIMITS)
    assert straight_on.duration <= found.duration + 1e-3 < straight_on.duration + 0.6


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("scene")
    (folder / "own.yaml").write_text(yaml.safe_dump(read_parkbench(write(folder / "own.json", scene()))))
    ran = drive_scene(str(folder / "own.yaml"), KINEMATIC, fmu_files("native"), "native")[1]
    found: list[TimedMotion] = []

    def kept(*given: Any) -> TimedMotion:
        found.append(optimize(*given))
        return found[0]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reference, "optimize", kept)
        optimum = find_optimum(ran.scenario, ran.recording)
    return folder / "own.yaml", ran, optimum, found[0]


@NATIVE
def test_a_drive_is_compared_with_its_optimum(
    drive: Any, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, ran, optimum, motion = drive
    monkeypatch.setattr(reference, "optimize", lambda *_: motion)
    assert optimum.is_valid, optimum.reason
    assert 1.0 < optimum.time_ratio < 2.0
    assert 0.5 < optimum.length_ratio < 1.5
    assert optimum.clearance >= 0.08
    assert optimum.poses[-1] == pytest.approx(ran.scenario.target.pose, abs=0.01)
    assert main(["bench", "optimal", str(file), "--out", str(tmp_path / "a"), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["duration"] == pytest.approx(optimum.duration)
    shown, _ = data_of((tmp_path / "a" / "report.html").read_text())
    assert any(f"time {optimum.time_ratio:.2f}" in text for _, text in shown["facts"])
    assert len(shown["runs"][0]["scene"]["optimum"]) == len(optimum.poses)
    table = ["bench", "parking", str(file), "--body", KINEMATIC, "--optimal", "--out", str(tmp_path / "b")]
    assert main(table) == 0
    printed = capsys.readouterr().out
    assert f"1 valid optima, median of driven over optimal time {optimum.time_ratio:.2f}" in printed
    assert main(table) == 0, "from the row that was kept"
    assert capsys.readouterr().out == printed


@NATIVE
@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda motion: motion._replace(inputs=motion.inputs * [1.0, 0.9]), "from the goal"),
        (lambda motion: motion._replace(durations=3.0 * motion.durations, inputs=motion.inputs / 3.0), "goal|slower"),
    ],
)
def test_an_optimum_that_cannot_be_driven_has_no_figures(
    drive: Any, change: Any, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, ran, _, motion = drive
    monkeypatch.setattr(reference, "optimize", lambda *_: change(motion))
    optimum = find_optimum(ran.scenario, ran.recording)
    assert not optimum.is_valid
    assert math.isnan(optimum.duration)
    assert math.isnan(optimum.time_ratio)
    assert any(word in optimum.reason for word in said.split("|"))


@NATIVE
def test_a_solution_that_passes_through_a_wall_is_invalid(
    drive: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """A wall stands in the way of the optimum that the solver does not know; the check between the knots is."""
    file, ran, found, motion = drive
    x, y, heading = found.poses[len(found.poses) // 2]
    beside = [(x + 0.9 * math.sin(heading) * side, y - 0.9 * math.cos(heading) * side) for side in (1.0, 1.1)]
    monkeypatch.setattr(reference, "optimize", lambda *_: motion)
    monkeypatch.setattr(reference, "obstacles_of_map", lambda _: [beside])
    optimum = find_optimum(ran.scenario, ran.recording)
    assert "of an obstacle between its knots" in optimum.reason
    assert main(["bench", "optimal", str(file), "--out", str(tmp_path / "a")]) == 1
    assert "no valid optimum: comes within" in capsys.readouterr().out
    assert json.loads((tmp_path / "a" / "optimal.json").read_text())["time_ratio"] is None


@NATIVE
def test_what_has_no_optimum_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "optimal", "guo2015-case4", "--out", str(tmp_path)]) == 2
    assert "expected a drive of the parking system" in capsys.readouterr().err
    assert main(["bench", "parking", "--optimal", "--body", "double_track", "--out", str(tmp_path)]) == 2
    assert "add --body kinematic" in capsys.readouterr().err
