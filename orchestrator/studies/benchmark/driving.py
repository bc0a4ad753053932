"""A scene driven by the FMUs: on the kinematic body without errors, and on the double-track body with all of them."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from orchestrator.evaluation.verdict.numbers import facts_of
from orchestrator.evaluation.verdict.summary import Summary, summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.recording import Recording

KINEMATIC, DOUBLE_TRACK = "kinematic", "double_track"
BODIES = {
    KINEMATIC: ("vehicle.body=kinematic",),
    DOUBLE_TRACK: (
        "vehicle.body=double_track",
        "vehicle.steering.dead_time=40 ms",
        "vehicle.steering.lag=50 ms",
        "vehicle.steering.backlash=0.03",
        "vehicle.drive.brake_lag=80 ms",
        "vehicle.odometry={ideal: false, radius_error: 0.001, steering_offset: 0.0002, tick: 0.01}",
        "vehicle.ultrasonic={noise: 0.01, dropout: 0.01}",
    ),
}
"""Body -> what is set of the vehicle: the double track has errors of steering, brake, odometry and sensors."""


class DrivenScene(NamedTuple):
    """How a drive ended. Clearance: of the outline to everything, NaN if not known."""

    parked: bool
    """Without contact."""
    reason: str
    contact: bool
    clearance: float
    """[m]"""
    length: float
    """Distance travelled [m]."""
    manoeuvres: int
    """Moves between changes of direction, also those before the first reverse one."""
    duration: float
    """[s]"""


class SceneRun(NamedTuple):
    """A drive with all that is known of it."""

    scenario: Scenario
    recording: Recording
    summary: Summary


def drive_scene(
    name: str,
    body: str,
    files: Mapping[str, Path] | None,
    kind: str,
    interrupt: Interrupt | None = None,
    overrides: Sequence[str] = (),
) -> tuple[DrivenScene, SceneRun]:
    """Return how the scene ``name`` (a file) was driven on ``body`` with ``overrides`` as of ``--set``, and the run."""
    scenario = load_scenario(name, [*BODIES[body], *overrides])
    ran = run_scenario(scenario, files, kind=kind, interrupt=interrupt)
    facts = facts_of(ran.recording, scenario)
    summary = summarize(ran.recording, scenario, ran.wall_time, facts=facts)
    clearance = facts.numbers["min_clearance"]
    if scenario.obstacles:
        clearance = float(np.minimum(clearance, facts.numbers["polygon_clearance"]))
    signals = ran.recording.signals
    speed = signals["controller.speed_request"]
    signs = np.sign(speed[speed != 0.0])
    manoeuvres = int((signs[1:] != signs[:-1]).sum()) + 1 if len(signs) else 0
    touched = math.isfinite(clearance) and clearance <= 0.0
    drive = DrivenScene(
        summary.is_done and not touched,
        "" if summary.is_done else summary.reason,
        touched,
        clearance,
        float(signals["vehicle.distance"][-1]),
        manoeuvres,
        summary.duration,
    )
    return drive, SceneRun(scenario, ran.recording, summary)
