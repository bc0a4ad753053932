"""overview.png: the four panels of the paper, the path with the car drawn along it, and a ribbon of chart states."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Ellipse, Patch, Polygon

from orchestrator.cosim.recording import Recording
from orchestrator.cosim.slave import Array
from orchestrator.drawing.looks import CAR, PERSON, looks
from orchestrator.drawing.palette import LIGHT, role
from orchestrator.drawing.save import save
from orchestrator.scenario.scenario import Scenario
from orchestrator.text.quantities import DEGREE
from orchestrator.text.readable import changes_text, shifts_text
from orchestrator.verdict.geometry import (
    WHEEL_RADIUS,
    WHEEL_WIDTH,
    Box,
    CarOutline,
    described,
    kerbs,
    place,
    sample_path,
    slot_box,
    things,
)
from orchestrator.verdict.summary import Summary, phase_changes

BLUE, ASKED, GREEN, GREY, INK = LIGHT["run-a"], LIGHT["asked"], LIGHT["good"], "#8a8f98", "#22262c"
RIBBONS = ("controller.hsic.characteristic", "controller.preview.stage", "controller.phase")
"""What the ribbon shows: the first of these that changes during the run."""
STYLE: Any = {
    "font.size": 9.0,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.titlesize": 10.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.grid": True,
    "grid.color": "#e3e6ea",
    "grid.linewidth": 0.7,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
}
FAR = 50.0
"""Beyond this [m] from the origin, positions are shown from the start."""
STILLS = 10
"""Of a thing that moves, one picture a second is drawn."""
OUTLINES = 14
"""About how many outlines are drawn along the path."""


def draw(recording: Recording, summary: Summary, scenario: Scenario, path: Path) -> None:
    """Write the overview picture of a run to ``path``."""
    with mpl.rc_context(STYLE):
        save(overview(recording, summary, scenario), path, dpi=120, metadata={"Software": "apa-cosim"})


def overview(recording: Recording, summary: Summary, scenario: Scenario) -> Figure:
    """Return the overview picture of a run."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(13.0, 9.0), layout="constrained")
        grid = figure.add_gridspec(4, 3, height_ratios=(1.45, 0.07, 1.0, 0.075))
        _plan(figure.add_subplot(grid[0, :]), recording, scenario)
        panels = [figure.add_subplot(grid[2, column]) for column in range(3)]
        for axis, panel in zip(panels, (_speed, _position, _heading), strict=True):
            panel(axis, recording)
            axis.tick_params(labelbottom=False)
            axis.set_xlim(recording.t[0], recording.t[-1])
            for row, _, _ in phase_changes(recording):
                axis.axvline(recording.t[row], color="#d5d9df", linewidth=0.8, zorder=0)
        names: dict[str, str] = {}
        for column, axis in enumerate(panels):
            names = _ribbon(figure.add_subplot(grid[3, column], sharex=axis), recording)
        _legend(figure.add_subplot(grid[1, :]), names)
        figure.suptitle(_title(summary, scenario), x=0.012, ha="left", fontsize=12.5, fontweight="bold", color=INK)
    return figure


def _title(summary: Summary, scenario: Scenario) -> str:
    final, changes, outcome = summary.final, changes_text(summary.changed), summary.outcome.replace("_", " ")
    name = f"{scenario.name} with {changes}" if changes else scenario.name
    text = f"{name}: {outcome} after {summary.duration:.1f} s"
    if not math.isfinite(final.lateral_error):
        return text
    errors = f"{final.lateral_error * 100:+.1f} cm lateral, {final.heading_error / DEGREE:+.2f} deg"
    return f"{text}, {shifts_text(summary.shifts)}; {errors}"


def _signal(recording: Recording, name: str) -> Array:
    return recording.signals.get(name, np.full(len(recording.t), np.nan))


def _speed(axis: Any, recording: Recording) -> None:
    t = recording.t
    axis.set_title("(a) speed, steering")
    axis.plot(t, _signal(recording, "vehicle.speed"), color=BLUE, linewidth=1.5)
    axis.set_ylabel("speed [m/s]", color=BLUE)
    wheel = axis.twinx()
    wheel.grid(False)
    wheel.spines["right"].set_visible(True)
    request = _signal(recording, "controller.steering_wheel_request") / DEGREE
    wheel.plot(t, request, color=ASKED, linewidth=0.8, linestyle=(0, (3, 2)), label="request")
    wheel.plot(t, _signal(recording, "vehicle.steering_wheel_angle") / DEGREE, color=INK, linewidth=1.2, label="angle")
    wheel.set_ylabel("steering wheel [deg]", color=INK)
    wheel.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=2, borderaxespad=0.0)


def _position(axis: Any, recording: Recording) -> None:
    t = recording.t
    far = max(abs(_signal(recording, f"vehicle.pose.{name}")[0]) for name in ("x", "y")) > FAR
    axis.set_title("(b) position")
    for name, colour in (("x", BLUE), ("y", INK)):
        driven = _signal(recording, f"vehicle.pose.{name}")
        origin = driven[0] if far else 0.0
        reference = _used(recording, f"controller.reference.{name}") - origin
        axis.plot(t, reference, color=ASKED, linewidth=0.8, linestyle=(0, (3, 2)))
        axis.plot(t, driven - origin, color=colour, linewidth=1.5, label=name)
    axis.plot([], [], color=ASKED, linewidth=0.8, linestyle=(0, (3, 2)), label="reference")
    axis.set_ylabel("way from start [m]" if far else "position [m]")
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=3, borderaxespad=0.0)


def _heading(axis: Any, recording: Recording) -> None:
    t = recording.t
    axis.set_title("(c) heading")
    driven = _signal(recording, "vehicle.pose.heading")
    reference = _used(recording, "controller.reference.heading")
    turns = np.round((driven - reference) / (2.0 * np.pi))
    reference = (reference + turns * 2.0 * np.pi) / DEGREE
    axis.plot(t, reference, color=ASKED, linewidth=0.8, linestyle=(0, (3, 2)), label="reference")
    axis.plot(t, driven / DEGREE, color=BLUE, linewidth=1.5, label="heading")
    axis.set_ylabel("heading [deg]")
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=2, borderaxespad=0.0)


def _used(recording: Recording, name: str) -> Array:
    """Return a reference signal, blank until the controller first gives one."""
    prefix = name.rsplit(".", 1)[0]
    given = np.zeros(len(recording.t), dtype=bool)
    for axis in ("x", "y", "heading"):
        given |= _signal(recording, f"{prefix}.{axis}") != 0.0
    return np.where(given, _signal(recording, name), np.nan)


def _ribbon(axis: Any, recording: Recording) -> dict[str, str]:
    """Draw the states of the chart over time; return those that occurred with their colours."""
    axis.set_yticks([])
    axis.grid(False)
    axis.spines["left"].set_visible(False)
    axis.set_xlabel("time [s]")
    t = recording.t
    shown = next((name for name in RIBBONS if np.ptp(_signal(recording, name)) > 0.0), RIBBONS[-1])
    states = recording.states(shown)
    phases = _signal(recording, shown)
    edges = [0, *(int(row) + 1 for row in np.flatnonzero(np.diff(phases))), len(t) - 1]
    names: dict[str, str] = {}
    for first, last in pairwise(edges):
        value = phases[first]
        name = states.get(int(value), f"{value:g}") if math.isfinite(value) else "unknown"
        names[name] = LIGHT[role(name, value if math.isfinite(value) else 0.0)]
        axis.axvspan(t[first], t[last], color=names[name], linewidth=0)
    axis.set_ylim(0.0, 1.0)
    return names


def _legend(axis: Any, names: dict[str, str]) -> None:
    axis.axis("off")
    handles = [Patch(color=colour, label=name.lower().replace("_", " ")) for name, colour in names.items()]
    axis.legend(
        handles=handles,
        title="states of the chart",
        title_fontsize=8,
        loc="center",
        ncols=len(handles),
        fontsize=8,
        borderaxespad=0.0,
        handlelength=1.2,
        columnspacing=1.4,
    )


def _plan(axis: Any, recording: Recording, scenario: Scenario) -> None:
    axis.set_title("(d) path of the rear-axle midpoint, outline along it")
    axis.set_aspect("equal", adjustable="datalim")
    axis.set_xlabel("x [m]")
    axis.set_ylabel("y [m]")
    vehicle = described(scenario, recording.parameters_of("vehicle"))
    car = CarOutline.of(vehicle)
    for thing in things(vehicle):
        stills = [still for still in thing.stills() if still.appear_at <= recording.t[-1]]
        for still in [*stills[:-1:STILLS], *stills[-1:]]:
            _thing(axis, still)
    for corners in scenario.polygons:
        axis.add_patch(Polygon(corners, facecolor="#c4c8ce", edgecolor=GREY, linewidth=1.0))
    for kerb in kerbs(vehicle):
        axis.plot([kerb.x1, kerb.x2], [kerb.y1, kerb.y2], color="#5b6068", linewidth=2.5, solid_capstyle="butt")
    if scenario.slot is not None:
        _slot(axis, slot_box(scenario.slot))
    if scenario.target is not None:
        at_target = place(car.outline(), *scenario.target.pose)
        axis.plot(*at_target.T, color=GREEN, linewidth=1.4, linestyle=(0, (4, 2)), label="target")
    planned = _planned(recording)
    if len(planned):
        axis.plot(*planned.T, color=ASKED, linewidth=1.6, linestyle=(0, (5, 2)), label="planned path", zorder=4)
    x, y, heading = (_signal(recording, f"vehicle.pose.{name}") for name in ("x", "y", "heading"))
    _outlines(axis, car, x, y, heading)
    axis.plot(x, y, color=BLUE, linewidth=1.8, label="driven path", zorder=5)
    _wheels(axis, recording, car, (x[-1], y[-1], heading[-1]))
    axis.legend(loc="upper left", fontsize=8)


def _thing(axis: Any, box: Box) -> None:
    """Draw what is in the way: somebody, a car, or a plain box; hatched if it comes or goes."""
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


def _planned(recording: Recording) -> Array:
    """Return the last path that was planned, (n, 2) [m]."""
    marks = [
        values
        for name, values in recording.signals.items()
        if name.endswith(("path.segments[1].length", "move.direction"))
    ]
    rows = np.flatnonzero(np.any([values != 0.0 for values in marks], axis=0)) if marks else np.empty(0, dtype=np.intp)
    return sample_path(recording.values_at("controller", int(rows[-1]))) if len(rows) else np.empty((0, 2))


def _outlines(axis: Any, car: CarOutline, x: Array, y: Array, heading: Array) -> None:
    """Draw the car at equal distances along its way, later ones darker."""
    way = np.concatenate([[0.0], np.cumsum(np.nan_to_num(np.hypot(np.diff(x), np.diff(y))))])
    if way[-1] <= 0.0:
        rows = np.array([len(x) - 1])
    else:
        rows = np.unique(np.searchsorted(way, np.linspace(0.0, way[-1], OUTLINES)).clip(0, len(x) - 1))
        rows[-1] = len(x) - 1
    for number, row in enumerate(rows):
        share = (number + 1) / len(rows)
        last = number == len(rows) - 1
        points = place(car.outline(), x[row], y[row], heading[row])
        face = (0.145, 0.388, 0.659, 0.16 if last else 0.0)
        edge = (0.145, 0.388, 0.659, 1.0 if last else 0.12 + 0.4 * share)
        axis.add_patch(Polygon(points, facecolor=face, edgecolor=edge, linewidth=1.8 if last else 0.9, zorder=3))
    axis.autoscale_view()


def _wheels(axis: Any, recording: Recording, car: CarOutline, pose: tuple[float, float, float]) -> None:
    steered = float(_signal(recording, "vehicle.front_wheel_angle")[-1])
    half_length, half_width = WHEEL_RADIUS, 0.5 * WHEEL_WIDTH
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.array([half_length, half_width])
    for x, y in car.wheels():
        local = place(corners, x, y, steered if x > 0.0 and math.isfinite(steered) else 0.0)
        axis.add_patch(Polygon(place(local, *pose), facecolor=INK, linewidth=0, zorder=6))
