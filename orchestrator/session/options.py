"""The options for FMUs and output, as several commands have them; imports little."""

import argparse
import re
from pathlib import Path

from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.kinds import KINDS, default_kind
from orchestrator.simulation.imported.limits import MEMORY_BYTES, RUN_TIMEOUT, STEP_TIMEOUT


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
        default=STEP_TIMEOUT,
        metavar="S",
        help=f"wall-clock limit for loading, initializing and each step of a third-party FMU ({STEP_TIMEOUT:g} s)",
    )
    parser.add_argument(
        "--run-timeout",
        type=seconds,
        default=RUN_TIMEOUT,
        metavar="S",
        help=f"wall-clock limit for all calls of a third-party FMU together ({RUN_TIMEOUT:g} s)",
    )
    parser.add_argument(
        "--fmu-memory",
        type=memory,
        default=MEMORY_BYTES,
        metavar="SIZE",
        help=f"memory limit for the process of each third-party FMU ({MEMORY_BYTES / 1e9:g} GB)",
    )
    parser.add_argument(
        "--sandbox",
        action="store_true",
        help="run third-party FMUs without network, other processes and write access (needs bubblewrap)",
    )
    parser.add_argument(
        "--in-process",
        action="store_true",
        help="run a third-party FMU in this process: faster; a crash of the FMU ends apa",
    )


def add_fmus_argument(parser: argparse.ArgumentParser) -> None:
    """Add the option that says which of the shipped FMUs are used."""
    parser.add_argument(
        "--fmus",
        choices=(*KINDS, "none"),
        default=default_kind(),
        help="kind of FMU (default: native where it can be built); none runs the models in process",
    )


def add_output_arguments(parser: argparse.ArgumentParser, default: str) -> None:
    """Add the options that say what is written and where."""
    parser.add_argument("--out", type=Path, metavar="DIR", help=f"output folder (default: {default})")
    parser.add_argument("--force", action="store_true", help="replace an existing run in the output folder")
    parser.add_argument("--json", action="store_true", help="print summary.json instead of the table")
    parser.add_argument("--no-page", action="store_true", help="write neither figure nor pages")


def seconds(text: str) -> float:
    """Return a limit of time [s] as the command line has it: ``5``, ``200 ms``."""
    from orchestrator.inputs.text.quantities import number

    try:
        found = number(text, "s")
    except BadInput as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    if not found > 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} is no time later than 0 s")
    return found


SIZES = {"": 1.0, "kB": 1e3, "MB": 1e6, "GB": 1e9}


def memory(text: str) -> float:
    """Return a size [bytes] as the command line has it: ``500 MB``, ``8GB``."""
    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*(kB|MB|GB|)\s*", text)
    found = float(match[1]) * SIZES[match[2]] if match else 0.0
    if not MIN_MEMORY <= found < 1e15:
        raise argparse.ArgumentTypeError(f"{text!r} is no size of at least 64 MB, such as 500MB or 8GB")
    return found


MIN_MEMORY = 64e6
