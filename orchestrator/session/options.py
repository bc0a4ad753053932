"""The options for FMUs of others, as several commands have them; imports little."""

import argparse
from pathlib import Path

from orchestrator.text.errors import BadInput

TIMEOUT = 30.0
"""Wall-clock limit [s], if nothing else is said."""


def add_foreign_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that put an FMU in the place of the controller or of the vehicle."""
    for name in ("controller", "vehicle"):
        parser.add_argument(
            f"--{name}",
            metavar="FMU",
            help=f"use this {name} instead of the shipped one: an .fmu, or a model such as my_{name}.py:MODEL",
        )
    parser.add_argument(
        "--timeout",
        type=seconds,
        default=TIMEOUT,
        metavar="S",
        help=f"wall-clock limit for loading, initializing and each step of a third-party FMU ({TIMEOUT:g} s)",
    )
    parser.add_argument(
        "--in-process",
        action="store_true",
        help="run a third-party FMU in this process: faster; a crash of the FMU ends apa",
    )


def add_output_arguments(parser: argparse.ArgumentParser, default: str) -> None:
    """Add the options that say what is written and where."""
    parser.add_argument("--out", type=Path, metavar="DIR", help=f"output folder (default: {default})")
    parser.add_argument("--force", action="store_true", help="replace a run that is in that folder")
    parser.add_argument("--json", action="store_true", help="print summary.json instead of the table")
    parser.add_argument("--no-page", action="store_true", help="write neither picture nor pages")


def seconds(text: str) -> float:
    """Return a limit of time [s] as the command line has it: ``5``, ``200 ms``."""
    from orchestrator.text.quantities import number

    try:
        found = number(text, "s")
    except BadInput as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    if not found > 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} is no time later than 0 s")
    return found
