"""Controllers that know their slot, in the same slots with the same cars, bodies and disturbances."""

import math
import statistics
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from rich.markup import escape
from rich.table import Table as Printed

from orchestrator.evaluation.verdict.numbers import Metric
from orchestrator.evaluation.verdict.outcome import BEYOND
from orchestrator.inputs.scenario.end_condition import EndCondition
from orchestrator.inputs.text.console import console
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.bakeoff.drives import EXACT, REFUSED, Drive, drives, exact_limits
from orchestrator.studies.bakeoff.entries import CONTROLLERS, SLOTS, entries
from orchestrator.studies.bakeoff.figure import draw
from orchestrator.studies.sweep.study.cases import LabelledScenario, design_of
from orchestrator.studies.sweep.study.study import Columns, DerivedParameter, Study
from orchestrator.studies.sweep.table import Table

CONTENT = {
    "name": "bakeoff",
    "title": "Controllers with a known slot in the same slots",
    "description": "Three slots, two cars, two bodies, three starts, five disturbances. Parked: within GB/T 41630, "
    "no contact.",
    "map": {"x": "slot", "y": "controller", "split": None},
}
FOOTNOTES = (
    "Medians of the parked runs. Refused: no path from this start. Parked: the controller reports it, at standstill "
    "in the slot, within the limits of GB/T 41630, without contact. Exact: also within the lateral and heading limits "
    "of the set project.",
)
HEADS = ("slot [m]", "controller", "runs", "refused", "parked", "exact", "time [s]", "manoeuvres", "lateral [cm]")
MORE = ("heading [deg]", "clearance [m]", "wheel [turns]", "why not")
MEDIANS: tuple[Callable[[Drive], float], ...] = (
    lambda item: item.time,
    lambda item: item.manoeuvres,
    lambda item: 100.0 * abs(item.lateral),
    lambda item: math.degrees(abs(item.heading)),
    lambda item: item.clearance,
    lambda item: item.effort / (2.0 * math.pi),
)
TIME = DerivedParameter(
    {"time": Metric("s", "from the start until the vehicle is parked")}, lambda columns: {"time": _times(columns)}
)


def study() -> Study:
    """Return the whole bake-off."""
    return study_of(list(entries()))


def study_of(cases: list[LabelledScenario]) -> Study:
    """Return the study of some drives."""
    scenario, design = design_of(cases)
    within = {EXACT: list(exact_limits())}
    return Study(scenario, design, CONTENT, within=within, derived=TIME)


def report(table: Table, folder: Path) -> int:
    """Print the comparison and write its picture. Returns 0."""
    found = drives({name: table.column(name) for name in table.names()})
    to = console()
    to.print(_comparison_lines(found))
    for note in FOOTNOTES:
        to.print(f"- {escape(note)}")
    to.print(f"picture in {draw(found, folder / 'bakeoff.png')}", markup=False)
    return 0


def _times(columns: Columns) -> Array:
    times: Array = columns["duration"] - EndCondition().standstill
    return times


def _comparison_lines(found: list[Drive]) -> Printed:
    """Return a line for each slot and controller."""
    table = Printed(box=None, title="the same slots, cars, bodies, starts and disturbances")
    for head in (*HEADS, *MORE):
        table.add_column(escape(head), justify="left" if head in ("controller", "why not") else "right")
    for slot in SLOTS:
        for name in CONTROLLERS:
            mine = [item for item in found if item.controller == name and item.slot == slot]
            if mine:
                table.add_row(*_cells(f"{slot:g}", name, mine))
        table.add_section()
    return table


def _cells(slot: str, name: str, mine: list[Drive]) -> list[str]:
    won = [item for item in mine if item.parked]
    refused = sum(item.why == REFUSED for item in mine)
    reasons = Counter(item.why.removeprefix(BEYOND).replace(", ", " and ") for item in mine if item.why)
    why = ", ".join(f"{reason.replace('_', ' ')} {count}" for reason, count in reasons.most_common())
    counts = [str(len(mine)), f"{100.0 * refused / len(mine):.0f} %", str(len(won)), str(sum(i.exact for i in mine))]
    numbers = [f"{statistics.median(pick(item) for item in won):.3g}" if won else "-" for pick in MEDIANS]
    return [slot, name, *counts, *numbers, why]
