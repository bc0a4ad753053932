"""Fewer instants that look the same: what a page keeps of a run."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orchestrator.simulation.cosim.fmu_instance import Array

RANGE_TOLERANCE = 1.0 / 500.0
"""Share of a signal's range that straight lines between the kept instants may be off: under a pixel."""
MAX_ROUNDS = 40


class Thinned(NamedTuple):
    """Which rows stay, and what that costs."""

    rows: NDArray[np.intp]
    deviation: float
    """Largest distance of any signal from the straight line between kept rows, as a share of its range."""


def thin(t: Array, lines: list[Array], steps: list[Array], keep: list[int], most: int) -> Thinned:
    """Return at most about ``most`` rows (more only if ``steps`` change more often) of signals over time ``t`` [s].

    All changes of ``steps`` (modes, flags) and the rows in ``keep`` stay. ``lines`` are continuous
    signals: the row furthest from the straight line is added until all are within ``RANGE_TOLERANCE``.
    """
    count = len(t)
    kept = np.zeros(count, dtype=bool)
    kept[:: max(1, -(-count // max(2, most // 3)))] = True
    kept[[0, count - 1, *keep]] = True
    for values in [*steps, *(np.isnan(line).astype(float) for line in lines)]:
        changes = np.flatnonzero(values[1:] != values[:-1])
        kept[changes] = True
        kept[changes + 1] = True
    scaled = [line for line in (_scale(values) for values in lines) if line is not None]
    for values in scaled:
        kept[[int(np.argmin(values)), int(np.argmax(values))]] = True
    error = _error(t, scaled, kept)
    for _ in range(MAX_ROUNDS):
        room = most - int(kept.sum())
        if room <= 0 or not (error > RANGE_TOLERANCE).any():
            break
        kept[_worst_of_each_gap(kept, error, room)] = True
        error = _error(t, scaled, kept)
    return Thinned(np.flatnonzero(kept), float(error.max(initial=0.0)))


def _scale(values: Array) -> Array | None:
    """Return the signal over its range, not-a-numbers as zero; None for a constant."""
    finite = np.where(np.isfinite(values), values, 0.0)
    span = float(finite.max() - finite.min())
    return (finite - finite.min()) / span if span > 0.0 else None


def _error(t: Array, scaled: list[Array], kept: NDArray[np.bool_]) -> Array:
    error = np.zeros(len(t))
    for values in scaled:
        np.maximum(error, np.abs(np.interp(t, t[kept], values[kept]) - values), out=error)
    return error


def _worst_of_each_gap(kept: NDArray[np.bool_], error: Array, room: int) -> NDArray[np.intp]:
    starts = np.flatnonzero(kept)
    worst = np.maximum.reduceat(error, starts)
    gap = np.cumsum(kept) - 1
    candidates = np.flatnonzero((error > RANGE_TOLERANCE) & (error == worst[gap]))
    return candidates[np.argsort(-error[candidates], kind="stable")][:room]
