"""Whether a run depends on the integration step: with half the body step it ends as before.

The same outcome, the same number of manoeuvres, and a final pose within 5 cm and 1 degree. The exceptions are listed
with the decision that changes; the list is checked from both sides.
"""

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from orchestrator.studies.sweep.study.read_study import bind
from orchestrator.studies.sweep.study.study_file import StudyFile
from orchestrator.studies.sweep.sweep import Options, sweep
from orchestrator.studies.sweep.table import Table
from tests.golden.test_golden import kept, reported
from vehicle_fmu.interface import VehicleParams

MAX_POSITION_CHANGE = 0.05
MAX_HEADING_CHANGE = math.radians(1.0)
MAX_EXCEPTION_SHARE = 0.05
BODY_STEP = VehicleParams().body_step
EXCEPTIONS = {
    "apa-parallel-real": "after the first move the car counts as in place, or moves forward to the middle once more",
    "apa-pull-out-right": "after move 7 the way out counts as free, or one more shuffle is planned",
    "preview-camera": "the camera frame in which the end of a lap of 194 s is reached",
    "preview-geometry": "the sample at which the end of a lap of 172 s is reached",
}
"""Scenario -> the decision that changes."""
RANDOM_RUNS = 1_000
RANDOM_BASES = {
    "guo2015-case4": ("double_track", 0.1),
    "zhang2022-double-track": ("double_track", 0.1),
    "hsic": ("double_track", 0.1),
    "preview": ("single_track", 0.01),
    "adaptive": ("double_track", 0.1),
    "apa-perpendicular-real": ("double_track", 0.1),
}
"""A scenario of each system -> the body with which it is varied, and the largest lateral offset of its starts [m]."""

pytestmark = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")


class Ending(NamedTuple):
    """How a run ended, as far as it must not depend on the step."""

    outcome: str
    manoeuvres: float
    pose: tuple[float, float, float]


def is_same(one: Ending, other: Ending) -> bool:
    """Return whether two runs ended alike."""
    x, y, heading = (a - b for a, b in zip(one.pose, other.pose, strict=True))
    return (
        one[:2] == other[:2]
        and math.hypot(x, y) <= MAX_POSITION_CHANGE
        and abs(math.remainder(heading, math.tau)) <= MAX_HEADING_CHANGE
    )


def recorded_ending(record: dict[str, Any]) -> Ending:
    return Ending(record["outcome"], record["manoeuvres"], tuple(record["pose"]))


def ending_with(name: str, *changes: str) -> Ending:
    scenario = load_scenario(name, list(changes))
    ran = run_scenario(scenario, fmu_files("native", lambda text: None), kind="native")
    return recorded_ending(reported(summarize(ran.recording, scenario, ran.wall_time)))


def test_an_ending_differs_by_each_of_its_parts() -> None:
    ending = Ending("parked", 2, (1.0, 2.0, math.pi))
    assert is_same(ending, ending._replace(pose=(1.04, 2.02, -math.pi + 0.01)))
    assert not is_same(ending, ending._replace(outcome="failed"))
    assert not is_same(ending, ending._replace(manoeuvres=3))
    assert not is_same(ending, ending._replace(pose=(1.04, 2.04, math.pi)))
    assert not is_same(ending, ending._replace(pose=(1.0, 2.0, math.pi - 0.02)))


def test_exceptions_are_few_and_none_is_an_example_of_the_readme() -> None:
    text = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
    assert EXCEPTIONS.keys() <= set(scenario_names())
    assert len(EXCEPTIONS) <= MAX_EXCEPTION_SHARE * len(scenario_names())
    assert not [name for name in EXCEPTIONS if name in text.split()]


@pytest.mark.release
@pytest.mark.parametrize("name", scenario_names())
def test_a_scenario_ends_alike_with_half_the_body_step(name: str) -> None:
    vehicle = load_scenario(name, []).parameters_for("vehicle")
    if not vehicle.get("body"):
        pytest.skip("a body without mass does not use the body step")
    found = ending_with(name, f"vehicle.body_step={0.5 * vehicle.get('body_step', BODY_STEP)}")
    assert is_same(found, recorded_ending(kept()[name])) == (name not in EXCEPTIONS), found


@pytest.mark.release
@pytest.mark.slow
@pytest.mark.parametrize("name", RANDOM_BASES)
def test_random_runs_end_alike_with_half_the_body_step(name: str, tmp_path: Path) -> None:
    whole, half = (random_endings(name, step, tmp_path) for step in (BODY_STEP, 0.5 * BODY_STEP))
    different = [number for number, pair in enumerate(zip(whole, half, strict=True)) if not is_same(*pair)]
    assert len(different) <= MAX_EXCEPTION_SHARE * RANDOM_RUNS, (len(different), different[:10])


def random_endings(name: str, step: float, folder: Path, count: int = RANDOM_RUNS) -> list[Ending]:
    """Return how runs from random starts end with a body step [s]; the starts depend on the scenario alone."""
    start = load_scenario(name, []).parameters_for("vehicle")
    body, offset = RANDOM_BASES[name]
    spread = {
        f"vehicle.start.{axis}": {"uniform": [start.get(f"start.{axis}", 0.0) + sign * half for sign in (-1, 1)]}
        for axis, half in (("x", 0.2), ("y", offset), ("heading", 0.2 * offset))
    }
    fixed = {"vehicle.body": body, "vehicle.body_step": step}
    runs = {"monte_carlo": {"n": count, **spread}}
    study = StudyFile.model_validate({"name": "convergence", "scenario": name, "set": fixed, "seed": 46, "runs": runs})
    table = sweep(bind(study), folder / str(step), Options()).table
    assert table is not None
    columns = Table(table)
    poses = np.column_stack([columns.column(f"final.{axis}") for axis in ("x", "y", "heading")]).tolist()
    outcomes, manoeuvres = (columns.column(key) for key in ("outcome", "manoeuvres"))
    return [
        Ending(str(outcome), float(moves), tuple(pose))
        for outcome, moves, pose in zip(outcomes, manoeuvres, poses, strict=True)
    ]
