"""The two rasters over the window: which edges are near a cell, and how far it is from a cell to the target."""

import math
from typing import NamedTuple

from controller_fmu.planning.clearance import SIGHT
from controller_fmu.planning.plan_store import (
    BUCKETS,
    NONE,
    PlanStore,
    clear_route,
    put_bucket,
    put_edge,
    put_near,
    put_near_first,
    put_route,
    put_route_next,
)
from controller_fmu.planning.task import PlannedCar, SearchWindow, Task
from modelkit.geometry import Point

FAR = 1e6
"""Way [m] from where the target cannot be reached."""
UNLISTED = -2


def near_reach(window: SearchWindow, car: PlannedCar) -> float:
    """Return how far [m] from a cell's centre an edge may lie that the car could see from the cell."""
    radius = math.sqrt(car.half_length * car.half_length + car.half_width * car.half_width)
    return 0.7072 * window.near + radius + SIGHT


def add_edge(store: PlanStore, count: int, start: Point, end: Point, window: SearchWindow) -> int:
    """Return the count of edges with this one added, as far as it lies in the window or within 10 m of it."""
    low = -10.0
    high = window.side + 10.0
    ax = start.x - window.x0
    ay = start.y - window.y0
    dx = end.x - start.x
    dy = end.y - start.y
    enter = 0.0
    leave = 1.0
    for side in range(4):
        rate = dx if side < 2 else dy
        at = ax if side < 2 else ay
        bound = low if side % 2 == 0 else high
        if abs(rate) < 1e-12:
            if at < low or at > high:
                return count
        else:
            t = (bound - at) / rate
            if (rate > 0.0) == (side % 2 == 0):
                enter = t if t > enter else enter
            else:
                leave = t if t < leave else leave
    if enter > leave:
        return count
    if count >= len(store.edge_x1):
        return len(store.edge_x1) + 1
    put_edge(store, count, _onward(start, enter, dx, dy), _onward(start, leave, dx, dy))
    return count + 1


def _onward(start: Point, share: float, dx: float, dy: float) -> Point:
    return Point(start.x + share * dx, start.y + share * dy)


def list_near(store: PlanStore, edges: int, window: SearchWindow, car: PlannedCar) -> bool:
    """List the edges near each cell; returns whether the list has room for all."""
    cells = window.near_count * window.near_count
    for cell in range(cells + 1):
        put_near_first(store, cell, 0)
    for edge in range(edges):
        _each_near(store, edge, window, car, False)
    total = 0
    for cell in range(cells + 1):
        total += store.near_first[cell]
        put_near_first(store, cell, total)
    if total > len(store.near_edge):
        return False
    for edge in range(edges):
        _each_near(store, edge, window, car, True)
    return True


class _EdgeBox(NamedTuple):
    """An edge as seen from the window's corner: its first end, the way to the other, the least x and y of both [m]."""

    x: float
    y: float
    dx: float
    dy: float
    low_x: float
    low_y: float


def _edge(store: PlanStore, edge: int, window: SearchWindow) -> _EdgeBox:
    x = store.edge_x1[edge] - window.x0
    y = store.edge_y1[edge] - window.y0
    dx = store.edge_x2[edge] - store.edge_x1[edge]
    dy = store.edge_y2[edge] - store.edge_y1[edge]
    return _EdgeBox(x, y, dx, dy, x if dx > 0.0 else x + dx, y if dy > 0.0 else y + dy)


def _each_near(store: PlanStore, edge: int, window: SearchWindow, car: PlannedCar, fill: bool) -> None:
    """Count the edge at each cell it is near, or put it into the cell's list, from the end of the list on."""
    reach = near_reach(window, car)
    x1, y1, dx, dy, low_x, low_y = _edge(store, edge, window)
    first = _cell(low_x - reach, window.near, window.near_count)
    last = _cell(low_x + abs(dx) + reach, window.near, window.near_count)
    for row in range(
        _cell(low_y - reach, window.near, window.near_count),
        _cell(low_y + abs(dy) + reach, window.near, window.near_count) + 1,
    ):
        for column in range(first, last + 1):
            x = (column + 0.5) * window.near - x1
            y = (row + 0.5) * window.near - y1
            if point_line(x, y, dx, dy) < reach * reach:
                cell = row * window.near_count + column
                place = store.near_first[cell]
                if fill:
                    put_near_first(store, cell, place - 1)
                    put_near(store, place - 1, edge)
                else:
                    put_near_first(store, cell, place + 1)


def point_line(x: float, y: float, dx: float, dy: float) -> float:
    """Return the squared distance [m2] of a point to the line from the origin by (dx, dy)."""
    square = dx * dx + dy * dy
    t = (x * dx + y * dy) / square if square > 0.0 else 0.0
    t = 0.0 if t < 0.0 else (1.0 if t > 1.0 else t)
    ex = x - t * dx
    ey = y - t * dy
    return ex * ex + ey * ey


def _cell(at: float, side: float, count: int) -> int:
    cell = math.floor(at / side)
    return 0 if cell < 0 else (count - 1 if cell >= count else cell)


def block_route(store: PlanStore, edges: int, task: Task) -> None:
    """Mark the cells of the map of ways whose every point is too near an edge for the rear axle's midpoint."""
    window = task.window
    count = window.route_count
    clear_route(store, count * count)
    reach = task.car.half_width + task.margin - 0.7072 * window.route
    for edge in range(edges):
        x1, y1, dx, dy, low_x, low_y = _edge(store, edge, window)
        for row in range(
            _cell(low_y - reach, window.route, count), _cell(low_y + abs(dy) + reach, window.route, count) + 1
        ):
            y = (row + 0.5) * window.route - y1
            from_x = low_x
            to_x = low_x + abs(dx)
            if abs(dy) > window.route:
                a = x1 + dx * (y - reach) / dy
                b = x1 + dx * (y + reach) / dy
                low = a if a < b else b
                high = b if a < b else a
                from_x = low if low > from_x else from_x
                to_x = high if high < to_x else to_x
            for column in range(
                _cell(from_x - reach, window.route, count), _cell(to_x + reach, window.route, count) + 1
            ):
                x = (column + 0.5) * window.route - x1
                if point_line(x, y, dx, dy) < reach * reach:
                    put_route(store, row * count + column, -1.0)


def measure_route(store: PlanStore, task: Task) -> None:
    """Measure the way [m] of a point from each free cell to the target, over eight neighbours (Dijkstra, Dial)."""
    window = task.window
    count = window.route_count
    for number in range(BUCKETS):
        put_bucket(store, number, NONE)
    row = _cell(task.target.y - window.y0, window.route, count)
    column = _cell(task.target.x - window.x0, window.route, count)
    start = row * count + column
    put_route(store, start, 0.0)
    put_route_next(store, start, NONE)
    put_bucket(store, 0, start)
    for number in range(BUCKETS):
        while store.bucket[number] != NONE:
            cell = store.bucket[number]
            put_bucket(store, number, store.route_next[cell])
            put_route_next(store, cell, UNLISTED)
            _relax(store, cell, window)


def _relax(store: PlanStore, cell: int, window: SearchWindow) -> None:
    count = window.route_count
    row = cell // count
    column = cell - row * count
    here = store.route[cell]
    straight = here + window.route
    diagonal = here + window.route * 1.41421356
    for r in range(max(0, row - 1), min(count, row + 2)):
        for c in range(max(0, column - 1), min(count, column + 2)):
            other = r * count + c
            before = store.route[other]
            way = straight if r == row or c == column else diagonal
            if before >= 0.0 and way < before - 1e-3:
                put_route(store, other, way)
                if store.route_next[other] == UNLISTED:
                    number = math.floor(way / window.route)
                    number = number if number < BUCKETS else BUCKETS - 1
                    put_route_next(store, other, store.bucket[number])
                    put_bucket(store, number, other)


def route_left(store: PlanStore, x: float, y: float, window: SearchWindow) -> float:
    """Return the way [m] of a point at (x, y) to the target."""
    column = _cell(x - window.x0, window.route, window.route_count)
    row = _cell(y - window.y0, window.route, window.route_count)
    way = store.route[row * window.route_count + column]
    return way if way >= 0.0 else FAR
