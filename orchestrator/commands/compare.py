"""``apa compare``: do two runs agree, signal by signal."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.markup import escape

from orchestrator.evaluation.comparison.compare import DURATION, Comparison, compare
from orchestrator.evaluation.comparison.tolerance import Tolerance, read_tolerances
from orchestrator.inputs.text.console import console, say
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.printable import readable
from orchestrator.inputs.text.quantities import number
from orchestrator.presentation.log.messages import read_messages
from orchestrator.presentation.log.read_log import log_file, read_log
from orchestrator.presentation.report.overlay import write_overlay
from orchestrator.session.terminal import differences_table

EXAMPLES = """examples:
  apa compare reference/run.mcap runs/guo2015-case4/run.mcap
  apa compare A.mcap B.mcap --abs 0.01 --rel 0.02 --time "100 ms" --html overlay.html
  apa compare A.mcap B.mcap C.mcap --html overlay.html    all on one page, B and C each compared with A
  apa compare A.mcap B.mcap --signals "vehicle.pose.*" --tolerances tolerances.yaml --json

A value of B passes if it is within max(ABS, REL * |A|) of a value of A within TIME before or after.
TOLERANCES.yaml sets tolerances for single signals; the last matching pattern applies:
  "vehicle.pose.*": {abs: 1 cm, time: 100 ms}
  "*.heading": {abs: 0.5 deg}

exit codes: 0 all within tolerance, 1 something differs, 2 bad input
"""
SAME, DIFFERENT = 0, 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("a", type=log_file, metavar="A.mcap", help="the reference: a log, or the folder of a run")
    parser.add_argument("b", type=log_file, metavar="B.mcap", help="the run to compare")
    parser.add_argument(
        "more", type=log_file, nargs="*", metavar="MORE.mcap", help="further runs, each compared with A"
    )
    parser.add_argument("--abs", default="1e-9", metavar="NUMBER", help="absolute tolerance in SI units (1e-9)")
    parser.add_argument("--rel", default="1e-9", metavar="NUMBER", help="tolerance relative to A (1e-9)")
    parser.add_argument("--time", default="0", metavar="SECONDS", help="tolerance along time (0)")
    parser.add_argument("--tolerances", type=Path, metavar="FILE", help="tolerances of single signals, YAML")
    parser.add_argument(
        "--signals", action="append", metavar="PATTERN", help="compare only these, for example vehicle.pose.*"
    )
    parser.add_argument("--html", type=Path, metavar="FILE", help="write a page with all runs and curves")
    parser.add_argument("--json", action="store_true", help="print the whole comparison as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Compare and print. Returns 0 if all signals are within tolerance, 1 if not."""
    bounds = [
        number(getattr(arguments, key), unit, key=f"--{key}", any_value=True)
        for key, unit in (("abs", "1"), ("rel", "1"), ("time", "s"))
    ]
    for key, bound in zip(("abs", "rel", "time"), bounds, strict=True):
        if not bound >= 0.0:
            raise BadInput(f"{bound:g} is not 0 or more", key=f"--{key}")
    logs = [arguments.a, arguments.b, *arguments.more]
    runs = [read_log(log) for log in logs]
    scenarios = [str(run.info.get("scenario", {}).get("name", "")) for run in runs]
    if len(set(filter(None, scenarios))) > 1:
        say(f"apa: note: the runs are of different scenarios: {', '.join(scenarios)}")
    tolerances = read_tolerances(arguments.tolerances, Tolerance(*bounds))
    for pattern in tolerances.patterns_without_match([*(name for run in runs for name in run.signals), DURATION]):
        say(f"apa: warning: {arguments.tolerances}: {pattern}: no signal fits, so it changes nothing")
    found = [compare(runs[0], run, tolerances, arguments.signals) for run in runs[1:]]
    if arguments.html:
        write_overlay(arguments.html, runs, [read_messages(log) for log in logs], found, _names(logs))
    if arguments.json:
        texts = [item.model_dump_json(indent=2) for item in found]
        print(texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]")
    else:
        for log, item in zip(logs[1:], found, strict=True):
            if len(found) > 1:
                console().print(f"[bold]{escape(str(log))}[/]")
            _print(item)
        if arguments.html:
            print(arguments.html, file=sys.stderr)
    return SAME if all(item.passed for item in found) else DIFFERENT


def _names(logs: Sequence[Path]) -> list[str]:
    """Return the names of runs: of their folders, or of the files where a folder has several."""
    folders = [readable(log.resolve().parent.name) for log in logs]
    return folders if len(set(folders)) == len(folders) else [readable(log.stem) for log in logs]


def _print(found: Comparison) -> None:
    out = console()
    if found.parameters:
        names = ", ".join(change.name for change in found.parameters[:5])
        out.print(f"{len(found.parameters)} parameters differ: {names}{', ...' if len(found.parameters) > 5 else ''}")
    if found.only_in_b:
        out.print(f"only in B: {', '.join(found.only_in_b)}")
    if found.passed:
        out.print(f"[green]same[/]: all {found.compared} signals within tolerance")
        return
    out.print(f"[red]different[/]: {found.differing} of {found.compared} signals beyond tolerance")
    out.print(differences_table([row for row in found.signals if not row.passed], out))
