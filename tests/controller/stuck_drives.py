"""Steerings that stick at a random instant of a drive, and real ones that do not: what is found, and how soon.

All of a drive follows from its system and number. A stuck wheel can be seen from the instant on at which it is off its
request by more than the monitor's threshold, to stay so until the drive ends: before that nothing is asked of it.
"""

import math
import random
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from controller_fmu.common.params import LimitParams
from controller_fmu.interface import Reason
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording

BASES: dict[str, tuple[str, ...]] = {
    "ntbptcwpt": ("guo2015-case3",),
    "adaptive": ("adaptive",),
    "apa": ("apa-parallel", "apa-perpendicular"),
}
"""System -> scenarios it is driven in, in turn."""
STICKS = {"ntbptcwpt": (0.1, 14.0), "adaptive": (0.1, 12.0), "apa": (7.0, 25.0)}
"""Between these times [s] a wheel sticks; the assist steers from 7 to 9 s on."""
STOP_TIME = 130.0
NEVER_TIME = 1e9
REAL = {
    "car.steering.rate_limit": math.radians(0.8 * 570.0),
    "steering.dead_time": 0.1,
    "steering.lag": 0.15,
    "steering.backlash": math.radians(5.0),
}
"""A real actuator: a fifth slower than in the controller's model, with dead time, lag and play."""
OFF = LimitParams().steering_tracking_error


class StuckDrive(NamedTuple):
    """What became of one drive."""

    system: str
    is_real: bool
    """With a real actuator."""
    stuck: float
    """When the wheel sticks [s]; 1e9: never."""
    seen: float
    """From when on it can be seen [s]; NaN: nothing was asked of it any more."""
    found: float
    """When the system reports it [s]; NaN: it did not."""
    touched: bool
    """Whether the car touched something."""
    took: float
    """How long the drive took [s]."""

    @property
    def delay(self) -> float:
        """Return how long [s] after it could be seen it was found."""
        return self.found - self.seen

    @property
    def is_asked(self) -> bool:
        """Return whether something was still asked of the stuck wheel, long enough to tell it from a slow one."""
        return self.took - self.seen > LimitParams().steering_fault_debounce or self.delay >= 0.0


def scenario_of(system: str, number: int, sticks: bool) -> Scenario:
    """Return drive ``number`` of a system, every second one with a real actuator; none for drives that do not stick."""
    draw = random.Random(f"{system} {number}")
    base = _base(BASES[system][number // 2 % len(BASES[system])])
    vehicle: dict[str, Any] = {
        **base.vehicle,
        "start.x": float(base.vehicle.get("start.x", 0.0)) + draw.uniform(-0.2, 0.2),
        "start.y": float(base.vehicle.get("start.y", 0.0)) + draw.uniform(-0.1, 0.1),
        "driver.reaction_delay": draw.uniform(0.0, 0.5),
        "driver.complies_with_slow_down": True,
        "steering.fault_time": draw.uniform(*STICKS[system]) if sticks else NEVER_TIME,
    }
    speed = draw.uniform(0.3, 1.5)
    if system != "apa":
        vehicle["driver.profile[1].speed"] = speed
    if number % 2 or not sticks:
        vehicle |= REAL
    return base.model_copy(update={"vehicle": vehicle, "stop_time": STOP_TIME})


@cache
def _base(name: str) -> Scenario:
    return load_scenario(name)


def drive(system: str, number: int, sticks: bool, files: dict[str, Path] | None, kind: str) -> StuckDrive:
    """Return what becomes of a drive."""
    scenario = scenario_of(system, number, sticks)
    recording = run_scenario(scenario, files, kind=kind).recording
    stuck = float(scenario.vehicle["steering.fault_time"])
    found = _first(recording, recording.signals["controller.reason"] == Reason.STEERING_FAULT)
    ends = found if math.isfinite(found) else _ends(recording)
    seen = _off_for_good(recording, stuck, ends)
    touched = bool((recording.signals["vehicle.clearance"] <= 0.0).any())
    is_real = "steering.lag" in scenario.vehicle
    return StuckDrive(system, is_real, stuck, seen, found, touched, ends)


def _ends(recording: Recording) -> float:
    """Return the last instant [s] at which the wheel is steered."""
    steered = np.flatnonzero(recording.signals["vehicle.steering_active"] > 0.5)
    return float(recording.t[steered[-1]]) if len(steered) else 0.0


def _off_for_good(recording: Recording, stuck: float, end: float) -> float:
    """Return from when on [s] a wheel that is ``stuck`` is off its request, until ``end`` [s]; NaN: it is not then."""
    t, signals = recording.t, recording.signals
    off = np.abs(signals["vehicle.steering_wheel_request"] - signals["vehicle.steering_wheel_angle"]) > OFF
    asked = off & (signals["vehicle.steering_active"] > 0.5) & (t >= stuck)
    rows: Array = t[(t >= stuck) & (t < end) & ~asked]
    last = rows[-1] if len(rows) else -math.inf
    later = t[asked & (t > last) & (t < end)]
    return float(later[0]) if len(later) else math.nan


def _first(recording: Recording, holds: Array) -> float:
    rows = np.flatnonzero(holds)
    return float(recording.t[rows[0]]) if len(rows) else math.nan
