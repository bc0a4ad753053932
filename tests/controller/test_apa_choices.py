"""What a user asks of the assist beside a search: a slot told, one chosen, the way out, going on; scenarios, driven."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from shapely.geometry import box

from controller_fmu.apa.chart import Mode
from controller_fmu.apa.out.moves import CLEAR
from controller_fmu.apa.signals import Family
from modelkit.vocabulary import Pose, Prompt
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from tests.controller.test_apa_pull_out import CAR, outline

pytestmark = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")
REASONS = {
    "apa-slot-too-shallow": "slot_too_shallow",
    "apa-external-slot-occupied": "slot_contradicted",
    "apa-external-slot-nose-in": "slot_not_supported",
}
ENDS = {
    "apa-external-slot": 0.15,
    "apa-external-slot-occupied": 0.9,
    "apa-external-slot-nose-in": 1.0,
    "apa-choose": 0.14,
    "apa-slot-too-shallow": 0.9,
    "apa-pull-out": 0.1,
    "apa-pull-out-right": 0.07,
    "apa-resume": 0.12,
    "apa-switched-on-again": 0.12,
}
"""Scenario -> clearance [m] that it keeps at least."""


@pytest.fixture(scope="module")
def files() -> Any:
    return fmu_files("native", lambda text: None)


def driven(name: str, files: Any, *sets: str) -> Any:
    scenario = load_scenario(name, list(sets))
    ran = run_scenario(scenario, files, kind="native")
    return scenario, ran.recording, summarize(ran.recording, scenario, ran.wall_time)


def seen(recording: Any, signal: str) -> Any:
    return recording.signals[f"controller.{signal}"]


@pytest.mark.parametrize("name", ENDS)
def test_it_ends_as_it_should(name: str, files: Any) -> None:
    scenario, recording, summary = driven(name, files)
    assert summary.outcome == scenario.expected_outcome
    assert recording.signals["vehicle.clearance"].min() > ENDS[name]
    if name in REASONS:
        assert REASONS[name] in summary.reason


def test_without_what_is_told_there_is_no_slot(files: Any, tmp_path: Path) -> None:
    untold = tmp_path / "untold.yaml"
    faults = "faults: [{signal: controller.external_slot.kind, kind: override, value: none}]"
    untold.write_text(f"name: untold\nextends: apa-external-slot\nstop_time: 25\n{faults}\n", encoding="utf-8")
    _, recording, _ = driven(str(untold), files)
    assert not (seen(recording, "apa.mode") == Mode.PARKING_SPACE_APPEARS).any()


@pytest.mark.parametrize(("name", "side", "ahead"), [("apa-pull-out", 1, 4.4), ("apa-pull-out-right", -1, 4.15)])
def test_the_car_is_handed_over_when_its_front_is_clear(name: str, side: int, ahead: float, files: Any) -> None:
    _, recording, _ = driven(name, files)
    x, y, heading = (float(recording.signals[f"vehicle.pose.{part}"][-1]) for part in ("x", "y", "heading"))
    on_the_right = outline(Pose(x, side * y, side * heading), CAR._replace(front=CAR.front + CLEAR))
    assert on_the_right.distance(box(ahead, -30.0, ahead + 4.4, 0.0 if side > 0 else 0.2)) > 0.0
    assert seen(recording, "prompt")[-1] == Prompt.TAKE_OVER
    assert set(np.unique(seen(recording, "apa.family"))) == {Family.NONE, Family.PULL_OUT}


def test_both_slots_are_offered_and_the_one_chosen_is_shown(files: Any) -> None:
    _, recording, _ = driven("apa-choose", files)
    shows = seen(recording, "apa.mode") == Mode.PARKING_SPACE_APPEARS
    assert set(seen(recording, "apa.shown")[shows]) == {1, 2}
    assert set(seen(recording, "apa.offered[1].side")[shows]) == {0}
    assert set(seen(recording, "apa.offered[2].side")[shows]) == {1}
    assert set(seen(recording, "apa.offered[3].kind")[shows]) == {0}


def test_on_it_goes_without_a_new_search_and_in_one_reverse(files: Any) -> None:
    _, recording, _ = driven("apa-resume", files)
    later = recording.t > 50.0
    assert not (seen(recording, "apa.mode")[later] == Mode.PARKING_SPACE_SEARCH).any()
    assert seen(recording, "manoeuvres")[-1] == 1
