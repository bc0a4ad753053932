"""``apa run``: one scenario, from YAML to log, figure, summary and exit code."""

import argparse
import json
from pathlib import Path

from orchestrator.cosim.fmu_files import KINDS, default_kind, fmu_files
from orchestrator.cosim.interrupts import on_interrupt
from orchestrator.cosim.master import End, Interrupt
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.scenario.scenario import Scenario
from orchestrator.session.session import Ran, run_scenario
from orchestrator.session.terminal import print_summary
from orchestrator.text.console import Meter, say
from orchestrator.text.errors import INTERRUPTED, NOT_PARKED, PARKED
from orchestrator.verdict.summary import Summary, summarize

SHOWN_NS = 500_000_000
"""Simulated time between two looks at how far a run is."""
EXAMPLES = """examples:
  apa run guo2015-case4
  apa run my.yaml --set vehicle.body=double_track --set "vehicle.steering.rate_limit=105 deg/s"
  apa run guo2015-case4 --set stop_time=30 --fmus none --out /tmp/trial --json

writes DIR/run.mcap, DIR/summary.json, DIR/overview.png and DIR/report.html (the replay)
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
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
    files = None if kind == "none" else fmu_files(kind, say)
    out.mkdir(parents=True, exist_ok=True)
    interrupt = Interrupt()
    with on_interrupt(interrupt), _Clock(scenario.name, scenario.stop_time, "s") as clock:
        ran = run_scenario(scenario, files, kind=kind, log=out / "run.mcap", observers=(clock,), interrupt=interrupt)
    return ran, summarize(ran.recording, scenario, ran.wall_time)


class _Clock(Meter):
    """Observer that shows the simulated time."""

    _next_ns = 0

    def exchanged(self, t_ns: int) -> None:
        """Show the time now and then."""
        if t_ns >= self._next_ns:
            self._next_ns = t_ns + SHOWN_NS
            self.at(t_ns / 1e9)

    def closed(self, end: End) -> None:
        """Nothing to close."""
