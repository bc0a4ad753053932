"""The bake-off in one picture."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from orchestrator.bakeoff.driver_study import Study
from orchestrator.bakeoff.entries import CONTROLLERS
from orchestrator.bakeoff.results import Result

COLOURS = {"ntbptcwpt": "#1f5fbf", "ntbpt": "#7fa8dd", "zhang2022": "#d1602a", "hsic": "#2b8a5a"}


def draw(found: list[Result], study: Study | None, file: Path) -> Path:
    """Write parked share, final errors, time and steering effort, and the driver study; return the path."""
    figure, axes = plt.subplots(2, 2, figsize=(11.0, 8.0), layout="constrained")
    share, errors, spent, claim = axes.flat
    for place, name in enumerate(CONTROLLERS):
        mine = [item for item in found if item.entry.controller == name]
        won = [item for item in mine if item.parked]
        colour = COLOURS[name]
        share.bar(place, 100.0 * len(won) / len(mine), color=colour)
        share.bar(place, 100.0 * sum(item.house for item in mine) / len(mine), color="#222222", alpha=0.35, width=0.4)
        style = {"color": colour, "s": 14, "alpha": 0.8, "label": name}
        errors.scatter([100.0 * item.lateral for item in won], [np.degrees(item.heading) for item in won], **style)
        spent.scatter([item.time for item in won], [item.effort / (2.0 * np.pi) for item in won], **style)
    share.set_xticks(range(len(CONTROLLERS)), CONTROLLERS)
    share.set(ylabel="%", ylim=(0, 100), title="parked (GB/T 41630, no contact); dark: 5 cm, 1 deg")
    errors.add_patch(Rectangle((-5, -1), 10, 2, fill=False, edgecolor="#888888", linestyle=":"))
    errors.set(xlabel="final lateral error [cm]", ylabel="final heading [deg]", title="where the parked ones stand")
    spent.set(xlabel="time [s]", ylabel="steering wheel [turns]", title="what it took", xlim=(0, None), ylim=(0, None))
    spent.legend(frameon=False)
    if study is not None:
        _claim(claim, study)
    for axis in axes.flat:
        axis.grid(alpha=0.25, linewidth=0.6)
        axis.spines[["top", "right"]].set_visible(False)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=110)
    plt.close(figure)
    return file


def _claim(axis: Axes, study: Study) -> None:
    edges = np.linspace(study.speed.min(), study.speed.max(), 25)
    place = np.clip(np.digitize(study.speed, edges) - 1, 0, len(edges) - 2)
    middle = 0.5 * (edges[1:] + edges[:-1])
    for name, won in study.success.items():
        rate = [100.0 * won[place == k].mean() if (place == k).any() else np.nan for k in range(len(middle))]
        style = "o-" if name.endswith("house") else "o:"
        axis.plot(middle, rate, style, markersize=3, color=COLOURS[name.partition(",")[0]], label=name)
    count = study.rates[0].runs
    axis.set(
        xlabel="mean speed driven [m/s]", ylabel="%", ylim=(-3, 103), title=f"driver speed errors, {count} runs each"
    )
    axis.legend(frameon=False)
