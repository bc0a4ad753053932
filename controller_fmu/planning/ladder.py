"""The searches that are made in turn: coarse ones first, from the goal and from the start; less margin last."""

import math

from controller_fmu.planning.plan_store import GOAL_TIGHTER, NEAR_SIDE, ROOM, ROUTE_SIDE, RUNG, PlanStore
from controller_fmu.planning.task import Request, Rung, SearchWindow, Task
from modelkit.vocabulary import Pose

DEG = math.pi / 180.0
LADDER = (
    Rung(False, True, 1.0, 1.0, 20.0 * DEG, 1.0, 4.0, 3.0, 80),
    Rung(True, False, 1.0, 1.0, 20.0 * DEG, 1.0, 4.0, 3.0, 80),
    Rung(False, True, 1.0, 0.7, 14.0 * DEG, 2.0, 3.0, 3.0, 400),
    Rung(True, False, 1.0, 0.7, 14.0 * DEG, 2.0, 3.0, 3.0, 400),
    Rung(False, True, 1.0, 0.5, 10.0 * DEG, 4.0, 3.0, 3.0, 2000),
    Rung(True, False, 1.0, 0.5, 10.0 * DEG, 4.0, 3.0, 3.0, 1500),
    Rung(False, True, 1.0, 0.3, 6.0 * DEG, 4.0, 3.0, 3.0, 4000),
    Rung(True, False, 1.0, 0.3, 6.0 * DEG, 4.0, 3.0, 3.0, 4000),
    Rung(False, True, 0.5, 0.5, 10.0 * DEG, 4.0, 3.0, 3.0, 2000),
    Rung(False, True, 0.5, 0.3, 6.0 * DEG, 4.0, 3.0, 3.0, 4000),
    Rung(True, False, 0.5, 0.4, 8.0 * DEG, 4.0, 3.0, 3.0, 2000),
    Rung(False, True, 0.5, 0.15, 3.0 * DEG, 4.0, 1.0, 0.0, 5000),
    Rung(False, True, 0.3, 0.5, 10.0 * DEG, 4.0, 3.0, 3.0, 2000),
    Rung(False, True, 0.3, 0.15, 3.0 * DEG, 4.0, 1.0, 0.0, 5000),
    Rung(False, True, 0.3, 0.1, 2.0 * DEG, 4.0, 1.0, 0.0, 10000),
    Rung(False, True, 0.2, 0.15, 3.0 * DEG, 4.0, 3.0, 0.0, 5000),
    Rung(True, False, 0.2, 0.3, 6.0 * DEG, 4.0, 3.0, 3.0, 2000),
)
ROOM_RESERVE = 0.001
"""The margin is so much [m] less than the clearance at start and goal."""
MIN_MARGIN = 0.002
"""Least margin [m] of a search. A sweep finds contact only where it keeps a margin above the rounding of the tree's
poses (single precision: under 0.1 mm), and its steps shrink with the margin."""
AROUND = 15.0
"""The window reaches so far [m] beyond start and goal."""
NEAR_CELL = 2.0
ROUTE_CELL = 0.4


def window_of(request: Request) -> SearchWindow:
    """Return the window of a request, in a frame whose origin is the goal."""
    x = request.start.x - request.goal.x
    y = request.start.y - request.goal.y
    across = abs(x) if abs(x) > abs(y) else abs(y)
    side = across + 2.0 * AROUND
    near = side / NEAR_SIDE if side > NEAR_CELL * NEAR_SIDE else NEAR_CELL
    route = side / ROUTE_SIDE if side > ROUTE_CELL * ROUTE_SIDE else ROUTE_CELL
    near_count = math.floor(side / near)
    route_count = math.floor(side / route)
    return SearchWindow(0.5 * (x - side), 0.5 * (y - side), side, near, near_count, route, route_count)


def task_of(store: PlanStore, request: Request) -> Task:
    """Return the search of the rung in hand."""
    rung = LADDER[store.mark[RUNG]]
    start = Pose(request.start.x - request.goal.x, request.start.y - request.goal.y, request.start.heading)
    goal = Pose(0.0, 0.0, request.goal.heading)
    wished = request.margin * rung.share
    room = store.measure[ROOM] - ROOM_RESERVE
    margin = wished if wished < room else room
    margin = margin if margin > MIN_MARGIN else MIN_MARGIN
    from_goal = rung.tighter == (store.mark[GOAL_TIGHTER] == 1)
    root = goal if from_goal else start
    target = start if from_goal else goal
    return Task(root, target, request.car, window_of(request), from_goal, margin, rung)
