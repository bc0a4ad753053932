"""Which curves a page shows at first; every other signal can be added on the page."""

from typing import Any

import numpy as np

from orchestrator.evaluation.verdict.judge import Check
from orchestrator.presentation.drawing.panels import PANELS
from orchestrator.simulation.cosim.recording import Recording


def plots_of(recordings: list[Recording], checks: list[Check], more: list[str]) -> list[dict[str, Any]]:
    """Return the plots for ``template/plots.js``: panels that have something to show, then ``more`` one by one."""
    plots = []
    for panel in PANELS:
        title, unit, least = panel.title, panel.unit, panel.least_span
        signals = [name for name in panel.page_signals() if any(_alive(item, name) for item in recordings)]
        if not any(changes(item, name) for item in recordings for name in signals):
            continue
        if _far_apart(recordings, signals):
            plots += [plot_of(f"{title}: {words_of(name)}", unit, least, [name], checks) for name in signals]
        else:
            plots.append(plot_of(title, unit, least, signals, checks))
    shown = {_short(name) for plot in plots for name in plot["signals"]}
    for name in more:
        if _short(name) not in shown:
            variable = next((item.variables[name] for item in recordings if name in item.signals), None)
            if variable is not None:
                shown.add(_short(name))
                plots.append(plot_of(name, variable.signal.unit, 0.0, [name], checks))
    return plots


def plot_of(title: str, unit: str, least: float, signals: list[str], checks: list[Check]) -> dict[str, Any]:
    """Return a plot of ``signals``; ``least``: smallest span of its y axis, in ``unit``."""
    limits = sorted({bound for check in checks if check.signal in signals for bound in _bounds(check)})
    return {"title": title, "unit": unit, "least": least, "signals": signals, "limits": limits}


def _short(name: str) -> str:
    """Return the name without its instance: an input and the output that feeds it are one curve."""
    return name.partition(".")[2]


def _bounds(check: Check) -> list[float]:
    """Return the horizontal lines that show a limit."""
    return [check.limit, -check.limit] if check.condition == "max_abs" else [check.limit]


def _far_apart(recordings: list[Recording], names: list[str]) -> bool:
    """Return whether curves in one plot would be flat lines, far from each other."""
    ranges = []
    for item in recordings:
        for name in names:
            values = item.signals.get(name, np.empty(0))
            finite = values[np.isfinite(values)]
            if len(finite) and not name.endswith("heading"):
                ranges.append((float(finite.min()), float(finite.max())))
    if not ranges:
        return False
    whole = max(high for _, high in ranges) - min(low for low, _ in ranges)
    return whole > 20.0 * max(high - low for low, high in ranges)


def words_of(name: str) -> str:
    """Return the name of a signal, without its instance, as words."""
    return _short(name).replace(".", " ").replace("_", " ")


def changes(recording: Recording, name: str) -> bool:
    """Return whether a signal is there and has more than one value."""
    values = recording.signals.get(name)
    return values is not None and bool(np.any(values != values[:1]))


def _alive(recording: Recording, name: str) -> bool:
    values = recording.signals.get(name)
    return values is not None and len(values) > 0 and bool(np.any(values != 0.0))
