"""The study of slots at all angles: its cases, and a study beside single runs of the same."""

import math
from typing import Any

import numpy as np
import pytest
from shapely import union_all
from shapely.geometry import Polygon

from controller_fmu.parking.chart import ParkingPhase
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.obstacle_map import box_corners, map_of
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from orchestrator.studies.parking import detected_slot_study
from orchestrator.studies.parking.detected_slot_cases import cases as slots
from orchestrator.studies.parking.detected_slot_scenarios import out_of, scenario_of
from orchestrator.studies.sweep.in_memory import columns_in_memory

pytestmark = pytest.mark.skipif(not can_compile(), reason="runs without Python need a C compiler: pip install ziglang")


def boxes_of(scenario: Any) -> Any:
    found: dict[int, dict[str, Any]] = {}
    for name, value in scenario.vehicle.items():
        if name.startswith("scene.boxes["):
            number, _, field = name[len("scene.boxes[") :].partition("].")
            found.setdefault(int(number), {})[field] = value
    return [Polygon(box_corners(box)) for box in found.values()]


def test_the_slot_is_free_and_the_map_has_what_stands_there() -> None:
    for case in slots(200)[::7]:
        scenario = scenario_of(case, reported=True)
        slot, things, known = scenario.slot, boxes_of(scenario), map_of(scenario)
        assert slot is not None
        around = Polygon(box_corners({name: getattr(slot, name) for name in ("x", "y", "heading", "length", "width")}))
        if case.neighbours != "misaligned" and case.end != "shallow":
            assert union_all(things).intersection(around).area < 1e-6
        points = 4 * len(things) + (2 if case.end in ("kerb", "wheel stop") else 0)
        assert f"map[{points}].polygon" in known
        assert f"map[{points + 1}].polygon" not in known
        assert scenario.target is not None
        assert scenario.controller["target.heading"] == scenario.target.heading


def test_a_row_of_the_study_is_the_run_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = [slots(60)[number] for number in (3, 40)]
    monkeypatch.setattr(detected_slot_study, "cases", lambda runs, lot: chosen)
    columns = columns_in_memory(detected_slot_study.study(reported=True))
    files = fmu_files("native", lambda text: None)
    for place, case in enumerate(chosen):
        scenario = scenario_of(case, reported=True)
        scenario = scenario.model_copy(update={"controller": scenario.controller | map_of(scenario)})
        ran = run_scenario(scenario, files, kind="native")
        summary = summarize(ran.recording, scenario, ran.wall_time)
        assert columns["outcome"][place] == summary.outcome == "parked"
        assert columns["duration"][place] == summary.duration
        assert columns["final.x"][place] == summary.final.x
        assert columns["min_clearance"][place] == np.min(ran.recording.signals["vehicle.clearance"])
        assert columns["plans"][place] == ran.recording.signals["controller.apa.plans"][-1]


def test_out_of_a_slot_the_car_hands_over_along_the_street() -> None:
    case = next(case for case in slots(20) if case.angle == 60)
    scenario = out_of(case).model_copy(update={"controller": out_of(case).controller | map_of(out_of(case))})
    ran = run_scenario(scenario, fmu_files("native", lambda text: None), kind="native").recording
    assert ran.signals["controller.phase"][-1] == ParkingPhase.PARKED
    assert ran.signals["vehicle.clearance"].min() > 0.02
    assert abs(math.sin(ran.signals["vehicle.pose.heading"][-1])) < math.sin(math.radians(3.0))
    assert scenario.target is not None
    assert ran.signals["vehicle.pose.y"][-1] == pytest.approx(scenario.target.y, abs=0.15)
    assert ran.signals["vehicle.pose.y"][-1] * case.side > 1.0


@pytest.mark.parametrize("number", [286, 414])
def test_the_nose_keeps_its_margin_where_the_wheel_turns_on_the_move(number: int) -> None:
    """Both touched a post with the nose, with 12 cm planned: the rear axle was no more than 2 cm off its path."""
    case = slots(number + 1, 5)[number]
    scenario = out_of(case).model_copy(update={"controller": out_of(case).controller | map_of(out_of(case))})
    ran = run_scenario(scenario, fmu_files("native", lambda text: None), kind="native").recording
    assert ran.signals["controller.phase"][-1] == ParkingPhase.PARKED
    assert ran.signals["controller.apa.margin"].max() == pytest.approx(0.12)
    assert ran.signals["vehicle.clearance"].min() > 0.045
