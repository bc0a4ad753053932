"""The planner: searches in turn, step by step; the work arrays cache the result of (scene, request, step count).

What the work arrays hold after ``search_until`` follows from its arguments alone. If they hold something else, of
another request or of later steps, all is done anew from the first step.
"""

from enum import IntEnum
from typing import NamedTuple

from controller_fmu.parking.geometry.outline import outline_frame, pose_along_arc
from controller_fmu.parking.geometry.polygons import LOCAL_VERTICES, ObstacleMap, Vertex
from controller_fmu.parking.planning.collision import MAX_CLEARANCE, clearance, sweep_arc
from controller_fmu.parking.planning.grids import (
    UNREACHABLE_COST,
    add_edges,
    compute_cost_to_go,
    holonomic_cost_to_go,
    index_edges,
    is_inside,
    mark_blocked_cells,
)
from controller_fmu.parking.planning.problem import PlanningRequest, SearchProblem
from controller_fmu.parking.planning.search import PATH_FOUND, SEARCH_ACTIVE, begin_search, expand_next
from controller_fmu.parking.planning.search_schedule import (
    CLEARANCE_RESERVE,
    MIN_MARGIN,
    SEARCH_SCHEDULE,
    search_problem,
    search_region,
)
from controller_fmu.parking.planning.shortcut_smoothing import begin_smoothing, smooth, span_cost
from controller_fmu.parking.planning.work import (
    MAX_CUSPS,
    REQUEST_SIZE,
    WORK_SEGMENTS,
    PlanCount,
    PlanningWork,
    PlanValue,
    move_segments,
    set_segment,
)
from modelkit.maths import sign
from modelkit.vocabulary import Pose


class PlanningPhase(IntEnum):
    """What the next step of the planner does."""

    LAY_OUT = 0
    BEGIN = 1
    SEARCH = 2
    SMOOTH = 3
    FINISHED = 4


class PlanningStatus(IntEnum):
    """State of a request."""

    PLANNING = 0
    PLANNED = 1
    NO_PATH = 2
    START_BLOCKED = 3
    GOAL_BLOCKED = 4
    TOO_MANY_EDGES = 5
    MARGIN_TOO_SMALL = 6
    """Free at start and goal, but with less than the least margin."""


MAX_SEGMENTS = 64


class PathSegment(NamedTuple):
    """A segment of a path."""

    distance: float = 0.0
    """[m], reverse negative."""
    curvature: float = 0.0
    """Curvature [1/m]."""
    overrun: float = 0.0
    """How far [m] the segment before may go on where the gear changes."""


class PlannedPath(NamedTuple):
    """What the planner gives: segments from the start on, those past ``used`` are not; its margin and cost [m]."""

    used: int = 0
    margin: float = 0.0
    cost: float = 0.0
    segments: tuple[PathSegment, ...] = (PathSegment(),) * MAX_SEGMENTS


def search_until(
    work: PlanningWork, local: ObstacleMap, known: tuple[Vertex, ...], request: PlanningRequest, count: int
) -> None:
    """Bring the search for a path among ``local`` and, if requested, ``known`` polygons to ``count`` steps."""
    is_same = store_request(work, local, known, request)
    if work.counts[PlanCount.COUNT] > count or not is_same:
        restart(work)
    for _ in range(work.counts[PlanCount.COUNT], count):
        step(work, request)


def continue_search(work: PlanningWork, request: PlanningRequest, most: int) -> int:
    """Bring the search on by at most ``most`` steps, fewer where one is long; returns their count so far."""
    done = 0
    while done < most and work.counts[PlanCount.PHASE] != PlanningPhase.FINISHED:
        is_long = work.counts[PlanCount.PHASE] < PlanningPhase.SEARCH
        if not is_long or done == 0:
            step(work, request)
        done = most if is_long else done + 1
    return work.counts[PlanCount.COUNT]


def search_status(work: PlanningWork) -> int:
    """Return the ``PlanningStatus`` of the search."""
    return work.counts[PlanCount.STATUS]


def restart(work: PlanningWork) -> None:
    """Bring the search for the stored request back to its first step."""
    work.counts[PlanCount.COUNT] = 0
    work.counts[PlanCount.PHASE] = PlanningPhase.LAY_OUT
    work.counts[PlanCount.STAGE] = 0
    work.counts[PlanCount.STATUS] = PlanningStatus.PLANNING
    work.counts[PlanCount.BEST_SEGMENT_COUNT] = 0


def store_request(work: PlanningWork, local: ObstacleMap, known: tuple[Vertex, ...], request: PlanningRequest) -> bool:
    """Store scene and request in the work arrays; returns whether they held the same before."""
    start = request.start
    goal = request.goal
    car = request.car
    numbers: tuple[float, ...] = (
        (start.x, start.y, start.heading, goal.x, goal.y, goal.heading)
        + (car.centre_ahead, car.half_length, car.half_width, car.max_curvature)
        + (request.margin, request.run_in, float(request.max_cusps))
    )
    count = LOCAL_VERTICES + (len(known) if request.has_map else 0)
    is_same = work.counts[PlanCount.VERTEX_COUNT] == count
    work.counts[PlanCount.VERTEX_COUNT] = count
    for which in range(REQUEST_SIZE):
        is_same = is_same and work.requested[which] == numbers[which]
        work.requested[which] = numbers[which]
    for number in range(count):
        vertex = _vertex(local, known, number)
        is_there = work.corner_x[number] == vertex.x and work.corner_y[number] == vertex.y
        is_same = is_same and is_there and work.corner_of[number] == vertex.polygon
        work.corner_x[number] = vertex.x
        work.corner_y[number] = vertex.y
        work.corner_of[number] = vertex.polygon
    return is_same


def _vertex(local: ObstacleMap, known: tuple[Vertex, ...], number: int) -> Vertex:
    """Return a vertex of both maps in a row; a known polygon has a number that no local one has."""
    if number < LOCAL_VERTICES:
        return local.vertices[number]
    vertex = known[number - LOCAL_VERTICES]
    return vertex._replace(polygon=vertex.polygon + LOCAL_VERTICES) if vertex.polygon > 0 else Vertex()


def step(work: PlanningWork, request: PlanningRequest) -> None:
    """Do one bounded step: set up a scene, begin a search, expand a node, or smooth a span."""
    work.counts[PlanCount.COUNT] = work.counts[PlanCount.COUNT] + 1
    phase = work.counts[PlanCount.PHASE]
    problem = search_problem(work, request)
    if phase == PlanningPhase.LAY_OUT:
        _lay_out(work, request)
    elif phase == PlanningPhase.BEGIN:
        _begin_stage(work, problem)
    elif phase == PlanningPhase.SEARCH:
        status = expand_next(work, problem)
        if status == PATH_FOUND:
            begin_smoothing(work, problem)
            work.counts[PlanCount.PHASE] = PlanningPhase.SMOOTH
        elif status != SEARCH_ACTIVE:
            _next_stage(work)
    elif phase == PlanningPhase.SMOOTH:
        more = smooth(work, problem)
        if not more:
            _keep_if_better(work, request.run_in, problem)
            _next_stage(work)


def path_of_plan(work: PlanningWork, request: PlanningRequest) -> PlannedPath:
    """Return the path that was found, and how far the vehicle may go on where it changes gear, at its margin."""
    count = work.counts[PlanCount.BEST_SEGMENT_COUNT]
    margin = work.values[PlanValue.BEST_PATH_MARGIN]
    problem = search_problem(work, request)._replace(margin=margin)
    pose = Pose(request.start.x - request.goal.x, request.start.y - request.goal.y, request.start.heading)
    before = PathSegment()
    segments: tuple[PathSegment, ...] = (PathSegment(),) * MAX_SEGMENTS
    for number in range(MAX_SEGMENTS):
        if number < count:
            distance = work.best_length[number]
            overrun = 0.0
            if before.distance * distance < 0.0:
                gap = clearance(work, outline_frame(pose), problem) - margin
                longest = sign(before.distance) * MAX_CLEARANCE
                overrun = sweep_arc(work, pose, gap, longest, before.curvature, problem).distance
            before = PathSegment(distance, work.best_curvature[number], overrun)
            segments = segments[:number] + (before,) + segments[number + 1 :]
            pose = pose_along_arc(pose, distance, before.curvature)
    return PlannedPath(count, margin, work.values[PlanValue.BEST_PATH_COST], segments)


def _finish(work: PlanningWork, status: int) -> None:
    work.counts[PlanCount.PHASE] = PlanningPhase.FINISHED
    work.counts[PlanCount.STATUS] = status


def _lay_out(work: PlanningWork, request: PlanningRequest) -> None:
    """Take over the scene's edges, list them by cell, and see whether the car can stand at start and goal."""
    region = search_region(request)
    edges = add_edges(work, request.goal, region)
    work.counts[PlanCount.EDGE_COUNT] = edges
    fits = index_edges(work, edges, region, request.car)
    if not fits:
        _finish(work, PlanningStatus.TOO_MANY_EDGES)
        return
    problem = search_problem(work, request)
    start = problem.target if problem.from_goal else problem.root
    goal = problem.root if problem.from_goal else problem.target
    at_start = 0.0 if is_inside(work, request.start) else clearance(work, outline_frame(start), problem)
    at_goal = 0.0 if is_inside(work, request.goal) else clearance(work, outline_frame(goal), problem)
    at_goal = min(at_goal, clearance(work, outline_frame(Pose(heading=goal.heading)), problem))
    work.values[PlanValue.MIN_END_CLEARANCE] = min(at_start, at_goal)
    work.counts[PlanCount.GOAL_TIGHTER] = 0 if at_start < at_goal else 1
    if at_start <= 0.0:
        _finish(work, PlanningStatus.START_BLOCKED)
    elif at_goal <= 0.0:
        _finish(work, PlanningStatus.GOAL_BLOCKED)
    elif work.values[PlanValue.MIN_END_CLEARANCE] < MIN_MARGIN + CLEARANCE_RESERVE:
        _finish(work, PlanningStatus.MARGIN_TOO_SMALL)
    else:
        work.counts[PlanCount.PHASE] = PlanningPhase.BEGIN


def _begin_stage(work: PlanningWork, problem: SearchProblem) -> None:
    """Begin the search of the stage in hand, unless not even a point could get through."""
    mark_blocked_cells(work, work.counts[PlanCount.EDGE_COUNT], problem)
    compute_cost_to_go(work, problem)
    if holonomic_cost_to_go(work, problem.root.x, problem.root.y, problem.region) >= UNREACHABLE_COST:
        _next_stage(work)
        return
    begin_search(work, problem)
    work.counts[PlanCount.PHASE] = PlanningPhase.SEARCH


def _keep_if_better(work: PlanningWork, run_in: float, problem: SearchProblem) -> None:
    """Keep the path if it is the best yet; from a pose to itself it is one segment without a distance."""
    if run_in != 0.0 and work.counts[PlanCount.SEGMENT_COUNT] < WORK_SEGMENTS:
        _add_run_in(work, run_in, problem)
    if work.counts[PlanCount.SEGMENT_COUNT] == 0:
        set_segment(work, 0, problem.root, 0.0, 0.0)
        work.counts[PlanCount.SEGMENT_COUNT] = 1
    count = work.counts[PlanCount.SEGMENT_COUNT]
    cost = span_cost(work, 0, count, problem)
    best = work.counts[PlanCount.BEST_SEGMENT_COUNT]
    is_worse = best > 0 and work.values[PlanValue.BEST_PATH_COST] <= cost
    cusps = 0
    for segment in range(1, count):
        if work.segment_length[segment] * work.segment_length[segment - 1] < 0.0:
            cusps += 1
    if count > MAX_SEGMENTS or cusps > work.requested[MAX_CUSPS] or is_worse:
        return
    for number in range(count):
        place = count - 1 - number if problem.from_goal else number
        work.best_length[number] = -work.segment_length[place] if problem.from_goal else work.segment_length[place]
        work.best_curvature[number] = work.segment_curvature[place]
    work.counts[PlanCount.BEST_SEGMENT_COUNT] = count
    work.values[PlanValue.BEST_PATH_COST] = cost
    work.values[PlanValue.BEST_PATH_MARGIN] = problem.margin


def _add_run_in(work: PlanningWork, run_in: float, problem: SearchProblem) -> None:
    """Add the straight line to the goal to the path in hand, which may begin there."""
    count = work.counts[PlanCount.SEGMENT_COUNT]
    work.counts[PlanCount.SEGMENT_COUNT] = count + 1
    if problem.from_goal:
        move_segments(work, 0, count, 1)
        set_segment(work, 0, pose_along_arc(problem.root, run_in, 0.0), -run_in, 0.0)
    else:
        set_segment(work, count, problem.target, run_in, 0.0)


def _next_stage(work: PlanningWork) -> None:
    """Go on to the next search, or end."""
    stage = work.counts[PlanCount.STAGE] + 1
    best = work.counts[PlanCount.BEST_SEGMENT_COUNT] > 0
    last = stage >= len(SEARCH_SCHEDULE)
    if best and (last or not SEARCH_SCHEDULE[stage].always):
        _finish(work, PlanningStatus.PLANNED)
    elif last:
        _finish(work, PlanningStatus.NO_PATH)
    else:
        work.counts[PlanCount.STAGE] = stage
        work.counts[PlanCount.PHASE] = PlanningPhase.BEGIN
