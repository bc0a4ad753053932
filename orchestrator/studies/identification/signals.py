"""A log as signals of the vehicle over time, in SI units, and the use of each: input, followed or compared."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from orchestrator.inputs.text.errors import BadInput, suggestion_or_choices
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.identification.compiled_vehicle import INPUTS, SIGNALS

FRAMES = {"pose": ("pose.x", "pose.y", "pose.heading"), "odometry": ("odometry.x", "odometry.y", "odometry.heading")}
"""Poses whose frame is that of the log: it is estimated beside the parameters."""
COMPARED = (*FRAMES["pose"], *FRAMES["odometry"], "speed", "measured_speed", "steering_wheel_angle")
REQUESTS = tuple(name for name in INPUTS if not name.startswith("manual."))
SPEEDS = ("measured_speed", "speed")
"""Measurements that can stand for a speed request; the first one that the log has does."""
USED = (*COMPARED, *REQUESTS)
"""Signals of the vehicle that a log can have."""
TYPICAL_NOISE = {"m": 0.01, "rad": 0.002, "m/s": 0.01}
"""Standard deviation by unit: first estimate before there are residuals, and of signals of a further log."""
TIME_TOLERANCE = 1e-9
"""Times [s] closer than this are the same instant."""
MOVING_SPEED = 0.05
"""Speed [m/s] above which the vehicle moves."""
NOISE_FLOOR = {"m": 1e-3, "rad": 2e-4, "m/s": 1e-3}
"""Smallest standard deviation: below it the sampling of the inputs decides."""


class Series(NamedTuple):
    """One signal of the log."""

    t: Array
    """[s], rising"""
    values: Array
    """SI"""
    column: str
    """Its column in the log."""

    def sample_and_hold(self, t: Array) -> Array:
        """Return at times ``t`` [s] the latest sample; before the first one, the first."""
        places = np.searchsorted(self.t, t + TIME_TOLERANCE, side="right") - 1
        values: Array = self.values[np.maximum(places, 0)]
        return values


class MeasuredDrive(NamedTuple):
    """What a log has of a drive; times begin at 0."""

    inputs: dict[str, Series]
    """Requests, which are held from sample to sample."""
    followed: dict[str, Series]
    """Measurements that stand for requests that are not logged: the model follows them."""
    compared: dict[str, Series]
    """Outputs that the model is compared with."""
    duration: float
    """[s]"""

    @property
    def frames(self) -> list[str]:
        """Return the frames that its poses are given in."""
        return [name for name, parts in FRAMES.items() if any(part in self.compared for part in parts)]

    @property
    def follows_steering(self) -> bool:
        """Return whether the model follows a measured steering-wheel angle."""
        return "steering_wheel_angle" in self.followed

    @property
    def follows_speed(self) -> bool:
        """Return whether the model follows a measured speed."""
        return any(name in self.followed for name in SPEEDS)


def drive_of(series: Mapping[str, Series], file: object) -> MeasuredDrive:
    """Return how the signals of a log are used. Raises ``BadInput`` if no drive can be made of them."""
    first = max(item.t[0] for item in series.values())
    last = min((item.t[-1] for name, item in series.items() if name not in REQUESTS), default=first)
    if last - first <= 0.0:
        raise BadInput("its signals have no time in common", file=file)
    signals = {name: _between(item, first, last) for name, item in series.items()}
    inputs = {name: signals[name] for name in REQUESTS if name in signals}
    followed: dict[str, Series] = {}
    if "steering_wheel_request" not in inputs or not _is_always_on(inputs, "steering_active", signals):
        _follow(("steering_wheel_angle",), "steering_wheel_request", signals, followed, file)
        inputs = {name: item for name, item in inputs.items() if not name.startswith("steering_")}
    if "speed_request" not in inputs or not _is_always_on(inputs, "speed_control_active", signals):
        _follow(SPEEDS, "speed_request", signals, followed, file)
        inputs = {name: item for name, item in inputs.items() if name.startswith("steering_")}
    compared = {
        name: without_jumps(name, signals[name]) for name in COMPARED if name in signals and name not in followed
    }
    if not compared:
        raise BadInput("nothing to compare the model with: expected a pose, odometry, speed or angle", file=file)
    return MeasuredDrive(inputs, followed, compared, last - first)


def _follow(
    names: tuple[str, ...], request: str, signals: Mapping[str, Series], followed: dict[str, Series], file: object
) -> None:
    """Add the first of ``names`` that the log has as what stands for ``request``. Raises ``BadInput`` without one."""
    name = next((item for item in names if item in signals), "")
    if not name:
        text = f"has neither {request} (with its control active all the time) nor {' or '.join(names)}"
        raise BadInput(f"{text}; name the column: --column {names[-1]}=COLUMN", file=file)
    followed[name] = signals[name]


def _is_always_on(inputs: Mapping[str, Series], active: str, signals: Mapping[str, Series]) -> bool:
    """Return whether a control is active whenever the vehicle moves; a log without the flag implies it."""
    if active not in inputs:
        return True
    moves = signals.get("speed", signals.get("measured_speed"))
    if moves is None:
        return bool(inputs[active].values.all())
    return bool((inputs[active].sample_and_hold(moves.t) != 0.0)[np.abs(moves.values) > MOVING_SPEED].all())


def _between(item: Series, first: float, last: float) -> Series:
    """Return the samples of the common time, from 0; of a request also the one in force at its beginning."""
    keep = (item.t >= first) & (item.t <= last)
    before = int(np.searchsorted(item.t, first, side="right")) - 1
    keep[max(before, 0)] = True
    return Series(np.maximum(item.t[keep] - first, 0.0), item.values[keep], item.column)


def without_jumps(name: str, item: Series) -> Series:
    """Return a signal whose heading has no jumps of whole turns."""
    return item._replace(values=np.unwrap(item.values)) if name.endswith("heading") else item


def check_signal(name: str) -> str:
    """Return the name of a signal that a log can have. Raises ``BadInput``."""
    short = name.removeprefix("vehicle.")
    if short not in USED:
        raise BadInput(f"no such signal{suggestion_or_choices(name, USED)}", key="--column")
    return short


def unit_of(name: str) -> str:
    """Return the unit of a signal of the vehicle."""
    return SIGNALS[name].signal.unit
