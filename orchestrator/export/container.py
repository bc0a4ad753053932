"""``apa export container``: the system of a scenario as one FMU."""

import argparse
from importlib.util import find_spec

from orchestrator.export.ssp import add_system_arguments
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.text.console import say
from orchestrator.text.errors import BadInput

EXAMPLES = """examples:
  apa export container guo2015-case4
  fmpy simulate ParkingSystem.fmu --stop-time 60
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the format takes."""
    add_system_arguments(parser, "ParkingSystem.fmu")


def run(arguments: argparse.Namespace) -> int:
    """Write the file. Returns 0."""
    from fmus.systems.container import INSTALL, PACKAGE, write_container
    from orchestrator.export.system_of import fmus_for, system_of

    if find_spec(PACKAGE) is None:
        raise BadInput(f"needs fmucontainer: {INSTALL}")
    scenario = load_scenario(arguments.scenario, arguments.set)
    system = system_of(scenario, fmus_for(arguments.fmus, arguments.platform, say))
    try:
        print(write_container(system, arguments.out))
    except RuntimeError as error:
        raise BadInput(str(error)) from error
    return 0
