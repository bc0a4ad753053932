"""The panels of the overview picture: curves over time, at most two units each, in rows of three."""

import re
from typing import Any, NamedTuple

import numpy as np

from orchestrator.presentation.drawing.overview import Overview
from orchestrator.presentation.drawing.palette import LIGHT
from orchestrator.presentation.drawing.panels import DEGREE, Panel, PanelCurve
from orchestrator.simulation.cosim.fmu_instance import Array

BLUE, ASKED, INK = LIGHT["run-a"], LIGHT["asked"], "#22262c"
FAR_FROM_ORIGIN = 50.0
"""Beyond this [m], positions are shown from the start."""
COLUMNS_PER_ROW = 3
BASE_WIDTH, BASE_HEIGHT, ROW_HEIGHT = 13.0, 9.0, 3.6
"""Of the picture with one row of panels, and of each further row [in]."""
LEFT_EDGE, RIGHT_EDGE = 0.058, 0.986
PANEL_BOTTOM, PANEL_HEIGHT = 0.088, 0.295
GAP, GAP_WITH_AXIS = 0.069, 0.106
"""Between two panels, and where the left one has an axis at its right; shares of the width."""
LEGEND_STYLE: Any = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "fontsize": 8, "borderaxespad": 0.0}


class AxesPlace(NamedTuple):
    """Where axes lie in the picture, as shares of its width and height."""

    left: float
    bottom: float
    width: float
    height: float


def picture_height(columns: int) -> float:
    """Return the height [in] of a picture with so many panels."""
    return BASE_HEIGHT + ROW_HEIGHT * (_rows(columns) - 1)


def raise_place(place: AxesPlace, columns: int) -> AxesPlace:
    """Return a place above the panels in a picture that may have more rows of them than one."""
    height = picture_height(columns)
    bottom = place.bottom * BASE_HEIGHT + height - BASE_HEIGHT
    return place._replace(bottom=bottom / height, height=place.height * BASE_HEIGHT / height)


def panel_places(columns: list[list[Panel]]) -> list[AxesPlace]:
    """Return where the panels lie: rows of three, as wide as there is room. All places are fixed.

    To have them found by matplotlib costs more than all the rest.
    """
    height, rows, right = picture_height(len(columns)), _rows(len(columns)), COLUMNS_PER_ROW - 1
    wide = [any(len(column) > 1 for column in columns[number::COLUMNS_PER_ROW]) for number in range(right)]
    gaps = [GAP_WITH_AXIS if is_wide else GAP for is_wide in wide]
    width = (RIGHT_EDGE - LEFT_EDGE - sum(gaps)) / COLUMNS_PER_ROW
    places = []
    for number in range(len(columns)):
        row, column = divmod(number, COLUMNS_PER_ROW)
        left = LEFT_EDGE + column * width + sum(gaps[:column])
        bottom = (PANEL_BOTTOM * BASE_HEIGHT + ROW_HEIGHT * (rows - 1 - row)) / height
        places.append(AxesPlace(left, bottom, width, PANEL_HEIGHT * BASE_HEIGHT / height))
    return places


def draw_panel(axis: Any, letter: str, panels: list[Panel], seen: Overview) -> None:
    """Draw the panels of one column: the first at the left axis, a second one at the right."""
    axis.set_title(f"({letter}) {panels[0].title.lower() if len(panels) == 1 else _short_title(panels)}")
    _curves(axis, panels[0], seen, [BLUE, INK], "" if len(panels) == 1 else BLUE)
    for panel in panels[1:]:
        right = axis.twinx()
        right.grid(False)
        right.spines["right"].set_visible(True)
        _curves(right, panel, seen, [INK, BLUE], INK)


def _short_title(panels: list[Panel]) -> str:
    """Return the first word of each: there is room for a legend beside it then."""
    return ", ".join(panel.title.lower().split()[0] for panel in panels)


def _rows(columns: int) -> int:
    return max(1, -(-columns // COLUMNS_PER_ROW))


def _curves(axis: Any, panel: Panel, seen: Overview, colours: list[str], label_colour: str) -> None:
    factor, unit = (DEGREE, "deg") if panel.unit == "rad" else (1.0, panel.unit)
    shown = [curve for curve in panel.curves if curve.in_picture]
    driven = [curve for curve in shown if not curve.reference_of]
    from_start = panel.unit == "m" and any(abs(seen.signal(curve.signal)[0]) > FAR_FROM_ORIGIN for curve in driven)
    named = "" if len(shown) > 1 else "_"
    dashed: Any = {"color": ASKED, "linewidth": 0.8, "linestyle": (0, (3, 2))}
    references = [curve for curve in shown if curve.reference_of]
    for number, curve in enumerate(references):
        label = ("request" if curve.signal.endswith("request") else "reference") if number == 0 else "_"
        values = _reference(seen, curve, panel.unit) - _origin(seen, curve.reference_of, from_start)
        axis.plot(seen.t, values / factor, label=named + label, zorder=2.0, **dashed)
    for number, curve in enumerate(driven):
        values = (seen.signal(curve.signal) - _origin(seen, curve.signal, from_start)) / factor
        label, colour = named + re.split(r"[._]", curve.signal)[-1], colours[number % len(colours)]
        axis.plot(seen.t, values, color=colour, linewidth=1.5 if colour == BLUE else 1.2, label=label, zorder=2.1)
    low, high = axis.get_ylim()
    missing = max(0.0, panel.least_span / factor - (high - low))
    axis.set_ylim(low - 0.5 * missing, high + 0.5 * missing)
    name = "distance from start" if from_start else panel.title.lower()
    axis.set_ylabel(name + ("" if unit == "1" else f" [{unit}]"), **({"color": label_colour} if label_colour else {}))
    if len(shown) > 1:
        axis.legend(ncols=min(len(driven) + 1, 3), **LEGEND_STYLE)


def _origin(seen: Overview, signal: str, from_start: bool) -> float:
    return float(seen.signal(signal)[0]) if from_start else 0.0


def _reference(seen: Overview, curve: PanelCurve, unit: str) -> Array:
    """Return the requested values: a pose blank until one is first given, an angle in the turn of what follows it."""
    values = seen.signal(curve.signal)
    group, _, name = curve.signal.rpartition(".")
    if name in ("x", "y", "heading"):
        given = np.zeros(len(seen.t), dtype=bool)
        for axis in ("x", "y", "heading"):
            given |= seen.signal(f"{group}.{axis}") != 0.0
        values = np.where(given, values, np.nan)
    if unit == "rad" and name == "heading":
        values = values + 2.0 * np.pi * np.round((seen.signal(curve.reference_of) - values) / (2.0 * np.pi))
    return values
