"""``apa migrate``: rewrite the names of an earlier version in scenarios, studies, tests and sets of requirements."""

import argparse
from pathlib import Path

from fmus.files import write_whole
from orchestrator.inputs.scenario.migration import check_migrated, migrate
from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.errors import BadInput

EXAMPLES = """examples:
  apa migrate my-scenario.yaml                 rewrite the file in place
  apa migrate scenarios/*.yaml studies/*.yaml
  apa migrate my-scenario.yaml --output -      print the new text, leave the file
  apa migrate my-scenario.yaml --output new.yaml
  apa migrate my-scenario.yaml --check         exit code 1 if something would change

Comments, order and layout stay as they are. Python tests are not rewritten: an old name is answered with the new one.
exit code: 0 done, 1 with --check something would change, 2 bad input
"""
UP_TO_DATE, OUTDATED = 0, 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="scenario, study, test or requirements")
    parser.add_argument("--output", metavar="FILE", help="write here instead of in place; - prints; one FILE only")
    parser.add_argument("--check", action="store_true", help="write nothing, report what would change")


def run(arguments: argparse.Namespace) -> int:
    """Rewrite the files, all or none of them. Returns 1 if ``--check`` finds an old name, else 0."""
    if arguments.output and len(arguments.files) > 1:
        raise BadInput(f"{len(arguments.files)} files: expected one", key="--output")
    found = [(path, migrate(path)) for path in arguments.files]
    for path, migrated in found:
        check_migrated(path, migrated)
    for path, migrated in found:
        for change in migrated.changes:
            say(f"{path}:{change.line}: {change.old} -> {change.new}")
        if not arguments.check:
            _write(path, migrated.text, arguments.output, is_new=bool(migrated.changes))
    count = sum(len(migrated.changes) for _, migrated in found)
    say(f"apa: {count} names {'are out of date' if arguments.check else 'replaced'} in {len(found)} files")
    return OUTDATED if arguments.check and count else UP_TO_DATE


def _write(path: Path, text: str, output: str | None, *, is_new: bool) -> None:
    if output == "-":
        print(text, end="")
    elif output or is_new:
        write_whole(Path(output or path), text)
