"""Obstacles as polygons: what the planner keeps clear of, and what the sensors should measure among them."""

from typing import NamedTuple

VERTICES = 256
"""Capacity of an obstacle map: 64 landmarks of two vertices, 32 quadrilaterals about a slot."""


class Vertex(NamedTuple):
    """A vertex [m]; vertices in a row with the same number are one polygon, 0: unused."""

    x: float = 0.0
    y: float = 0.0
    polygon: int = 0


class ObstacleMap(NamedTuple):
    """Polygons, convex or not; one of two vertices is a line, one of a single vertex a point."""

    vertices: tuple[Vertex, ...] = (Vertex(),) * VERTICES


def next_index(obstacles: ObstacleMap, index: int, first: int) -> int:
    """Return the vertex that the edge from ``index`` leads to; ``first`` is the first of its polygon."""
    last = index + 1 >= VERTICES
    after = 0 if last else index + 1
    goes_on = not last and obstacles.vertices[after].polygon == obstacles.vertices[index].polygon
    return after if goes_on else first
