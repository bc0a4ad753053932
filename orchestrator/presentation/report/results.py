"""What a run leaves in its folder beside the log: summary.json, the picture, the replay page."""

import json
from pathlib import Path

from fmus.files import write_whole
from orchestrator.evaluation.verdict.summary import Summary
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.failures import verdict_stands
from orchestrator.presentation.log.line import Line
from orchestrator.simulation.cosim.recording import Recording

LOG, SUMMARY, PICTURE, PAGE, LIVE = "run.mcap", "summary.json", "overview.png", "report.html", "live.html"
"""Names of the files in a run's folder."""


def write_summary(folder: Path, summary: Summary) -> str:
    """Write summary.json; return its text."""
    text = json.dumps(summary.as_json(), indent=2, allow_nan=False)
    write_whole(folder / SUMMARY, text + "\n")
    return text


def write_picture(folder: Path, recording: Recording, summary: Summary, scenario: Scenario) -> None:
    """Write overview.png."""
    from orchestrator.presentation.drawing.figure import picture
    from orchestrator.presentation.drawing.picture_data import overview_of

    with verdict_stands(str(folder / PICTURE)):
        write_whole(folder / PICTURE, picture(overview_of(recording, summary, scenario)))


def write_page(folder: Path, recording: Recording, summary: Summary, lines: list[Line]) -> None:
    """Write the replay page; it leads to the page that is driven, if there is one in ``folder``."""
    from orchestrator.presentation.report.replay import write_replay

    with verdict_stands(str(folder / PAGE)):
        write_replay(folder / PAGE, recording, summary, lines, LIVE if (folder / LIVE).exists() else "")


def is_shown(recording: Recording) -> bool:
    """Return whether a run has a duration, so that there is something to show."""
    return recording.count > 1
