"""Zhang 2022: path, heading, speed and front-wheel angle over time, and how far each is from its reference."""

import math
from pathlib import Path

import numpy as np

from orchestrator.cosim.slave import Array
from orchestrator.papers.motion_figure import draw_zhang
from orchestrator.papers.result import Drive, Driven, Reproduction, Row

TITLE = "Parallel parking simulation analysis based on CarSim (Zhang et al. 2022)"
NOTES = [
    "The paper prints curves, no numbers of the error, and neither slot, start pose, weights nor horizon: those are "
    "chosen; the checks are ours (2 cm rms, 5 cm, 1 deg, 5 %).",
    "(5) gives four conditions for a quintic's six coefficients; the other two are zero curvature at both ends.",
    'The "height 2.229" of Table 1 is a slip; it is not used.',
    "A quintic of zero curvature at both ends peaks higher than the arc it replaces (1.6 times here), so the arcs "
    "must be that much wider than the car's smallest: the slot is 7.7 m for a car of 4.44 m.",
    "zhang2022-refused starts 7 m ahead: refused, with the best curvature found beside the limit.",
]
PLANNED = 2.0
"""Phase PATH_TRACKING."""


def reproduce(out: Path, drive: Drive) -> Reproduction:
    """Return measured numbers beside the limits; writes zhang2022.png to ``out``."""
    runs = [drive("zhang2022"), drive("zhang2022-double-track")]
    rows = [row for driven in runs for row in _rows(driven)]
    refused = drive("zhang2022-refused")
    name, last = refused.summary.scenario, {key: float(values[-1]) for key, values in refused.recording.signals.items()}
    rows.append(Row(name, "outcome", "", "failed", refused.summary.outcome, 0.0))
    rows.append(Row(name, "reason", "", "no_path", refused.summary.reason, 0.0))
    rows.append(Row(name, "curvature of the best path", "1/m", None, last["controller.zhang2022.largest_curvature"]))
    rows.append(Row(name, "curvature limit of the path", "1/m", None, curvature_limit(refused)))
    return Reproduction("zhang2022", TITLE, rows, [draw_zhang(runs, out / "zhang2022.png")], NOTES)


def curvature_limit(driven: Driven) -> float:
    """Return the share of the car's curvature that a path may use [1/m]."""
    p = driven.recording.parameters_of("controller")
    lock = p["car.steering.angle_limit"] / p["car.steering.ratio"]
    return p["zhang2022.quintic.curvature_share"] * math.tan(lock) / p["car.wheelbase"]


def tracking(driven: Driven) -> Array:
    """Return which instants are driven along the path."""
    return np.asarray(driven.recording.signals["controller.phase"] == PLANNED)


def cruising(driven: Driven) -> Array:
    """Return which instants are after the start and before the ramp to the target: full set speed for a second."""
    t, wanted = driven.recording.t, driven.recording.signals["controller.zhang2022.set_speed"]
    full = np.abs(wanted) >= 0.999 * driven.recording.parameters["controller.zhang2022.speed"]
    since = float(t[np.flatnonzero(full)[0]]) + 1.0
    return np.asarray(full & (t > since))


def _rows(driven: Driven) -> list[Row]:
    name, signals = driven.summary.scenario, driven.recording.signals
    on = tracking(driven)
    lateral = signals["controller.lateral_error"][on]
    angle = signals["vehicle.front_wheel_angle"] - signals["controller.zhang2022.reference_angle"]
    speed = signals["vehicle.speed"] - signals["controller.zhang2022.set_speed"]
    share = float(np.abs(speed[cruising(driven)]).max()) / driven.recording.parameters["controller.zhang2022.speed"]
    iterations = signals["controller.zhang2022.iterations"][on]
    status = set(signals["controller.zhang2022.solver_status"][on].astype(int).tolist()) - {0}
    final = driven.summary.final
    return [
        Row(name, "outcome", "", "parked", driven.summary.outcome, 0.0),
        Row(name, "lateral error, rms", "m", 0.0, float(np.sqrt(np.mean(lateral**2))), 0.02),
        Row(name, "lateral error, largest", "m", 0.0, float(np.abs(lateral).max()), 0.05),
        Row(name, "heading at the end", "deg", 0.0, math.degrees(final.heading_error), 1.0),
        Row(name, "speed off its set value after the start", "%", 0.0, 100.0 * share, 5.0),
        Row(
            name,
            "front-wheel angle off the path's, rms",
            "deg",
            None,
            math.degrees(float(np.sqrt(np.mean(angle[on] ** 2)))),
        ),
        Row(name, "largest iterations of the QP", "1", None, float(iterations.max())),
        Row(name, "every QP solved", "", "yes", "yes" if status == {1} else "no", 0.0),
        Row(name, "smallest clearance", "m", None, float(signals["vehicle.clearance"].min())),
        Row(name, "time", "s", None, driven.summary.duration),
    ]
