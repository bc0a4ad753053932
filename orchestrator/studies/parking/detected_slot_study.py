"""Slot detection and parking at all angles: slot types, neighbours, walls, roads, search paths."""

from pathlib import Path
from typing import Any

from rich.table import Table as Printed

from orchestrator.evaluation.verdict.outcome import BEYOND
from orchestrator.inputs.scenario.obstacle_map import map_of
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import console, result_table
from orchestrator.studies.parking.detected_slot_cases import DetectedSlotCase, cases
from orchestrator.studies.parking.detected_slot_scenarios import out_of, scenario_of
from orchestrator.studies.parking.system_signals import plan_measures
from orchestrator.studies.sweep.study.cases import LabelledScenario, design_of
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.table import Table

FACTORS = ("angle", "neighbours", "end", "street", "wish")
WAY = "way"
"""A run with this shows whether there is a path."""
PLANNING_TIME = 10.0


def study(runs: int = 1000, lot: int = 0, reported: bool = False, out: bool = False, ways: bool = False) -> Study:
    """Return so many runs; ``reported``: the same with the map and the target given, no search: what could be parked.

    ``out``: the car stands in the slot, receives the map, and comes out to either side. ``ways``: behind every run a
    short one in which the system receives the map and has ``PLANNING_TIME`` seconds to plan: whether a path exists.
    """
    scenarios = []
    for case in cases(runs, lot):
        scenario = out_of(case) if out else scenario_of(case, reported)
        scenario = _with_map(scenario) if reported or out else scenario
        scenarios.append(LabelledScenario(_labels(case, ""), scenario))
        if ways:
            scenarios.append(LabelledScenario(_labels(case, WAY), _planning_scenario(case)))
    scenario, design = design_of(scenarios)
    content = {
        "name": "valet-slots",
        "title": "Slot detection: kinds, angles, neighbours, walls, roads, sides, search paths",
        "description": "Parked: heading and lateral position within GB/T 41630, no contact. No external slot.",
        "map": {"x": "angle", "y": "neighbours", "split": "end"},
    }
    return Study(scenario, design, content, measures=plan_measures())


def _planning_scenario(case: DetectedSlotCase) -> Scenario:
    """Return the short scenario in which the system plans with map and target known."""
    reported = _with_map(scenario_of(case, reported=True))
    return reported.model_copy(
        update={"stop_time": PLANNING_TIME, "controller": reported.controller | {"plan.steps_per_sample": 100}}
    )


def _with_map(scenario: Scenario) -> Scenario:
    """Return the scenario with its map."""
    return scenario.model_copy(update={"controller": scenario.controller | map_of(scenario)})


def _labels(case: DetectedSlotCase, of: str) -> dict[str, str | float]:
    own = {name: str(value) if isinstance(value, bool) else value for name, value in case._asdict().items()}
    return {**own, "of": of}


def report(table: Table, folder: Path) -> int:
    """Print how many parked by each factor, and why others did not. Returns 1 if a run touched something.

    With ``ways`` shares are of the slots for which there is a path.
    """
    names = (*FACTORS, "number", "of", "outcome", "reason", "min_clearance", "margin")
    every = [dict(zip(names, row, strict=True)) for row in zip(*(table.column(name) for name in names), strict=True)]
    rows = [row for row in every if row["of"] != WAY]
    planned = {row["number"] for row in every if row["of"] == WAY and row["margin"] > 0.0}
    for row in rows:
        row["way"] = row["number"] in planned or len(every) == len(rows)
    for factor in FACTORS:
        console().print(_by(rows, factor))
    for reason in sorted({str(row["reason"]) for row in rows if row["outcome"] != "parked"}):
        count = sum(row["reason"] == reason and row["outcome"] != "parked" for row in rows)
        console().print(f"{count} not parked: {reason}")
    touched = sum(row["min_clearance"] <= 0.0 for row in rows)
    parked = sum(row["outcome"] == "parked" for row in rows)
    if len(every) > len(rows):
        console().print(f"{len(planned)} slots with a path on the exact map")
    counts = f"{len(rows)} runs, {parked} parked, {touched} with contact"
    console().print(f"{counts}; {_gbt(rows)} of those that stand in a slot")
    return 1 if touched else 0


def _by(rows: list[dict[str, Any]], factor: str) -> Printed:
    table = result_table(console(), (factor, "runs", "with a path", "parked", "GB/T 41630", "contact"))
    for value in sorted({row[factor] for row in rows}):
        own = [row for row in rows if row[factor] == value]
        ways = [row for row in own if row["way"]]
        parked = sum(row["outcome"] == "parked" for row in ways)
        share = f"{100.0 * parked / len(ways):.1f} %" if ways else ""
        touched = sum(row["min_clearance"] <= 0.0 for row in own)
        table.add_row(f"{value}", f"{len(own)}", f"{len(ways)}", share, _gbt(own), f"{touched}")
    return table


def _gbt(rows: list[dict[str, Any]]) -> str:
    """Return how many of those that the system says are parked stand as GB/T 41630 asks."""
    stand = [row for row in rows if row["outcome"] == "parked" or str(row["reason"]).startswith(BEYOND)]
    good = sum(row["outcome"] == "parked" for row in stand)
    return f"{100.0 * good / len(stand):.1f} %" if stand else ""
