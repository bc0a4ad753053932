"""The study of slots in rows: its cases, and a study of the valet beside single runs of the same."""

import math
from typing import Any

import numpy as np
import pytest
from shapely import union_all
from shapely.geometry import Polygon

from orchestrator.cosim.fmu_files import can_compile, fmu_files
from orchestrator.grid.slot_rows import cases, scenario_of, study
from orchestrator.scenario.polygons import box_corners
from orchestrator.session.session import run_scenario
from orchestrator.sweep.in_memory import columns_in_memory
from orchestrator.verdict.summary import summarize

pytestmark = pytest.mark.skipif(not can_compile(), reason="runs without Python need a C compiler: pip install ziglang")


def boxes_of(scenario: Any) -> Any:
    found: dict[int, dict[str, Any]] = {}
    for name, value in scenario.vehicle.items():
        if name.startswith("scene.boxes["):
            number, _, field = name[len("scene.boxes[") :].partition("].")
            found.setdefault(int(number), {})[field] = value
    return [Polygon(box_corners(box)) for box in found.values()]


def test_the_slot_is_free_and_the_map_has_what_stands_there() -> None:
    assert len(cases()) == 480
    for case in cases()[::13]:
        scenario = scenario_of(case)
        slot, things = scenario.slot, boxes_of(scenario)
        assert slot is not None
        around = Polygon(box_corners({name: getattr(slot, name) for name in ("x", "y", "heading", "length", "width")}))
        assert union_all(things).intersection(around).area < 1e-6
        assert scenario.controller["map[24].polygon"] == 6
        assert "map[25].polygon" not in scenario.controller
        assert scenario.controller["slot.bx"] * math.sin(-scenario.controller["slot.heading"]) == pytest.approx(
            slot.width
        )


def test_a_row_of_the_study_is_the_run_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = [cases()[number] for number in (40, 330)]
    monkeypatch.setattr("orchestrator.grid.slot_rows.cases", lambda lot: chosen)
    columns = columns_in_memory(study())
    files = fmu_files("native", lambda text: None)
    for place, case in enumerate(chosen):
        scenario = scenario_of(case)
        ran = run_scenario(scenario, files, kind="native")
        summary = summarize(ran.recording, scenario, ran.wall_time)
        assert columns["outcome"][place] == summary.outcome == "parked"
        assert columns["duration"][place] == summary.duration
        assert columns["final.x"][place] == summary.final.x
        assert columns["min_clearance"][place] == np.min(ran.recording.signals["vehicle.clearance"])
        assert columns["plans"][place] == 1.0
