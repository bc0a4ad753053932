"""The searches that are made in turn: coarse ones first, from the goal and from the start; less margin last."""

import math

from controller_fmu.parking.geometry.outline import pose_along_arc
from controller_fmu.parking.planning.problem import (
    PlanningRequest,
    SearchGrid,
    SearchProblem,
    SearchRegion,
    SearchResolution,
    SearchStage,
)
from controller_fmu.parking.planning.work import COST_TO_GO_CELLS, EDGE_CELLS, PlanCount, PlanningWork, PlanValue
from modelkit.vocabulary import Pose

RADIANS_PER_DEGREE = math.pi / 180.0
COARSE = SearchResolution(1.0, 20.0 * RADIANS_PER_DEGREE, refinement=1.0, heuristic_weight=4.0, crowding_cost=3.0)
MEDIUM = SearchResolution(0.7, 14.0 * RADIANS_PER_DEGREE, refinement=2.0, heuristic_weight=3.0, crowding_cost=3.0)
FINE = SearchResolution(0.5, 10.0 * RADIANS_PER_DEGREE, refinement=4.0, heuristic_weight=3.0, crowding_cost=3.0)
FINER = SearchResolution(0.3, 6.0 * RADIANS_PER_DEGREE, refinement=4.0, heuristic_weight=3.0, crowding_cost=3.0)
EXHAUSTIVE = SearchResolution(0.15, 3.0 * RADIANS_PER_DEGREE, refinement=4.0, heuristic_weight=1.0, crowding_cost=0.0)
"""Cells shrink as fast as their headings; the last orders nodes by their true cost and leaves none out."""
SEARCH_SCHEDULE = (
    SearchStage(COARSE, 1.0, 80),
    SearchStage(COARSE, 1.0, 80, always=True, root_at_tighter_end=False),
    SearchStage(MEDIUM, 1.0, 400),
    SearchStage(MEDIUM, 1.0, 400, always=True, root_at_tighter_end=False),
    SearchStage(FINE, 1.0, 2000),
    SearchStage(FINE, 1.0, 2000, always=True, root_at_tighter_end=False),
    SearchStage(FINER, 1.0, 4000),
    SearchStage(FINER, 1.0, 4000, always=True, root_at_tighter_end=False),
    SearchStage(FINE, 0.5, 2000),
    SearchStage(FINER, 0.5, 4000),
    SearchStage(FINE, 0.5, 2000, always=True, root_at_tighter_end=False),
    SearchStage(EXHAUSTIVE, 0.5, 5000),
    SearchStage(FINE, 0.3, 2000),
    SearchStage(EXHAUSTIVE, 0.3, 10000),
    SearchStage(EXHAUSTIVE, 0.2, 5000),
    SearchStage(FINER, 0.2, 2000, always=True, root_at_tighter_end=False),
)
"""Coarse searches first; where the desired margin cannot be kept, a half, a third and a fifth of it."""
CLEARANCE_RESERVE = 0.001
"""The margin is so much [m] less than the clearance at start and goal."""
MIN_MARGIN = 0.002
"""Least margin [m] of a search. A sweep finds contact only where it keeps a margin above the rounding of the tree's
poses (single precision: under 0.1 mm), and its steps shrink with the margin."""
REGION_MARGIN = 15.0
"""The window reaches so far [m] beyond start and goal."""
EDGE_CELL = 2.0
COST_TO_GO_CELL = 0.4
"""Least side [m] of a cell of the two grids; a region that is too large for their capacity has larger cells."""


def search_region(request: PlanningRequest) -> SearchRegion:
    """Return the search region of a request, in a frame whose origin is the goal."""
    x = request.start.x - request.goal.x
    y = request.start.y - request.goal.y
    side = max(abs(x), abs(y)) + 2.0 * REGION_MARGIN
    edge_grid = search_grid(side, EDGE_CELL, EDGE_CELLS)
    cost_to_go = search_grid(side, COST_TO_GO_CELL, COST_TO_GO_CELLS)
    return SearchRegion(0.5 * (x - side), 0.5 * (y - side), side, edge_grid, cost_to_go)


def search_grid(side: float, least_cell: float, most: int) -> SearchGrid:
    """Return a grid over a square of ``side`` [m], of cells of ``least_cell`` [m] or, if those are too many, larger."""
    cell = max(side / most, least_cell)
    return SearchGrid(cell, math.floor(side / cell))


def search_problem(work: PlanningWork, request: PlanningRequest) -> SearchProblem:
    """Return the search of the stage in hand."""
    stage = SEARCH_SCHEDULE[work.counts[PlanCount.STAGE]]
    start = Pose(request.start.x - request.goal.x, request.start.y - request.goal.y, request.start.heading)
    goal = pose_along_arc(Pose(0.0, 0.0, request.goal.heading), -request.run_in, 0.0)
    clearance = work.values[PlanValue.MIN_END_CLEARANCE] - CLEARANCE_RESERVE
    margin = max(min(request.margin * stage.margin_fraction, clearance), MIN_MARGIN)
    from_goal = stage.root_at_tighter_end == (work.counts[PlanCount.GOAL_TIGHTER] == 1)
    root = goal if from_goal else start
    target = start if from_goal else goal
    return SearchProblem(root, target, request.car, search_region(request), from_goal, margin, stage)
