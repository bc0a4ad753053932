"""Slots that the valet has to find, as a study, and what it prints."""

from pathlib import Path
from typing import Any

from rich.table import Table as Printed

from orchestrator.grid.found_scenarios import out_of, scenario_of
from orchestrator.grid.found_slots import FoundCase, cases
from orchestrator.scenario.polygons import map_of
from orchestrator.sweep.study.cases import LabelledScenario, design_of
from orchestrator.sweep.study.study import Study
from orchestrator.sweep.table import Table
from orchestrator.text.console import console
from orchestrator.verdict.measures import Measure

MEASURES = {
    "plans": Measure("last", "controller.valet.plans"),
    "margin": Measure("last", "controller.valet.margin"),
    "layout": Measure("last", "controller.valet.slot.layout"),
    "into": Measure("last", "controller.valet.slot.heading"),
    "width": Measure("last", "controller.valet.slot.width"),
    "depth": Measure("last", "controller.valet.slot.depth"),
    "ax": Measure("last", "controller.valet.slot.ax"),
    "ay": Measure("last", "controller.valet.slot.ay"),
    "target_x": Measure("last", "controller.valet.target.x"),
    "target_y": Measure("last", "controller.valet.target.y"),
}


def study(runs: int = 1000, lot: int = 0, told: bool = False, out: bool = False) -> Study:
    """Return so many runs; ``told``: the same with the map and the target told, no search: what could be parked.

    ``out``: the car stands in the slot, is told the map, and comes out to either side.
    """
    chosen = cases(runs, lot)
    scenarios = []
    for case in chosen:
        scenario = out_of(case) if out else scenario_of(case, told)
        if told or out:
            scenario = scenario.model_copy(update={"controller": scenario.controller | map_of(scenario)})
        scenarios.append(LabelledScenario(_labels(case), scenario))
    scenario, design = design_of(scenarios)
    content = {
        "name": "valet-slots",
        "title": "Slots that the valet finds: kinds, angles, neighbours, ends, streets, sides, ways past",
        "description": "Parked: turned and beside as GB/T 41630 allows, no contact; the sensors alone tell the slot.",
        "map": {"x": "angle", "y": "neighbours", "split": "end"},
    }
    return Study(scenario, design, content, measures=MEASURES)


def _labels(case: FoundCase) -> dict[str, str | float]:
    return {name: str(value) if isinstance(value, bool) else value for name, value in case._asdict().items()}


def report(table: Table, folder: Path) -> int:
    """Print how many parked by each factor, and why others did not. Returns 1 if a run touched something."""
    names = ("angle", "neighbours", "end", "street", "wish", "outcome", "reason", "min_clearance")
    rows = [dict(zip(names, row, strict=True)) for row in zip(*(table.column(name) for name in names), strict=True)]
    for factor in names[:5]:
        console().print(_by(rows, factor))
    for reason in sorted({str(row["reason"]) for row in rows if row["outcome"] != "parked"}):
        count = sum(row["reason"] == reason and row["outcome"] != "parked" for row in rows)
        console().print(f"{count} not parked: {reason}")
    touched = sum(row["min_clearance"] <= 0.0 for row in rows)
    console().print(f"{len(rows)} runs, {sum(row['outcome'] == 'parked' for row in rows)} parked, {touched} touched")
    return 1 if touched else 0


def _by(rows: list[dict[str, Any]], factor: str) -> Printed:
    table = Printed(box=None, pad_edge=False)
    for name in (factor, "runs", "parked", "touched"):
        table.add_column(name, justify="right")
    for value in sorted({row[factor] for row in rows}):
        own = [row for row in rows if row[factor] == value]
        parked = sum(row["outcome"] == "parked" for row in own)
        table.add_row(
            f"{value}",
            f"{len(own)}",
            f"{100.0 * parked / len(own):.1f} %",
            f"{sum(r['min_clearance'] <= 0 for r in own)}",
        )
    return table
