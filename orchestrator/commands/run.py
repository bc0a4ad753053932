"""``apa run``: one scenario, from YAML to log, figure, summary and exit code."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from orchestrator.cosim.fmu_files import KINDS, default_kind, fmu_files
from orchestrator.cosim.interrupts import on_interrupt
from orchestrator.cosim.master import Interrupt, Observer
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.scenario.scenario import Scenario
from orchestrator.session.session import Ran, run_scenario
from orchestrator.session.terminal import INTERRUPTED, NOT_PARKED, PARKED, ProgressBar, print_summary
from orchestrator.verdict.summary import Summary, summarize

EXAMPLES = """examples:
  apa run guo2015-case4
  apa run my.yaml --set vehicle.body=double_track --set "vehicle.steering.rate_limit=105 deg/s"
  apa run guo2015-case4 --set stop_time=30 --fmus none --out /tmp/trial --json

writes DIR/run.mcap, DIR/summary.json, DIR/overview.png and DIR/report.html (the replay)
"""


def add_parser(subparsers: Any) -> argparse.ArgumentParser:
    """Add the command."""
    parser: argparse.ArgumentParser = subparsers.add_parser("run", help="run a scenario", epilog=EXAMPLES)
    parser.add_argument("scenario", metavar="NAME|FILE", help="a shipped scenario, or a YAML file")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="vehicle.KEY, controller.KEY or a scenario key"
    )
    parser.add_argument(
        "--fmus",
        choices=(*KINDS, "none"),
        default=default_kind(),
        help="kind of FMU (default: native where it can be built); none runs the models in process",
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="where results go (default: runs/NAME)")
    parser.add_argument("--json", action="store_true", help="print summary.json instead of the table")
    parser.add_argument("--no-figure", action="store_true", help="write neither overview.png nor report.html")
    return parser


def run(arguments: argparse.Namespace) -> int:
    """Run, write, print. Returns 0 parked, 1 not parked, 130 interrupted."""
    scenario = load_scenario(arguments.scenario, arguments.set)
    out: Path = arguments.out or Path("runs") / scenario.name
    ran, summary = _drive(scenario, arguments.fmus, out)
    text = json.dumps(summary.as_json(), indent=2, allow_nan=False)
    (out / "summary.json").write_text(text + "\n", encoding="utf-8")
    if not arguments.no_figure and len(ran.recording.t) > 1:
        from orchestrator.drawing.figure import draw

        draw(ran.recording, summary, scenario, out / "overview.png")
    if not arguments.no_figure and len(ran.recording.t) > 1:
        from orchestrator.report.replay import write_replay
        from orchestrator.report.words import read_words

        write_replay(out / "report.html", ran.recording, summary, read_words(out / "run.mcap"))
    if arguments.json:
        print(text)
    else:
        print_summary(summary, scenario.title, scenario.expect)
        print(f"results in {out}")
    if ran.end.reason == "interrupted":
        return INTERRUPTED
    return PARKED if summary.outcome == "parked" else NOT_PARKED


def _drive(scenario: Scenario, kind: str, out: Path) -> tuple[Ran, Summary]:
    def say(text: str) -> None:
        print(text, file=sys.stderr)

    files = None if kind == "none" else fmu_files(kind, say)
    out.mkdir(parents=True, exist_ok=True)
    shown: tuple[Observer, ...] = (ProgressBar(scenario.name, scenario.stop_ns),) if sys.stderr.isatty() else ()
    interrupt = Interrupt()
    with on_interrupt(interrupt):
        ran = run_scenario(scenario, files, kind=kind, log=out / "run.mcap", observers=shown, interrupt=interrupt)
    return ran, summarize(ran.recording, scenario, ran.wall_time)
