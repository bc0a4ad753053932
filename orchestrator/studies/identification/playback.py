"""A measured drive as inputs of the model: requests are held, measurements that stand for requests are followed.

A followed measurement is the reading of a sensor: the wheel speed of ``speed (1 + radius_error)``, the steering-wheel
angle of ``angle + ratio * steering_offset``. So errors of the odometry are identified with a true pose alone. The
model follows without delay: its steering and drive have no lag and no rate limit then.
"""

from collections.abc import Mapping

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.identification.compiled_vehicle import INPUTS, PARAMETERS, InputSequence
from orchestrator.studies.identification.parameter import STEERING_ACTUATOR
from orchestrator.studies.identification.signals import MeasuredDrive, Series

LONGEST_STEP = 0.01
LONGEST_FOLLOWED_STEP = 0.005
"""Longest steps [s]; a followed measurement is reached within one internal step of the model."""
LEAD_TIME = 3.0
"""Time [s] before the drive in which the model reaches speed and wheel angle of a log that begins in motion."""
AT_REST = {"steering": 1e-2, "speed": 1e-2}
"""Angle [rad] and speed [m/s] below which a log begins at rest, as the model does."""
HIGH_LIMIT = 1e3
WITHOUT_ACTUATOR = {
    **dict.fromkeys((*STEERING_ACTUATOR, "steering.backlash", "steering.standstill_rate"), 0.0),
    "car.steering.rate_limit": HIGH_LIMIT,
    "car.steering.angle_limit": HIGH_LIMIT,
}
WITHOUT_DRIVE = {
    "drive.acceleration_limit": HIGH_LIMIT,
    "drive.deceleration_limit": HIGH_LIMIT,
    "drive.shift_time": 0.0,
}
"""Parameters of a model that follows a measured steering-wheel angle, or a measured speed."""


DEAD_TIME = "steering.dead_time"
DELAYED = "steering_wheel_request"
DELAY_CELLS = 16
INTERNAL_STEP = float(PARAMETERS["largest_step"].start)
"""Of the vehicle's dead time: the cells of its line, and the step [s] in which it moves."""


class Playback:
    """The inputs of a drive."""

    def __init__(self, drive: MeasuredDrive) -> None:
        self.drive = drive
        self.lead_ns = 0 if _begins_at_rest(drive) else round(LEAD_TIME * 1e9)
        """Time of the model at which the log begins."""
        self._sequences: dict[float, tuple[InputSequence, Array]] = {}

    def inputs(self, parameters: Mapping[str, float]) -> InputSequence:
        """Return the inputs with these parameters: dead time, and sensor errors of followed measurements."""
        sequence, at = self._sequence(steering_delay(parameters[DEAD_TIME]))
        if not self.drive.followed:
            return sequence
        rows = sequence.rows.copy()
        for name, item in self.drive.followed.items():
            column = np.interp(at[1:], item.t, item.values)
            if name == "steering_wheel_angle":
                offset = parameters["car.steering.ratio"] * parameters["odometry.steering_offset"]
                rows[:, INPUTS[DELAYED]] = column - offset
            else:
                scale = 1.0 + parameters["odometry.radius_error"] if name == "measured_speed" else 1.0
                rows[:, INPUTS["speed_request"]] = column / scale
        return sequence._replace(rows=rows)

    @property
    def parameter_overrides(self) -> dict[str, float]:
        """Return the parameters of a model that follows, or whose requests are delayed beforehand."""
        return {
            DEAD_TIME: 0.0,
            **(WITHOUT_ACTUATOR if self.drive.follows_steering else {}),
            **(WITHOUT_DRIVE if self.drive.follows_speed else {}),
        }

    def _sequence(self, delay: float) -> tuple[InputSequence, Array]:
        """Return the inputs with requests held, and the times [s] of the log that they are for."""
        if delay not in self._sequences:
            self._sequences.clear()
            self._sequences[delay] = self._hold_requests(delay)
        return self._sequences[delay]

    def _hold_requests(self, delay: float) -> tuple[InputSequence, Array]:
        t = _instants(self.drive, delay)
        lead = self.lead_ns / 1e9
        count = round(lead / LONGEST_FOLLOWED_STEP)
        at = np.concatenate([np.full(count, t[0]), t])
        t_ns = np.rint(np.concatenate([np.arange(count) * LONGEST_FOLLOWED_STEP, lead + t]) * 1e9).astype(np.int64)
        rows = np.zeros((len(at) - 1, len(INPUTS)))
        rows[:, [INPUTS["steering_active"], INPUTS["speed_control_active"]]] = 1.0
        for name, item in self.drive.inputs.items():
            rows[:, INPUTS[name]] = item.sample_and_hold(at[:-1] - (delay if name == DELAYED else 0.0))
        return InputSequence(t_ns, rows), at


def dead_time_resolution(dead_time: float) -> float:
    """Return how exactly [s] the vehicle's line realises a ``dead_time`` [s]: half a cell and half an internal step."""
    return 0.5 * (dead_time / DELAY_CELLS + INTERNAL_STEP)


def steering_delay(dead_time: float) -> float:
    """Return by how much [s] the steering of the vehicle with a ``dead_time`` [s] delays requests in the mean."""
    return max((DELAY_CELLS - 0.5) / DELAY_CELLS * dead_time - 0.5 * INTERNAL_STEP, 0.0)


def _instants(drive: MeasuredDrive, delay: float) -> Array:
    """Return the instants [s] of all inputs, and between them so many that no step is too long."""
    longest = LONGEST_FOLLOWED_STEP if drive.followed else LONGEST_STEP
    times = [_changes(item) + (delay if name == DELAYED else 0.0) for name, item in drive.inputs.items()]
    times += [item.t for item in drive.followed.values()]
    known = np.unique(np.rint(np.concatenate([[0.0, drive.duration], *times]) * 1e9).astype(np.int64))
    known = known[known <= round(drive.duration * 1e9)]
    parts = np.maximum(np.ceil(np.diff(known) / (longest * 1e9) - 1e-6), 1.0).astype(np.int64)
    begins, widths = np.repeat(known[:-1], parts), np.repeat(np.diff(known) / parts, parts)
    number = np.arange(len(begins)) - np.repeat(np.cumsum(parts) - parts, parts)
    instants: Array = np.append(begins + number * widths, known[-1]) / 1e9
    return instants


def _changes(item: Series) -> Array:
    """Return the times [s] at which a request changes."""
    times: Array = item.t[np.append(True, np.diff(item.values) != 0.0)]
    return times


def _begins_at_rest(drive: MeasuredDrive) -> bool:
    signals = {**drive.inputs, **drive.followed, **drive.compared}
    firsts = {
        "steering": ("steering_wheel_angle", "steering_wheel_request"),
        "speed": ("speed", "measured_speed", "speed_request"),
    }
    for kind, names in firsts.items():
        item = next((signals[name] for name in names if name in signals), None)
        if item is not None and abs(float(np.median(item.values[:3]))) > AT_REST[kind]:
            return False
    return True
