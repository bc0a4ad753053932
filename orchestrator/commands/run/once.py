"""One scenario run, written and printed."""

import argparse
from pathlib import Path
from typing import NamedTuple

from fmus.files import write_whole
from orchestrator.commands.run.run_folder import run_folder
from orchestrator.evaluation.verdict.summary import Summary, summarize
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.errors import INTERRUPTED, NOT_PARKED, PARKED
from orchestrator.inputs.text.failures import verdict_stands
from orchestrator.inputs.text.readable import shortly
from orchestrator.presentation.drawing.picture_data import overview_of
from orchestrator.presentation.drawing.picture_process import PictureBeside
from orchestrator.presentation.report.results import (
    LIVE,
    LOG,
    PICTURE,
    is_shown,
    write_page,
    write_picture,
    write_summary,
)
from orchestrator.session.drive import drive
from orchestrator.session.foreign import ImportedFmus, foreign_of, load_bound_scenario
from orchestrator.session.session import SimulationResult
from orchestrator.session.stream.realtime import Realtime
from orchestrator.simulation.cosim.recording import Recording


class Done(NamedTuple):
    """A run that was written and printed."""

    recording: Recording
    code: int
    """0 parked or finished, 1 not, 130 interrupted."""


def run_once(arguments: argparse.Namespace, beside: PictureBeside | None) -> int:
    """Load the scenario, run, write, print; return the exit code."""
    scenario, left_out, foreign = load_bound_scenario(arguments.scenario, arguments.set, foreign_of(arguments))
    if left_out:
        say(f"apa: note: parameters that the FMU does not have are left out: {shortly(left_out)}")
    paced = arguments.realtime or arguments.live is not None
    realtime = Realtime(arguments.live, say) if paced else None
    return execute(arguments, scenario, foreign, arguments.out, beside, realtime).code


def execute(
    arguments: argparse.Namespace,
    scenario: Scenario,
    foreign: ImportedFmus,
    chosen: Path | None,
    beside: PictureBeside | None = None,
    realtime: Realtime | None = None,
) -> Done:
    """Run a scenario, write its folder, print its verdict (``arguments``: fmus, force, json, no_page)."""
    with run_folder(chosen, scenario.name, force=arguments.force) as out:
        ran = drive(scenario, arguments.fmus, out / LOG, foreign, realtime)
        summary = summarize(ran.recording, scenario, ran.wall_time)
        text = write_summary(out, summary)
        interrupted = ran.end.reason == "interrupted"
        is_drawn = is_shown(ran.recording) and not interrupted and not arguments.no_page
        if is_drawn and beside is not None:
            beside.begin(overview_of(ran.recording, summary, scenario))
        _print_result(arguments, text, summary, scenario)
        if not interrupted and not arguments.no_page:
            _write_pages(out, ran, summary, scenario, foreign)
        if is_drawn and beside is not None:
            with verdict_stands(str(out / PICTURE)):
                write_whole(out / PICTURE, beside.picture())
        elif is_drawn:
            write_picture(out, ran.recording, summary, scenario)
    if not arguments.json:
        print(f"results in {out}")
    code = INTERRUPTED if interrupted else PARKED if summary.is_done else NOT_PARKED
    return Done(ran.recording, code)


def _print_result(arguments: argparse.Namespace, text: str, summary: Summary, scenario: Scenario) -> None:
    """Print summary.json, or its table."""
    if arguments.json:
        print(text)
        return
    from orchestrator.session.terminal import print_summary

    print_summary(summary, scenario.title, scenario.expected_outcome)


def _write_pages(out: Path, ran: SimulationResult, summary: Summary, scenario: Scenario, foreign: ImportedFmus) -> None:
    """Write the page that is driven, and the replay page if the run has an instant."""
    with verdict_stands(str(out / LIVE)):
        _write_live(out / LIVE, scenario, foreign)
    if is_shown(ran.recording):
        write_page(out, ran.recording, summary, ran.lines)


def _write_live(path: Path, scenario: Scenario, foreign: ImportedFmus) -> None:
    """Write the page on which the scenario is driven; none for imported FMUs, or without a C compiler."""
    from fmus.native.web import can_build

    if can_build() and not foreign.files:
        from orchestrator.studies.live.page import write_live
        from orchestrator.studies.live.situation import why_not

        if not why_not(scenario):
            write_live(path, [scenario])
            return
    path.unlink(missing_ok=True)
