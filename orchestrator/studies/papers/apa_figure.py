"""The parking system's ways into a parallel and a perpendicular slot, as one picture."""

import math
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from controller_fmu.parking.chart import ParkingState
from orchestrator.presentation.drawing.save import save
from orchestrator.studies.papers.result import Driven

ROWS_PER_OUTLINE = 120
"""Rows between two outlines drawn."""
DRIVING_STATES = tuple(
    int(state)
    for state in (ParkingState.STEERING, ParkingState.DRIVING, ParkingState.STOPPING, ParkingState.STRAIGHTENING)
)
MARKS = {1: ("parking", "tab:blue"), 0: ("search", "0.6")}


def draw_apa(parallel: Driven, perpendicular: Driven, path: Path) -> Path:
    """Write the picture and return its path."""
    figure = Figure(figsize=(10, 7))
    for number, driven in enumerate((parallel, perpendicular), start=1):
        _draw(figure.add_subplot(2, 1, number), driven)
    figure.tight_layout()
    save(figure, path, dpi=110)
    return path


def _draw(axes: Any, driven: Driven) -> None:
    signals = driven.recording.signals
    x, y, heading = (signals[f"vehicle.pose.{name}"] for name in ("x", "y", "heading"))
    vehicle = driven.scenario.vehicle
    for number in range(1, 17):
        name = f"scene.boxes[{number}]."
        if vehicle.get(name + "length"):
            box = [float(vehicle.get(name + item, 0.0)) for item in ("x", "y", "heading", "length", "width")]
            axes.fill(*_rectangle(box[0], box[1], box[2], 0.5 * box[3], 0.5 * box[3], 0.5 * box[4]), color="0.8")
    driving = np.isin(signals["controller.apa.state"], DRIVING_STATES)
    for flag, (label, colour) in MARKS.items():
        axes.plot(np.where(driving == flag, x, np.nan), np.where(driving == flag, y, np.nan), color=colour, label=label)
    front = float(vehicle["car.wheelbase"]) + float(vehicle["car.front_overhang"])
    rear, half = float(vehicle["car.rear_overhang"]), 0.5 * float(vehicle["car.width"])
    for row in [*np.flatnonzero(driving)[::ROWS_PER_OUTLINE], len(x) - 1]:
        axes.plot(*_rectangle(x[row], y[row], heading[row], front, rear, half), color="tab:blue", linewidth=0.5)
    for corner in ("a", "b"):
        x_y = (signals[f"controller.apa.slot.{corner}{axis}"][-1] for axis in "xy")
        axes.plot(*x_y, "r+")
    axes.set_title(driven.scenario.title)
    axes.set_aspect("equal")
    axes.legend(loc="upper right")


def _rectangle(x: float, y: float, heading: float, front: float, rear: float, half: float) -> tuple[Any, Any]:
    c, s = math.cos(heading), math.sin(heading)
    corners = np.array([(front, half), (front, -half), (-rear, -half), (-rear, half), (front, half)])
    return x + corners[:, 0] * c - corners[:, 1] * s, y + corners[:, 0] * s + corners[:, 1] * c
