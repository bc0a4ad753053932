"""Measures: single numbers of a run's signals, gathered while it runs in a batch, or read off its recording.

Both ways give the same bits.
"""

from typing import Literal, NamedTuple

import numpy as np

from orchestrator.cosim.recording import Recording
from orchestrator.cosim.slave import Array

How = Literal["last", "largest", "greatest", "smallest", "travel", "first", "time"]


class When(NamedTuple):
    """The instants at which a mode has one of some values."""

    signal: str
    values: tuple[int, ...]


class Measure(NamedTuple):
    """One number of one signal over a run, NaN if there is no instant to take it from."""

    how: How
    """``last``; ``largest`` absolute value, with its sign; ``greatest``; ``smallest``; ``travel``: sum of absolute
    changes; ``first``; ``time``: of the first instant [s], of whatever signal."""
    signal: str
    """``vehicle.speed``: an output, or an input as its model saw it."""
    when: When | None = None
    """The instants that count; None: all."""


def measured(measure: Measure, recording: Recording, missing: float = float("nan")) -> float:
    """Return the measure of a recorded run; ``missing`` if it has no such signal, or no instant."""
    values = recording.t if measure.how == "time" else recording.signals.get(measure.signal)
    if values is not None and measure.when is not None:
        mode = recording.signals.get(measure.when.signal, np.full(len(recording.t), np.nan))
        values = values[np.isin(mode, measure.when.values)]
    return missing if values is None or not len(values) else _of(measure.how, values)


def _of(how: How, values: Array) -> float:
    if how == "travel":
        changes = np.abs(np.diff(values))
        return float(np.add.accumulate(changes)[-1]) if len(changes) else 0.0
    if how == "largest":
        size = np.abs(values)
        return float(values[int(np.argmax(np.where(np.isnan(size), np.inf, size)))])
    return float(
        {
            "last": values[-1],
            "first": values[0],
            "time": values[0],
            "greatest": np.max(values),
            "smallest": np.min(values),
        }[how]
    )
