"""A falsification from study to counterexamples: global sampling, Monte Carlo, CMA-ES, minimisation, bounds."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from orchestrator.evaluation.verdict.confidence import clopper_pearson
from orchestrator.inputs.text.console import Meter
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.interrupts import on_interrupt
from orchestrator.studies.falsification.counterexamples import Counterexample, write_counterexample
from orchestrator.studies.falsification.search import Drawn, Seed, cma_es, global_sampling, monte_carlo
from orchestrator.studies.falsification.sensitivity import SobolIndices, first_orders, total_index
from orchestrator.studies.falsification.shrink import away, chance, shrink
from orchestrator.studies.falsification.subject import Subject
from orchestrator.studies.falsification.subset_simulation import LAST_SEED, SubsetSimulation, subset_simulation

EVERYWHERE, BY_LOT, DOWNHILL, TOTALS, RARE = 0.15, 0.3, 0.25, 0.15, 0.15
"""Shares of the budget. What shrinking takes comes on top, about as much again at most."""
MOST_FINDS = 5
"""Shrunk and written."""
LOCAL_SEARCHES = 4
MOST_TOTALS = 12
"""Factors whose total index is worked out one by one, the others together."""
LEAST_LEVEL = 50
"""Runs of a level of subset simulation."""
OTHERS, NOISE = "all others", "noise (seed)"


class FalsificationResult(NamedTuple):
    """Result of a falsification."""

    counterexamples: Sequence[Counterexample]
    runs: int
    broken: int
    """Runs that broke the requirement, in all stages."""
    first_after: int | None
    """Runs until the first of them."""
    sample: tuple[int, int]
    """Of independent runs: how many broke it, and how many there were."""
    bound: tuple[float, float]
    """95 % each: the probability is above, and below."""
    rare: SubsetSimulation | None
    influences: Sequence[SobolIndices]


def falsify(subject: Subject, budget: int, seed: int, folder: Path) -> FalsificationResult:
    """Return the result of about ``budget`` runs; counterexamples are written into ``folder``. Raises ``Stopped``."""
    with on_interrupt(subject.interrupt), Meter("falsify", budget, "runs") as meter:
        subject.meter = meter
        subject.stage = "global_sampling"
        spread = global_sampling(subject, _part(budget, EVERYWHERE), seed)
        first = _first_broken(spread, 0)
        subject.stage = "cma_es"
        downs = _downhill(subject, spread, _part(budget, DOWNHILL), seed)
        if first is None and downs:
            first = subject.runs
        subject.stage = "random runs"
        before = subject.runs
        sample = monte_carlo(subject, _part(budget, BY_LOT), seed)
        first = _first_broken(sample, before) if first is None else first
        subject.stage = "which factors matter"
        influences = _influences(subject, spread, sample, _part(budget, TOTALS), seed)
        subject.stage = "how rare"
        rare = _rare(subject, sample, _part(budget, RARE), seed)
        subject.stage = "shrinking"
        counterexamples = _counterexamples(
            subject, [*downs, *spread.broken(), *sample.broken()], seed, subject.runs + budget
        )
        for counterexample in counterexamples:
            write_counterexample(subject, counterexample, folder)
    events = int((sample.margins <= 0.0).sum())
    bound = clopper_pearson(events, len(sample.margins))
    return FalsificationResult(
        counterexamples, subject.runs, subject.broken, first, (events, len(sample.margins)), bound, rare, influences
    )


def _part(budget: int, share: float) -> int:
    return max(8, round(share * budget))


def _first_broken(sample: Drawn, before: int) -> int | None:
    broken = np.flatnonzero(sample.margins <= 0.0)
    return before + int(broken[0]) + 1 if len(broken) else None


def _downhill(subject: Subject, spread: Drawn, budget: int, seed: int) -> list[Seed]:
    """Return the worst run of each of several searches, from the runs that were nearest to breaking."""
    found = []
    order = np.argsort(spread.margins, kind="stable")
    near = [int(number) for number in order if spread.margins[number] > 0.0][:LOCAL_SEARCHES]
    for restart, number in enumerate(near):
        broken = cma_es(subject, spread.shares[number], budget // len(near), seed + restart)
        found += broken[:1]
    return found


def _influences(subject: Subject, spread: Drawn, sample: Drawn, budget: int, seed: int) -> list[SobolIndices]:
    """Return the influences, the strongest first; totals of those that matter most at first sight."""
    names = [factor.name for factor in subject.space.factors]
    shares, margins = np.concatenate([spread.shares, sample.shares]), np.concatenate([spread.margins, sample.margins])
    firsts = first_orders(shares, margins, seed)
    order = sorted(range(len(names)), key=lambda number: -firsts[number].value)
    singles = order[:MOST_TOTALS]
    groups = {names[number]: [number] for number in singles} | {OTHERS: order[MOST_TOTALS:], NOISE: []}
    groups = {name: members for name, members in groups.items() if members or name == NOISE}
    count = min(len(sample.margins), max(4, budget // len(groups)))
    rng = np.random.default_rng([seed, 7])
    other, seeds = rng.random((count, len(names))), rng.integers(1, LAST_SEED, count)
    own, variance = sample.margins[:count], float(np.var(margins))
    totals = {}
    for name, members in groups.items():
        changed: Array = sample.shares[:count].copy()
        changed[:, members] = other[:, members]
        drawn = seeds if name == NOISE else sample.seeds[:count]
        totals[name] = total_index(own, subject.margins(changed, drawn), variance, seed)
    found = [SobolIndices(names[number], firsts[number], totals.get(names[number])) for number in order]
    return [*found, *(SobolIndices(name, None, totals[name]) for name in (OTHERS, NOISE) if name in totals)]


def _rare(subject: Subject, sample: Drawn, budget: int, seed: int) -> SubsetSimulation | None:
    """Return the estimate for a rare event; None where independent runs have met it often enough, or few are left."""
    often = (sample.margins <= 0.0).sum() >= MIN_VIOLATIONS
    level = budget // 3
    if often or level < LEAST_LEVEL:
        return None
    return subset_simulation(subject.margins, len(subject.space.factors), level, seed)


MIN_VIOLATIONS = 10
"""Events in independent runs."""


def _counterexamples(subject: Subject, broken: list[Seed], seed: int, last: int) -> list[Counterexample]:
    """Return counterexamples that differ in outcome or factors, each shrunk; none is begun after run ``last``."""
    found: dict[tuple[str, ...], Counterexample] = {}
    seen: dict[str, int] = {}
    for run in broken:
        if len(found) >= MOST_FINDS or subject.runs >= last:
            break
        if seen.get(run.words, 0) >= 2:
            continue
        seen[run.words] = seen.get(run.words, 0) + 1
        mild = shrink(subject, run)
        needs = [subject.space.factors[number].name for number in away(subject.space, mild.shares)]
        if (mild.words, *needs) not in found:
            name = f"{subject.study.name}-{subject.objective.name}-{seed}-{len(found) + 1}".replace(" ", "-")
            found[mild.words, *needs] = Counterexample(name, mild, chance(subject, mild, seed), run)
    return list(found.values())
