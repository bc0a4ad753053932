"""``apa build``: make the FMUs."""

import argparse
from typing import Any

from orchestrator.cosim.fmu_files import KINDS, build


def add_parser(subparsers: Any) -> argparse.ArgumentParser:
    """Add the command."""
    parser: argparse.ArgumentParser = subparsers.add_parser("build", help="build Controller.fmu and Vehicle.fmu")
    parser.add_argument("--kind", choices=KINDS, action="append", help="which FMUs (default: all that can be built)")
    return parser


def run(arguments: argparse.Namespace) -> int:
    """Build and print one line per FMU. Returns 0."""
    from fmus.build import BUILDERS

    for kind in arguments.kind or [kind for kind in KINDS if kind in BUILDERS]:
        for line in build(kind):
            print(line)
    return 0
