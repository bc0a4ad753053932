"""The scene of a request in the work arrays: edges of its polygons, and whether a pose lies inside one."""

from controller_fmu.parking.geometry.polygons import VERTICES
from controller_fmu.parking.planning.grids import add_edge
from controller_fmu.parking.planning.problem import SearchRegion
from controller_fmu.parking.planning.work import PlanningWork
from modelkit.geometry import Point
from modelkit.vocabulary import Pose


def add_edges(work: PlanningWork, origin: Pose, region: SearchRegion) -> int:
    """Take over the edges of all polygons, seen from ``origin``; returns how many lie in or near the search region."""
    count = 0
    for vertex in range(VERTICES):
        if work.corner_of[vertex] > 0:
            after = next_corner(work, vertex)
            count = add_edge(work, count, _seen_from(origin, work, vertex), _seen_from(origin, work, after), region)
    return count


def _seen_from(origin: Pose, work: PlanningWork, vertex: int) -> Point:
    return Point(work.corner_x[vertex] - origin.x, work.corner_y[vertex] - origin.y)


def next_corner(work: PlanningWork, vertex: int) -> int:
    """Return the vertex that an edge leads to from ``vertex``: the next one, or the first of the polygon."""
    polygon = work.corner_of[vertex]
    if vertex + 1 < VERTICES and work.corner_of[vertex + 1] == polygon:
        return vertex + 1
    first = vertex
    while first > 0 and work.corner_of[first - 1] == polygon:
        first -= 1
    return first


def is_inside(work: PlanningWork, pose: Pose) -> bool:
    """Return whether the rear axle's midpoint lies inside a polygon: a ray meets an odd count of its edges."""
    odd = False
    for vertex in range(VERTICES):
        if work.corner_of[vertex] > 0:
            after = next_corner(work, vertex)
            ay = work.corner_y[vertex] - pose.y
            by = work.corner_y[after] - pose.y
            if (ay > 0.0) != (by > 0.0):
                ax = work.corner_x[vertex] - pose.x
                bx = work.corner_x[after] - pose.x
                if ax + ay / (ay - by) * (bx - ax) > 0.0:
                    odd = not odd
            if after <= vertex:
                if odd:
                    return True
                odd = False
    return False
