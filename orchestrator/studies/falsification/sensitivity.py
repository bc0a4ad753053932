"""Which factors matter: first-order and total Sobol indices of a margin, with intervals.

    S_i = V(E(g | x_i)) / V(g)      from all random runs: the means over bins of x_i, less what they vary by chance
    T_i = E(V(g | all but x_i)) / V(g)      Jansen 1999: 1/2 mean (g(A) - g(A with x_i of B))^2 / V(g)

Both come with 95 % intervals by resampling the runs.
"""

from typing import NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.page.statistics import variance_share

BOOTSTRAP_SAMPLES = 200
"""Resamplings."""
MOST_BINS, LEAST_IN_BIN = 24, 15


class Index(NamedTuple):
    """A Sobol index and its 95 % interval."""

    value: float
    low: float
    high: float


class SobolIndices(NamedTuple):
    """What one factor, or all the others together, does to the margin."""

    name: str
    first: Index | None
    total: Index | None
    """None if it was not worked out."""


def first_orders(shares: Array, margins: Array, seed: int) -> list[Index]:
    """Return the first-order index of each column of ``shares`` (runs, factors)."""
    rng = np.random.default_rng([seed, 13])
    count = max(2, min(MOST_BINS, len(margins) // LEAST_IN_BIN))
    cells = np.minimum((shares * count).astype(int), count - 1)
    picks = [rng.integers(0, len(margins), len(margins)) for _ in range(BOOTSTRAP_SAMPLES)]
    found = []
    for cell in cells.T:
        again = [variance_share(margins[pick], cell[pick]) for pick in picks]
        own = variance_share(margins, cell)
        # resampling a finite sample adds its own chance once more: the middle of the resampled ones is taken off
        shift = own - float(np.median(again))
        low, high = np.quantile(again, (0.025, 0.975)) + shift
        found.append(Index(own, float(min(max(low, 0.0), own)), float(min(max(high, own), 1.0))))
    return found


def total_index(own: Array, changed: Array, variance: float, seed: int) -> Index:
    """Return the total index of what differs between runs with margins ``own`` and ``changed``."""
    if variance == 0.0:
        return Index(0.0, 0.0, 0.0)
    parts = 0.5 * (own - changed) ** 2 / variance
    rng = np.random.default_rng([seed, 17])
    again = [float(parts[rng.integers(0, len(parts), len(parts))].mean()) for _ in range(BOOTSTRAP_SAMPLES)]
    low, high = np.quantile(again, (0.025, 0.975))
    return Index(float(parts.mean()), float(low), float(high))
