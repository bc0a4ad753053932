"""overview.png: the four panels of the paper, the path with the car drawn along it, and a ribbon of chart states.

Imports no more than it takes to draw: ``beside`` runs this in a process of its own.
"""

import math
import string
from io import BytesIO
from itertools import pairwise
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Ellipse, Patch, Polygon

from orchestrator.evaluation.verdict.geometry import Box, CarOutline, place
from orchestrator.presentation.drawing.looks import CAR, PERSON, looks
from orchestrator.presentation.drawing.overview import Overview
from orchestrator.presentation.drawing.palette import LIGHT, role
from orchestrator.presentation.drawing.panels import PANELS, Panel, picture_columns
from orchestrator.presentation.drawing.time_panels import (
    BASE_HEIGHT,
    BASE_WIDTH,
    LEFT_EDGE,
    PANEL_HEIGHT,
    RIGHT_EDGE,
    AxesPlace,
    draw_panel,
    panel_places,
    picture_height,
    raise_place,
)
from orchestrator.simulation.cosim.fmu_instance import Array, Indices

BLUE, ASKED, GREEN, GREY, INK = LIGHT["run-a"], LIGHT["asked"], LIGHT["good"], "#8a8f98", "#22262c"
DEGREE = math.radians(1.0)
PNG_COMPRESSION = 3
"""Of the PNG file: a tenth larger than at best, in a fifth of the time."""
TITLE, TITLE_AT = 12.5, 0.012
"""Size of the title's letters [pt]; where it begins, as a share of the width."""
LEAST_TITLE = 4.0
STYLE: Any = {
    "font.size": 9.0,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.titlesize": 10.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titley": 1.0,
    "axes.grid": True,
    "grid.color": "#e3e6ea",
    "grid.linewidth": 0.7,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
}
MAX_MOVING_OUTLINES = 10
"""Of a thing that moves, one picture a second is drawn."""
PATH_OUTLINES = 14
"""About how many outlines are drawn along the path."""

FIGURE_DPI = 120
"""Dots in an inch."""


PLAN = AxesPlace(LEFT_EDGE, 0.515, RIGHT_EDGE - LEFT_EDGE, 0.43)
LEGEND = AxesPlace(LEFT_EDGE, 0.415, RIGHT_EDGE - LEFT_EDGE, 0.045)
RIBBON = (-0.125, -0.05)
"""From and to, below a panel, as shares of its height."""


def picture(seen: Overview) -> bytes:
    """Return the overview picture of a run as a PNG file."""
    file, how = BytesIO(), {"compress_level": PNG_COMPRESSION}
    with mpl.rc_context(STYLE):
        canvas: Any = FigureCanvasAgg(overview(seen))  # savefig() goes through everything twice
        canvas.print_png(file, metadata={"Software": "apa-cosim"}, pil_kwargs=how)
    return file.getvalue()


def overview(seen: Overview, panels: tuple[Panel, ...] = PANELS) -> Figure:
    """Return the overview picture of a run."""
    columns = picture_columns(panels)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(BASE_WIDTH, picture_height(len(columns))), dpi=FIGURE_DPI)
        letters = string.ascii_lowercase
        _plan(figure.add_axes(raise_place(PLAN, len(columns))), letters[len(columns)], seen)
        pieces = _pieces(seen)
        for letter, place_of_panel, column in zip(letters, panel_places(columns), columns, strict=False):
            axis = figure.add_axes(place_of_panel)
            draw_panel(axis, letter, column, seen)
            _over_time(axis, seen, pieces)
        _legend(figure, {piece.name: piece.colour for piece in pieces}, raise_place(LEGEND, len(columns)))
        _title(figure, seen.title)
    return figure


def _title(figure: Figure, text: str) -> None:
    """Write the title, in smaller letters if it is longer than the picture is wide."""
    title = figure.suptitle(text, x=TITLE_AT, y=0.996, ha="left", va="top", fontweight="bold", color=INK)
    room, size = figure.bbox.width * (1.0 - 2.0 * TITLE_AT), TITLE
    title.set_fontsize(size)
    while title.get_window_extent().width > room and size > LEAST_TITLE:  # letters do not get narrower evenly
        size -= 0.5
        title.set_fontsize(size)


class _Piece(NamedTuple):
    """A state of the chart from one time to another [s]."""

    begin: float
    end: float
    name: str
    colour: str


def _pieces(seen: Overview) -> list[_Piece]:
    """Return the states of the chart, one after the other."""
    t, (phases, states) = seen.t, seen.ribbon
    edges = [0, *(int(row) + 1 for row in np.flatnonzero(np.diff(phases))), len(t) - 1]
    pieces = []
    for first, last in pairwise(edges):
        value = phases[first]
        name = states.get(int(value), f"{value:g}") if math.isfinite(value) else "unknown"
        colour = LIGHT[role(name, value if math.isfinite(value) else 0.0)]
        pieces.append(_Piece(t[first], t[last], name, colour))
    return pieces


def _over_time(axis: Any, seen: Overview, pieces: list[_Piece]) -> None:
    """Give a panel its time axis: the states of the chart in a ribbon below, a line where the phase changes."""
    axis.set_xlim(seen.t[0], seen.t[-1])
    axis.set_xlabel("time [s]")
    below, (bottom, top) = axis.get_xaxis_transform(), RIBBON
    axis.vlines(seen.t[seen.changes], 0.0, 1.0, color="#d5d9df", linewidth=0.8, zorder=0, transform=below)
    corners = [[(piece.begin, bottom), (piece.end, bottom), (piece.end, top), (piece.begin, top)] for piece in pieces]
    ribbon = PolyCollection(corners, facecolors=[piece.colour for piece in pieces], linewidths=0, transform=below)
    ribbon.set_clip_on(False)
    axis.add_collection(ribbon, autolim=False)
    axis.tick_params(axis="x", length=0, pad=0.14 * PANEL_HEIGHT * BASE_HEIGHT * 72.0)


def _legend(figure: Figure, names: dict[str, str], place_of_legend: AxesPlace) -> None:
    handles = [Patch(color=colour, label=name.lower().replace("_", " ")) for name, colour in names.items()]
    figure.legend(
        handles=handles,
        title="states of the chart",
        title_fontsize=8,
        loc="center",
        bbox_to_anchor=place_of_legend,
        ncols=len(handles),
        fontsize=8,
        borderaxespad=0.0,
        handlelength=1.2,
        columnspacing=1.4,
    )


def _plan(axis: Any, letter: str, seen: Overview) -> None:
    axis.set_title(f"({letter}) path of the rear-axle midpoint, outline along it")
    axis.set_aspect("equal", adjustable="datalim")
    axis.set_xlabel("x [m]")
    axis.set_ylabel("y [m]")
    stills = [[still for still in box.stills() if still.appear_at <= seen.t[-1]] for box in seen.around.boxes]
    draw_scene(axis, seen, [still for each in stills for still in (*each[:-1:MAX_MOVING_OUTLINES], *each[-1:])])
    x, y, heading = (seen.signal(f"vehicle.pose.{name}") for name in ("x", "y", "heading"))
    _outlines(axis, seen.car, x, y, heading)
    apart = _apart(seen, x, y)
    pieces = (np.insert(values, apart, math.nan) for values in (x, y))
    axis.plot(*pieces, color=BLUE, linewidth=1.8, label="driven path", zorder=5)
    axis.plot(x[apart], y[apart], ".", color=BLUE, markersize=1.8, zorder=5)
    _wheels(axis, seen, seen.car, (x[-1], y[-1], heading[-1]))
    axis.legend(loc="upper left", fontsize=8)


def _apart(seen: Overview, x: Array, y: Array) -> Indices:
    """Return the rows to which the car drove further than straight on, as in circles, of a long run of which few
    instants are kept."""
    speed = np.abs(seen.signal("vehicle.speed"))
    driven = 0.5 * (speed[1:] + speed[:-1]) * np.diff(seen.t)
    return np.flatnonzero(np.hypot(np.diff(x), np.diff(y)) < 0.95 * driven - 0.2) + 1


def draw_scene(axis: Any, seen: Overview, stills: list[Box]) -> None:
    """Draw what stands around the car, ``stills`` among it, the target and the planned path."""
    car, around = seen.car, seen.around
    for still in stills:
        draw_thing(axis, still)
    for corners in around.polygons:
        axis.add_patch(Polygon(corners, facecolor="#c4c8ce", edgecolor=GREY, linewidth=1.0))
    for kerb in around.kerbs:
        axis.plot([kerb.x1, kerb.x2], [kerb.y1, kerb.y2], color="#5b6068", linewidth=2.5, solid_capstyle="butt")
    if around.slot is not None:
        _slot(axis, around.slot)
    if around.target is not None:
        at_target = place(car.outline(), *around.target)
        axis.plot(*at_target.T, color=GREEN, linewidth=1.4, linestyle=(0, (4, 2)), label="target")
    if len(seen.planned):
        axis.plot(*seen.planned.T, color=ASKED, linewidth=1.6, linestyle=(0, (5, 2)), label="planned path", zorder=4)
    for name, at in seen.points.items():
        axis.plot(*at, "o", color=ASKED, markersize=3.5, zorder=4)
        axis.annotate(name, at, textcoords="offset points", xytext=(4, -10), fontsize=8, color=ASKED, zorder=6)


def draw_thing(axis: Any, box: Box) -> None:
    """Draw an obstacle: a person, a car, or a plain box; hatched if it appears or disappears."""
    what, passing = looks(box), box.comes_or_goes
    style: Any = {"edgecolor": LIGHT["warn"] if passing else GREY, "linewidth": 1.0}
    if what == PERSON:
        axis.add_patch(
            Circle((box.x, box.y), 0.55 * math.hypot(box.length, box.width), fill=False, linestyle=":", **style)
        )
        axis.add_patch(
            Ellipse((box.x, box.y), 0.4 * box.length, 0.9 * box.width, angle=box.heading / DEGREE, color=INK)
        )
        axis.add_patch(Circle((box.x, box.y), 0.18 * box.width, facecolor="#f2c9a1", linewidth=0, zorder=3))
        return
    axis.add_patch(Polygon(box.outline(), facecolor="#c4c8ce", hatch="///" if passing else None, **style))
    if what == CAR:
        for near, far in ((-0.26, -0.16), (0.32, 0.24)):
            glass = np.array([[near, -0.4], [near, 0.4], [far, 0.34], [far, -0.34]])
            turned = glass if box.length >= box.width else glass[:, ::-1]
            corners = place(turned * np.array([box.length, box.width]), box.x, box.y, box.heading)
            axis.add_patch(Polygon(corners, facecolor=GREY, linewidth=0))


def _slot(axis: Any, box: Box) -> None:
    axis.add_patch(Polygon(box.outline(), facecolor="#eef1f4", edgecolor=GREY, linewidth=1.4, label="slot", zorder=0))


def _outlines(axis: Any, car: CarOutline, x: Array, y: Array, heading: Array) -> None:
    """Draw the car at equal distances along its path, later ones darker."""
    travelled = np.concatenate([[0.0], np.cumsum(np.nan_to_num(np.hypot(np.diff(x), np.diff(y))))])
    if travelled[-1] <= 0.0:
        rows = np.array([len(x) - 1])
    else:
        rows = np.unique(np.searchsorted(travelled, np.linspace(0.0, travelled[-1], PATH_OUTLINES)).clip(0, len(x) - 1))
        rows[-1] = len(x) - 1
    for number, row in enumerate(rows):
        share = (number + 1) / len(rows)
        last = number == len(rows) - 1
        points = place(car.outline(), x[row], y[row], heading[row])
        face = (0.145, 0.388, 0.659, 0.16 if last else 0.0)
        edge = (0.145, 0.388, 0.659, 1.0 if last else 0.12 + 0.4 * share)
        axis.add_patch(Polygon(points, facecolor=face, edgecolor=edge, linewidth=1.8 if last else 0.9, zorder=3))
    axis.autoscale_view()


def _wheels(axis: Any, seen: Overview, car: CarOutline, pose: tuple[float, float, float]) -> None:
    for local in car.wheel_outlines(float(seen.signal("vehicle.front_wheel_angle")[-1])):
        axis.add_patch(Polygon(place(local, *pose), facecolor=INK, linewidth=0, zorder=6))
