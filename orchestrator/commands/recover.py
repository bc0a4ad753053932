"""``apa recover``: repair the log of a killed run."""

import argparse
from pathlib import Path

from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.locked_folder import lock_with
from orchestrator.presentation.log.recover import recover

EXAMPLES = """examples:
  apa recover runs/guo2015-case4/run.mcap.part
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("file", type=Path, metavar="FILE", help="incomplete or damaged log, usually run.mcap.part")


def run(arguments: argparse.Namespace) -> int:
    """Write the repaired log and print what is in it and what is lost. Returns 0."""
    with lock_with(arguments.file, arguments.file):
        found = recover(arguments.file)
    content = f"{found.messages} messages up to {found.last_ns / 1e9:.2f} s"
    if found.path == arguments.file:
        print(f"{found.path}: is whole, {content}; nothing to mend")
        return 0
    for text in found.lost:
        say(f"apa: lost: {text}")
    print(f"{found.path}: {content} ({'all that was there' if found.complete else 'all that is whole'})")
    return 0
