"""Two grids over the search region: the edges near each cell, and the cost-to-go from each cell to the target."""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.geometry.polygons import clip_to_box, segment_distance_squared
from controller_fmu.parking.planning.collision import MAX_CLEARANCE
from controller_fmu.parking.planning.problem import SearchGrid, SearchProblem, SearchRegion
from controller_fmu.parking.planning.work import BUCKET_COUNT, NO_INDEX, PlanCount, PlanningWork
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

HALF_DIAGONAL = 0.7072
"""Of a cell of side 1, rounded up."""
UNREACHABLE_COST = 1e6
"""Distance [m] from where the target cannot be reached."""
NOT_QUEUED = -2


def index_edges(work: PlanningWork, edges: int, region: SearchRegion, car: VehicleOutline) -> bool:
    """List the edges near each cell; returns whether edges and lists have room for all."""
    if edges > len(work.edge_x1):
        return False
    cells = region.edge_grid.row_cells * region.edge_grid.row_cells
    for cell in range(cells + 1):
        work.cell_start[cell] = 0
    for edge in range(edges):
        _index_edge(work, edge, region, car, False)
    total = 0
    for cell in range(cells + 1):
        total += work.cell_start[cell]
        work.cell_start[cell] = total
    if total > len(work.cell_edge):
        return False
    for edge in range(edges):
        _index_edge(work, edge, region, car, True)
    return True


class _EdgeBounds(NamedTuple):
    """An edge in the region's frame: its first end, the vector to the other, the least x and y of both [m]."""

    x: float
    y: float
    dx: float
    dy: float
    low_x: float
    low_y: float


def _edge(work: PlanningWork, edge: int, region: SearchRegion) -> _EdgeBounds:
    x = work.edge_x1[edge] - region.x0
    y = work.edge_y1[edge] - region.y0
    dx = work.edge_x2[edge] - work.edge_x1[edge]
    dy = work.edge_y2[edge] - work.edge_y1[edge]
    return _EdgeBounds(x, y, dx, dy, x if dx > 0.0 else x + dx, y if dy > 0.0 else y + dy)


def _index_edge(work: PlanningWork, edge: int, region: SearchRegion, car: VehicleOutline, fill: bool) -> None:
    """Count the edge at each cell it is near, or put it into the cell's list, from the end of the list on.

    Near is within the distance [m] of the cell's centre that can matter to a car whose own centre is in the cell.
    """
    grid = region.edge_grid
    radius = math.sqrt(car.half_length * car.half_length + car.half_width * car.half_width)
    reach = HALF_DIAGONAL * grid.cell + radius + MAX_CLEARANCE
    x1, y1, dx, dy, low_x, low_y = _edge(work, edge, region)
    for row in range(_cell(low_y - reach, grid), _cell(low_y + abs(dy) + reach, grid) + 1):
        for column in range(_cell(low_x - reach, grid), _cell(low_x + abs(dx) + reach, grid) + 1):
            x = (column + 0.5) * grid.cell - x1
            y = (row + 0.5) * grid.cell - y1
            if segment_distance_squared(x, y, dx, dy) < reach * reach:
                cell = row * grid.row_cells + column
                place = work.cell_start[cell]
                if fill:
                    work.cell_start[cell] = place - 1
                    work.cell_edge[place - 1] = edge
                else:
                    work.cell_start[cell] = place + 1


def _cell(at: float, grid: SearchGrid) -> int:
    cell = math.floor(at / grid.cell)
    return 0 if cell < 0 else (grid.row_cells - 1 if cell >= grid.row_cells else cell)


def mark_blocked_cells(work: PlanningWork, edges: int, problem: SearchProblem) -> None:
    """Mark the cost-to-go cells whose every point is too near an edge for the rear axle's midpoint."""
    region = problem.region
    grid = region.cost_to_go
    for cell in range(grid.row_cells * grid.row_cells):
        work.cost_to_go[cell] = UNREACHABLE_COST
        work.cost_to_go_next[cell] = NOT_QUEUED
    reach = problem.car.half_width + problem.margin - HALF_DIAGONAL * grid.cell
    for edge in range(edges):
        x1, y1, dx, dy, low_x, low_y = _edge(work, edge, region)
        for row in range(_cell(low_y - reach, grid), _cell(low_y + abs(dy) + reach, grid) + 1):
            y = (row + 0.5) * grid.cell - y1
            from_x = low_x
            to_x = low_x + abs(dx)
            if abs(dy) > grid.cell:
                a = x1 + dx * (y - reach) / dy
                b = x1 + dx * (y + reach) / dy
                from_x = max(min(a, b), from_x)
                to_x = min(max(a, b), to_x)
            for column in range(_cell(from_x - reach, grid), _cell(to_x + reach, grid) + 1):
                x = (column + 0.5) * grid.cell - x1
                if segment_distance_squared(x, y, dx, dy) < reach * reach:
                    work.cost_to_go[row * grid.row_cells + column] = -1.0


def compute_cost_to_go(work: PlanningWork, problem: SearchProblem) -> None:
    """Measure the distance [m] of a point from each free cell to the target, over eight neighbours (Dijkstra, Dial)."""
    for number in range(BUCKET_COUNT):
        work.bucket[number] = NO_INDEX
    start = _cost_to_go_cell(problem.target.x, problem.target.y, problem.region)
    work.cost_to_go[start] = 0.0
    work.cost_to_go_next[start] = NO_INDEX
    work.bucket[0] = start
    for number in range(BUCKET_COUNT):
        while work.bucket[number] != NO_INDEX:
            cell = work.bucket[number]
            work.bucket[number] = work.cost_to_go_next[cell]
            work.cost_to_go_next[cell] = NOT_QUEUED
            _relax(work, cell, problem.region.cost_to_go)


def _relax(work: PlanningWork, cell: int, grid: SearchGrid) -> None:
    row = cell // grid.row_cells
    column = cell - row * grid.row_cells
    here = work.cost_to_go[cell]
    for r in range(max(row - 1, 0), min(row + 2, grid.row_cells)):
        for c in range(max(column - 1, 0), min(column + 2, grid.row_cells)):
            other = r * grid.row_cells + c
            before = work.cost_to_go[other]
            distance = here + grid.cell * (1.0 if r == row or c == column else 1.41421356)
            if before >= 0.0 and distance < before - 1e-3:
                work.cost_to_go[other] = distance
                if work.cost_to_go_next[other] == NOT_QUEUED:
                    number = min(math.floor(distance / grid.cell), BUCKET_COUNT - 1)
                    work.cost_to_go_next[other] = work.bucket[number]
                    work.bucket[number] = other


def holonomic_cost_to_go(work: PlanningWork, x: float, y: float, region: SearchRegion) -> float:
    """Return the length [m] of the shortest way of a point from (x, y) to the target around the edges."""
    distance = work.cost_to_go[_cost_to_go_cell(x, y, region)]
    return distance if distance >= 0.0 else UNREACHABLE_COST


def _cost_to_go_cell(x: float, y: float, region: SearchRegion) -> int:
    grid = region.cost_to_go
    return _cell(y - region.y0, grid) * grid.row_cells + _cell(x - region.x0, grid)


def add_edges(work: PlanningWork, origin: Pose, region: SearchRegion) -> int:
    """Copy the polygons' edges into the frame of ``origin``, as far as they lie within 10 m of the search region.

    Returns how many do. A line has one edge, not a second one back.
    """
    low = Point(region.x0 - 10.0, region.y0 - 10.0)
    high = Point(region.x0 + region.side + 10.0, region.y0 + region.side + 10.0)
    count = 0
    for vertex in range(work.counts[PlanCount.VERTEX_COUNT]):
        if work.corner_of[vertex] > 0:
            after = next_corner(work, vertex)
            start = Point(work.corner_x[vertex] - origin.x, work.corner_y[vertex] - origin.y)
            end = Point(work.corner_x[after] - origin.x, work.corner_y[after] - origin.y)
            part = clip_to_box(start, end, low, high)
            if after != vertex - 1 and part.enter <= part.leave:
                if count < len(work.edge_x1):
                    work.edge_x1[count] = start.x + part.enter * (end.x - start.x)
                    work.edge_y1[count] = start.y + part.enter * (end.y - start.y)
                    work.edge_x2[count] = start.x + part.leave * (end.x - start.x)
                    work.edge_y2[count] = start.y + part.leave * (end.y - start.y)
                count += 1
    return count


def next_corner(work: PlanningWork, vertex: int) -> int:
    """Return the vertex that an edge leads to from ``vertex``: the next one, or the first of the polygon."""
    polygon = work.corner_of[vertex]
    if vertex + 1 < work.counts[PlanCount.VERTEX_COUNT] and work.corner_of[vertex + 1] == polygon:
        return vertex + 1
    first = vertex
    while first > 0 and work.corner_of[first - 1] == polygon:
        first -= 1
    return first


def is_inside(work: PlanningWork, pose: Pose) -> bool:
    """Return whether the rear axle's midpoint lies inside a polygon: a ray meets an odd count of its edges."""
    odd = False
    for vertex in range(work.counts[PlanCount.VERTEX_COUNT]):
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
