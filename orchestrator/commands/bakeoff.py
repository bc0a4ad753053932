"""``apa bakeoff``: every parking controller in the same slots, with the same cars, bodies and disturbances."""

import argparse
import json
import math
import statistics
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.markup import escape
from rich.table import Table

from orchestrator.bakeoff.cost import Cost, costs
from orchestrator.bakeoff.driver_study import Rate, study
from orchestrator.bakeoff.entries import CONTROLLERS, SLOTS, entries
from orchestrator.bakeoff.figure import draw
from orchestrator.bakeoff.results import REFUSED, Result, results
from orchestrator.cosim.fmu_files import can_compile
from orchestrator.text.console import console, working
from orchestrator.text.errors import BadInput

EXAMPLES = """examples:
  apa bakeoff                     the tables, the picture, 10,000 drives of each system of Guo 2015
  apa bakeoff --runs 0            without the driver study
  apa bakeoff --json > out.json   every run, for machines
"""
FOOTNOTES = (
    "Medians of the parked drives. Refused: no path from this start. Parked: the controller says so, the car stands, "
    "in the slot and within the limits of GB/T 41630, nothing touched; exact: of these within the house limits across "
    "the slot and in heading.",
    "apa is told neither slot, target nor start: it drives past at 2 m/s along the line through the start pose, with "
    "1 cm of sensor noise, and parks from where it likes. Its time counts from the driver's confirmation, its "
    "clearance with the way past the slot; it chooses its place along the slot, so errors along it are not compared.",
)
HEADS = ("slot [m]", "controller", "runs", "refused", "parked", "exact", "time [s]", "shifts", "lateral [cm]")
MORE = ("heading [deg]", "clearance [m]", "wheel [turns]", "why not")
MEDIANS: tuple[Callable[[Result], float], ...] = (
    lambda item: item.time,
    lambda item: item.shifts,
    lambda item: 100.0 * abs(item.lateral),
    lambda item: math.degrees(abs(item.heading)),
    lambda item: item.clearance,
    lambda item: item.effort / (2.0 * math.pi),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("--runs", type=int, default=10_000, help="drives of each system in the driver study")
    parser.add_argument("--seed", type=int, default=1, help="seed of the driver study")
    parser.add_argument("--out", type=Path, default=Path("runs/bakeoff"), metavar="DIR", help="where the picture goes")
    parser.add_argument("--json", action="store_true", help="print JSON instead of the tables")


def run(arguments: argparse.Namespace) -> int:
    """Drive everything, write the picture, print. Returns 0."""
    if not can_compile():
        raise BadInput("the bake-off runs as compiled code: install apa-cosim[native]")
    if arguments.runs < 0:
        raise BadInput(f"--runs {arguments.runs}: expected a number of at least 0")
    with working("bake-off: every controller in every slot"):
        found = results(list(entries()))
    with working(f"driver study: {arguments.runs} drives of each system"):
        claim = study(arguments.runs, arguments.seed) if arguments.runs else None
    rates = claim.rates if claim else []
    with working("cost of a step"):
        spent = costs()
    picture = draw(found, claim, arguments.out / "bakeoff.png")
    data = {
        "runs": [_plain(item) for item in found],
        "rates": [{**rate.group._asdict(), **_numbers(rate)} for rate in rates],
        "step_us": {name: item._asdict() for name, item in spent.items()},
    }
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


def _numbers(rate: Rate) -> dict[str, Any]:
    return {key: value for key, value in rate._asdict().items() if key != "group"}


def _print(found: list[Result], rates: list[Rate], spent: dict[str, Cost]) -> None:
    to = console()
    table = Table(box=None, title="the same slots, cars, bodies, starts and disturbances")
    for head in (*HEADS, *MORE):
        table.add_column(escape(head), justify="left" if head in ("controller", "why not") else "right")
    for slot in SLOTS:
        for name in CONTROLLERS:
            mine = [item for item in found if item.entry.controller == name and item.entry.slot == slot]
            if mine:
                table.add_row(*_cells(f"{slot:g}", name, mine))
        table.add_section()
    to.print(table)
    for note in FOOTNOTES:
        to.print(f"- {escape(note)}")
    for name, cost in spent.items():
        to.print(
            f"{name}: one step takes {cost.mean:.0f} us in CPython, the slowest of the drive {cost.slowest:.0f} us"
        )
    for rate in rates:
        group = rate.group
        to.print(
            f"{group.system}, wheels {group.steering}, {group.limit}: {100 * rate.rate:.2f} % of {rate.runs} drives "
            f"with driver speed errors parked (95 %: {100 * rate.low:.2f} to {100 * rate.high:.2f} %)"
        )


def _cells(slot: str, name: str, mine: list[Result]) -> list[str]:
    won = [item for item in mine if item.parked]
    refused = sum(item.reason == REFUSED for item in mine)
    reasons = Counter(
        item.reason.removeprefix("beyond its limit: ").replace(", ", " and ") for item in mine if not item.parked
    )
    why = ", ".join(f"{reason.replace('_', ' ')} {count}" for reason, count in reasons.most_common())
    counts = [str(len(mine)), f"{100.0 * refused / len(mine):.0f} %", str(len(won)), str(sum(i.house for i in mine))]
    numbers = [f"{statistics.median(pick(item) for item in won):.3g}" if won else "-" for pick in MEDIANS]
    return [slot, name, *counts, *numbers, why]
