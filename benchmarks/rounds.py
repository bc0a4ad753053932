"""How often work is measured: all of it in turn, until the medians are known or the time for it is up."""

import math
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

BUDGET = 20.0
"""Time for the rounds of one comparison [s]: the longest benchmark has some 15 comparisons."""
LEAST_ROUNDS = 3
"""Before the spread of fewer times says anything."""
KNOWN = 0.01
"""A median is known if its standard error is this share of it."""
NEXT_NOTE = 15.0
"""So often it says how far it is [s]."""


def in_turn(works: Mapping[str, Callable[[], float]], most: int, budget: float = BUDGET) -> dict[str, list[float]]:
    """Return name -> the times that each work returned [s], once a round and after one that does not count.

    Ends after ``most`` rounds, when all medians are known, or when the next round would end after ``budget`` [s]. There
    is one round at least. Work of which a round takes a quarter of the budget has no round that does not count.
    """
    times: dict[str, list[float]] = {name: [] for name in works}
    begun = noted = time.perf_counter()
    for name, work in works.items():
        times[name].append(work())
    first = time.perf_counter() - begun
    if most > 1 and first < budget / 4:
        times = {name: [] for name in works}
    while (done := min(map(len, times.values()))) < most:
        spent = time.perf_counter() - begun
        if done and (spent + first > budget or (done >= LEAST_ROUNDS and all(map(is_known, times.values())))):
            break
        for name, work in works.items():
            times[name].append(work())
        if time.perf_counter() - noted > NEXT_NOTE:
            noted = time.perf_counter()
            print(f"  {done + 1} of at most {most} rounds after {noted - begun:.0f} s", file=sys.stderr, flush=True)
    return times


def is_known(times: list[float]) -> bool:
    """Return whether the standard error of the median, by the middle half of the times, is small."""
    low, middle, high = np.quantile(times, (0.25, 0.5, 0.75))
    return bool((high - low) / math.sqrt(len(times)) <= KNOWN * middle)


def timed(work: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> Callable[[], float]:
    """Return what does the work and returns how long it took [s]."""

    def once() -> float:
        begun = clock()
        work()
        return clock() - begun

    return once


def new_log(folder: Path) -> Path:
    """Return a path in ``folder`` at which there is no log: one that replaces a file waits for the disk."""
    return Path(tempfile.mkdtemp(dir=folder)) / "log.mcap"
