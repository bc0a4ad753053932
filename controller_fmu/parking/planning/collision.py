"""Exact distance of the car's outline to the edges of polygons, at a pose and along an arc.

Edges are listed by square cells of the search region: each cell has those that a car whose centre lies in it could
come within ``MAX_CLEARANCE`` of. A sweep goes on by what the clearance at hand allows: no point of the outline moves
farther than ``max_point_speed_ratio`` times the distance. Between two poses at least at the margin the outline
keeps half of it, as no step is longer than the margin over ``max_point_speed_ratio``.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.outline import max_point_speed_ratio, pose_along_arc
from controller_fmu.parking.geometry.outline_distance import edge_distance_squared
from controller_fmu.parking.planning.problem import SearchProblem
from controller_fmu.parking.planning.work import PlanningWork
from modelkit.maths import sign
from modelkit.vocabulary import Pose

MAX_CLEARANCE = 1.0
"""Clearances [m] above this read as this."""
MIN_STEP = 0.01
"""Steps [m] of a sweep that runs alongside an edge at the margin; shorter where the margin is small."""


def clearance(work: PlanningWork, pose: Pose, problem: SearchProblem) -> float:
    """Return the distance [m] of the outline to the nearest edge, at most ``MAX_CLEARANCE``; 0: contact or outside."""
    car = problem.car
    region = problem.region
    cos = math.cos(pose.heading)
    sin = math.sin(pose.heading)
    x = pose.x + car.centre_ahead * cos
    y = pose.y + car.centre_ahead * sin
    grid = region.edge_grid
    column = math.floor((x - region.x0) / grid.cell)
    row = math.floor((y - region.y0) / grid.cell)
    if column < 0 or row < 0 or column >= grid.row_cells or row >= grid.row_cells:
        return 0.0
    cell = row * grid.row_cells + column
    best = MAX_CLEARANCE * MAX_CLEARANCE
    for place in range(work.cell_start[cell], work.cell_start[cell + 1]):
        edge = work.cell_edge[place]
        ax = work.edge_x1[edge] - x
        ay = work.edge_y1[edge] - y
        bx = work.edge_x2[edge] - x
        by = work.edge_y2[edge] - y
        best = edge_distance_squared(
            ax * cos + ay * sin, ay * cos - ax * sin, bx * cos + by * sin, by * cos - bx * sin, car, best
        )
    return math.sqrt(best)


class ArcSweep(NamedTuple):
    """How far the car can drive along an arc."""

    distance: float
    """Before its clearance falls under the margin [m]."""
    gap: float
    """Clearance beyond the margin [m] where the sweep has ended."""


def sweep_arc(
    work: PlanningWork, pose: Pose, gap: float, distance: float, curvature: float, problem: SearchProblem
) -> ArcSweep:
    """Drive along an arc, at most ``distance`` [m] (reverse negative), from a pose with ``gap`` [m] over the margin."""
    direction = sign(distance)
    longest = abs(distance)
    rate = max_point_speed_ratio(problem.car, curvature)
    least = min(MIN_STEP, problem.margin / rate)
    driven = 0.0
    while driven < longest:
        sure = max(gap, 0.0) / rate
        after = min(driven + max(sure, least), longest)
        gap_after = clearance(work, pose_along_arc(pose, direction * after, curvature), problem) - problem.margin
        if gap_after < 0.0:
            return ArcSweep(min(driven + sure, longest), gap_after)
        driven = after
        gap = gap_after
    return ArcSweep(longest, gap)
