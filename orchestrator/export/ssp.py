"""``apa export ssp``: the system of a scenario as ParkingSystem.ssp."""

import argparse
from pathlib import Path

from orchestrator.cosim.fmu_files import KINDS
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.text.console import say

EXAMPLES = """examples:
  apa export ssp guo2015-case4
  apa export ssp guo2015-case4 --platform all --set controller.guo2015.k4=3 --out /tmp/case4.ssp
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the format takes."""
    add_system_arguments(parser, "ParkingSystem.ssp")


def add_system_arguments(parser: argparse.ArgumentParser, name: str) -> None:
    """Add what ``ssp`` and ``container`` have in common."""
    parser.add_argument("scenario", metavar="NAME|FILE", help="a shipped scenario, or a YAML file")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as for apa run")
    parser.add_argument("--fmus", choices=KINDS, default="native", help="kind of FMU inside (default: native)")
    parser.add_argument(
        "--platform",
        action="append",
        default=[],
        metavar="NAME",
        help="native FMUs for these, or all (default: this one)",
    )
    parser.add_argument("--out", type=Path, default=Path(name), metavar="FILE", help=f"default: {name}")


def run(arguments: argparse.Namespace) -> int:
    """Write the file. Returns 0."""
    from fmus.systems.ssp import write_ssp
    from orchestrator.export.system_of import fmus_for, system_of

    scenario = load_scenario(arguments.scenario, arguments.set)
    system = system_of(scenario, fmus_for(arguments.fmus, arguments.platform, say))
    print(write_ssp(system, arguments.out))
    return 0
