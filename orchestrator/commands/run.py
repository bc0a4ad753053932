"""``apa run``: one scenario, from YAML to log, figure, summary and exit code."""

import argparse
from pathlib import Path

from orchestrator.cosim.fmu_files import KINDS, default_kind
from orchestrator.report.results import LIVE, LOG, write_pages, write_summary
from orchestrator.scenario.scenario import Scenario
from orchestrator.session.drive import drive
from orchestrator.session.foreign import Foreign, add_foreign_arguments, foreign_of, load_fitting
from orchestrator.session.terminal import print_summary
from orchestrator.stream.realtime import Realtime
from orchestrator.text.console import say
from orchestrator.text.errors import INTERRUPTED, NOT_PARKED, PARKED
from orchestrator.text.owned import owned
from orchestrator.verdict.summary import summarize

PORT = 8765
"""Where Foxglove looks for a stream if nothing else is said."""
EXAMPLES = """examples:
  apa run guo2015-case4
  apa run guo2015-case4 --set vehicle.body=double_track --set "vehicle.driver.reaction_delay=300 ms" --out runs/late
  apa run guo2015-case4 --controller their.fmu --set controller.their_gain=2
  apa run guo2015-case4 --realtime --live
  apa run guo2015-case4 --set stop_time=30 --fmus none --out /tmp/trial --json

writes DIR/run.mcap, DIR/summary.json, DIR/overview.png, DIR/report.html (the replay) and DIR/live.html (to drive it
yourself); the first two if it is interrupted
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
    add_foreign_arguments(parser)
    parser.add_argument(
        "--realtime", action="store_true", help="as fast as the clock on the wall; says how late it was"
    )
    parser.add_argument(
        "--live",
        nargs="?",
        type=int,
        const=PORT,
        metavar="PORT",
        help=f"show the run as it goes, at this WebSocket ({PORT}), to Foxglove or Lichtblick; includes --realtime",
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="where results go (default: runs/NAME)")
    parser.add_argument("--json", action="store_true", help="print summary.json instead of the table")
    parser.add_argument("--no-page", action="store_true", help="write neither picture nor pages")
    parser.add_argument("--no-figure", action="store_true", dest="no_page", help=argparse.SUPPRESS)


def run(arguments: argparse.Namespace) -> int:
    """Run, write, print. Returns 0 parked or finished, 1 not, 130 interrupted."""
    scenario, left_out, foreign = load_fitting(arguments.scenario, arguments.set, foreign_of(arguments))
    if left_out:
        say(f"apa: warning: left out, the FMU does not have them: {', '.join(left_out)}")
    out: Path = arguments.out or Path("runs") / scenario.name
    with owned(out):
        return _run(arguments, scenario, foreign, out)


def _run(arguments: argparse.Namespace, scenario: Scenario, foreign: Foreign, out: Path) -> int:
    paced = arguments.realtime or arguments.live is not None
    ran = drive(scenario, arguments.fmus, out / LOG, foreign, Realtime(arguments.live, say) if paced else None)
    summary = summarize(ran.recording, scenario, ran.wall_time)
    text = write_summary(out, summary)
    interrupted = ran.end.reason == "interrupted"
    if not arguments.no_page and not interrupted:
        _write_live(out / LIVE, scenario, foreign)
        write_pages(out, ran.recording, summary, scenario)
    if arguments.json:
        print(text)
    else:
        print_summary(summary, scenario.title, scenario.expect)
        print(f"results in {out}")
    if interrupted:
        return INTERRUPTED
    return PARKED if summary.is_done else NOT_PARKED


def _write_live(path: Path, scenario: Scenario, foreign: Foreign) -> None:
    """Write the page on which the scenario is driven; none for somebody else's FMUs, or where nothing compiles C."""
    from fmus.native.web import can_build

    if can_build() and not foreign.files:
        from orchestrator.live.page import write_live
        from orchestrator.live.situation import why_not

        if not why_not(scenario):
            write_live(path, [scenario])
            return
    path.unlink(missing_ok=True)
