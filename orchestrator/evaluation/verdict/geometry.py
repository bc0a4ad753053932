"""Where things are in the plane: the car's outline and wheels, the planned path, the slot."""

import math
import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orchestrator.evaluation.verdict.frame import pose_at
from orchestrator.simulation.cosim.fmu_instance import Array, Indices

if TYPE_CHECKING:
    from orchestrator.inputs.scenario.scenario import Scenario, Slot

WHEEL_RADIUS = 0.29
WHEEL_WIDTH = 0.18
"""For pictures only [m]."""


class CarOutline(NamedTuple):
    """Outline of the car about the midpoint of its rear axle [m]."""

    front: float
    rear: float
    half_width: float
    wheelbase: float

    @staticmethod
    def of(parameters: Mapping[str, float]) -> "CarOutline":
        """Return the outline that the vehicle's parameters (by flat name) give, with fair guesses for what lacks."""
        wheelbase = parameters.get("car.wheelbase", 2.5)
        front = wheelbase + parameters.get("car.front_overhang", 0.8)
        return CarOutline(
            front, parameters.get("car.rear_overhang", 0.6), 0.5 * parameters.get("car.width", 1.7), wheelbase
        )

    def outline(self) -> Array:
        """Return the closed outline in the car's frame, (5, 2) [m]."""
        front, rear, half = self.front, -self.rear, self.half_width
        return np.array([[rear, -half], [front, -half], [front, half], [rear, half], [rear, -half]])

    def wheels(self) -> list[tuple[float, float]]:
        """Return the wheel centres: rear right, rear left, front right, front left [m]."""
        half = self.half_width - WHEEL_WIDTH
        return [(0.0, -half), (0.0, half), (self.wheelbase, -half), (self.wheelbase, half)]

    def wheel_outlines(self, steered: float) -> list[Array]:
        """Return the corners (4, 2) [m] of each wheel in the car's frame, the front ones turned by ``steered`` [rad].

        They point straight ahead where that is not known.
        """
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.array([WHEEL_RADIUS, 0.5 * WHEEL_WIDTH])
        angle = steered if math.isfinite(steered) else 0.0
        return [place(corners, x, y, angle if x > 0.0 else 0.0) for x, y in self.wheels()]


FRAME, LONGEST = 0.1, 60.0
"""Between two pictures of a thing that moves, and how long it is followed [s]."""
MIN_PERMANENT_TIME = 1e6
"""What goes later than this [s] stays."""


class Box(NamedTuple):
    """An oriented rectangle: its middle [m], heading [rad] and size [m], when it is there [s], and how it moves."""

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0
    length: float = 0.0
    width: float = 0.0
    appear_at: float = 0.0
    disappear_at: float = 1e9
    speed_x: float = 0.0
    speed_y: float = 0.0
    moves_at: float = 0.0
    halts_at: float = 1e9
    height: float = 2.0
    """[m]"""

    @property
    def comes_or_goes(self) -> bool:
        """Whether it is there for a part of the run only, or moves."""
        moves = self.speed_x != 0.0 or self.speed_y != 0.0
        return moves or self.appear_at > 0.0 or self.disappear_at < MIN_PERMANENT_TIME

    def outline(self) -> Array:
        """Return the closed outline in the world, (5, 2) [m]."""
        a, b = 0.5 * self.length, 0.5 * self.width
        return place(np.array([[-a, -b], [a, -b], [a, b], [-a, b], [-a, -b]]), self.x, self.y, self.heading)

    def stills(self) -> "list[Box]":
        """Return boxes that stand, one after the other, in the place of one that moves: a picture each ``FRAME``."""
        begin, end = max(self.moves_at, self.appear_at), min(self.halts_at, self.disappear_at, self.moves_at + LONGEST)
        if (self.speed_x == 0.0 and self.speed_y == 0.0) or end <= begin:
            return [self]
        frames = [begin + FRAME * number for number in range(math.ceil((end - begin) / FRAME))]
        times = [*([self.appear_at] if self.appear_at < begin else []), *frames, end, self.disappear_at]
        return [self._at(time, until) for time, until in pairwise(times) if time < until]

    def _at(self, time: float, until: float) -> "Box":
        """Return the box standing where it is at ``time``, there from then on ``until`` [s]."""
        moved = max(0.0, min(time, self.halts_at) - self.moves_at)
        x, y = self.x + self.speed_x * moved, self.y + self.speed_y * moved
        return Box(x, y, self.heading, self.length, self.width, time, until)


def place(points: Array, x: float, y: float, heading: float) -> Array:
    """Return ``points`` (n, 2) turned by ``heading`` [rad] and moved to (x, y) [m]."""
    c, s = math.cos(heading), math.sin(heading)
    return np.column_stack([x + c * points[:, 0] - s * points[:, 1], y + s * points[:, 0] + c * points[:, 1]])


def vehicle_parameters(scenario: "Scenario", own: Mapping[str, float]) -> dict[str, float]:
    """Return the vehicle's parameters: its ``own``, and the scenario's where an FMU has none of that name."""
    return {**scenario.vehicle, **own}


def slot_box(slot: "Slot") -> Box:
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
    """Return the obstacles among a vehicle's parameters: ``scene.boxes[1].x`` and so on; empty ones left out.

    One that moves becomes many that stand, each for a short time.
    """
    return [still for box in moving_boxes(parameters) for still in box.stills()]


def moving_boxes(parameters: Mapping[str, float]) -> list[Box]:
    """Return the boxes as given, one for each obstacle even if it moves."""
    rows = [Box(*row) for row in _rows(parameters, "scene.boxes", Box._field_defaults)]
    return [box for box in rows if box.length > 0.0 and box.width > 0.0 and all(map(math.isfinite, box))]


def kerbs(parameters: Mapping[str, float]) -> list[Kerb]:
    """Return the kerbs among a vehicle's parameters: ``scene.kerbs[1].x1`` and so on; empty ones left out."""
    return [
        kerb
        for kerb in (Kerb(*row) for row in _rows(parameters, "scene.kerbs", Kerb._field_defaults))
        if kerb.height > 0.0
    ]


def edges(polygons: Sequence[Sequence[tuple[float, float]]]) -> list[Kerb]:
    """Return the sides of polygons as kerbs, where no polygons are known; a wall, of two corners, has one."""
    closed = [corners if len(corners) == 2 else [*corners, corners[0]] for corners in polygons]
    return [Kerb(*a, *b, 1.0) for corners in closed for a, b in pairwise(corners)]


def _rows(parameters: Mapping[str, float], array: str, fields: Mapping[str, float]) -> list[list[float]]:
    rows: list[list[float]] = []
    while any(f"{array}[{len(rows) + 1}].{field}" in parameters for field in fields):
        prefix = f"{array}[{len(rows) + 1}]."
        rows.append([parameters.get(prefix + field, default) for field, default in fields.items()])
    return rows


PLANNED = re.compile(r"path\.|.*\b(move|plan)\.|.*\bpoints\[")
"""The outputs by flat name that the planned path is made of."""
ON_ROAD = "preview.l1"
"""The output that is above zero while a road is followed, which is a parameter of the controller."""
KEY_POINT = re.compile(r"(?:.*\.)?([pq]\d|la\d)\.x")
"""A point that a controller has in mind: Q1 to Q4, P1 to P4, LA1 and LA2."""


def sample_path(
    values: Mapping[str, float], spacing: float = 0.05, parameters: Mapping[str, float] | None = None
) -> Array:
    """Return points (n, 2) [m] of the path a controller plans, from its outputs by flat name; empty if there is none.

    One of: a ``plan``, quintics y(x) in the frame of ``plan.origin``; ``path``, arcs driven in reverse from
    ``path.start``, curvature seen with x along the heading; ``points``; a ``move`` (``apa.move``), pieces of linear
    curvature driven in ``direction`` from ``move.start``; the road among the controller's ``parameters``.
    """
    for name, side in values.items():
        if name.endswith("plan.side") and side != 0.0:
            return _quintics(values, name.removesuffix(".side"), side, spacing)
    pieces = [(length, k, k) for length, k in _fields(values, "path.segments", ("length", "curvature"))]
    if any(length > 0.0 for length, _, _ in pieces):
        return _trace_pieces(
            pose_at(values, "path.start"), -1.0, [(length, -k, -k) for length, k, _ in pieces], spacing
        )
    for name in values:
        if name.endswith("points[1].x"):
            points = np.array(_fields(values, name.removesuffix("[1].x"), ("x", "y")))
            if np.any(points) and np.isfinite(points).all():
                return points
    for name, direction in values.items():
        if name.endswith("move.direction") and direction != 0.0:
            prefix = name.removesuffix(".direction")
            moves = _fields(values, f"{prefix}.pieces", ("length", "start_curvature", "end_curvature"))
            turned = [(length, direction * k0, direction * k1) for length, k0, k1 in moves]
            return _trace_pieces(pose_at(values, f"{prefix}.start"), direction, turned, spacing)
    if values.get(ON_ROAD, 0.0) > 0.0:
        road = _fields(parameters or {}, "preview.road", ("length", "curvature"))
        return _trace_pieces((0.0, 0.0, 0.0), 1.0, [(length, k, k) for length, k in road], max(spacing, 0.5))
    return np.empty((0, 2))


def is_planned(signals: Mapping[str, Array]) -> Array:
    """Return for each row of a controller's outputs, by flat name, whether a path is planned."""
    marks = [
        values != 0.0
        for name, values in signals.items()
        if name.endswith(("path.segments[1].length", "move.direction", "plan.side", "points[1].x", ON_ROAD))
    ]
    return np.any(marks, axis=0) if marks else np.empty(0, dtype=bool)


def find_changes(values: Array, before: Array | None = None) -> Indices:
    """Return the rows of ``values`` (n, signals) that differ from the row above, or the first one from ``before``.

    Without ``before`` the first row counts as changed. Not a number equals itself.
    """
    bits = np.asarray(values, dtype=np.float64).view(np.int64)
    changed = np.empty(len(bits), dtype=bool)
    changed[:1] = before is None or (bits[:1] != np.asarray(before, dtype=np.float64).view(np.int64)).any()
    changed[1:] = (bits[1:] != bits[:-1]).any(axis=1)
    return np.flatnonzero(changed)


def key_points(values: Mapping[str, float]) -> dict[str, tuple[float, float]]:
    """Return the points that a controller has in mind by name (Q1), in the world [m]; none that is not known yet."""
    found: dict[str, tuple[float, float, float]] = {}
    for name in values:
        match = KEY_POINT.fullmatch(name)
        if match is not None:
            found[match[1].upper()] = pose_at(values, name.removesuffix(".x"))
    known = {name[0] for name, pose in found.items() if any(pose)}
    return {name: pose[:2] for name, pose in found.items() if name[0] in known and all(map(math.isfinite, pose))}


def _quintics(values: Mapping[str, float], plan: str, side: float, spacing: float) -> Array:
    """Return points of y(x) = y0 + m0 t + c2 t^2 + ... + c5 t^5 with t = (x - x0) / length, from start to target."""
    parts = []
    for x0, length, *c in _fields(values, f"{plan}.quintics", ("x0", "length", "y0", "m0", "c2", "c3", "c4", "c5")):
        count = math.ceil(min(max(1.0, length / spacing), MOST_POINTS)) if math.isfinite(length) else 1
        t = np.linspace(1.0, 0.0, count + 1)
        y = np.polynomial.polynomial.polyval(t, c)
        parts.append(np.column_stack([x0 + length * t, side * y]))
    points = place(np.concatenate(parts), *pose_at(values, f"{plan}.origin"))
    return points if np.isfinite(points).all() else np.empty((0, 2))


def _fields(values: Mapping[str, float], array: str, fields: tuple[str, ...]) -> list[tuple[float, ...]]:
    rows: list[tuple[float, ...]] = []
    while f"{array}[{len(rows) + 1}].{fields[0]}" in values:
        rows.append(tuple(values[f"{array}[{len(rows) + 1}].{field}"] for field in fields))
    return rows


MOST_POINTS = 10_000.0


def _trace_pieces(
    start: tuple[float, float, float], direction: float, pieces: Sequence[tuple[float, ...]], spacing: float
) -> Array:
    """Return points along pieces (length, rate of turning per metre at the start, at the end) from ``start``.

    Empty where a number is not finite, or so large that points are not.
    """
    if not all(map(math.isfinite, (*start, direction, *(item for piece in pieces for item in piece)))):
        return np.empty((0, 2))
    counts = [math.ceil(min(max(1.0, length / spacing), MOST_POINTS)) if length > 0.0 else 0 for length, _, _ in pieces]
    if not sum(counts):
        return np.empty((0, 2))
    x, y, heading = start
    length, k0, k1, count = np.repeat(np.column_stack([np.array(pieces), counts]), counts, axis=0).T
    number = np.concatenate([np.arange(item) for item in counts])
    with np.errstate(over="ignore", invalid="ignore"):
        ds = length / count
        turns = (k0 + (k1 - k0) * (number + 0.5) / count) * ds
        along = np.cumsum(np.append(heading, turns))[:-1] + 0.5 * turns
        chords = direction * ds * np.sinc(0.5 * turns / math.pi)
        points = np.cumsum([[x, y], *np.column_stack([chords * np.cos(along), chords * np.sin(along)])], axis=0)
    return points if np.isfinite(points).all() else np.empty((0, 2))
