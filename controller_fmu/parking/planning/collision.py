"""Exact distance of the car's outline to the edges of polygons, at a pose and along an arc.

Edges are listed by square cells of the search region: each cell has those that a car whose centre lies in it could
come within ``MAX_CLEARANCE`` of. A sweep goes on by what the clearance at hand allows: no point of the outline moves
farther than ``max_point_speed_ratio`` times the distance. Between two poses at least at the margin the outline
keeps half of it, as no step is longer than the margin over ``max_point_speed_ratio``.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.outline import OutlineFrame, frame_along_arc, max_point_speed_ratio, outline_frame
from controller_fmu.parking.geometry.outline_distance import box_distance, edge_distance_squared
from controller_fmu.parking.planning.problem import SearchProblem
from controller_fmu.parking.planning.work import PlanningWork
from modelkit.maths import sign
from modelkit.vocabulary import Pose

MAX_CLEARANCE = 1.0
"""Clearances [m] above this read as this."""
MIN_STEP = 0.01
"""Steps [m] of a sweep that runs alongside an edge at the margin; shorter where the margin is small."""


def clearance(work: PlanningWork, frame: OutlineFrame, problem: SearchProblem) -> float:
    """Return the distance [m] of the outline to the nearest edge, at most ``MAX_CLEARANCE``; 0: contact or outside."""
    car = problem.car
    region = problem.region
    cos = frame.cos
    sin = frame.sin
    x = frame.x + car.centre_ahead * cos
    y = frame.y + car.centre_ahead * sin
    along = car.half_length * abs(cos) + car.half_width * abs(sin)
    across = car.half_length * abs(sin) + car.half_width * abs(cos)
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
        apart_x = box_distance(ax, bx, along)
        apart_y = box_distance(ay, by, across)
        if apart_x * apart_x + apart_y * apart_y < best:
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
    start = outline_frame(pose)
    while driven < longest:
        sure = max(gap, 0.0) / rate
        after = min(driven + max(sure, least), longest)
        frame = frame_along_arc(start, pose.heading, direction * after, curvature)
        gap_after = clearance(work, frame, problem) - problem.margin
        if gap_after < 0.0:
            return ArcSweep(min(driven + sure, longest), gap_after)
        driven = after
        gap = gap_after
    return ArcSweep(longest, gap)
