"""Temporal operators over sampled margins, with the quantitative meaning of signal temporal logic (Donze, Maler 2010).

A margin is a distance to a limit at each instant, negative beyond it. Each function returns the margin of the whole
formula at the row that decides it, and that row; what never applies gives None. Rows are counted, so that a window of
0.3 s at steps of 10 ms holds 31 instants and no rounding decides.
"""

from typing import NamedTuple

import numpy as np

from orchestrator.evaluation.verdict.truth import Bools
from orchestrator.simulation.cosim.fmu_instance import Array, Indices


class TemporalResult(NamedTuple):
    """The margin of a formula, and the row that decided."""

    margin: float
    row: int


def always(margins: Array, rows: Bools) -> TemporalResult | None:
    """Return the least margin in ``rows``; NaN is the worst."""
    if not rows.any():
        return None
    row = int(np.argmin(np.where(rows, _without_nan(margins), np.inf)))
    return TemporalResult(float(margins[row]), row)


def eventually(margins: Array, starts: Indices, length: int) -> TemporalResult | None:
    """Return, of the best margins in the ``length`` rows from each of ``starts`` on, the least."""
    return _worst([_best(margins, int(start), length) for start in starts])


def until(holds: Array, ends: Array, starts: Indices, length: int) -> TemporalResult | None:
    """Return the margin of "``holds`` until ``ends``", which has to come within ``length`` rows of each start."""
    return _worst([_until(_without_nan(holds), _without_nan(ends), int(start), length) for start in starts])


def rises(margins: Array) -> Indices:
    """Return the rows at which a condition begins to hold, the first row included."""
    met = np.asarray(margins >= 0.0)
    return np.flatnonzero(met & ~np.concatenate(([False], met[:-1]))).astype(np.intp)


def _best(margins: Array, start: int, length: int) -> TemporalResult:
    window = _without_nan(margins[start : start + length])
    row = int(np.argmax(window))
    return TemporalResult(float(window[row]), start + row)


def _until(holds: Array, ends: Array, start: int, length: int) -> TemporalResult:
    window = slice(start, start + length)
    before = np.minimum.accumulate(np.concatenate(([np.inf], holds[window])))[:-1]
    both = np.minimum(ends[window], before)
    row = int(np.argmax(both))
    return TemporalResult(float(both[row]), start + row)


def _worst(found: list[TemporalResult]) -> TemporalResult | None:
    return min(found, key=lambda item: item.margin) if found else None


def _without_nan(margins: Array) -> Array:
    return np.where(np.isnan(margins), -np.inf, margins)
