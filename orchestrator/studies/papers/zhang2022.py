"""Zhang 2022: path, heading, speed and front-wheel angle over time, and how far each is from its reference."""

import math

import numpy as np

from controller_fmu.zhang2022.phases import ZhangPhase
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.papers.result import CONCLUSION, OWN, Drive, Driven, Reproduction, Row, not_tested, yes_row

TITLE = "Parallel parking simulation analysis based on CarSim (Zhang et al. 2022)"
NOTES = [
    "The paper prints curves, no numbers of the error, and neither slot, start pose, weights nor horizon: those are "
    "chosen. So what is checked is that the car parks and touches nothing, and our own results, a little looser.",
    "(5) gives four conditions for a quintic's six coefficients; the other two are zero curvature at both ends.",
    'The "height 2.229" of Table 1 is a slip; it is not used.',
    "A quintic of zero curvature at both ends peaks higher than the arc it replaces (1.6 times here), so the arcs "
    "must be that much wider than the car's smallest: the slot is 7.7 m for a car of 4.44 m.",
    "zhang2022-refused starts 7 m ahead: refused, with the best curvature found beside the limit.",
]
UNTESTED = [
    not_tested("Fig. 5 to 8: errors of path, heading, speed, angle", "printed as curves without numbers"),
    not_tested("gains of (8), weights and horizon of the MPC", "not printed; zhang2022-pid has all three terms of (8)"),
    not_tested(
        "Fig. 2: slot a, b, c, d and l_c, l_k, l_w", "letters without numbers; the slot here is chosen, contact seen"
    ),
]


def reproduce(drive: Drive) -> Reproduction:
    """Return measured numbers beside the limits."""
    runs = [drive("zhang2022"), drive("zhang2022-double-track"), drive("zhang2022-pid")]
    rows = UNTESTED + [row for driven in runs for row in _rows(driven)]
    refused = drive("zhang2022-refused")
    name, last = refused.summary.scenario, {key: float(values[-1]) for key, values in refused.recording.signals.items()}
    best, limit = last["controller.zhang2022.largest_curvature"], curvature_limit(refused)
    rows.append(Row(name, "curvature of the best path", "1/m", None, best))
    rows.append(Row(name, "curvature limit of the path", "1/m", None, limit))
    right = refused.summary.reason == "no_path" and best > limit
    rows.append(yes_row(name, "refused, its best path being beyond the limit", right, OWN))
    return Reproduction("zhang2022", TITLE, rows, NOTES)


def curvature_limit(driven: Driven) -> float:
    """Return the share of the car's curvature that a path may use [1/m]."""
    p = driven.recording.parameters_of("controller")
    lock = p["car.steering.angle_limit"] / p["car.steering.ratio"]
    return p["zhang2022.quintic.curvature_share"] * math.tan(lock) / p["car.wheelbase"]


def tracking(driven: Driven) -> Array:
    """Return which instants are driven along the path."""
    return np.asarray(driven.recording.signals["controller.phase"] == ZhangPhase.PATH_TRACKING)


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
    touched = float(signals["vehicle.clearance"].min()) <= 0.0
    rms = float(np.sqrt(np.mean(lateral**2)))
    off = math.degrees(float(np.sqrt(np.mean(angle[on] ** 2))))
    status = set(signals["controller.zhang2022.solver_status"][on].astype(int).tolist()) - {0}
    final = driven.summary.final
    return [
        Row(name, "outcome", "", "parked", driven.summary.outcome, 0.0, basis=CONCLUSION),
        yes_row(name, "touches nothing", not touched, CONCLUSION),
        Row(name, "lateral error, rms", "m", None, rms, 0.0015, basis=OWN),
        Row(name, "lateral error, largest", "m", None, float(np.abs(lateral).max()), 0.003, basis=OWN),
        Row(name, "heading at the end", "deg", None, math.degrees(final.heading_error), 0.03, basis=OWN),
        Row(name, "speed off its set value after the start", "%", None, 100.0 * share, 4.0, basis=OWN),
        Row(name, "front-wheel angle off the path's, rms", "deg", None, off, 0.7, basis=OWN),
        Row(name, "largest iterations of the QP", "1", None, float(iterations.max()), 20.0, basis=OWN),
        yes_row(name, "every QP solved", status == {1}, OWN),
        Row(name, "smallest clearance", "m", None, float(signals["vehicle.clearance"].min())),
        Row(name, "time", "s", None, driven.summary.duration),
    ]
