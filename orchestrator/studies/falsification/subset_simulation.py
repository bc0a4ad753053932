"""The probability of a rare event by subset simulation (Au and Beck 2001): a product of such as are not rare.

    P(g <= 0) = P(g <= b1) P(g <= b2 | g <= b1) ...    each about p0, the levels b chosen on the way

Of the runs of a level the share p0 with the least margin are the seeds of the next one's chains (Metropolis, each
coordinate on its own), which stay below the level. The run's seed is a variable like the others, sampled independently.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.study.space import Seeds

Chains = NDArray[np.intp]
Margins = Callable[[Array, Seeds], Array]
"""(points of the unit cube, seeds) -> margins; an event is a margin of 0 or less."""
LEVEL_PROBABILITY = 0.1
"""p0."""
PROPOSAL_SIGMA = 0.8
"""Of a proposal, in standard deviations."""
MOST_LEVELS = 8
LAST_SEED = 2**31 - 1
NORMAL_QUANTILE_975 = 1.959963984540054


class SubsetSimulation(NamedTuple):
    """An estimate of a probability."""

    probability: float
    low: float
    high: float
    """95 %, from the variation of each level's estimate; chains taken as correlated by their measured amount."""
    runs: int
    levels: list[float]
    """Margins that were the levels."""
    is_bound: bool
    """The levels did not reach the event: the probability is lower."""


def subset_simulation(margins: Margins, size: int, runs: int, seed: int) -> SubsetSimulation:
    """Return the probability of a margin of 0 or less for ``size`` factors; ``runs`` a level."""
    rng = np.random.default_rng([seed, 11])
    z, seeds = rng.standard_normal((runs, size)), rng.integers(1, LAST_SEED, runs)
    values = margins(ndtr(z), seeds)
    probability, variance, levels, used = 1.0, 0.0, list[float](), runs
    chains: Chains = np.arange(runs)
    for _ in range(MOST_LEVELS):
        order = np.argsort(values, kind="stable")
        level = max(0.0, float(values[order[round(LEVEL_PROBABILITY * runs) - 1]]))
        below = values <= level
        probability *= float(below.mean())
        variance += _variation(below, chains)
        levels.append(level)
        if level <= 0.0 or below.all():
            break
        starts = order[: round(LEVEL_PROBABILITY * runs)]
        z, seeds, values, chains, made = _next_level(margins, (z, seeds, values), starts, level, rng, runs)
        used += made
    spread = NORMAL_QUANTILE_975 * math.sqrt(math.log1p(variance))
    low, high = probability * math.exp(-spread), min(1.0, probability * math.exp(spread))
    return SubsetSimulation(probability, low, high, used, levels, levels[-1] > 0.0)


def _next_level(
    margins: Margins,
    found: tuple[Array, Seeds, Array],
    starts: Chains,
    level: float,
    rng: np.random.Generator,
    runs: int,
) -> tuple[Array, Seeds, Array, Chains, int]:
    """Return points, seeds, margins and chains of the next level: chains from ``starts`` that stay below ``level``."""
    z, seeds, values = (item[starts] for item in found)
    kept = [(z, seeds, values)]
    for _ in range(math.ceil(runs / len(starts)) - 1):
        step = z + PROPOSAL_SIGMA * rng.standard_normal(z.shape)
        accepted = rng.random(z.shape) < np.exp(np.minimum(0.0, 0.5 * (z**2 - step**2)))
        moved = np.where(accepted, step, z)
        drawn = np.where(rng.random(len(seeds)) < 0.5, rng.integers(1, LAST_SEED, len(seeds)), seeds)
        tried = margins(ndtr(moved), drawn)
        good = tried <= level
        z, seeds, values = (
            np.where(good[:, None], moved, z),
            np.where(good, drawn, seeds),
            np.where(good, tried, values),
        )
        kept.append((z, seeds, values))
    joined = (np.concatenate([item[place] for item in kept]) for place in range(3))
    all_z, all_seeds, all_values = joined
    chains = np.tile(np.arange(len(starts)), len(kept))
    return all_z, all_seeds, all_values, chains, len(starts) * (len(kept) - 1)


def _variation(below: NDArray[np.bool_], chains: Chains) -> float:
    """Return the squared coefficient of variation of a level's share, from the means of its chains."""
    p = float(below.mean())
    if p in (0.0, 1.0):
        return 0.0
    means = np.array([below[chains == chain].mean() for chain in np.unique(chains)])
    return float(np.var(means, ddof=1) / len(means)) / p**2
