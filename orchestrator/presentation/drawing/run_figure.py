"""Figures of runs for a publication: no title, embedded fonts, lines distinct in black and white."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from orchestrator.evaluation.verdict.geometry import moving_boxes
from orchestrator.inputs.text.errors import BadInput, suggestion
from orchestrator.presentation.drawing.panels import DEGREE, PANELS, Panel, PanelCurve
from orchestrator.presentation.drawing.picture_data import path_plans, path_points
from orchestrator.presentation.drawing.save import save
from orchestrator.simulation.cosim.recording import Recording

STYLES = ("screen", "paper")
LINES = (("#000000", "-"), ("#b0401a", "--"), ("#1f5fbf", "-."), ("#4d8a4d", ":"), ("#777777", (0, (5, 1, 1, 1, 1, 1))))
"""Colour and dashes of one run after the other."""
CM_PER_INCH = 2.54
UNITS = {"cm": 1.0, "mm": 0.1, "in": CM_PER_INCH}
DEFAULT_WIDTH_CM = 17.0
"""Default [cm]."""
SETTINGS: dict[str, Any] = {
    "pdf.fonttype": 42,
    "ps.fonttype": 42,
    "svg.hashsalt": "apa",
    "font.size": 8.0,
    "axes.labelsize": 8.0,
    "legend.fontsize": 7.0,
    "lines.linewidth": 1.2,
    "axes.linewidth": 0.6,
}


PATH = "path"
DEFAULT_PANELS = ("path", "speed", "steering", "heading")


def run_figure(
    runs: Sequence[tuple[str, Recording]],
    panels: Sequence[str] = DEFAULT_PANELS,
    width: float = DEFAULT_WIDTH_CM,
    style: str = "paper",
) -> Figure:
    """Return a matplotlib figure ``width`` [cm] wide of one or several (label, recording), overlaid.

    ``panels`` are names of panels, ``path``, or signals (``vehicle.yaw_rate``). Lines are solid or dashed by run,
    references dotted. Raises ``BadInput`` for a panel that is neither.
    """
    for panel in panels:
        _check_panel(panel, runs[0][1])
    columns = 2 if len(panels) > 1 and width > 10.0 else 1
    rows = -(-len(panels) // columns)
    with style_context(style):
        figure = Figure(
            figsize=(width / CM_PER_INCH, rows * 0.62 * width / columns / CM_PER_INCH), layout="constrained"
        )
        for place, panel in enumerate(panels, start=1):
            _draw_panel(figure.add_subplot(rows, columns, place), panel, runs)
        named = {
            text: handle for axis in figure.axes for handle, text in zip(*axis.get_legend_handles_labels(), strict=True)
        }
        if len(named) > 1:
            columns = min(len(named), 3)
            figure.legend(named.values(), named.keys(), loc="outside lower center", ncols=columns, frameon=False)
    return figure


def save_figure(figure: Figure, path: Path, dpi: int, style: str = "paper") -> None:
    """Write the figure as PNG, SVG or PDF by its name, fonts embedded."""
    with style_context(style):
        save(figure, path, dpi=dpi)


@contextmanager
def style_context(style: str = "paper") -> Iterator[None]:
    """Set matplotlib to the style within."""
    if style not in STYLES:
        raise BadInput(f"--style {style}: expected one of: {', '.join(STYLES)}")
    settings: dict[Any, Any] = {**SETTINGS, "axes.grid": style == "screen", "grid.alpha": 0.3}
    with matplotlib.rc_context(settings):
        yield


def width_in_cm(text: str) -> float:
    """Return a width [cm] written as ``8.4cm``, ``84mm``, ``3.3in`` or ``8.4``. Raises ``BadInput``."""
    match = re.fullmatch(r"\s*([0-9]*\.?[0-9]+)\s*(cm|mm|in)?\s*", text)
    width = float(match[1]) * UNITS[match[2] or "cm"] if match else 0.0
    if not 2.0 <= width <= 100.0:
        raise BadInput(f"--width {text}: expected a length from 2cm to 100cm, such as 8.4cm, 84mm or 3.3in")
    return width


def _check_panel(panel: str, recording: Recording) -> None:
    names = [shown.name for shown in PANELS]
    if panel in names or panel == PATH or panel in recording.signals:
        return
    known = [PATH, *names]
    raise BadInput(
        f"--panels {panel}: neither a panel nor a signal of the run{suggestion(panel, [*known, *recording.signals])}; "
        f"panels are {', '.join(known)}"
    )


def _panel(name: str) -> Panel:
    """Return a panel of the table, or one of a signal alone, in its own unit."""
    return next((panel for panel in PANELS if panel.name == name), Panel(name, name, "", 0.0, (PanelCurve(name),)))


def _draw_panel(axis: Any, panel: str, runs: Sequence[tuple[str, Recording]]) -> None:
    axis.spines[["top", "right"]].set_visible(False)
    for number, (label, recording) in enumerate(runs):
        colour, dashes = LINES[number % len(LINES)]
        how = {"color": colour, "linestyle": dashes}
        if panel == PATH:
            _draw_path(axis, recording, label, how, number == 0)
            continue
        shown = _panel(panel)
        factor, unit = (DEGREE, "deg") if shown.unit == "rad" else (1.0, shown.unit)
        driven = [curve.signal for curve in shown.curves if not curve.reference_of]
        for curve in shown.curves:
            values = recording.signals.get(curve.signal)
            if values is None or (curve.reference_of and not np.any(values)):
                continue
            name = curve.signal.rpartition(".")[2].replace("_", " ")
            line: dict[str, Any] = dict(how)
            text = label
            if curve.reference_of:
                line |= {"linestyle": ":", "linewidth": 0.9}
                asked = name if name.endswith(("request", "speed")) else "reference"
                text = asked if number == 0 else "_"
            elif len(driven) > 1:
                line |= {"linewidth": 1.2 if curve.signal == driven[0] else 0.7}
                text = f"{label}, {name}"
            axis.plot(recording.t, values / factor, label=text, **line)
        axis.set(xlabel="t [s]", ylabel=f"{shown.title.lower()} [{unit}]" if unit else shown.title)
    if panel == PATH:
        axis.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")


def _draw_path(axis: Any, recording: Recording, label: str, how: dict[str, Any], scene: bool) -> None:
    if scene:
        _draw_boxes(axis, recording)
    signals = recording.signals
    axis.plot(signals["vehicle.pose.x"], signals["vehicle.pose.y"], label=label, **how)
    for number, planned in enumerate(path_plans(recording)):
        name = "planned" if scene and number == 0 else None
        axis.plot(*planned.T, color="#ffffff", linewidth=0.5)
        axis.plot(*planned.T, color="#b0401a", linestyle=":", linewidth=1.0, label=name)
    if scene:
        _draw_key_points(axis, recording)


def _draw_key_points(axis: Any, recording: Recording) -> None:
    for name, (x, y) in path_points(recording).items():
        axis.plot([x], [y], "o", color="#000000", markersize=2.5)
        axis.annotate(name, (x, y), textcoords="offset points", xytext=(3, -8), fontsize=6)


def _draw_boxes(axis: Any, recording: Recording) -> None:
    for box in moving_boxes(recording.parameters_of("vehicle")):
        axis.fill(*box.outline().T, facecolor="#dddddd", edgecolor="#888888", linewidth=0.6)
