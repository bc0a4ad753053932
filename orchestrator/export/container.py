"""``apa export container``: the system of a scenario as one FMU."""

import argparse
import sys
from typing import Any

from orchestrator.export.ssp import add_arguments
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.text.errors import BadInput

EXAMPLES = """examples:
  apa export container guo2015-case4
  fmpy simulate ParkingSystem.fmu --stop-time 60
"""


def add_parser(subparsers: Any) -> argparse.ArgumentParser:
    """Add the format."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "container", help="the system as one FMU, for any importer", epilog=EXAMPLES
    )
    add_arguments(parser, "ParkingSystem.fmu")
    return parser


def run(arguments: argparse.Namespace) -> int:
    """Write the file. Returns 0."""
    from fmus.systems.container import write_container
    from orchestrator.export.system_of import fmus_for, system_of

    scenario = load_scenario(arguments.scenario, arguments.set)
    system = system_of(
        scenario, fmus_for(arguments.fmus, arguments.platform, lambda text: print(text, file=sys.stderr))
    )
    try:
        print(write_container(system, arguments.out))
    except RuntimeError as error:
        raise BadInput(str(error)) from error
    return 0
