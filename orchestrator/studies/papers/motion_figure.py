"""Pictures of the parking papers beside Guo 2015: Zhang's Fig. 5 to 8, HSIC's Fig. 13 with the ribbon of its states."""

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from controller_fmu.hsic.characteristic_states import Characteristic
from controller_fmu.zhang2022.phases import ZhangPhase
from orchestrator.evaluation.verdict.geometry import CarOutline
from orchestrator.presentation.drawing.save import save as save_picture
from orchestrator.studies.papers.result import Driven

BLUE, ORANGE, GREEN, GREY = "#1f5fbf", "#d1602a", "#2b8a5a", "#888888"


def draw_zhang(runs: list[Driven], file: Path) -> Path:
    """Write path, heading, speed and front-wheel angle of the runs, with their references."""
    figure, axes = plt.subplots(2, 2, figsize=(11.0, 7.2), layout="constrained")
    path, heading, speed, angle = axes.flat
    for driven, colour in zip(runs, (BLUE, ORANGE), strict=True):
        signals, t = driven.recording.signals, driven.recording.t
        label = "double-track body" if driven.summary.scenario.endswith("track") else "kinematic body"
        path.plot(signals["vehicle.pose.x"], signals["vehicle.pose.y"], color=colour, label=label)
        on = signals["controller.phase"] == ZhangPhase.PATH_TRACKING
        heading.plot(t, np.degrees(signals["vehicle.pose.heading"]), color=colour)
        speed.plot(t, signals["vehicle.speed"], color=colour)
        error = signals["vehicle.front_wheel_angle"] - signals["controller.zhang2022.reference_angle"]
        angle.plot(t[on], np.degrees(error[on]), color=colour)
    first = runs[0].recording
    on = first.signals["controller.phase"] == ZhangPhase.PATH_TRACKING
    dotted = {"color": "#222222", "linestyle": ":", "linewidth": 1.0}
    path.plot(
        first.signals["controller.reference.x"][on], first.signals["controller.reference.y"][on], label="path", **dotted
    )
    heading.plot(first.t[on], np.degrees(first.signals["controller.reference.heading"][on]), **dotted)
    speed.plot(first.t, first.signals["controller.zhang2022.set_speed"], **dotted)
    outlines(path, runs[0], 8)
    path.set(xlabel="x [m]", ylabel="y [m]", title="Fig. 5: path", aspect="equal")
    heading.set(xlabel="t [s]", ylabel="deg", title="Fig. 6: heading")
    speed.set(xlabel="t [s]", ylabel="m/s", title="Fig. 7: speed")
    angle.set(xlabel="t [s]", ylabel="deg", title="Fig. 8: front-wheel angle off the path's")
    figure.legend(loc="outside lower center", ncols=3, frameon=False)
    return save(figure, file)


def draw_hsic(plain: Driven, shuffle: Driven, file: Path) -> Path:
    """Write path, angles, deviation from the tangent and the ribbon of states for two drives."""
    figure, axes = plt.subplots(4, 2, figsize=(12.0, 10.0), layout="constrained", height_ratios=(2.2, 1, 1, 1.4))
    for column, driven in enumerate((plain, shuffle)):
        signals, t = driven.recording.signals, driven.recording.t
        path, angles, tangent, ribbon = axes[:, column]
        path.plot(signals["vehicle.pose.x"], signals["vehicle.pose.y"], color=BLUE, linewidth=1.4)
        outlines(path, driven, 9)
        path.set(aspect="equal", title=driven.summary.scenario, xlabel="x [m]", ylabel="y [m]")
        angles.plot(t, np.degrees(signals["vehicle.front_wheel_angle"]), color=GREEN, label="front wheel")
        angles.plot(t, np.degrees(signals["vehicle.pose.heading"]), color=BLUE, label="heading")
        angles.set(ylabel="deg")
        angles.legend(frameon=False, ncols=2)
        on = signals["controller.hsic.stage"] == ZhangPhase.PATH_TRACKING
        tangent.plot(t[on], 100.0 * signals["controller.hsic.tangent_error"][on], color=ORANGE)
        tangent.set(ylabel="off the\ntangent [cm]", xlim=(0.0, t[-1]))
        _ribbon(ribbon, driven)
    return save(figure, file)


def _ribbon(axis: Any, driven: Driven) -> None:
    t, state = driven.recording.t, driven.recording.signals["controller.hsic.characteristic"]
    colours = {0: GREY, 1: BLUE, 2: ORANGE, 3: GREEN}
    edges = np.flatnonzero(np.diff(state)) + 1
    for start, end in zip([0, *edges], [*edges, len(t) - 1], strict=True):
        value = int(state[start])
        if value:
            axis.plot(
                [t[start], max(t[end], t[start] + 0.15)],
                [value, value],
                linewidth=6,
                color=colours[(value - 1) % 4],
                solid_capstyle="butt",
            )
    names = [item.name.replace("_", " ").lower() for item in Characteristic if item]
    axis.set_yticks(range(1, 13), names, fontsize=7)
    axis.set(xlabel="t [s]", xlim=(0.0, t[-1]), ylim=(12.7, 0.3))


def outlines(axis: Any, driven: Driven, count: int) -> None:
    """Draw the car ``count`` times along its path, and the cars beside the slot."""
    recording = driven.recording
    p = recording.parameters_of("vehicle")
    x, y, heading = (recording.signals[f"vehicle.pose.{key}"] for key in ("x", "y", "heading"))
    corners = CarOutline.of(p).outline()
    for row in np.linspace(0, len(x) - 1, count).astype(int):
        c, s = np.cos(heading[row]), np.sin(heading[row])
        points = corners @ np.array([[c, s], [-s, c]]) + (x[row], y[row])
        axis.add_patch(Polygon(points, fill=False, edgecolor=GREY, linewidth=0.7, alpha=0.8))
    for number in range(1, 17):
        box = {key: p.get(f"scene.boxes[{number}].{key}", 0.0) for key in ("x", "y", "length", "width")}
        if box["length"] > 0.0:
            half = np.array([box["length"], box["width"]]) / 2
            points = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half + (box["x"], box["y"])
            axis.add_patch(Polygon(points, facecolor="#dddddd", edgecolor=GREY, linewidth=0.8))
    axis.autoscale_view()


def save(figure: Figure, file: Path) -> Path:
    """Write the figure and return its path."""
    for axis in figure.axes:
        axis.grid(alpha=0.25, linewidth=0.6)
        axis.spines[["top", "right"]].set_visible(False)
    save_picture(figure, file, dpi=110)
    plt.close(figure)
    return file
