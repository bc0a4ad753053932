"""The minimal counterexample: the fewest factors off their nominal values, each by the least."""

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.falsification.search import Seed
from orchestrator.studies.falsification.subject import Subject
from orchestrator.studies.sweep.study.space import Space

BISECTION_STEPS = 4
SEED_TRIALS = 32
"""Other seeds that a counterexample is tried with."""


def shrink(subject: Subject, found: Seed) -> Seed:
    """Return the minimal counterexample from ``found`` on, with its own seed; it breaks as well."""
    nominal = subject.space.nominal()
    best = _fewest(subject, found, nominal)
    for factor in away(subject.space, best.shares):
        best = _milder(subject, best, nominal, factor)
    return _fewest(subject, best, nominal)


def _fewest(subject: Subject, found: Seed, nominal: Array) -> Seed:
    """Return the run with factors at their nominal values until each that is left is needed."""
    while (fewer := _fewer(subject, found, nominal)) is not found:
        found = fewer
    return found


def away(space: Space, shares: Array) -> list[int]:
    """Return which factors are not nominal."""
    found = []
    for number, (factor, share) in enumerate(zip(space.factors, shares, strict=True)):
        value = float(factor.at(np.array([share]))[0])
        if value != factor.nominal and factor.share(factor.nominal) != share:
            found.append(number)
    return found


def chance(subject: Subject, found: Seed, seed: int) -> float:
    """Return with what share of other seeds the same disturbances break it as well."""
    seeds = np.random.default_rng([seed, 5]).integers(1, 2**31 - 1, SEED_TRIALS)
    return float((subject.margins(np.tile(found.shares, (SEED_TRIALS, 1)), seeds) <= 0.0).mean())


def _fewer(subject: Subject, found: Seed, nominal: Array) -> Seed:
    """Return the run with more factors at their nominal values; the same if each that is left is needed."""
    left = away(subject.space, found.shares)
    alone = _run_points(subject, found, [_with(found.shares, nominal, [factor]) for factor in left])
    needless = [factor for factor, one in zip(left, alone, strict=True) if one is not None]
    if not needless:
        return found
    together, size = list[int](), len(needless)
    kept = next(one for one in alone if one is not None)
    together = [needless[0]]
    rest = needless[1:]
    while rest and size:
        size = min(size, len(rest))
        (one,) = _run_points(subject, found, [_with(found.shares, nominal, [*together, *rest[:size]])])
        if one is not None:
            kept, together, rest = one, [*together, *rest[:size]], rest[size:]
        elif size == 1:
            rest = rest[1:]
        else:
            size //= 2
    return kept


def _milder(subject: Subject, found: Seed, nominal: Array, factor: int) -> Seed:
    """Return the run with one factor moved towards its nominal value as far as it breaks."""
    if subject.space.factors[factor].choices:
        return found
    best, good, bad = found, float(found.shares[factor]), float(nominal[factor])
    for _ in range(BISECTION_STEPS):
        middle = found.shares.copy()
        middle[factor] = 0.5 * (good + bad)
        (one,) = _run_points(subject, found, [middle])
        if one is None:
            bad = float(middle[factor])
        else:
            best, good = one, float(middle[factor])
    return best


def _with(shares: Array, nominal: Array, factors: list[int]) -> Array:
    changed = shares.copy()
    changed[factors] = nominal[factors]
    return changed


def _run_points(subject: Subject, found: Seed, points: list[Array]) -> list[Seed | None]:
    """Return for each point the run with the seed of ``found``, None if it does not break."""
    if not points:
        return []
    seen = subject.see(np.array(points), np.full(len(points), found.seed, dtype=np.int64))
    runs = zip(points, seen.margins.tolist(), seen.words.tolist(), strict=True)
    return [Seed(point, found.seed, margin, words) if margin <= 0.0 else None for point, margin, words in runs]
