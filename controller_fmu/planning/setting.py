"""The scene of a request in the store: edges of its polygons, and whether a pose lies inside one."""

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.planning.rasters import add_edge
from controller_fmu.planning.task import SearchWindow
from modelkit.geometry import Point
from modelkit.vocabulary import Pose


def add_edges(store: PlanStore, origin: Pose, window: SearchWindow) -> int:
    """Take over the edges of all polygons, seen from ``origin``; returns how many lie in or near the window."""
    count = 0
    for corner in range(len(store.corner_x)):
        after = next_corner(store, corner)
        if store.corner_of[corner] > 0 and not _leads_back(store, corner, after):
            count = add_edge(store, count, _seen_from(origin, store, corner), _seen_from(origin, store, after), window)
    return count


def _leads_back(store: PlanStore, corner: int, after: int) -> bool:
    """Return whether the edge from ``corner`` is that of a wall, a polygon of two corners, once more."""
    return after == corner - 1 and (after == 0 or store.corner_of[after - 1] != store.corner_of[corner])


def _seen_from(origin: Pose, store: PlanStore, corner: int) -> Point:
    return Point(store.corner_x[corner] - origin.x, store.corner_y[corner] - origin.y)


def next_corner(store: PlanStore, corner: int) -> int:
    """Return the corner that an edge leads to from ``corner``: the next one, or the first of the polygon."""
    polygon = store.corner_of[corner]
    if corner + 1 < len(store.corner_x) and store.corner_of[corner + 1] == polygon:
        return corner + 1
    first = corner
    while first > 0 and store.corner_of[first - 1] == polygon:
        first -= 1
    return first


def is_inside(store: PlanStore, pose: Pose) -> bool:
    """Return whether the rear axle's midpoint lies inside a polygon: a ray meets an odd count of its edges."""
    odd = False
    for corner in range(len(store.corner_x)):
        if store.corner_of[corner] > 0:
            after = next_corner(store, corner)
            ay = store.corner_y[corner] - pose.y
            by = store.corner_y[after] - pose.y
            if (ay > 0.0) != (by > 0.0):
                ax = store.corner_x[corner] - pose.x
                bx = store.corner_x[after] - pose.x
                if ax + ay / (ay - by) * (bx - ax) > 0.0:
                    odd = not odd
            if after <= corner:
                if odd:
                    return True
                odd = False
    return False
