"""The parking system over a grid of cars, slots, distances, headings, bodies and speeds."""

import math
from pathlib import Path

from rich.table import Table as Printed

from orchestrator.inputs.scenario.requirements import Requirement, library_requirements
from orchestrator.inputs.text.console import console, result_table
from orchestrator.studies.parking.cases import EXTRA, KINDS, SIDES, GridCase, cases, gbt_limits, scenario_of
from orchestrator.studies.parking.parkings import (
    FOUND,
    GBT,
    MEASURES,
    PROJECT_LIMITS,
    PROJECT_LIMITS_BUT_MANOEUVRES,
    GridRun,
    parkings,
)
from orchestrator.studies.sweep.study.cases import LabelledScenario, design_of
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.table import Table

GBT_SETS = dict(zip(KINDS, ("gbt41630", "gbt41630-perpendicular"), strict=True))
CLEAR = Requirement(id="clearance of the whole run", signal="min_clearance", min=0.1, source="project")


def study(lot: int = 0) -> Study:
    """Return the whole grid; ``lot``: which draw of speeds, noise and odometry errors."""
    return study_of(cases(lot))


def study_of(chosen: list[GridCase]) -> Study:
    """Return the study of some cases."""
    scenario, design = design_of(LabelledScenario(_labels(case), scenario_of(case)) for case in chosen)
    content = {
        "name": "apa-grid",
        "title": "The parking system over cars, slots, distances, headings and bodies",
        "description": "Parked: within GB/T 41630 (heading, lateral position, manoeuvres if parallel), no contact.",
        "map": {"x": "extra", "y": "beside", "split": "kind"},
        "lot": chosen[0].lot,
    }
    within = {
        **{GBT[kind]: gbt_limits(name) for kind, name in GBT_SETS.items()},
        PROJECT_LIMITS: [*library_requirements("apa"), CLEAR],
        PROJECT_LIMITS_BUT_MANOEUVRES: [*library_requirements("apa-tight"), CLEAR],
    }
    return Study(scenario, design, content, measures=MEASURES, within=within, derived=FOUND)


def report(table: Table, folder: Path) -> int:
    """Print a line for each run that misses GB/T 41630, and the totals. Returns 1 if a run touched something."""
    found = parkings({name: table.column(name) for name in table.names()})
    to = console()
    for item in found:
        if item.is_ghost or not item.is_gbt:
            to.print(line(item), soft_wrap=True, highlight=False)
    to.print(_totals(found))
    to.print(_by_size(found))
    return 1 if any(item.nearest <= 0.0 for item in found) else 0


def totals(found: list[GridRun]) -> dict[str, int]:
    """Return how many runs did what."""
    return {
        "runs": len(found),
        "with contact": sum(item.nearest <= 0.0 for item in found),
        "parked within GB/T 41630": sum(item.is_gbt for item in found),
        "parked within the project limits": sum(item.is_within_limits for item in found),
        "gave up with a reason": sum(item.is_given_up for item in found),
        "ended in neither way": sum(not item.is_ended for item in found),
        "slot found": sum(item.kind != 0 for item in found),
        "both corners within 10 cm": sum(max(item.corner_a, item.corner_b) <= 0.1 for item in found),
        "found a slot that is not there": sum(item.is_ghost for item in found),
    }


def line(item: GridRun) -> str:
    """Return one run in words."""
    case = item.case
    verdict = "project" if item.is_within_limits else "gbt" if item.is_gbt else "-"
    return (
        f"{case.number:4d} {case.car} {KINDS[case.kind]} {SIDES[case.side]} +{case.extra:.1f} m, "
        f"{case.beside:.1f} m beside, {math.degrees(case.heading):+.0f} deg, {case.body}, {3.6 * case.speed:.0f} km/h, "
        f"{item.outcome} ({item.reason}), "
        f"{100.0 * item.lateral:+.1f} cm {math.degrees(item.heading):+.2f} deg, {item.manoeuvres} manoeuvres, "
        f"{item.parking_time:.0f} s, {100.0 * item.nearest:.0f} cm clear, "
        f"corners {100.0 * item.corner_a:.0f} and {100.0 * item.corner_b:.0f} cm: {verdict}"
    )


def _labels(case: GridCase) -> dict[str, str | float]:
    return {
        **{"number": case.number, "car": case.car, "kind": KINDS[case.kind], "side": SIDES[case.side]},
        **{"extra": case.extra, "beside": case.beside, "heading": round(math.degrees(case.heading))},
        **{"body": case.body, "speed": case.speed, "length": case.length, "lot": case.lot},
    }


def _totals(found: list[GridRun]) -> Printed:
    """Return the totals: of all runs, of those that a slot was shown to, of the rest."""
    groups = {
        "all": found,
        "slot found": [item for item in found if item.kind != 0],
        "no slot found": [item for item in found if item.kind == 0],
    }
    table = result_table(console(), ("", *groups), ("",))
    columns = [(totals(group), max(len(group), 1)) for group in groups.values()]
    for name in columns[0][0]:
        texts = (
            str(numbers[name]) if name == "runs" else f"{numbers[name]} ({100.0 * numbers[name] / count:.1f} %)"
            for numbers, count in columns
        )
        table.add_row(name, *texts)
    return table


def _by_size(found: list[GridRun]) -> Printed:
    """Return how the limits are met in slots of each size: what a slot allows depends on it."""
    titles = ("slot", "runs", "GB/T", "project", "project, but manoeuvres as GB/T", "manoeuvres", "clearance")
    table = result_table(console(), titles, ("slot",))
    for kind, extra in [(kind, extra) for kind, extras in EXTRA.items() for extra in extras]:
        group = [item for item in found if (item.case.kind, item.case.extra) == (kind, extra)]
        if not group:
            continue
        manoeuvres = sorted(item.manoeuvres for item in group)
        table.add_row(
            f"{KINDS[kind]}, ISO's shortest + {extra:.1f} m",
            *map(str, (len(group), sum(item.is_gbt for item in group), sum(item.is_within_limits for item in group))),
            str(sum(item.is_within_limits_but_manoeuvres for item in group)),
            f"{manoeuvres[0]} to {manoeuvres[-1]}",
            f"{100.0 * min(item.nearest for item in group):.0f} cm",
        )
    return table
