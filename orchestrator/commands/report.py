"""``apa report``: the replay page of a run, one HTML file that needs nothing else."""

import argparse
from pathlib import Path

from orchestrator.log.messages import read_messages
from orchestrator.log.read_log import log_file, read_log
from orchestrator.report.replay import write_replay
from orchestrator.text.console import say
from orchestrator.text.errors import PARKED
from orchestrator.text.owned import owned_with
from orchestrator.verdict.logged import logged
from orchestrator.verdict.summary import summarize

EXAMPLES = """examples:
  apa report runs/guo2015-case4                           writes runs/guo2015-case4/report.html
  apa report run.mcap --out /tmp/page.html

The page plays the run in any browser, offline: top view, curves, states, checks, parameters.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("log", type=log_file, metavar="RUN.mcap", help="log of a run, or its folder")
    parser.add_argument("--out", type=Path, metavar="FILE", help="the page (default: report.html beside the log)")


def run(arguments: argparse.Namespace) -> int:
    """Write the page. Returns 0."""
    log: Path = arguments.log
    out: Path = arguments.out or log.parent / "report.html"
    with owned_with(log, out):
        recording = read_log(log)
        scenario, note = logged(recording, str(log), log.stem)
        if note:
            say(note)
        write_replay(out, recording, summarize(recording, scenario, 0.0, note), read_messages(log))
    print(out)
    return PARKED
