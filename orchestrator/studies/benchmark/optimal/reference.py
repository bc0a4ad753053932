"""How a drive compares with the time-optimal motion near it, at the limits that it had itself.

The optimum starts from the driven motion, with its gears, and keeps the margin of its plan. It counts only if it can
be driven: its inputs, integrated from the start without a correction at the knots, reach the goal, keep clear between
the knots and are not slower than the drive. What does not is reported as invalid, without figures.
"""

import math
from typing import NamedTuple

import numpy as np

from orchestrator.evaluation.verdict.geometry import CarOutline, edges
from orchestrator.evaluation.verdict.polygons import polygon_clearances
from orchestrator.inputs.scenario.obstacle_map import obstacles_of_map
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.studies.benchmark.optimal.motion import INPUTS, STATES, MotionLimits, TimedMotion, drive_through
from orchestrator.studies.benchmark.optimal.search import optimize

WANTED_INTERVAL = 0.4
"""Wanted duration of an interval [s]."""
MIN_INTERVALS, MAX_INTERVALS = 6, 160
"""Of a move; of all moves, roughly."""
MOVING_SPEED = 1e-3
"""[m/s]"""
CHECK_SUBSTEPS = 10
"""Poses checked in each interval."""
CLEARANCE_TOLERANCE = 0.02
"""[m]"""
GOAL_TOLERANCE, GOAL_HEADING_TOLERANCE = 0.01, math.radians(0.2)
"""[m], [rad]"""


class Optimum(NamedTuple):
    """The time-optimal motion near a drive; figures are NaN if it is not valid."""

    reason: str
    """Why it is not valid; empty if it is."""
    duration: float
    """[s]"""
    length: float
    """[m]"""
    clearance: float
    """Least distance [m] to obstacles, between the knots too."""
    driven_duration: float
    """From the start to the report that the vehicle is parked [s], planning and halts included."""
    driven_length: float
    poses: Array
    """(p, 3)"""

    @property
    def is_valid(self) -> bool:
        """Whether it can be driven, and is not slower than the drive."""
        return not self.reason

    @property
    def time_ratio(self) -> float:
        """Driven over optimal time."""
        return self.driven_duration / self.duration

    @property
    def length_ratio(self) -> float:
        """Driven over optimal length."""
        return self.driven_length / self.length


def find_optimum(scenario: Scenario, recording: Recording) -> Optimum:
    """Return the optimum near a drive that has parked. Raises ``BadInput`` if the drive has none to compare with."""
    if scenario.target is None or "controller.apa.margin" not in recording.signals:
        raise BadInput("expected a drive of the parking system to a target", file=scenario.file)
    obstacles = obstacles_of_map(scenario)
    limits = limits_of(recording)
    driven = motion_of_drive(scenario, recording)
    sides = np.array([side[:4] for side in edges(obstacles)], dtype=float).reshape(-1, 2, 2)
    motion = optimize(driven, sides, limits)
    path = drive_through(motion, limits.wheelbase, CHECK_SUBSTEPS)
    car = CarOutline.of(recording.parameters_of("controller"))
    clearance = float(polygon_clearances(path[:, :3], obstacles, car).min()) if obstacles else math.inf
    duration, length = _time_and_length(recording)
    reason = _reason(motion, path, clearance, limits, duration)
    steps = np.diff(path[:, :2], axis=0)
    figures = motion.duration, float(np.hypot(steps[:, 0], steps[:, 1]).sum()), clearance
    return Optimum(reason, *(figures if not reason else (math.nan,) * 3), duration, length, path[:, :3])


def limits_of(recording: Recording) -> MotionLimits:
    """Return the limits that the controller and the vehicle of a drive had, and the margin of its plan."""
    parameters = recording.parameters_of("controller")
    ratio = parameters["car.steering.ratio"]
    front, rear = parameters["car.wheelbase"] + parameters["car.front_overhang"], parameters["car.rear_overhang"]
    return MotionLimits(
        speed=parameters["drive.speed"],
        acceleration=recording.parameters_of("vehicle")["drive.acceleration_limit"],
        deceleration=parameters["drive.deceleration"],
        wheel_angle=parameters["car.steering.angle_limit"] / ratio,
        wheel_rate=parameters["car.steering.rate_limit"] / ratio,
        wheelbase=parameters["car.wheelbase"],
        clearance=float(recording.signals["controller.apa.margin"].max()),
        half_length=0.5 * (front + rear),
        half_width=0.5 * parameters["car.width"],
        ahead=0.5 * (front - rear),
    )


def motion_of_drive(scenario: Scenario, recording: Recording) -> TimedMotion:
    """Return a drive as a motion: one move for each gear, standstill before it included, and the goal at its end."""
    assert scenario.target is not None
    signals, t = recording.signals, recording.t
    speed = signals["vehicle.speed"]
    moving = np.flatnonzero(np.abs(speed) > MOVING_SPEED)
    if not len(moving):
        raise BadInput("the vehicle does not move in this drive", file=scenario.file)
    changes = moving[1:][np.diff(np.sign(speed[moving])) != 0.0]
    stops = [*(moving[np.searchsorted(moving, change) - 1] for change in changes), moving[-1]]
    wheel = signals["vehicle.steering_wheel_angle"] / scenario.controller["car.steering.ratio"]
    turning = np.flatnonzero(np.abs(np.diff(wheel)) > 1e-9)
    begin = min([moving[0], *turning[:1]])
    ends = t[[begin, *stops[:-1], max([stops[-1], *(turning[-1:] + 1)])]]
    gears = np.sign(speed[[moving[0], *changes]])
    spans = np.diff(ends)
    wanted = max(WANTED_INTERVAL, spans.sum() / MAX_INTERVALS)
    counts = np.maximum(MIN_INTERVALS, np.round(spans / wanted)).astype(int)
    times = np.concatenate(
        [[ends[0]], *(a + s * np.arange(1, n + 1) / n for a, s, n in zip(ends, spans, counts, strict=False))]
    )
    values = (*(signals[f"vehicle.pose.{axis}"] for axis in ("x", "y")), np.unwrap(signals["vehicle.pose.heading"]))
    states = np.stack([np.interp(times, t, column) for column in (*values, speed, wheel)], axis=-1)
    target = scenario.target.pose
    turns = round((states[-1, 2] - target[2]) / (2.0 * math.pi))
    states[-1] = [target[0], target[1], target[2] + 2.0 * math.pi * turns, 0.0, 0.0]
    states[0, 3:] = 0.0
    move_of = np.repeat(np.arange(len(counts)), counts)
    inputs = np.diff(states[:, STATES - INPUTS :], axis=0) / (spans / counts)[move_of][:, None]
    return TimedMotion(states, inputs, spans, move_of, gears)


def _time_and_length(recording: Recording) -> tuple[float, float]:
    """Return time [s] until the last change of phase, and length [m]."""
    phases = recording.signals["controller.phase"]
    changes = np.flatnonzero(np.diff(phases)) + 1
    last = changes[-1] if len(changes) else len(phases) - 1
    return float(recording.t[last]), float(recording.signals["vehicle.distance"][-1])


def _reason(motion: TimedMotion, path: Array, clearance: float, limits: MotionLimits, driven: float) -> str:
    """Return why a motion is no valid optimum; empty if it is one."""
    off = path[-1, :3] - motion.states[-1, :3]
    if math.hypot(off[0], off[1]) > GOAL_TOLERANCE or abs(off[2]) > GOAL_HEADING_TOLERANCE:
        return f"its inputs end {math.hypot(off[0], off[1]) * 100:.1f} cm from the goal"
    if clearance <= 0.0 or clearance < limits.clearance - CLEARANCE_TOLERANCE:
        return f"comes within {clearance * 100:.1f} cm of an obstacle between its knots"
    if motion.duration > driven:
        return "slower than the drive: a poor local optimum"
    return ""
