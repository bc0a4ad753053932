"""A run as its picture shows it."""

import math

import numpy as np

from orchestrator.cosim.recording import Recording
from orchestrator.cosim.slave import Array
from orchestrator.drawing.overview import Overview, Ribbon, Standing
from orchestrator.drawing.panels import PICTURE_MODES, picture_signals
from orchestrator.scenario.scenario import Scenario
from orchestrator.text.quantities import DEGREE
from orchestrator.text.readable import changes_text, shifts_text
from orchestrator.verdict.geometry import CarOutline, described, kerbs, sample_path, slot_box, things
from orchestrator.verdict.summary import Summary, phase_changes

DRAWN = dict.fromkeys(
    (
        *picture_signals(),
        "vehicle.front_wheel_angle",
        *(f"{pose}.{axis}" for pose in ("vehicle.pose", "controller.reference") for axis in ("x", "y", "heading")),
    )
)
"""Signals in the picture."""


def overview_of(recording: Recording, summary: Summary, scenario: Scenario) -> Overview:
    """Return what the picture of a run shows."""
    vehicle = described(scenario, recording.parameters_of("vehicle"))
    around = Standing(
        things(vehicle),
        [list(corners) for corners in scenario.polygons],
        kerbs(vehicle),
        None if scenario.slot is None else slot_box(scenario.slot),
        None if scenario.target is None else scenario.target.pose,
    )
    return Overview(
        title=_title(summary, scenario),
        t=recording.t,
        signals={name: recording.signals[name] for name in DRAWN if name in recording.signals},
        changes=[row for row, _, _ in phase_changes(recording)],
        ribbon=_ribbon(recording),
        car=CarOutline.of(vehicle),
        around=around,
        planned=_planned(recording),
    )


def _title(summary: Summary, scenario: Scenario) -> str:
    final, changes, outcome = summary.final, changes_text(summary.changed), summary.outcome.replace("_", " ")
    name = f"{scenario.name} with {changes}" if changes else scenario.name
    text = f"{name}: {outcome} after {summary.duration:.1f} s"
    if not math.isfinite(final.lateral_error):
        return text
    errors = f"{final.lateral_error * 100:+.1f} cm lateral, {final.heading_error / DEGREE:+.2f} deg"
    return f"{text}, {shifts_text(summary.shifts)}; {errors}"


def _ribbon(recording: Recording) -> Ribbon:
    there = [name for name in PICTURE_MODES if name in recording.signals]
    shown = next((name for name in there if np.ptp(recording.signals[name]) > 0.0), PICTURE_MODES[-1])
    values = recording.signals.get(shown, np.full(len(recording.t), np.nan))
    return Ribbon(values, recording.states(shown))


def _planned(recording: Recording) -> Array:
    """Return the last path that was planned, (n, 2) [m]."""
    marks = [
        values
        for name, values in recording.signals.items()
        if name.endswith(("path.segments[1].length", "move.direction"))
    ]
    rows = np.flatnonzero(np.any([values != 0.0 for values in marks], axis=0)) if marks else np.empty(0, dtype=np.intp)
    return sample_path(recording.values_at("controller", int(rows[-1]))) if len(rows) else np.empty((0, 2))
