"""Pulling out of parallel and perpendicular slots, to either side."""

from collections import Counter
from pathlib import Path
from typing import NamedTuple

import numpy as np
from rich.table import Table as Printed

from modelkit.vocabulary import Pose
from orchestrator.evaluation.verdict.measures import Instants, Measure
from orchestrator.inputs.scenario.car import car_parameters
from orchestrator.inputs.scenario.fault import Fault
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import console, result_table
from orchestrator.studies.parking.cases import CARS, KINDS
from orchestrator.studies.parking.pull_out_cases import PullOutCase, case_labels, case_of, cases, side_of, vehicle_of
from orchestrator.studies.parking.pull_out_feasibility import free_ahead, is_way_out
from orchestrator.studies.parking.system_signals import APA_SYSTEM, PARKING_TIME
from orchestrator.studies.sweep.fields import find_field
from orchestrator.studies.sweep.study.cases import LabelledScenario, design_of
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.table import Table

STOP_TIME = 150.0
STANDSTILL_SPEED = 0.01
FREE_AHEAD = 3.5
"""A car is handed over with so much free ahead [m]; the assist asks for 4 m by its map."""
MEASURES = {
    "parking_time": Measure("last", PARKING_TIME),
    "touched.speed": Measure("first", "vehicle.speed", Instants("vehicle.contact", (1,))),
}


class OutRun(NamedTuple):
    """What became of a run."""

    case: PullOutCase
    is_out: bool
    reason: str
    nearest: float
    driven: bool
    """Touched something while it drove."""
    manoeuvres: int
    seconds: float
    ahead: float
    """Free ahead of the car where it ended [m]."""
    way: bool
    """Whether there is a way out; not looked for if the car came out."""


def scenario_of(case: PullOutCase) -> Scenario:
    """Return the scenario of a case: the driver wants out, to the side of the case."""
    return Scenario(
        name="apa-out",
        stop_time=STOP_TIME,
        task="drive",
        vehicle=vehicle_of(case),
        controller={**car_parameters(CARS[case.car]), "system": APA_SYSTEM},
        faults=[
            Fault(signal="controller.driver_selection.task", kind="override", value="pull_out"),
            Fault(signal="controller.driver_selection.side", kind="override", value="left"),
        ],
        requirements=[*library_requirements("no-contact")],
    )


def study(runs: int = 400, lot: int = 0) -> Study:
    """Return so many runs."""
    chosen = cases(runs, lot)
    scenario, design = design_of(LabelledScenario(case_labels(case), scenario_of(case)) for case in chosen)
    side = np.array([[float(side_of(case))] for case in chosen])
    field = find_field("faults[2].value", scenario)
    design = design._replace(fields=[*design.fields, field], values=np.hstack([design.values, side]))
    content = {
        "name": "apa-out",
        "title": "Pulling out of parallel and perpendicular slots, to either side",
        "description": "Finished: the driver is prompted to take over, no contact.",
        "map": {"x": "extra", "y": "behind", "split": "kind"},
        "lot": lot,
    }
    return Study(scenario, design, content, measures=MEASURES)


def outs(table: Table) -> list[OutRun]:
    """Return what became of each run of a table."""
    columns = {name: table.column(name) for name in table.names()}
    found = []
    for row in range(len(columns["number"])):
        number, lot = int(columns["number"][row]), int(columns["lot"][row])
        case = case_of(number, lot)
        out = str(columns["outcome"][row]) == "finished"
        end = Pose(*(float(columns[f"final.{name}"][row]) for name in ("x", "y", "heading")))
        nearest, driven = (
            float(columns["min_clearance"][row]),
            abs(float(columns["touched.speed"][row])) > STANDSTILL_SPEED,
        )
        numbers = (nearest, driven, int(columns["manoeuvres"][row]), float(columns["duration"][row]))
        reason, way = str(columns["reason"][row]), out or is_way_out(case)
        found.append(OutRun(case, out, reason, *numbers, free_ahead(case, end), way))
    return found


def report(table: Table, folder: Path) -> int:
    """Print how many came out of those slots that there is a way out of.

    Returns 1 if one drove against something, or was handed over with its front not clear.
    """
    found, to = outs(table), console()
    to.print(_by_room(found))
    for run in found:
        if not run.is_out and run.way:
            where = f"{KINDS[run.case.kind]} +{run.case.extra:.2f} m, {run.case.behind} {run.case.beside:.2f} m"
            text = f"run {run.case.number}: {where}, {run.case.car}: {run.reason}; a path exists"
            to.print(text, highlight=False, soft_wrap=True)
    for reason, count in Counter(run.reason for run in found if not run.is_out).most_common():
        to.print(f"{count} not out: {reason}", highlight=False)
    touched, driven = sum(run.nearest <= 0.0 for run in found), sum(run.driven for run in found)
    early = sum(run.is_out and run.ahead < FREE_AHEAD for run in found)
    out, feasible = sum(run.is_out for run in found), sum(run.way for run in found)
    share = f"{100.0 * out / max(feasible, 1):.1f} %"
    text = f"{len(found)} runs, {feasible} with a path, {out} out ({share}), {touched} with contact"
    text += f" ({driven} while they drove)" if touched else ""
    to.print(f"{text}, {early} handed to the driver too early", highlight=False)
    return 1 if driven or early else 0


def _by_room(found: list[OutRun]) -> Printed:
    """Return how many came out by kind and room."""
    titles = ("room", "runs", "with a path", "out", "manoeuvres", "clearance", "longest")
    table = result_table(console(), titles, ("room",))
    for kind, low in sorted({(run.case.kind, 0.5 * int(2.0 * run.case.extra)) for run in found}):
        own = [run for run in found if run.case.kind == kind and low <= run.case.extra < low + 0.5]
        out = sorted((run for run in own if run.is_out), key=lambda run: run.manoeuvres)
        ends = (f"{out[len(out) // 2].manoeuvres} (most {out[-1].manoeuvres})",) if out else ("",)
        table.add_row(
            f"{KINDS[kind]}, {low:.1f} to {low + 0.5:.1f} m",
            *map(str, (len(own), sum(run.way for run in own), len(out))),
            *ends,
            f"{100.0 * min(run.nearest for run in own):.0f} cm",
            f"{max(run.seconds for run in own):.0f} s",
        )
    return table
