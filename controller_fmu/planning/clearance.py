"""Exact distance of the car's outline to the edges of polygons, at a pose and along an arc.

Edges are listed by square cells of the window: each cell has those that a car whose centre lies in it could
come within ``SIGHT`` of. A sweep goes on by what the clearance at hand allows: no point of the outline moves
farther than ``fastest`` times the way. Between two poses at least at the margin the outline keeps half of it, as no
step is longer than the margin over ``fastest``.
"""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.planning.task import PlannedCar, Task, drive, fastest
from modelkit.maths import sign
from modelkit.vocabulary import Pose

SIGHT = 1.0
"""Clearances [m] above this read as this."""
LEAST_STEP = 0.01
"""Steps [m] of a sweep that runs alongside an edge at the margin; shorter where the margin is small."""


def clearance(store: PlanStore, pose: Pose, task: Task) -> float:
    """Return the distance [m] of the outline to the nearest edge, at most ``SIGHT``; 0 on contact or outside."""
    car = task.car
    window = task.window
    cos = math.cos(pose.heading)
    sin = math.sin(pose.heading)
    x = pose.x + car.ahead * cos
    y = pose.y + car.ahead * sin
    column = math.floor((x - window.x0) / window.near)
    row = math.floor((y - window.y0) / window.near)
    if column < 0 or row < 0 or column >= window.near_count or row >= window.near_count:
        return 0.0
    cell = row * window.near_count + column
    best = SIGHT * SIGHT
    for place in range(store.near_first[cell], store.near_first[cell + 1]):
        edge = store.near_edge[place]
        ax = store.edge_x1[edge] - x
        ay = store.edge_y1[edge] - y
        bx = store.edge_x2[edge] - x
        by = store.edge_y2[edge] - y
        best = edge_gap(
            ax * cos + ay * sin,
            ay * cos - ax * sin,
            bx * cos + by * sin,
            by * cos - bx * sin,
            car,
            best,
        )
    return math.sqrt(best)


def edge_gap(ax: float, ay: float, bx: float, by: float, car: PlannedCar, best: float) -> float:
    """Return the squared distance [m2] from a line a-b to a car about the origin, or ``best`` if that is less."""
    half_length = car.half_length
    half_width = car.half_width
    low = ax if ax < bx else bx
    high = bx if ax < bx else ax
    apart_x = low - half_length if low > half_length else (-half_length - high if high < -half_length else 0.0)
    low = ay if ay < by else by
    high = by if ay < by else ay
    apart_y = low - half_width if low > half_width else (-half_width - high if high < -half_width else 0.0)
    if apart_x * apart_x + apart_y * apart_y >= best:
        return best
    dx = bx - ax
    dy = by - ay
    across = ax * dy - ay * dx
    if apart_x == 0.0 and apart_y == 0.0 and abs(across) <= half_length * abs(dy) + half_width * abs(dx):
        return 0.0
    best = _point_gap(ax, ay, half_length, half_width, best)
    best = _point_gap(bx, by, half_length, half_width, best)
    square = dx * dx + dy * dy
    if square <= 0.0:
        return best
    best = _corner_gap(half_length - ax, half_width - ay, dx, dy, square, best)
    best = _corner_gap(-half_length - ax, half_width - ay, dx, dy, square, best)
    best = _corner_gap(half_length - ax, -half_width - ay, dx, dy, square, best)
    return _corner_gap(-half_length - ax, -half_width - ay, dx, dy, square, best)


class Sweep(NamedTuple):
    """How far the car can drive along an arc."""

    way: float
    """Before its clearance falls under the margin [m]."""
    gap: float
    """Clearance beyond the margin [m] where the sweep has ended."""


def free_way(store: PlanStore, pose: Pose, direction: float, curvature: float, longest: float, task: Task) -> float:
    """Return how far [m] the car can drive along an arc before its clearance falls under the margin."""
    return sweep(store, pose, clearance(store, pose, task) - task.margin, direction * longest, curvature, task).way


def sweep(store: PlanStore, pose: Pose, gap: float, most: float, curvature: float, task: Task) -> Sweep:
    """Drive along an arc, at most ``most`` [m] (reverse negative); at ``pose`` it has ``gap`` [m] beyond the margin."""
    direction = sign(most)
    longest = abs(most)
    rate = fastest(task.car, curvature)
    least = LEAST_STEP if LEAST_STEP * rate < task.margin else task.margin / rate
    way = 0.0
    while way < longest:
        sure = gap / rate if gap > 0.0 else 0.0
        step = sure if sure > least else least
        after = way + step if way + step < longest else longest
        gap_after = clearance(store, drive(pose, direction * after, curvature), task) - task.margin
        if gap_after < 0.0:
            return Sweep(way + sure if way + sure < longest else longest, gap_after)
        way = after
        gap = gap_after
    return Sweep(longest, gap)


def _point_gap(x: float, y: float, half_length: float, half_width: float, best: float) -> float:
    dx = abs(x) - half_length
    dy = abs(y) - half_width
    dx = dx if dx > 0.0 else 0.0
    dy = dy if dy > 0.0 else 0.0
    gap = dx * dx + dy * dy
    return gap if gap < best else best


def _corner_gap(cx: float, cy: float, dx: float, dy: float, square: float, best: float) -> float:
    """Return the squared distance of a corner, seen from a, to the line that leads by (dx, dy) to b, or ``best``."""
    t = (cx * dx + cy * dy) / square
    t = 0.0 if t < 0.0 else (1.0 if t > 1.0 else t)
    x = cx - t * dx
    y = cy - t * dy
    gap = x * x + y * y
    return gap if gap < best else best
