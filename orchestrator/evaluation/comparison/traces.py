"""The same signal of two runs, span by span, so that long runs need not be in memory."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from orchestrator.evaluation.comparison.tube import Trace
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording

SPAN_ROWS = 1 << 18
"""Exchanges of a span, without those that the time tolerance adds."""


class TracePair(NamedTuple):
    """A signal of two runs around a span of time."""

    a: Trace
    b: Trace
    span: tuple[float, float] | None
    """From, and before [s]; None: all there is."""


def traces(
    name: str, a: Recording, b: Recording, held: bool, tolerance: float, is_heading: bool
) -> Iterator[TracePair]:
    """Yield a signal of both runs span by span, with what a tolerance of time [s] needs on both sides.

    ``is_heading``: without jumps, that of ``b`` moved by whole turns to where that of ``a`` begins.
    """
    angles = (_Angles(), _Angles()) if is_heading else None
    turn: float | None = None
    for span in _spans(a, b):
        first, second = (_part(run, span, tolerance) for run in (a, b))
        one, two = first[1].signals[name], second[1].signals[name]
        if angles is not None and not (np.isnan(one).any() or np.isnan(two).any()):
            one, two = angles[0].unwrap(one, first[0]), angles[1].unwrap(two, second[0])
            turn = 2.0 * math.pi * round((one[0] - two[0]) / (2.0 * math.pi)) if turn is None else turn
            two = two + turn
        yield TracePair(Trace(first[1].t, one, held), Trace(second[1].t, two, held), span)


def _spans(a: Recording, b: Recording) -> Iterator[tuple[float, float] | None]:
    if max(a.count, b.count) <= SPAN_ROWS:
        yield None
        return
    longer = a if a.count >= b.count else b
    edges = [longer.between(row, row + 1).t[0] for row in range(0, longer.count, SPAN_ROWS)]
    edges[0] = -math.inf
    for begin, end in zip(edges, [*edges[1:], math.inf], strict=True):
        yield float(begin), float(end)


def _part(run: Recording, span: tuple[float, float] | None, tolerance: float) -> tuple[int, Recording]:
    """Return the exchanges of a run around a span, and the row of the first."""
    if span is None:
        return 0, run
    first = max(0, run.row_at(span[0] - tolerance) - 2)
    end = min(run.count, run.row_at(span[1] + tolerance) + 2)
    first = min(first, run.count - 1)
    return first, run.between(first, max(end, first + 1))


class _Angles:
    """Angles without jumps over parts that overlap."""

    def __init__(self) -> None:
        self._row = 0
        self._known: Array = np.empty(0)

    def unwrap(self, values: Array, row: int) -> Array:
        """Return a part, which begins at ``row``, without jumps."""
        smooth: Array = np.unwrap(values)
        at = row - self._row
        if 0 <= at < len(self._known):
            smooth = smooth + 2.0 * math.pi * round((self._known[at] - smooth[0]) / (2.0 * math.pi))
        self._row, self._known = row, smooth
        return smooth
