"""``apa export ssp``: the system of a scenario as an .ssp file, its FMUs built to start as the scenario does."""

import argparse
from pathlib import Path

from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.simulation.cosim.kinds import KINDS, default_kind

EXAMPLES = """examples:
  apa export ssp guo2015-case4
  apa export ssp guo2015-case4 --platform all --set controller.guo2015.k4=3 --out /tmp/case4.ssp
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the format takes."""
    add_system_arguments(parser, ".ssp")
    kind = default_kind()
    text = "declare outputs of the system; libcosim and Ecos refuse them"
    parser.add_argument("--system-outputs", action="store_true", help=text)
    parser.add_argument("--fmus", choices=KINDS, default=kind, help=f"kind of FMU (default: {kind})")


def add_system_arguments(parser: argparse.ArgumentParser, suffix: str) -> None:
    """Add what ``ssp`` and ``container`` have in common."""
    parser.add_argument("scenario", metavar="NAME|FILE", help="a shipped scenario, or a YAML file")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as for apa run")
    parser.add_argument(
        "--platform",
        action="append",
        default=[],
        metavar="NAME,...",
        help="platforms of native FMUs, or all (default: this one)",
    )
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help=f"output file (default: name of the scenario with {suffix})"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the file. Returns 0."""
    from fmus.files import folder_for_a_while
    from fmus.systems.ssp import write_ssp
    from orchestrator.presentation.export.system_of import system_of

    scenario = load_scenario(arguments.scenario, arguments.set)
    with folder_for_a_while("ssp") as folder:
        system = system_of(scenario, folder, arguments.fmus, arguments.platform)
        print(write_ssp(system, arguments.out or Path(f"{scenario.name}.ssp"), arguments.system_outputs))
    return 0
