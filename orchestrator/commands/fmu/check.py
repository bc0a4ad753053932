"""``apa fmu check``: before any run, what of an FMU is connected, unconnected, unsupported, missing."""

import argparse
import json
from pathlib import Path

from orchestrator.inputs.text.console import console
from orchestrator.session.fmu_check import FmuReport, check_fmu
from orchestrator.session.foreign import connect_advice
from orchestrator.session.options import seconds
from orchestrator.simulation.imported.limits import STEP_TIMEOUT

EXAMPLES = """examples:
  apa fmu check their.fmu                                  as controller or vehicle, by its variables
  apa fmu check their.fmu --as vehicle --json
  apa fmu check gps.fmu --as gps --scenario mine.yaml      in the system of a scenario

exit codes: 0 the FMU can be run and evaluated, 1 something is missing or prevents a run, 2 the file is not an FMU
"""
READY, NOT_READY = 0, 1
PARTS = {
    "connected": "connected",
    "not_fed": "unconnected inputs",
    "not_understood": "not connected (outputs)",
    "no_unit": "no unit said",
    "missing": "missing for the verdict",
    "problems": "ends a run",
    "remarks": "besides",
}
"""Part of the report -> its head."""
BAD = ("missing", "problems")

MAX_LINES = 1000
"""Of one part of the report."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("fmu", type=Path, metavar="FMU", help="third-party FMU, FMI 2.0 or 3.0")
    parser.add_argument("--as", dest="place", default="", metavar="NAME", help="component that it replaces")
    parser.add_argument("--scenario", default="", metavar="NAME|FILE", help="scenario into whose system it is inserted")
    parser.add_argument("--no-load", action="store_true", help="read the model description only, execute nothing")
    parser.add_argument(
        "--timeout", type=seconds, default=STEP_TIMEOUT, metavar="S", help="wall-clock limit for loading and for a step"
    )
    parser.add_argument("--json", action="store_true", help="print the report as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Check and print. Returns 0 if the FMU can be run and evaluated, 1 if not."""
    report = check_fmu(arguments.fmu, arguments.place, arguments.scenario, arguments.timeout, not arguments.no_load)
    if arguments.json:
        print(json.dumps(report.plain(), indent=2))
    else:
        _print(report)
        if not report.is_ready:
            print(f"next: {connect_advice(report.place, str(arguments.fmu), arguments.scenario)}")
    return READY if report.is_ready else NOT_READY


def _print(report: FmuReport) -> None:
    out = console()
    for key, text in report.about.items():
        out.print(f"{key:>10}  {text}", markup=False, soft_wrap=True)
    out.print(f"{'as':>10}  {report.place}", markup=False)
    for part, head in PARTS.items():
        lines = getattr(report, part)
        if not lines:
            continue
        style = "bold red" if part in BAD else "bold"
        out.print(f"\n[{style}]{head}[/] ({len(lines)})")
        for line in lines[:MAX_LINES]:
            out.print(f"  {line}", markup=False, soft_wrap=True)
        if len(lines) > MAX_LINES:
            out.print(f"  and {len(lines) - MAX_LINES} more; --json lists all")
    verdict = "[bold green]can be run and evaluated[/]" if report.is_ready else "[bold red]not ready[/]"
    out.print(f"\n{verdict}")
