"""Obstacles as polygons: what the planner keeps clear of, and what the sensors should measure among them."""

from typing import Annotated, NamedTuple

from modelkit.geometry import Point
from modelkit.signal import Signal

LOCAL_VERTICES = 256
"""64 landmarks of two vertices, 32 quadrilaterals about a slot."""
MAP_VERTICES = 360
"""Vertices of the polygons of a given map."""


class Vertex(NamedTuple):
    """A vertex [m]; vertices in a row with the same number are one polygon, 0: unused."""

    x: Annotated[float, Signal("m", "x of the vertex")] = 0.0
    y: Annotated[float, Signal("m", "y of the vertex")] = 0.0
    polygon: Annotated[int, Signal("1", "vertices in a row with the same number are one polygon; 0: unused", 0)] = 0


class ObstacleMap(NamedTuple):
    """Polygons about the vehicle, convex or not; one of two vertices is a line, one of a single vertex a point."""

    vertices: tuple[Vertex, ...] = (Vertex(),) * LOCAL_VERTICES


def next_index(vertices: tuple[Vertex, ...], index: int) -> int:
    """Return the vertex that the edge from ``index`` leads to: the next one, or the first of its polygon."""
    after = min(index + 1, len(vertices) - 1)
    if after > index and vertices[after].polygon == vertices[index].polygon:
        return after
    first = index
    while first > 0 and vertices[first - 1].polygon == vertices[index].polygon:
        first -= 1
    return first


def segment_distance_squared(x: float, y: float, dx: float, dy: float) -> float:
    """Return the squared distance [m2] from (x, y) to the segment from the origin to (dx, dy)."""
    square = dx * dx + dy * dy
    t = (x * dx + y * dy) / square if square > 0.0 else 0.0
    t = 0.0 if t < 0.0 else (1.0 if t > 1.0 else t)
    ex = x - t * dx
    ey = y - t * dy
    return ex * ex + ey * ey


class SegmentPart(NamedTuple):
    """The part of a segment from the share ``enter`` of its length to ``leave``; none where those are in disorder."""

    enter: float
    leave: float


def clip_to_box(start: Point, end: Point, low: Point, high: Point) -> SegmentPart:
    """Return the part of a segment that lies within the box ``low`` to ``high``."""
    enter = 0.0
    leave = 1.0
    for side in range(4):
        is_x = side < 2
        at = start.x if is_x else start.y
        rate = (end.x if is_x else end.y) - at
        box = low if side % 2 == 0 else high
        left = (box.x if is_x else box.y) - at
        if abs(rate) < 1e-12:
            if left != 0.0 and (left > 0.0) == (side % 2 == 0):
                return SegmentPart(1.0, 0.0)
        elif (rate > 0.0) == (side % 2 == 0):
            enter = max(enter, left / rate)
        else:
            leave = min(leave, left / rate)
    return SegmentPart(enter, leave)
