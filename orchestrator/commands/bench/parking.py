"""``apa bench parking``: every scene planned and driven, as one table."""

import argparse
import json
import shlex
from pathlib import Path

from fmus.files import write_whole
from orchestrator.inputs.text.console import Meter, console, result_table, say
from orchestrator.inputs.text.errors import INTERRUPTED, NOT_PARKED, PARKED, BadInput
from orchestrator.inputs.text.locked_folder import lock_folder
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.simulation.cosim.interrupts import on_interrupt
from orchestrator.studies.benchmark.driving import BODIES, KINEMATIC
from orchestrator.studies.benchmark.scenes import ROWS, SceneRow, rows_of, scenes_in
from orchestrator.studies.benchmark.table import as_json, csv_text, figures_of, table_lines

EXAMPLES = """examples:
  apa bench parking                              the shipped scenarios valet-* with a known goal
  apa import tpcap cases --out tpcap             scenes of TPCAP, ParkBench: see apa import --help
  apa bench parking tpcap parkbench --out results
  apa bench parking parkbench --body kinematic --json > parkbench.json
  apa bench parking tpcap --optimal              also beside the time-optimal motion: apa bench optimal --help

kinematic: no errors. double_track: tyres, 40 ms dead time and 50 ms lag of the steering, 30 mrad backlash, 80 ms brake
lag, errors of odometry and noise of the ultrasonic sensors.

writes DIR/table.csv, DIR/table.json and DIR/rows; the same command continues with the scenes that have no row
exit codes: 0 every scene planned and parked without contact, 1 one was not, 2 bad input, 130 interrupted
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument(
        "places", nargs="*", metavar="FOLDER", help="folders of scenarios, or scenarios (default: shipped ones)"
    )
    parser.add_argument("--body", action="append", choices=BODIES, help="drive on this body only; may be repeated")
    parser.add_argument(
        "--out", type=Path, default=Path("runs/bench/parking"), metavar="DIR", help="output folder (runs/bench/parking)"
    )
    parser.add_argument(
        "--optimal",
        action="store_true",
        help="compare each drive with the time-optimal motion near it (some seconds each)",
    )
    parser.add_argument("--fresh", action="store_true", help="plan and drive all scenes again")
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument("--json", action="store_true", help="print JSON instead of the table")
    kinds.add_argument("--csv", action="store_true", help="print CSV instead of the table")


def run(arguments: argparse.Namespace) -> int:
    """Plan and drive, print the table. Returns 0 if all passed, 1 if not, 130 if interrupted."""
    out: Path = arguments.out
    bodies = list(dict.fromkeys(arguments.body or BODIES))
    if arguments.optimal and KINEMATIC not in bodies:
        raise BadInput("the optimum is compared with the kinematic drive: add --body kinematic", key="--optimal")
    scenes = scenes_in(arguments.places, bodies, arguments.optimal)
    interrupt = Interrupt()
    rows: list[SceneRow] = []
    with lock_folder(out):
        if arguments.fresh:
            for file in (out / ROWS).glob("*.json"):
                file.unlink()
        files = fmu_files("native", say)
        with on_interrupt(interrupt), Meter("apa bench parking", len(scenes), "scenes") as meter:
            for row in rows_of(scenes, bodies, (files, "native"), out, interrupt, arguments.optimal):
                rows.append(row)
                meter.at(len(rows), row.scene.name)
        content = as_json(rows, shlex.join(["apa", *arguments.words]))
        write_whole(out / "table.json", json.dumps(content, indent=1) + "\n")
        write_whole(out / "table.csv", csv_text(rows))
    if arguments.json:
        print(json.dumps(content, indent=1))
    elif arguments.csv:
        print(csv_text(rows), end="")
    else:
        _print(rows, out)
    if interrupt.requested:
        return INTERRUPTED
    return PARKED if all(row.is_passed for row in rows) else NOT_PARKED


def _print(rows: list[SceneRow], out: Path) -> None:
    from rich.markup import escape

    head, *lines = table_lines(rows)
    table = result_table(console(), head, head[:1])
    for line in lines:
        table.add_row(*map(escape, line))
    console().print(table)
    for figures in figures_of(rows):
        console().print(figures.line(), markup=False, soft_wrap=True)
    console().print(f"results in {out}", markup=False, soft_wrap=True)
