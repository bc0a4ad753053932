"""Whether a run depends on the integration step: with half the body step it ends as before.

The same outcome, the same number of manoeuvres, and a final pose within 5 cm and 1 degree. The exceptions are listed
with the decision that changes; the list is checked from both sides.
"""

import math
from pathlib import Path

import pytest

from benchmarks.half_step import (
    RANDOM_BASES,
    RANDOM_RUNS,
    Ending,
    difference,
    drive,
    ending_of,
    first_difference,
    has_body_step,
    random_runs,
    with_half_step,
)
from orchestrator.evaluation.verdict.summary import Event
from orchestrator.inputs.scenario.load_scenario import scenario_names
from orchestrator.simulation.cosim.fmu_files import can_compile
from tests.golden.test_golden import kept

MAX_EXCEPTION_SHARE = 0.05
MAX_SHARE_OF = {"adaptive": 0.08}
"""Scenario -> the share of its random runs that may end differently, where it is larger.

Which manoeuvre follows a stop depends on millimetres there; 9 of 1,000 outcomes differ.
"""
EXCEPTIONS = {
    "preview-geometry": "the sample at which the end of a lap of 172 s is reached",
    "preview-single": "none: it leaves the road, and swings after that",
    "valet-external-slot": "on its way in it goes on along its path, or plans again",
    "valet-parallel": "after move 3 it goes on along its path, or stops for an echo and plans again",
}
"""Scenario -> the decision that changes."""
FEW_RUNS = 12
"""Random runs that each change of the code makes of one scenario."""

pytestmark = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")


def test_an_ending_differs_by_each_of_its_parts() -> None:
    ending = Ending("parked", 2, (1.0, 2.0, math.pi))
    assert difference(ending, ending._replace(pose=(1.04, 2.02, -math.pi + 0.01))) == ""
    assert difference(ending, ending._replace(outcome="failed", manoeuvres=3)) == "outcome"
    assert difference(ending, ending._replace(manoeuvres=3)) == "manoeuvres"
    assert difference(ending, ending._replace(pose=(1.04, 2.04, math.pi))) == "pose"
    assert difference(ending, ending._replace(pose=(1.0, 2.0, math.pi - 0.02))) == "pose"


def test_the_decision_is_the_first_transition_that_differs() -> None:
    def events(*changes: tuple[float, str, str]) -> list[Event]:
        return [Event(t=t, from_=before, to=after, x=0.0, y=0.0, heading=0.0) for t, before, after in changes]

    whole = events((0.0, "IDLE", "FIRST_ARC"), (2.0, "FIRST_ARC", "PARKED"))
    assert first_difference(whole, events((0.0, "IDLE", "FIRST_ARC"), (2.0, "FIRST_ARC", "LOST"))) == (
        "FIRST_ARC to PARKED or LOST"
    )
    assert first_difference(whole, whole[:1]) == "FIRST_ARC to PARKED or no other"
    assert first_difference(whole, events((0.1, "IDLE", "FIRST_ARC"), (2.3, "FIRST_ARC", "PARKED"))) == (
        "time of FIRST_ARC to PARKED"
    )
    assert first_difference(whole, whole) == first_difference([], []) == "no transition differs"


def test_exceptions_are_few_and_none_is_an_example_of_the_readme() -> None:
    text = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
    assert EXCEPTIONS.keys() <= set(scenario_names())
    assert len(EXCEPTIONS) <= MAX_EXCEPTION_SHARE * len(scenario_names())
    assert not [name for name in EXCEPTIONS if name in text.split()]


def test_some_random_runs_end_alike_with_half_the_body_step(tmp_path: Path) -> None:
    runs = random_runs("guo2015-case4", tmp_path, FEW_RUNS)
    assert len(runs.endings) == len({one.pose for one, _ in runs.endings}) == FEW_RUNS
    assert all(one.pose != other.pose for one, other in runs.endings), "the body step has an effect"
    assert runs.different == []


@pytest.mark.release
@pytest.mark.parametrize("name", scenario_names())
def test_a_scenario_ends_alike_with_half_the_body_step(name: str) -> None:
    if not has_body_step(name):
        pytest.skip("a body without mass does not use the body step")
    record = kept()[name]
    whole, half = (
        Ending(record["outcome"], record["manoeuvres"], tuple(record["pose"])),
        ending_of(drive(with_half_step(name))),
    )
    assert (not difference(whole, half)) == (name not in EXCEPTIONS), half


@pytest.mark.release
@pytest.mark.slow
@pytest.mark.parametrize("name", RANDOM_BASES)
def test_random_runs_end_alike_with_half_the_body_step(name: str, tmp_path: Path) -> None:
    runs = random_runs(name, tmp_path)
    share = MAX_SHARE_OF.get(name, MAX_EXCEPTION_SHARE)
    assert len(runs.different) <= share * RANDOM_RUNS, (len(runs.different), runs.different[:10])
