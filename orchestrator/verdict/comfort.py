"""Numbers of how a drive feels: its peak jerk, and how often the wheel is turned at standstill."""

import math

import numpy as np

from orchestrator.cosim.slave import Array

HALF = 0.5
"""Jerk is taken over two stretches of this length [s]: the change of their mean accelerations."""
STANDING = 0.01
"""A car not faster than this [m/s] stands."""
TURNED = math.radians(5.0)
"""Steering-wheel angle [rad] that is more than the wheel's play or the end of a turn."""


def peak_jerk(t: Array, speed: Array) -> float:
    """Return the largest absolute jerk [m/s3], averaged over a second; NaN of a shorter run.

    j(t) = (v(t + h) - 2 v(t) + v(t - h)) / h^2 with h = 0.5 s. The mean over a second is what adaptive cruise
    controls are limited by; without one a speed profile of constant accelerations has no finite jerk.
    """
    if len(t) < 2 or not t[1] > t[0]:
        return math.nan
    rows = max(1, round(HALF / float(t[1] - t[0])))
    length = rows * float(t[1] - t[0])
    if len(speed) <= 2 * rows:
        return math.nan
    return float(np.abs(speed[2 * rows :] - 2.0 * speed[rows:-rows] + speed[: -2 * rows]).max()) / length**2


def standstill_steering(speed: Array, wheel: Array) -> float:
    """Return how many standstills there are in which the wheel is turned by more than 5 deg in all."""
    standing = np.abs(speed[1:]) <= STANDING
    turned = np.where(standing, np.abs(np.diff(wheel)), 0.0)
    begins = np.flatnonzero(standing & ~np.concatenate(([False], standing[:-1])))
    ways = np.add.reduceat(turned, begins) if len(begins) else np.zeros(0)
    return float((ways > TURNED).sum())
