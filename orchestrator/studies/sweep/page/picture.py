"""The success map of a study as a picture file, for documents."""

from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from orchestrator.presentation.drawing.save import save
from orchestrator.studies.sweep.page.figures import axis_name
from orchestrator.studies.sweep.page.statistics import Map, maps, word
from orchestrator.studies.sweep.table import Table

SHORT = {"vehicle.driver.speed_error": "driver's speed error", "vehicle.car.steering.rate_limit": "steering-wheel rate"}


def draw_maps(table: Table, path: Path) -> None:
    """Write the maps side by side, in the format of the file's suffix."""
    shown = maps(table)
    figure = Figure(figsize=(4.6 * max(1, len(shown)) + 0.9, 4.0), dpi=150, layout="constrained")
    axes = figure.subplots(1, max(1, len(shown)), sharey=True, squeeze=False)[0]
    for place, item in zip(axes, shown, strict=False):
        share = 100.0 * item.done / np.maximum(item.runs, 1)
        drawn = place.pcolormesh(
            item.x.edges, item.y.edges, share, cmap=matplotlib.colormaps["cividis"], vmin=0, vmax=100
        )
        place.set_title(
            f"{item.title.upper()}: {100.0 * item.done.sum() / item.runs.sum():.1f} % {word(table)}".lstrip(": ")
        )
        place.set_xlabel(_label(item, "x"))
    if shown:
        axes[0].set_ylabel(_label(shown[0], "y"))
        figure.colorbar(drawn, ax=axes.tolist(), label=f"{word(table)} within all limits [%]", fraction=0.04)
    figure.suptitle(f"{table.about['study']['title']} ({table.count:,} runs)", fontsize=10)
    save(figure, path)


def _label(item: Map, side: str) -> str:
    axis = item.x if side == "x" else item.y
    return axis_name(axis._replace(name=SHORT.get(axis.name, axis.name)))
