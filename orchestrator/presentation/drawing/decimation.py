"""A long recording in as many instants as a page or a figure can show."""

from collections.abc import Iterable

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array, Indices
from orchestrator.simulation.cosim.recording import Recording, StoredRecording

MAX_VALUES = 3_000_000
"""Of all signals at all kept instants."""
MAX_STEP_ROWS = 10_000
"""Instants kept for signals that change in steps: each of their changes; a signal beyond that counts as a curve."""


def decimate(recording: Recording, keep: Iterable[float] = ()) -> Recording:
    """Return the recording itself if it is in memory; of a long one, instants that look the same.

    The run is divided into equal spans. Of each, the instants of the smallest and the largest value of every curve are
    kept, and every change of a signal that changes seldom; also the instants next to the times ``keep`` [s].
    """
    if not isinstance(recording, StoredRecording):
        return recording
    changes = recording.blocks.changes()
    steps = _stepping(changes)
    curves = [name for name, count in changes.items() if count and name not in steps]
    kept_rows = max(2, MAX_VALUES // max(1, len(changes)))
    span = max(1, -(-recording.count * max(1, len(curves)) * 2 // kept_rows))
    found = [np.array([0, recording.count - 1])]
    for name in steps:
        rows = recording.blocks.change_rows(name)
        found += [rows, rows - 1]
    for part, first_row, _ in recording.parts():
        found += [first_row + _extremes(part.signals[name], span) for name in curves]
    found.append(np.array([min(recording.row_at(t), recording.count - 1) for t in keep], dtype=np.intp))
    return recording.rows(np.unique(np.concatenate(found)))


def deviation(recording: Recording, shown: Recording, names: list[str]) -> float:
    """Return how far the curves ``names`` are from straight lines between the instants shown, as a share of range."""
    spans = {name: _range(shown.signals[name]) for name in names}
    t, largest = shown.t, 0.0
    for part, _, _ in recording.parts():
        now = part.t
        for name, (low, high) in spans.items():
            if high > low:
                values = part.signals[name]
                off = np.abs(np.interp(now, t, shown.signals[name]) - values)
                largest = max(largest, float(off[np.isfinite(off)].max(initial=0.0)) / (high - low))
    return largest


def _range(values: Array) -> tuple[float, float]:
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 0.0)


def _stepping(changes: dict[str, int]) -> set[str]:
    """Return the signals whose changes are all kept: those that change most seldom."""
    chosen, rows = set(), 0
    for name, count in sorted(changes.items(), key=lambda item: item[1]):
        rows += 2 * count
        if count and rows <= MAX_STEP_ROWS:
            chosen.add(name)
    return chosen


def _extremes(values: Array, span: int) -> Indices:
    """Return the rows of the smallest and the largest value of each span."""
    whole = len(values) // span * span
    parts = [values[:whole].reshape(-1, span)] if whole else []
    starts = [np.arange(0, whole, span)] if whole else []
    if whole < len(values):
        parts.append(values[None, whole:])
        starts.append(np.array([whole]))
    return np.concatenate(
        [start + rows.argmin(axis=1) for start, rows in zip(starts, parts, strict=True)]
        + [start + rows.argmax(axis=1) for start, rows in zip(starts, parts, strict=True)]
    )
