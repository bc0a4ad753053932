"""One scenario run, written and printed."""

import argparse
from pathlib import Path

from fmus.files import write_whole
from orchestrator.drawing.beside import PictureBeside
from orchestrator.drawing.seen import overview_of
from orchestrator.report.results import LIVE, LOG, PICTURE, is_shown, write_page, write_summary
from orchestrator.scenario.scenario import Scenario
from orchestrator.session.drive import drive
from orchestrator.session.foreign import Foreign, foreign_of, load_fitting
from orchestrator.session.session import Ran
from orchestrator.stream.realtime import Realtime
from orchestrator.text.console import say
from orchestrator.text.errors import INTERRUPTED, NOT_PARKED, PARKED
from orchestrator.text.failures import verdict_stands
from orchestrator.text.owned import owned
from orchestrator.text.readable import shortly
from orchestrator.verdict.summary import Summary, summarize


def run_once(arguments: argparse.Namespace, beside: PictureBeside | None) -> int:
    """Run, write, print; with pages if there is somebody ``beside`` who draws."""
    scenario, left_out, foreign = load_fitting(arguments.scenario, arguments.set, foreign_of(arguments))
    if left_out:
        say(f"apa: warning: left out, the FMU does not have them: {shortly(left_out)}")
    out: Path = arguments.out or Path("runs") / scenario.name
    with owned(out):
        paced = arguments.realtime or arguments.live is not None
        ran = drive(scenario, arguments.fmus, out / LOG, foreign, Realtime(arguments.live, say) if paced else None)
        summary = summarize(ran.recording, scenario, ran.wall_time)
        text = write_summary(out, summary)
        interrupted = ran.end.reason == "interrupted"
        drawer = beside if is_shown(ran.recording) and not interrupted else None
        if drawer is not None:
            drawer.begin(overview_of(ran.recording, summary, scenario))
        _tell(arguments, text, summary, scenario)
        if beside is not None and not interrupted:
            _write_pages(out, ran, summary, scenario, foreign)
        if drawer is not None:
            with verdict_stands(str(out / PICTURE)):
                write_whole(out / PICTURE, drawer.picture())
    if not arguments.json:
        print(f"results in {out}")
    if interrupted:
        return INTERRUPTED
    return PARKED if summary.is_done else NOT_PARKED


def _tell(arguments: argparse.Namespace, text: str, summary: Summary, scenario: Scenario) -> None:
    """Print summary.json, or what it says as a table."""
    if arguments.json:
        print(text)
        return
    from orchestrator.session.terminal import print_summary

    print_summary(summary, scenario.title, scenario.expect)


def _write_pages(out: Path, ran: Ran, summary: Summary, scenario: Scenario, foreign: Foreign) -> None:
    """Write the page that is driven, and the replay page if there is something to show."""
    with verdict_stands(str(out / LIVE)):
        _write_live(out / LIVE, scenario, foreign)
    if is_shown(ran.recording):
        write_page(out, ran.recording, summary, ran.lines)


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
