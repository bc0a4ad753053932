"""Is a curve inside the tube around another: the band of values that the reference takes nearby in time.

At each instant t the reference is looked at over [t - T, t + T]; between its samples it is a straight
line (or holds its value, for modes and flags). The band of a line is [min - tol, max + tol] with
tol = max(absolute, relative * |reference|); a mode must equal one of the values the reference has there.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orchestrator.evaluation.comparison.tolerance import Tolerance
from orchestrator.simulation.cosim.fmu_instance import Array


class Trace(NamedTuple):
    """A signal over time [s], strictly increasing."""

    t: Array
    values: Array
    held: bool
    """The value holds until the next instant (modes and flags)."""

    def at(self, moments: Array) -> Array:
        """Return the values at ``moments``."""
        if self.held:
            return self.values[np.clip(np.searchsorted(self.t, moments, side="right") - 1, 0, None)]
        return np.interp(moments, self.t, self.values)


class Distance(NamedTuple):
    """How far a curve is from another, at each of the compared instants."""

    t: Array
    raw: Array
    """Distance to the nearest value that the reference takes within the time tolerance, >= 0, inf if not comparable."""
    excess: Array
    """Distance beyond the tube; positive means outside."""
    allowed: Array
    """Tolerance in value."""


def distance(reference: Trace, other: Trace, tolerance: Tolerance, span: tuple[float, float] | None = None) -> Distance:
    """Return the distance of ``other`` from ``reference`` over the time both cover, or the ``span`` [s] of it.

    A span ends before its second time.
    """
    end = min(reference.t[-1], other.t[-1])
    begin = max(reference.t[0], other.t[0])
    t = np.union1d(reference.t, other.t)
    t = t[(t >= begin) & (t <= end)]
    if span is not None:
        t = t[(t >= span[0]) & (t < span[1])]
        if not len(t):
            return Distance(t, t, t, t)
    inside = np.union1d(
        t, np.clip(np.concatenate([t - tolerance.time, t + tolerance.time]), reference.t[0], reference.t[-1])
    )
    grid = inside if tolerance.time > 0.0 else t
    known, seen = reference.at(grid), other.at(t)
    first = np.searchsorted(grid, t - tolerance.time, side="left")
    last = np.searchsorted(grid, t + tolerance.time, side="right")
    first = np.minimum(first, last - 1)
    if reference.held or other.held:
        return _mode_distance(t, known, seen, first, last)
    allowed = np.maximum(tolerance.absolute, tolerance.relative * np.abs(known))
    low, high = _extreme(np.minimum, known, first, last), _extreme(np.maximum, known, first, last)
    floor = _extreme(np.minimum, known - allowed, first, last)
    ceiling = _extreme(np.maximum, known + allowed, first, last)
    raw = np.maximum(np.maximum(low - seen, seen - high), 0.0)
    excess = np.maximum(floor - seen, seen - ceiling)
    gone = np.isnan(_extreme(np.maximum, np.where(np.isnan(known), np.nan, 0.0), first, last))
    raw = np.where(np.isnan(raw), np.where(gone & np.isnan(seen), 0.0, np.inf), raw)
    excess = np.where(np.isnan(excess), np.where(gone & np.isnan(seen), -1.0, np.inf), excess)
    return Distance(t, raw, excess, np.maximum(tolerance.absolute, tolerance.relative * np.abs(reference.at(t))))


def _mode_distance(t: Array, known: Array, seen: Array, first: NDArray[np.intp], last: NDArray[np.intp]) -> Distance:
    met = np.zeros(len(t), dtype=bool)
    for value in np.unique(seen):
        same = np.isnan(known) if np.isnan(value) else known == value
        count = np.concatenate([[0], np.cumsum(same)])
        here = np.isnan(seen) if np.isnan(value) else seen == value
        met |= here & (count[last] > count[first])
    middle = known[(first + last - 1) // 2]
    apart = np.abs(seen - middle)
    raw = np.where(met, 0.0, np.where(np.isnan(apart), np.inf, apart))
    return Distance(t, raw, np.where(met, -1.0, np.maximum(raw, 1.0)), np.zeros(len(t)))


def _extreme(function: np.ufunc, values: Array, first: NDArray[np.intp], last: NDArray[np.intp]) -> Array:
    """Return the extreme of ``values[first:last]`` for each pair, from extremes over powers of two."""
    levels = [values]
    while 2 ** len(levels) <= int((last - first).max(initial=1)):
        half = 2 ** (len(levels) - 1)
        below = levels[-1]
        levels.append(function(below[:-half], below[half:]))
    level = np.floor(np.log2(last - first)).astype(int)
    result = np.empty(len(first))
    for number, table in enumerate(levels):
        chosen = level == number
        left, right = first[chosen], last[chosen] - 2**number
        result[chosen] = function(table[left], table[right])
    return result
