"""The bake-off in one picture."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from orchestrator.presentation.drawing.save import save
from orchestrator.studies.bakeoff.drives import REFUSED, Drive, exact_limits
from orchestrator.studies.bakeoff.entries import CONTROLLERS, SLOTS

COLOURS = {"ntbptcwpt": "#1f5fbf", "ntbpt": "#7fa8dd", "adaptive": "#c9a227", "zhang2022": "#d1602a", "hsic": "#2b8a5a"}
BAR_WIDTH = 0.14
"""Width of a bar; the slots lie 1 apart."""


def draw(found: list[Drive], file: Path) -> Path:
    """Write parked share, final errors, time and steering effort; return the path."""
    figure, axes = plt.subplots(1, 3, figsize=(15.0, 4.6), layout="constrained")
    share, errors, spent = axes.flat
    _shares(share, found)
    for name in CONTROLLERS:
        won = [item for item in found if item.controller == name and item.parked]
        style = {"color": COLOURS[name], "s": 10, "alpha": 0.6, "label": name, "linewidths": 0}
        errors.scatter([100.0 * item.lateral for item in won], [np.degrees(item.heading) for item in won], **style)
        spent.scatter([item.time for item in won], [item.effort / (2.0 * np.pi) for item in won], **style)
    side, angle = 100.0 * _limit(0), np.degrees(_limit(1))
    corner, size = (-side, -angle), (2.0 * side, 2.0 * angle)
    errors.add_patch(Rectangle(corner, *size, fill=False, edgecolor="#666666", linestyle=":"))
    errors.set(xlabel="final lateral error [cm]", ylabel="final heading [deg]", title="where the parked ones stand")
    spent.set(xlabel="time [s]", ylabel="steering wheel [turns]", title="what it took", xlim=(0, None), ylim=(0, None))
    spent.legend(frameon=False, markerscale=2)
    for axis in axes.flat:
        axis.grid(alpha=0.25, linewidth=0.6)
        axis.set_axisbelow(True)
        axis.spines[["top", "right"]].set_visible(False)
    save(figure, file, dpi=110)
    plt.close(figure)
    return file


def _shares(axis: Axes, found: list[Drive]) -> None:
    """Draw for each slot and controller the share parked, within it the exact ones, and above it the refused."""
    for number, name in enumerate(CONTROLLERS):
        for place, slot in enumerate(SLOTS):
            mine = [item for item in found if item.controller == name and item.slot == slot]
            if not mine:
                continue
            x = place + BAR_WIDTH * (number - 0.5 * (len(CONTROLLERS) - 1))
            parked, exact, refused = (
                100.0 * sum(wins) / len(mine)
                for wins in zip(*((item.parked, item.exact, item.why == REFUSED) for item in mine), strict=True)
            )
            axis.bar(x, parked, color=COLOURS[name], width=0.9 * BAR_WIDTH)
            axis.bar(x, exact, color="#222222", alpha=0.35, width=0.4 * BAR_WIDTH)
            axis.bar(
                x,
                refused,
                bottom=100.0 - refused,
                color="none",
                edgecolor="#bbbbbb",
                hatch="////",
                width=0.9 * BAR_WIDTH,
            )
    axis.set_xticks(range(len(SLOTS)), [f"{slot:g} m" for slot in SLOTS])
    exact = f"{100.0 * _limit(0):g} cm, {np.degrees(_limit(1)):g} deg"
    axis.set(ylabel="%", ylim=(0, 100), title=f"parked within GB/T 41630; dark: {exact}; hatched: refused")


def _limit(place: int) -> float:
    """Return the limit of an exact drive: 0 lateral [m], 1 heading [rad]."""
    return float(exact_limits()[place].limit)
