"""Hardly any room at a known goal: the vehicle parks without contact or refuses; at its goal it is parked at once."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from modelkit.vocabulary import Pose
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from tests.planning.scenes import CAR, least_clearance

pytestmark = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")
WALL = [[10.0, 3.5], [-10.0, 3.5], [-10.0, 2.5], [10.0, 2.5]]
REAR = -4.2 - (CAR.half_length - CAR.centre_ahead)
"""y of the rear of a car that stands in the slot."""


def driven(folder: Path, start: tuple[float, float, float], target: tuple[float, float, float], polygons: Any) -> Any:
    """Return (outcome, reason, duration, poses) of the competition's car among polygons."""
    poses = [dict(zip(("x", "y", "heading"), pose, strict=True)) for pose in (start, target)]
    values = {
        "name": "little-room",
        "car": "tpcap",
        "stop_time": 200,
        "target": poses[1],
        "obstacles": polygons,
        "vehicle": {"body": "kinematic", "start": poses[0]},
        "controller": {"system": "apa", "search": {"active": False}, "plan": {"min_margin": 0.01}},
        "requirements": [],
    }
    file = folder / "little-room.yaml"
    file.write_text(yaml.safe_dump(values))
    scenario = load_scenario(str(file), [])
    ran = run_scenario(scenario, fmu_files("native", lambda text: None), kind="native")
    summary = summarize(ran.recording, scenario, ran.wall_time)
    axes = (ran.recording.signals[f"vehicle.pose.{axis}"].tolist() for axis in ("x", "y", "heading"))
    return summary.outcome, summary.reason, summary.duration, [Pose(*pose) for pose in zip(*axes, strict=True)]


def box(x1: float, x2: float, y1: float, y2: float) -> list[list[float]]:
    return [[x1, y1], [x2, y1], [x2, y2], [x1, y2]]


@pytest.mark.parametrize("off", [0.0, 0.001])
def test_a_car_that_stands_at_its_goal_is_parked_at_once(tmp_path: Path, off: float) -> None:
    outcome, _, duration, poses = driven(tmp_path, (0.0, 0.0, 0.0), (0.0, off, 0.0), [WALL])
    assert outcome == "parked"
    assert duration < 2.0
    assert poses[-1] == poses[0]


@pytest.mark.parametrize("room", [0.0, 0.001, 0.0035, 0.008, 0.03])
def test_behind_the_goal(tmp_path: Path, room: float) -> None:
    neighbours = [box(-3.75, -1.85, -5.3, -0.7), box(1.85, 3.75, -5.3, -0.7)]
    wall = box(-15.0, 15.0, REAR - room - 1.0, REAR - room)
    polygons = [*neighbours, wall, box(-15.0, 15.0, 6.0, 7.0)]
    outcome, reason, _, poses = driven(tmp_path, (-7.0, 2.0, 0.0), (0.0, -4.2, 1.5707963267948966), polygons)
    assert least_clearance(poses[::5], polygons, CAR) > 0.0
    assert outcome == "parked" if room > 0.012 else reason in ("no_path", "blocked")
