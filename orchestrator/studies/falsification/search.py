"""Where a requirement breaks: first global_sampling, then cma_es from where it is nearest to breaking."""

import warnings
from typing import Any, NamedTuple

import numpy as np
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.falsification.subject import Subject
from orchestrator.studies.falsification.subset_simulation import LAST_SEED
from orchestrator.studies.sweep.study.space import Seeds

GENERATION_SIZE = 24
"""Runs at a time of the adaptive search."""
CENTRE_PENALTY = 0.002
"""On squared distance from the middle of the ranges, so that what is found is likely."""
INITIAL_STEP_SIGMA = 0.7
"""Of the first generation, in standard deviations."""
EDGE_DISTANCE = 1e-6


class Seed(NamedTuple):
    """A point of the unit cube with the seed of its noise."""

    shares: Array
    seed: int
    margin: float
    words: str


class Drawn(NamedTuple):
    """Runs, as they were drawn."""

    shares: Array
    seeds: Seeds
    margins: Array
    words: Array

    def broken(self) -> list[Seed]:
        """Return the runs that break the requirement, the worst first."""
        return [self.at(int(n)) for n in np.argsort(self.margins, kind="stable") if self.margins[n] <= 0.0]

    def at(self, number: int) -> Seed:
        """Return one of them."""
        return Seed(self.shares[number], int(self.seeds[number]), float(self.margins[number]), str(self.words[number]))


def global_sampling(subject: Subject, count: int, seed: int) -> Drawn:
    """Return ``count`` runs of a scrambled Sobol sequence with random seeds."""
    rng = np.random.default_rng([seed, 1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # its balance asks for powers of two
        shares = qmc.Sobol(len(subject.space.factors), rng=rng).random(count)
    return _sample(subject, shares, rng.integers(1, LAST_SEED, count))


def monte_carlo(subject: Subject, count: int, seed: int) -> Drawn:
    """Return ``count`` independent runs."""
    rng = np.random.default_rng([seed, 2])
    return _sample(subject, rng.random((count, len(subject.space.factors))), rng.integers(1, LAST_SEED, count))


def _sample(subject: Subject, shares: Array, seeds: Seeds) -> Drawn:
    seen = subject.see(shares, seeds)
    return Drawn(shares, seeds, seen.margins, seen.words)


def cma_es(subject: Subject, start: Array, budget: int, seed: int) -> list[Seed]:
    """Return the broken runs of an adaptive search (CMA-ES) from ``start``; it ends with the first generation of such.

    Each run has noise of its own: the seeds are searched with the ranges.
    """
    import cma  # slow to import

    size = len(start)
    rng = np.random.default_rng([seed, 3])
    options = {"popsize": GENERATION_SIZE, "seed": seed % (2**31 - 2) + 1, "verbose": -9, "bounds": [-4.0, 4.0]}
    search: Any = cma.CMAEvolutionStrategy(_normal(start), INITIAL_STEP_SIGMA, options)
    while budget >= GENERATION_SIZE and not search.stop():
        budget -= GENERATION_SIZE
        asked = search.ask()
        z = np.array(asked)
        sample = _sample(subject, ndtr(z), rng.integers(1, LAST_SEED, GENERATION_SIZE))
        if (sample.margins <= 0.0).any():
            return sample.broken()
        search.tell(asked, (sample.margins + CENTRE_PENALTY * (z**2).sum(axis=1) / size).tolist())
    return []


def _normal(shares: Array) -> Array:
    """Return the standard normal numbers that stand for ``shares``."""
    return np.asarray(np.clip(ndtri(np.clip(shares, EDGE_DISTANCE, 1.0 - EDGE_DISTANCE)), -3.5, 3.5))
