"""A run as its picture shows it."""

import math

import numpy as np

from orchestrator.evaluation.verdict.geometry import (
    PLANNED,
    CarOutline,
    is_planned,
    kerbs,
    key_points,
    moving_boxes,
    sample_path,
    slot_box,
    vehicle_parameters,
)
from orchestrator.evaluation.verdict.summary import Summary, phase_changes
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.quantities import RAD_PER_DEGREE
from orchestrator.inputs.text.readable import changes_text, manoeuvres_text
from orchestrator.presentation.drawing.decimation import decimate
from orchestrator.presentation.drawing.overview import Overview, Ribbon, Standing
from orchestrator.presentation.drawing.panels import PICTURE_MODES, picture_signals
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording

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
    recording = decimate(recording)
    vehicle = vehicle_parameters(scenario, recording.parameters_of("vehicle"))
    around = Standing(
        moving_boxes(vehicle),
        [list(corners) for corners in scenario.obstacles],
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
        planned=_last_path(recording),
        points=path_points(recording),
    )


def _title(summary: Summary, scenario: Scenario) -> str:
    final, changes, outcome = summary.final, changes_text(summary.overrides), summary.outcome.replace("_", " ")
    name = f"{scenario.name} with {changes}" if changes else scenario.name
    text = f"{name}: {outcome} after {summary.duration:.1f} s"
    if not math.isfinite(final.lateral_error):
        return text
    errors = f"{final.lateral_error * 100:+.1f} cm lateral, {final.heading_error / RAD_PER_DEGREE:+.2f} deg"
    return f"{text}, {manoeuvres_text(summary.manoeuvres)}; {errors}"


def _ribbon(recording: Recording) -> Ribbon:
    there = [name for name in PICTURE_MODES if name in recording.signals]
    shown = next((name for name in there if np.ptp(recording.signals[name]) > 0.0), PICTURE_MODES[-1])
    values = recording.signals.get(shown, np.full(len(recording.t), np.nan))
    return Ribbon(values, recording.states(shown))


def path_points(recording: Recording) -> dict[str, tuple[float, float]]:
    """Return the points of the last path by name, Q1 to Q4 or P1 to P4 [m]; LA1 and LA2 move with the car."""
    rows = np.flatnonzero(is_planned(recording.signals))
    if not len(rows):
        return {}
    points = key_points(recording.values_at("controller", int(rows[-1])))
    return {name: point for name, point in points.items() if not name.startswith("LA")}


def path_plans(recording: Recording, most: int = 40) -> list[Array]:
    """Return the paths planned during a run one after the other, (n, 2) [m] each: at most the last ``most``."""
    planned = is_planned(recording.signals)
    names = [name for name in recording.signals if PLANNED.match(name.removeprefix("controller."))]
    if not planned.any():
        return []
    table = np.column_stack([planned, *(recording.signals[name] for name in names)])
    begun = np.append(True, (table[1:] != table[:-1]).any(axis=1))
    parameters = recording.parameters_of("controller")
    rows = np.flatnonzero(begun & planned)[-most:]
    return [sample_path(recording.values_at("controller", int(row)), parameters=parameters) for row in rows]


def _last_path(recording: Recording) -> Array:
    """Return the last path that was planned, (n, 2) [m]."""
    rows = np.flatnonzero(is_planned(recording.signals))
    if not len(rows):
        return np.empty((0, 2))
    values = recording.values_at("controller", int(rows[-1]))
    return sample_path(values, parameters=recording.parameters_of("controller"))
