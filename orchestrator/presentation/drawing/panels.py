"""The panels of curves over time: one table for pictures, replay page, Foxglove, Lichtblick and Rerun."""

import math
from typing import NamedTuple

DEGREE = math.radians(1.0)


class PanelCurve(NamedTuple):
    """A signal in a panel."""

    signal: str
    reference_of: str = ""
    """The signal that should follow it: it is drawn as a request, dashed; empty: it is measured."""
    on_page: bool = True
    """On the page and in viewers."""
    in_picture: bool = True


class Panel(NamedTuple):
    """Curves of one unit over time."""

    name: str
    """For ``--panels``."""
    title: str
    unit: str
    """SI; pictures and pages show angles in degrees."""
    least_span: float
    """Smallest span of the y axis, in its unit."""
    curves: tuple[PanelCurve, ...]
    column: int = 0
    """Which panel of the picture, from 1; the second panel of a column has its axis at the right; 0: not there."""

    def page_signals(self) -> list[str]:
        """Return the signals on the page and in viewers."""
        return [curve.signal for curve in self.curves if curve.on_page]


SPEED, WHEEL = "vehicle.speed", "vehicle.steering_wheel_angle"
PANELS = (
    Panel(
        "speed",
        "Speed",
        "m/s",
        0.2,
        (
            PanelCurve(SPEED),
            PanelCurve("controller.advised_speed", reference_of=SPEED, in_picture=False),
            PanelCurve("controller.speed_request", reference_of=SPEED, in_picture=False),
        ),
        column=1,
    ),
    Panel(
        "steering",
        "Steering wheel",
        "rad",
        5.0 * DEGREE,
        (PanelCurve(WHEEL), PanelCurve("controller.steering_wheel_request", reference_of=WHEEL)),
        column=1,
    ),
    Panel(
        "position",
        "Position",
        "m",
        0.5,
        (
            PanelCurve("vehicle.pose.x"),
            PanelCurve("vehicle.pose.y"),
            PanelCurve("controller.reference.x", reference_of="vehicle.pose.x", on_page=False),
            PanelCurve("controller.reference.y", reference_of="vehicle.pose.y", on_page=False),
        ),
        column=2,
    ),
    Panel(
        "heading",
        "Heading",
        "rad",
        5.0 * DEGREE,
        (
            PanelCurve("vehicle.pose.heading"),
            PanelCurve("controller.reference.heading", reference_of="vehicle.pose.heading"),
        ),
        column=3,
    ),
    Panel("lateral", "Lateral error", "m", 0.01, (PanelCurve("controller.lateral_error"),)),
    Panel("heading-error", "Heading error", "rad", 0.5 * DEGREE, (PanelCurve("controller.heading_error"),)),
    Panel("clearance", "Clearance", "m", 0.2, (PanelCurve("vehicle.clearance"),)),
)
"""In the order of the page."""
MODES = ("controller.phase", "controller.prompt", "vehicle.gear", "controller.reason")
"""Modes that are shown as ribbons and state tables before any other."""
PICTURE_MODES = ("controller.hsic.characteristic", "controller.preview.stage", "controller.phase")
"""The picture has one ribbon: the first of these that changes during the run."""
REFERENCES = frozenset(curve.signal for panel in PANELS for curve in panel.curves if curve.reference_of)
"""Signals that are requests."""


def picture_columns(panels: tuple[Panel, ...] = PANELS) -> list[list[Panel]]:
    """Return the panels of each column of the picture, in the order of the columns."""
    numbers = sorted({panel.column for panel in panels if panel.column > 0})
    return [[panel for panel in panels if panel.column == number] for number in numbers]


def picture_signals(panels: tuple[Panel, ...] = PANELS) -> list[str]:
    """Return the signals in the panels of the picture."""
    shown = (panel for column in picture_columns(panels) for panel in column)
    return [curve.signal for panel in shown for curve in panel.curves if curve.in_picture]
