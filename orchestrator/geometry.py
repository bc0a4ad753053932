"""Where things are in the plane: the car's outline and wheels, the planned path, the slot."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from orchestrator.scenario import Slot
from orchestrator.slave import Array

WHEEL_RADIUS = 0.29
WHEEL_WIDTH = 0.18
"""For pictures only [m]."""


class Car(NamedTuple):
    """Outline of the car about the midpoint of its rear axle [m]."""

    front: float
    rear: float
    half_width: float
    wheelbase: float

    @staticmethod
    def of(parameters: Mapping[str, float]) -> "Car":
        """Return the outline that the vehicle's parameters (by flat name) give, with fair guesses for what lacks."""
        wheelbase = parameters.get("wheelbase", 2.5)
        front = wheelbase + parameters.get("front_overhang", 0.8)
        return Car(front, parameters.get("rear_overhang", 0.6), 0.5 * parameters.get("width", 1.7), wheelbase)

    def outline(self) -> Array:
        """Return the closed outline in the car's frame, (5, 2) [m]."""
        front, rear, half = self.front, -self.rear, self.half_width
        return np.array([[rear, -half], [front, -half], [front, half], [rear, half], [rear, -half]])

    def wheels(self) -> list[tuple[float, float]]:
        """Return the wheel centres: rear right, rear left, front right, front left [m]."""
        half = self.half_width - WHEEL_WIDTH
        return [(0.0, -half), (0.0, half), (self.wheelbase, -half), (self.wheelbase, half)]


class Box(NamedTuple):
    """An oriented rectangle: its middle [m], heading [rad] and size [m], and when it is there [s]."""

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0
    length: float = 0.0
    width: float = 0.0
    appear_at: float = 0.0
    disappear_at: float = 1e9

    def outline(self) -> Array:
        """Return the closed outline in the world, (5, 2) [m]."""
        a, b = 0.5 * self.length, 0.5 * self.width
        return place(np.array([[-a, -b], [a, -b], [a, b], [-a, b], [-a, -b]]), self.x, self.y, self.heading)


def place(points: Array, x: float, y: float, heading: float) -> Array:
    """Return ``points`` (n, 2) turned by ``heading`` [rad] and moved to (x, y) [m]."""
    c, s = math.cos(heading), math.sin(heading)
    return np.column_stack([x + c * points[:, 0] - s * points[:, 1], y + s * points[:, 0] + c * points[:, 1]])


def in_frame(x: float, y: float, heading: float, frame: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return (longitudinal [m], lateral [m], heading [rad, wrapped]) of a pose in the frame of another."""
    dx, dy = x - frame[0], y - frame[1]
    c, s = math.cos(frame[2]), math.sin(frame[2])
    turn = heading - frame[2]
    return c * dx + s * dy, c * dy - s * dx, math.atan2(math.sin(turn), math.cos(turn))


def slot_box(slot: Slot) -> Box:
    """Return the slot as a rectangle."""
    return Box(slot.x, slot.y, slot.heading, slot.length, slot.width)


class Kerb(NamedTuple):
    """A straight kerb between two points [m]."""

    x1: float = 0.0
    y1: float = 0.0
    x2: float = 0.0
    y2: float = 0.0
    height: float = 0.0


def boxes(parameters: Mapping[str, float]) -> list[Box]:
    """Return the obstacles among a vehicle's parameters: ``scene.boxes[1].x`` and so on; empty ones left out."""
    rows = _rows(parameters, "scene.boxes", Box._field_defaults)
    return [box for box in (Box(*row) for row in rows) if box.length > 0.0 and box.width > 0.0]


def kerbs(parameters: Mapping[str, float]) -> list[Kerb]:
    """Return the kerbs among a vehicle's parameters: ``scene.kerbs[1].x1`` and so on; empty ones left out."""
    return [
        kerb
        for kerb in (Kerb(*row) for row in _rows(parameters, "scene.kerbs", Kerb._field_defaults))
        if kerb.height > 0.0
    ]


def _rows(parameters: Mapping[str, float], array: str, fields: Mapping[str, float]) -> list[list[float]]:
    rows: list[list[float]] = []
    while any(f"{array}[{len(rows) + 1}].{field}" in parameters for field in fields):
        prefix = f"{array}[{len(rows) + 1}]."
        rows.append([parameters.get(prefix + field, default) for field, default in fields.items()])
    return rows


def sample_path(values: Mapping[str, float], spacing: float = 0.05) -> Array:
    """Return points (n, 2) [m] of a planned path given as ``path.start`` and ``path.segments[i]``, driven in reverse.

    Each segment has constant curvature seen with x along the heading; empty if there is no path.
    """
    x, y, heading = (values.get(f"path.start.{axis}", 0.0) for axis in ("x", "y", "heading"))
    points = [(x, y)]
    number = 1
    while f"path.segments[{number}].length" in values:
        length = values[f"path.segments[{number}].length"]
        curvature = values[f"path.segments[{number}].curvature"]
        count = min(max(1, math.ceil(length / spacing)), 10_000) if length > 0.0 and math.isfinite(length) else 0
        for _ in range(count):
            ds = length / count
            turn = -curvature * ds
            chord = ds * (math.sin(0.5 * turn) / (0.5 * turn) if turn != 0.0 else 1.0)
            x -= chord * math.cos(heading + 0.5 * turn)
            y -= chord * math.sin(heading + 0.5 * turn)
            heading += turn
            points.append((x, y))
        number += 1
    return np.array(points) if len(points) > 1 else np.empty((0, 2))
