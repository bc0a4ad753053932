"""Figures of runs for a publication: no title, embedded fonts, lines told apart in black and white."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from orchestrator.cosim.recording import Recording
from orchestrator.drawing.save import check_picture, save
from orchestrator.text.errors import BadInput, suggestion

STYLES = ("screen", "paper")
LINES = (("#000000", "-"), ("#b0401a", "--"), ("#1f5fbf", "-."), ("#4d8a4d", ":"), ("#777777", (0, (5, 1, 1, 1, 1, 1))))
"""Colour and dashes of one run after the other."""
CM_PER_INCH = 2.54
UNITS = {"cm": 1.0, "mm": 0.1, "in": CM_PER_INCH}
WIDTH = 17.0
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


class Series(NamedTuple):
    """A signal of a panel: name, factor to the unit shown, and how it is drawn."""

    signal: str
    factor: float = 1.0
    reference: bool = False


class FigurePanel(NamedTuple):
    """A panel over time."""

    label: str
    series: tuple[Series, ...]


DEGREES = 180.0 / np.pi
PANELS = {
    "speed": FigurePanel("speed [m/s]", (Series("vehicle.speed"), Series("controller.speed_request", 1.0, True))),
    "steering": FigurePanel("steering wheel [deg]", (Series("vehicle.steering_wheel_angle", DEGREES),)),
    "heading": FigurePanel(
        "heading [rad]", (Series("vehicle.pose.heading"), Series("controller.reference.heading", 1.0, True))
    ),
    "x": FigurePanel("x [m]", (Series("vehicle.pose.x"), Series("controller.reference.x", 1.0, True))),
    "y": FigurePanel("y [m]", (Series("vehicle.pose.y"), Series("controller.reference.y", 1.0, True))),
    "lateral": FigurePanel("lateral error [m]", (Series("controller.lateral_error"),)),
    "clearance": FigurePanel("clearance [m]", (Series("vehicle.clearance"),)),
}
"""Panels over time by name; ``path`` is the top view."""
PATH = "path"
DEFAULT_PANELS = ("path", "speed", "steering", "heading")


def run_figure(
    runs: Sequence[tuple[str, Recording]],
    panels: Sequence[str] = DEFAULT_PANELS,
    width: float = WIDTH,
    style: str = "paper",
) -> Figure:
    """Return a matplotlib figure ``width`` [cm] wide of one or several (label, recording), overlaid.

    ``panels`` are names of ``PANELS``, ``path``, or signals (``vehicle.yaw_rate``). Lines are solid or dashed by run,
    references dotted. Raises ``BadInput`` for a panel that is neither.
    """
    for panel in panels:
        _check_panel(panel, runs[0][1])
    columns = 2 if len(panels) > 1 and width > 10.0 else 1
    rows = -(-len(panels) // columns)
    with styled(style):
        figure = Figure(
            figsize=(width / CM_PER_INCH, rows * 0.62 * width / columns / CM_PER_INCH), layout="constrained"
        )
        for place, panel in enumerate(panels, start=1):
            _draw_panel(figure.add_subplot(rows, columns, place), panel, runs)
        handles, labels = figure.axes[0].get_legend_handles_labels()
        if len(runs) > 1 or len(labels) > 1:
            figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 3), frameon=False)
    return figure


def save_figure(figure: Figure, path: Path, dpi: int, style: str = "paper") -> None:
    """Write the figure as PNG, SVG or PDF by its name, fonts embedded."""
    with styled(style):
        save(figure, path, dpi=dpi)


@contextmanager
def styled(style: str = "paper") -> Iterator[None]:
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


def check_figure(path: Path) -> None:
    """Raise ``BadInput`` unless the name is that of a figure."""
    check_picture(path)


def _check_panel(panel: str, recording: Recording) -> None:
    if panel in PANELS or panel == PATH or panel in recording.signals:
        return
    known = [PATH, *PANELS]
    raise BadInput(
        f"--panels {panel}: neither a panel nor a signal of the run{suggestion(panel, [*known, *recording.signals])}; "
        f"panels are {', '.join(known)}"
    )


def _draw_panel(axis: Any, panel: str, runs: Sequence[tuple[str, Recording]]) -> None:
    axis.spines[["top", "right"]].set_visible(False)
    for number, (label, recording) in enumerate(runs):
        colour, dashes = LINES[number % len(LINES)]
        how = {"color": colour, "linestyle": dashes}
        if panel == PATH:
            _draw_path(axis, recording, label, how, number == 0)
            continue
        shown = PANELS.get(panel, FigurePanel(panel, (Series(panel),)))
        for series in shown.series:
            values = recording.signals.get(series.signal)
            if values is None or (series.reference and not np.any(values)):
                continue
            line = {**how, "linestyle": ":", "linewidth": 0.9} if series.reference else how
            name = f"{label}, reference" if series.reference else label
            axis.plot(recording.t, series.factor * values, label=name, **line)
        axis.set(xlabel="t [s]", ylabel=shown.label)
    if panel == PATH:
        axis.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")


def _draw_path(axis: Any, recording: Recording, label: str, how: dict[str, Any], scene: bool) -> None:
    if scene:
        _draw_boxes(axis, recording)
    signals = recording.signals
    planned = planned_path(recording)
    if planned is not None:
        axis.plot(*planned, color="#888888", linestyle=":", linewidth=0.9, label="planned" if scene else None)
    axis.plot(signals["vehicle.pose.x"], signals["vehicle.pose.y"], label=label, **how)


def planned_path(recording: Recording) -> tuple[Any, Any] | None:
    """Return x and y [m] of the arcs and lines planned first in a run, None without."""
    signals = recording.signals
    names = [f"controller.path.{item}" for item in ("start.x", "start.y", "start.heading")]
    lengths = [name for name in signals if re.fullmatch(r"controller\.path\.segments\[\d+\]\.length", name)]
    if any(name not in signals for name in names) or not lengths:
        return None
    whole = sum(signals[name] for name in lengths)
    rows = np.flatnonzero(whole > 0.0)
    if not len(rows):
        return None
    at = int(rows[0])
    x, y, heading = (float(signals[name][at]) for name in names)
    points = [(x, y)]
    for name in sorted(lengths, key=lambda item: int(item.split("[")[1].split("]")[0])):
        length, bend = float(signals[name][at]), float(signals[name.replace(".length", ".curvature")][at])
        for _ in range(40):
            step = length / 40.0
            middle = heading - 0.5 * bend * step
            x, y, heading = x - step * np.cos(middle), y - step * np.sin(middle), heading - bend * step
            points.append((x, y))
    both = np.array(points)
    return both[:, 0], both[:, 1]


def _draw_boxes(axis: Any, recording: Recording) -> None:
    p = recording.parameters_of("vehicle")
    for number in range(1, 17):
        key = f"scene.boxes[{number}]."
        length, width = p.get(f"{key}length", 0.0), p.get(f"{key}width", 0.0)
        if length <= 0.0:
            continue
        c, s = np.cos(p.get(f"{key}heading", 0.0)), np.sin(p.get(f"{key}heading", 0.0))
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (0.5 * length, 0.5 * width)
        x = p.get(f"{key}x", 0.0) + corners[:, 0] * c - corners[:, 1] * s
        y = p.get(f"{key}y", 0.0) + corners[:, 0] * s + corners[:, 1] * c
        axis.fill(x, y, facecolor="#dddddd", edgecolor="#888888", linewidth=0.6)
