"""Measures: single numbers of a run's signals, gathered while it runs in a batch, or read off its recording.

Both ways give the same bits.
"""

from typing import Literal, NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording

How = Literal["last", "largest", "greatest", "smallest", "travel", "first", "time"]


class Instants(NamedTuple):
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
    when: Instants | None = None
    """The instants that count; None: all."""


def measure_recording(measure: Measure, recording: Recording, missing: float = float("nan")) -> float:
    """Return the measure of a recorded run; ``missing`` if it has no such signal, or no instant."""
    found = GatheredMeasure(measure.how)
    for part in recording.parts():
        values = _samples_in_window(measure, part.recording)
        if values is not None and len(values):
            found.add(values)
    return missing if found.value is None else found.value


def _samples_in_window(measure: Measure, recording: Recording) -> Array | None:
    """Return the values that count; None if there is no such signal."""
    values = recording.t if measure.how == "time" else recording.signals.get(measure.signal)
    if values is not None and measure.when is not None:
        mode = recording.signals.get(measure.when.signal, np.full(len(recording.t), np.nan))
        return values[np.isin(mode, measure.when.values)]
    return values


class GatheredMeasure:
    """A measure of values that come in parts: the same bits however they are divided."""

    def __init__(self, how: How) -> None:
        self._how = how
        self._last = 0.0
        self.value: float | None = None
        """None before there is any value."""

    def add(self, values: Array) -> None:
        """Take further values, at least one."""
        before, how = self.value, self._how
        if how == "travel":
            changes = np.abs(np.diff(values))
            if before is not None:
                changes = np.concatenate(([before, abs(float(values[0]) - self._last)], changes))
            self.value = float(np.add.accumulate(changes)[-1]) if len(changes) else 0.0
        elif how == "largest":
            self.value = _largest(values if before is None else np.concatenate(([before], values)))
        elif how in ("first", "time"):
            self.value = float(values[0]) if before is None else before
        else:
            known = values if before is None else np.concatenate(([before], values))
            self.value = float(known[-1] if how == "last" else np.max(known) if how == "greatest" else np.min(known))
        self._last = float(values[-1])


def _largest(values: Array) -> float:
    """Return the value of the largest size, with its sign; not-a-number counts as infinitely large."""
    size = np.abs(values)
    return float(values[int(np.argmax(np.where(np.isnan(size), np.inf, size)))])
