"""``apa study``: a shipped study with a table of its own."""

import argparse
import json
import math
from typing import Any

from rich.table import Table

from controller_fmu.apa.chart import Mode
from controller_fmu.interface import Reason
from orchestrator.apa_grid import KEPT, Result, cases, drive, is_within_gbt, is_within_house, totals
from orchestrator.apa_loop import Loop
from orchestrator.terminal import console

EPILOG = """examples:
  apa study apa-grid                     every run of the grid: hours, unless --compiled
  apa study apa-grid --every 20          each 20th run
  apa study apa-grid --run 658           that run again
"""


def add_parser(subparsers: Any) -> argparse.ArgumentParser:
    """Add the command."""
    text = "the parking assist over cars, slots, distances, headings and bodies"
    parser: argparse.ArgumentParser = subparsers.add_parser("study", help=text, description=text, epilog=EPILOG)
    parser.add_argument("name", choices=["apa-grid"])
    parser.add_argument("--every", type=int, default=1, metavar="N", help="only each N-th run")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="begin at run N")
    parser.add_argument("--run", type=int, metavar="N", dest="number", help="only this run")
    parser.add_argument("--compiled", action="store_true", help="compile first (minutes, needs numba), then run faster")
    parser.add_argument("--json", action="store_true", help="print JSON")
    return parser


def run(arguments: argparse.Namespace) -> int:
    """Print one line a run and the totals. Returns 1 if a run touched something."""
    loop = Loop(KEPT, compiled=arguments.compiled)
    chosen = cases()[arguments.first :: max(arguments.every, 1)]
    if arguments.number is not None:
        chosen = [case for case in cases() if case.number == arguments.number]
    results = []
    for case in chosen:
        result = drive(case, loop)
        results.append(result)
        if not arguments.json:
            console().print(_line(result), soft_wrap=True, highlight=False)
    if arguments.json:
        print(json.dumps([{**result._asdict(), "case": result.case._asdict()} for result in results]))
    else:
        table = Table(box=None, pad_edge=False)
        for name in ("of all runs", "number", "share"):
            table.add_column(name, justify="left" if name == "of all runs" else "right")
        for name, number in totals(results).items():
            table.add_row(name, str(number), f"{100.0 * number / max(len(results), 1):.1f} %")
        console().print(table)
    return 1 if any(result.nearest <= 0.0 for result in results) else 0


def _line(result: Result) -> str:
    case = result.case
    kind = "parallel" if case.kind == 1 else "perpendicular"
    side = "right" if case.side > 0 else "left"
    end = Mode(result.mode).name.lower() if result.reason == 0 else Reason(result.reason).name.lower()
    verdict = "house" if is_within_house(result) else "gbt" if is_within_gbt(result) else "-"
    return (
        f"{case.number:4d} {case.car} {kind} {side} +{case.extra:.1f} m, {case.beside:.1f} m beside, "
        f"{math.degrees(case.heading):+.0f} deg, {case.body}, {3.6 * case.speed:.0f} km/h: {end}, "
        f"{100.0 * result.lateral:+.1f} cm {math.degrees(result.heading):+.2f} deg, {result.shifts} shifts, "
        f"{result.parking_time:.0f} s, {100.0 * result.nearest:.0f} cm clear, "
        f"corners {100.0 * result.corner_a:.0f} and {100.0 * result.corner_b:.0f} cm: {verdict}"
    )
