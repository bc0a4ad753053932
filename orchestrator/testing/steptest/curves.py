"""The page of a step test: expectations with their verdicts, and the curves they are about, as in a replay."""

from pathlib import Path

import numpy as np

from fmus.files import write_whole
from orchestrator.evaluation.verdict.judge import Check
from orchestrator.presentation.report.charts import charts_of
from orchestrator.presentation.report.page import page
from orchestrator.presentation.report.payload import Arrays
from orchestrator.presentation.report.plots import plot_of
from orchestrator.presentation.report.replay import check_rows, foot, page_of_limited_size
from orchestrator.presentation.report.run_data import ribbons_of, run_data
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.testing.steptest.step_test import StepTest

MAX_STIMULI = 12
"""Curves of signals that nothing is expected of."""


def write_curves(path: Path, test: StepTest, recording: Recording, checks: list[Check]) -> None:
    """Write the page of one test; fewer instants are kept if it would pass 1 MB."""
    write_whole(path, page_of_limited_size(lambda most: _page(test, recording, checks, most)))


def _page(test: StepTest, recording: Recording, checks: list[Check], most: int) -> str:
    arrays, title, missed = Arrays(), test.title or test.name, sum(not check.passed for check in checks)
    run = run_data(recording, arrays, [], label="", most=most, keep=[check.t for check in checks])
    run["checks"] = check_rows(sorted(checks, key=lambda item: item.passed))
    header = {
        "title": title,
        "name": test.name,
        "subtitle": f"step test of {test.model}",
        "verdict": {"text": f"{len(checks) - missed} of {len(checks)} met", "kind": "bad" if missed else "good"},
        "facts": [["Duration", f"{recording.duration:.2f} s"]],
        "plots": [
            plot_of(name, recording.variables[name].signal.unit, 0.0, [name], _limits(checks, name, recording))
            for name in _signal_names(checks, recording)
        ],
        "ribbons": ribbons_of([recording]),
        "runs": [run],
        "foot": foot(recording, run["rows"]),
        "live": "",
        "charts": charts_of(recording),
    }
    return page(title, arrays.pack(header))


def _signal_names(checks: list[Check], recording: Recording) -> list[str]:
    """Return the signals of which something is expected, then others that change: the stimuli, and what they do."""
    changing = [name for name, values in recording.signals.items() if np.nanmin(values) != np.nanmax(values)]
    judged = [check.signal for check in checks if check.signal in recording.signals]
    return list(dict.fromkeys([*judged, *changing[:MAX_STIMULI]]))


def _limits(checks: list[Check], name: str, recording: Recording) -> list[Check]:
    """Return the checks whose limit is a value of a signal, not a time, a share or a difference from a reference."""
    unit = recording.variables[name].signal.unit
    return [item for item in checks if item.signal == name and item.unit == unit and item.source != "reference"]
