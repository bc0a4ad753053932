"""Numbers of how a drive feels: its peak jerk, and how often the wheel is turned at standstill."""

import math

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array

JERK_HALF_WINDOW = 0.5
"""Jerk is taken over two stretches of this length [s]: the change of their mean accelerations."""
STANDSTILL_SPEED = 0.01
"""A car not faster than this [m/s] stands."""
TURNED = math.radians(5.0)
"""Steering-wheel angle [rad] that is more than the wheel's play or the end of a turn."""


class PeakJerk:
    """Largest absolute jerk [m/s3], averaged over a second, of speeds that come in parts; NaN of a shorter run.

    j(t) = (v(t + h) - 2 v(t) + v(t - h)) / h^2 with h = 0.5 s. The mean over a second is what adaptive cruise
    controls are limited by; without one a speed profile of constant accelerations has no finite jerk.
    """

    def __init__(self) -> None:
        self._step = math.nan
        self._before: Array = np.empty(0)
        """The speeds of the last second."""
        self._largest = math.nan
        self._is_known = False

    def add(self, t: Array, speed: Array) -> None:
        """Take further speeds; ``t`` [s] is used for the step, which is the same all along."""
        if math.isnan(self._step) and len(t) > 1:
            self._step = float(t[1] - t[0])
        if not self._step > 0.0:
            return
        rows = max(1, round(JERK_HALF_WINDOW / self._step))
        known = np.concatenate((self._before, speed)) if len(self._before) else speed
        self._before = np.array(known[-2 * rows :])
        if len(known) <= 2 * rows:
            return
        largest = float(np.abs(known[2 * rows :] - 2.0 * known[rows:-rows] + known[: -2 * rows]).max())
        self._largest = largest if not self._is_known else float(np.maximum(self._largest, largest))
        self._is_known = True

    @property
    def value(self) -> float:
        """Return it [m/s3]."""
        if not self._is_known:
            return math.nan
        return self._largest / (max(1, round(JERK_HALF_WINDOW / self._step)) * self._step) ** 2


class DrySteering:
    """How many standstills there are in which the wheel is turned by more than 5 deg in all; speeds come in parts."""

    def __init__(self) -> None:
        self._wheel: float | None = None
        self._stands = False
        self._turned = 0.0
        """In the last standstill so far [rad]."""
        self._closed = 0

    def add(self, speed: Array, wheel: Array) -> None:
        """Take further speeds [m/s] and steering-wheel angles [rad]."""
        if self._wheel is not None:
            speed, wheel = np.concatenate(([0.0], speed)), np.concatenate(([self._wheel], wheel))
        self._wheel = float(wheel[-1])
        standing = np.abs(speed[1:]) <= STANDSTILL_SPEED
        turned = np.where(standing, np.abs(np.diff(wheel)), 0.0)
        begins = np.flatnonzero(standing & ~np.concatenate(([self._stands], standing[:-1])))
        self._turned += float(turned[: begins[0] if len(begins) else None].sum()) if self._stands else 0.0
        if len(begins):
            angles = np.add.reduceat(turned, begins)
            self._closed += int(self._turned > TURNED) + int((angles[:-1] > TURNED).sum())
            self._turned = float(angles[-1])
        self._stands = bool(standing[-1]) if len(standing) else self._stands

    @property
    def value(self) -> float:
        """Return the count."""
        return float(self._closed + int(self._turned > TURNED))
