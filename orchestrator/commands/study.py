"""``apa study``: a shipped study with a table of its own."""

import argparse
import json
import math
from collections.abc import Iterator

from rich.table import Table

from controller_fmu.apa.chart import Mode
from controller_fmu.apa.slot import Kind
from controller_fmu.interface import Reason
from orchestrator.cosim.fmu_files import can_compile
from orchestrator.grid.apa_grid import (
    KEPT,
    Case,
    Result,
    cases,
    drive,
    is_ghost,
    is_within_gbt,
    is_within_house,
    totals,
)
from orchestrator.grid.apa_loop import Loop
from orchestrator.grid.apa_verdict import HOUSE_SHIFTS_AS_GBT
from orchestrator.text.console import Meter, console

KINDS: dict[int, str] = {Kind.PARALLEL: "parallel", Kind.PERPENDICULAR: "perpendicular"}
EXAMPLES = """examples:
  apa study apa-grid                     every run of the grid: a minute or two where models can be compiled
  apa study apa-grid --every 20          each 20th run
  apa study apa-grid --run 658           that run again
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("name", choices=["apa-grid"])
    parser.add_argument("--every", type=int, default=1, metavar="N", help="only each N-th run")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="begin at run N")
    parser.add_argument("--run", type=int, metavar="N", dest="number", help="only this run")
    parser.add_argument(
        "--lot", type=int, default=0, metavar="N", help="another draw of speeds, noise, odometry errors"
    )
    parser.add_argument("--all", action="store_true", help="a line for every run, not only for those that miss GB/T")
    parser.add_argument("--plain", action="store_true", help="plain Python, not compiled: slower, the same bits")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace) -> int:
    """Print a line for each run that misses GB/T, and the totals. Returns 1 if a run touched something."""
    loop = Loop(KEPT, compiled=can_compile() and not arguments.plain)
    chosen = cases(arguments.lot)[arguments.first :: max(arguments.every, 1)]
    if arguments.number is not None:
        chosen = [case for case in cases(arguments.lot) if case.number == arguments.number]
    results = []
    for result in _driven(chosen, loop):
        results.append(result)
        asked = arguments.all or arguments.number is not None
        if not arguments.json and (asked or is_ghost(result) or not is_within_gbt(result)):
            console().print(_line(result), soft_wrap=True, highlight=False)
    if arguments.json:
        print(json.dumps([{**result._asdict(), "case": result.case._asdict()} for result in results]))
    else:
        console().print(_table(results))
        console().print(_by_size(results))
    return 1 if any(result.nearest <= 0.0 for result in results) else 0


def _driven(chosen: list[Case], loop: Loop) -> Iterator[Result]:
    """Yield the results, and show how far they are."""
    with Meter("apa-grid", len(chosen), "runs") as meter:
        for done, case in enumerate(chosen, start=1):
            yield drive(case, loop)
            meter.at(done)


def _table(results: list[Result]) -> Table:
    """Return the totals: of all runs, of those from inside the start range, of the rest, of those without a slot."""
    groups = {
        "all": results,
        "from inside the start range": [result for result in results if result.inside],
        "from outside": [result for result in results if result.kind != 0 and not result.inside],
        "no slot found": [result for result in results if result.kind == 0],
    }
    table = Table(box=None, pad_edge=False)
    table.add_column("")
    for name in groups:
        table.add_column(name, justify="right")
    columns = [(totals(group), max(len(group), 1)) for group in groups.values()]
    for name in columns[0][0]:
        texts = (
            str(numbers[name]) if name == "runs" else f"{numbers[name]} ({100.0 * numbers[name] / count:.1f} %)"
            for numbers, count in columns
        )
        table.add_row(name, *texts)
    return table


def _by_size(results: list[Result]) -> Table:
    """Return how the limits are met in slots of each size: what a slot allows depends on it."""
    table = Table(box=None, pad_edge=False)
    columns = ("slot", "runs", "GB/T", "house", "house, but shifts as GB/T", "shifts", "nearest")
    for name in columns:
        table.add_column(name, justify="left" if name == "slot" else "right")
    for kind, extra in sorted({(result.case.kind, result.case.extra) for result in results}):
        group = [result for result in results if (result.case.kind, result.case.extra) == (kind, extra)]
        shifts = sorted(result.shifts for result in group)
        table.add_row(
            f"{KINDS[kind]}, ISO's shortest + {extra:.1f} m",
            str(len(group)),
            str(sum(is_within_gbt(result) for result in group)),
            str(sum(is_within_house(result) for result in group)),
            str(sum(is_within_house(result, HOUSE_SHIFTS_AS_GBT) for result in group)),
            f"{shifts[0]} to {shifts[-1]}",
            f"{100.0 * min(result.nearest for result in group):.0f} cm",
        )
    return table


def _line(result: Result) -> str:
    case = result.case
    kind = KINDS[case.kind]
    side = "right" if case.side > 0 else "left"
    end = Mode(result.mode).name.lower() if result.reason == 0 else Reason(result.reason).name.lower()
    lateral, heading = (result.standing[f"final.{name}_error"] for name in ("lateral", "heading"))
    verdict = "house" if is_within_house(result) else "gbt" if is_within_gbt(result) else "-"
    return (
        f"{case.number:4d} {case.car} {kind} {side} +{case.extra:.1f} m, {case.beside:.1f} m beside, "
        f"{math.degrees(case.heading):+.0f} deg, {case.body}, {3.6 * case.speed:.0f} km/h, "
        f"{'inside' if result.inside else 'outside'}: {end}, "
        f"{100.0 * lateral:+.1f} cm {math.degrees(heading):+.2f} deg, {result.shifts} shifts, "
        f"{result.parking_time:.0f} s, {100.0 * result.nearest:.0f} cm clear, "
        f"corners {100.0 * result.corner_a:.0f} and {100.0 * result.corner_b:.0f} cm: {verdict}"
    )
