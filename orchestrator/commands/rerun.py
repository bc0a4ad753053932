"""``apa rerun``: a run once more, from its log alone, compared with it signal by signal."""

import argparse
from pathlib import Path

import numpy as np

from orchestrator.commands.run.once import execute
from orchestrator.evaluation.verdict.logged_scenario import read_logged_scenario
from orchestrator.evaluation.verdict.summary import FmuUsed
from orchestrator.inputs.text.console import console, say
from orchestrator.inputs.text.errors import BAD_INPUT, BadInput
from orchestrator.presentation.log.read_log import log_file, read_log
from orchestrator.session.foreign import FOREIGN, ImportedFmus, sha256_of
from orchestrator.session.options import add_output_arguments
from orchestrator.session.trust import require_trust
from orchestrator.simulation.cosim.recording import Recording

EXAMPLES = """examples:
  apa rerun runs/guo2015-case4                     results in runs/guo2015-case4-rerun
  apa rerun runs/guo2015-case4/run.mcap --out /tmp/again --no-page
  apa list runs                                    which runs there are, and by which command

The log contains scenario, parameters, seed, and the paths and hashes of the FMUs. Exit codes: those of `apa run`, and 2
if a signal differs from the log or an FMU has changed.
"""

ROWS_AT_ONCE = 1 << 18
"""Exchanges of two runs that are compared at once."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("log", metavar="RUN", help="a run's folder or its log")
    add_output_arguments(parser, "the run's folder with -rerun")


def run(arguments: argparse.Namespace) -> int:
    """Run the log's scenario again. Returns what ``apa run`` returns, or 2 if a signal or an FMU differs."""
    log = log_file(arguments.log)
    first = read_log(log)
    if not first.info.get("scenario"):
        raise BadInput("has no scenario, so there is nothing to run again", file=log)
    scenario = read_logged_scenario(first, str(log))
    used = [FmuUsed(**item) for item in first.info.get("fmus", [])]
    changed = [item.name for item in used if item.kind == FOREIGN and not _is_same_file(item, log)]
    files = {item.name: Path(item.path) for item in used if item.kind == FOREIGN}
    require_trust(log, map(str, files.values()))
    kinds = {item.kind for item in used} - {FOREIGN}
    arguments.fmus = kinds.pop() if len(kinds) == 1 else "none"
    out: Path = arguments.out or log.parent.with_name(f"{log.parent.resolve().name}-rerun")
    for name in changed:
        say(f"apa: warning: the FMU of {name} has changed since")
    done = execute(arguments, scenario, ImportedFmus(files), out)
    different = differing_signals(first, done.recording)
    if not arguments.json:
        text = f"differs from the log in {', '.join(different[:8])}" if different else "identical to the log"
        more = f" and {len(different) - 8} more signals" if len(different) > 8 else ""
        console().print(f"{text}{more}", markup=False)
    return BAD_INPUT if different or changed else done.code


def differing_signals(first: Recording, second: Recording) -> list[str]:
    """Return the signals that are not equal to the last bit, or that only one of the runs has."""
    if first.count != second.count or not _are_equal(first, second, None):
        return ["time"]
    names = sorted(first.signals.keys() | second.signals.keys())
    return [name for name in names if not _are_equal(first, second, name)]


def _are_equal(first: Recording, second: Recording, name: str | None) -> bool:
    """Return whether both have a signal, or the times (None), and the same values of it."""
    if name is not None and not (name in first.signals and name in second.signals):
        return False
    ranges = [(begin, min(begin + ROWS_AT_ONCE, first.count)) for begin in range(0, first.count, ROWS_AT_ONCE)]
    for begin, end in ranges:
        one, two = first.between(begin, end), second.between(begin, end)
        if name is None and not np.array_equal(one.t_ns, two.t_ns):
            return False
        if name is not None and not np.array_equal(one.signals[name], two.signals[name], equal_nan=True):
            return False
    return True


def _is_same_file(used: FmuUsed, log: Path) -> bool:
    """Return whether the file of an FMU is that of the log. Raises ``BadInput`` if it is not there."""
    path = Path(used.path)
    if not path.is_file():
        raise BadInput(f"the FMU of {used.name} is no longer there: {path}", file=log)
    return sha256_of(path) == used.sha256
