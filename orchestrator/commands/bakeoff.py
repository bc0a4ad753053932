"""``apa bakeoff``: every parking controller on the same slot, cars, bodies and disturbances."""

import argparse
import json
import statistics
from pathlib import Path
from typing import Any

from rich.markup import escape
from rich.table import Table

from orchestrator.bakeoff.cost import costs
from orchestrator.bakeoff.driver_study import Rate, study
from orchestrator.bakeoff.entries import CONTROLLERS, entries
from orchestrator.bakeoff.figure import draw
from orchestrator.bakeoff.results import Result, results
from orchestrator.errors import BadInput
from orchestrator.fmu_files import can_compile
from orchestrator.terminal import console

EXAMPLES = """examples:
  apa bakeoff                     the table, the picture, 10,000 drives of each system of Guo 2015
  apa bakeoff --runs 0            without the driver study
  apa bakeoff --json > out.json   every run, for machines
"""


def add_parser(subparsers: Any) -> argparse.ArgumentParser:
    """Add the command."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "bakeoff", help="compare the parking controllers", epilog=EXAMPLES
    )
    parser.add_argument("--runs", type=int, default=10_000, help="drives of each system in the driver study")
    parser.add_argument("--seed", type=int, default=1, help="seed of the driver study")
    parser.add_argument("--out", type=Path, default=Path("runs/bakeoff"), metavar="DIR", help="where the picture goes")
    parser.add_argument("--json", action="store_true", help="print JSON instead of the tables")
    return parser


def run(arguments: argparse.Namespace) -> int:
    """Drive everything, write the picture, print. Returns 0."""
    if not can_compile():
        raise BadInput("the bake-off runs as compiled code: install apa-cosim[native]")
    if arguments.runs < 0:
        raise BadInput(f"--runs {arguments.runs}: expected a number of at least 0")
    found = results(list(entries()))
    claim = study(arguments.runs, arguments.seed) if arguments.runs else None
    rates = claim.rates if claim else []
    spent = costs()
    picture = draw(found, claim, arguments.out / "bakeoff.png")
    data = {"runs": [_plain(item) for item in found], "rates": [rate._asdict() for rate in rates], "cost_us": spent}
    text = json.dumps(data, indent=2)
    (arguments.out / "bakeoff.json").write_text(text + "\n", encoding="utf-8")
    if arguments.json:
        print(text)
    else:
        _print(found, rates, spent)
        console().print(f"picture {picture}, every run in {arguments.out / 'bakeoff.json'}")
    return 0


def _plain(item: Result) -> dict[str, Any]:
    entry = {key: value for key, value in item.entry._asdict().items() if key != "scenario"}
    return {**entry, **{key: value for key, value in item._asdict().items() if key != "entry"}}


def _print(found: list[Result], rates: list[Rate], spent: dict[str, float]) -> None:
    to = console()
    table = Table(box=None, title="the same slot, cars, bodies, starts and disturbances; medians of the parked ones")
    heads = ("controller", "runs", "parked", "house", "time [s]", "shifts", "lateral [cm]", "heading [deg]")
    for head in (*heads, "clearance [m]", "wheel [turns]", "step [us]", "why not"):
        table.add_column(escape(head), justify="left" if head in ("controller", "why not") else "right")
    for name in CONTROLLERS:
        table.add_row(*_cells(name, [item for item in found if item.entry.controller == name], spent[name]))
    to.print(table)
    for rate in rates:
        to.print(
            f"{rate.name}: {100 * rate.rate:.2f} % of {rate.runs} drives with driver speed errors parked "
            f"(95 %: {100 * rate.low:.2f} to {100 * rate.high:.2f} %)"
        )


def _cells(name: str, mine: list[Result], spent: float) -> list[str]:
    won = [item for item in mine if item.parked]
    reasons: dict[str, int] = {}
    for item in mine:
        if not item.parked:
            reasons[item.reason] = reasons.get(item.reason, 0) + 1
    why = ", ".join(f"{reason} {count}" for reason, count in sorted(reasons.items(), key=lambda pair: -pair[1]))
    if not won:
        return [name, str(len(mine)), "0", "0", *["-"] * 6, f"{spent:.0f}", why]
    middle = {
        "time": statistics.median(item.time for item in won),
        "shifts": statistics.median(item.shifts for item in won),
        "lateral": statistics.median(abs(item.lateral) for item in won) * 100.0,
        "heading": statistics.median(abs(item.heading) for item in won) * 57.29578,
        "clearance": statistics.median(item.clearance for item in won),
        "effort": statistics.median(item.effort for item in won) / 6.283185,
    }
    numbers = [f"{value:.3g}" for value in middle.values()]
    return [name, str(len(mine)), str(len(won)), str(sum(item.house for item in won)), *numbers, f"{spent:.0f}", why]
