"""``apa recover``: mend the log of a run that was killed."""

import argparse
from pathlib import Path

from orchestrator.log.recover import recover

EXAMPLES = """examples:
  apa recover runs/guo2015-case4/run.mcap.part
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("file", type=Path, help="a log, usually run.mcap.part")


def run(arguments: argparse.Namespace) -> int:
    """Write the mended log and print what is in it. Returns 0."""
    found = recover(arguments.file)
    whole = "was whole already" if found.complete else "all but the unfinished last chunk"
    print(f"{found.path}: {found.messages} messages up to {found.last_ns / 1e9:.2f} s ({whole})")
    return 0
