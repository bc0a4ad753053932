"""The paper's four panels for one case, one line a run, the printed points as crosses."""

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from orchestrator.presentation.drawing.save import save
from orchestrator.studies.papers.result import Driven

COLOURS = ("#1f5fbf", "#d1602a", "#2b8a5a")
PRINTED: dict[int, list[tuple[float, float, float, float]]] = {
    1: [(9.5, -3.8, np.nan, np.nan)],
    2: [(3.5, -3.8, np.nan, np.nan)],
    4: [
        (3.59, -3.8, np.nan, np.nan),
        (4.58, -4.803, -2.441, 0.588),
        (9.38, -3.078, -0.858, 0.771),
        (11.6, -3.801, -1.539, 0.761),
    ],
    5: [(22.0, np.nan, -3.058, 0.002)],
}
"""t, x, y, heading as printed."""


def draw_case(case: int, runs: list[Driven], file: Path) -> Path:
    """Write the picture of one case and return its path."""
    figure, axes = plt.subplots(2, 2, figsize=(11.0, 7.6), layout="constrained")
    for colour, driven in zip(COLOURS, runs, strict=False):
        _lines(axes, driven, colour)
    _path(axes[1, 1], runs[0])
    _plot_published_points(axes, PRINTED.get(case, []))
    labels = ("(a) speed and steering wheel", "(b) position", "(c) heading", "(d) path")
    for axis, label in zip(axes.flat, labels, strict=True):
        axis.set_title(label, loc="left", fontsize=10)
        axis.grid(alpha=0.25, linewidth=0.6)
        axis.spines[["top", "right"]].set_visible(False)
    figure.suptitle(f"Guo 2015, case {case}; crosses and dots as printed", fontsize=12, fontweight="bold")
    lines, names = axes[0, 0].get_legend_handles_labels()
    figure.legend(lines, names, loc="outside lower center", ncols=len(lines), frameon=False)
    save(figure, file, dpi=110)
    plt.close(figure)
    return file


def _label(driven: Driven) -> str:
    name = driven.summary.scenario
    rate = "105 deg/s" if name.endswith("-105") else "30 deg/s"
    return f"{rate}, with point tracking" if name.endswith("cwpt") else rate


def _lines(axes: Any, driven: Driven, colour: str) -> None:
    signals, t = driven.recording.signals, driven.recording.t
    x, y = signals["vehicle.pose.x"], signals["vehicle.pose.y"]
    top, position, heading, path = axes.flat
    top.plot(t, signals["vehicle.speed"], color=colour, linewidth=1.4, label=_label(driven))
    wheel = np.degrees(signals["vehicle.steering_wheel_angle"]) / 360.0
    top.plot(t, wheel, color=colour, linewidth=0.9, linestyle="--")
    top.set(xlabel="t [s]", ylabel="speed [m/s]; wheel [turns], dashed")
    position.plot(t, x, color=colour, linewidth=1.4)
    position.plot(t, y, color=colour, linewidth=0.9, linestyle="--")
    position.set(xlabel="t [s]", ylabel="x [m]; y [m], dashed")
    heading.plot(t, signals["vehicle.pose.heading"], color=colour, linewidth=1.4)
    heading.set(xlabel="t [s]", ylabel="heading [rad]")
    path.plot(x, y, color=colour, linewidth=1.4)
    path.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")


def _path(axis: Any, driven: Driven) -> None:
    """Draw eq. (9) as printed, dotted."""
    first = np.linspace(-3.80, 0.0, 60)
    second = np.linspace(-7.61, -3.80, 60)
    axis.plot(first, -5.5 + np.sqrt(30.25 - first**2), color="#888888", linewidth=1.0, linestyle=":")
    axis.plot(second, 2.44 - np.sqrt(30.25 - (second + 7.61) ** 2), color="#888888", linewidth=1.0, linestyle=":")


def _plot_published_points(axes: Any, points: list[tuple[float, float, float, float]]) -> None:
    _, position, heading, path = axes.flat
    style = {"linestyle": "none", "marker": "x", "color": "#222222", "markersize": 6, "zorder": 5}
    for t, x, y, angle in points:
        position.plot([t, t], [x, y], **style)
        heading.plot([t], [angle], **style)
        path.plot([x], [y], **style)
