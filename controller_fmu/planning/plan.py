"""A path for a request: one search after the other, step by step, as a memo of (scene, request, count of steps).

What the store holds after ``search_to`` follows from the scene taken over and its arguments alone. If it holds
something else, of another scene or request or of later steps, all is done anew from the first step.
"""

from typing import NamedTuple

from controller_fmu.planning.clearance import clearance
from controller_fmu.planning.ladder import LADDER, MIN_MARGIN, ROOM_RESERVE, task_of, window_of
from controller_fmu.planning.plan_store import (
    ASKED,
    COUNT,
    EDGE_COUNT,
    GOAL_TIGHTER,
    KEPT_COST,
    KEPT_COUNT,
    KEPT_MARGIN,
    KEPT_RUNG,
    PHASE,
    PIECE_COUNT,
    ROOM,
    RUNG,
    SEEN,
    STATUS,
    PlanStore,
    put_asked,
    put_corner,
    put_kept,
    put_mark,
    put_measure,
    put_piece,
)
from controller_fmu.planning.rasters import FAR, block_route, list_near, measure_route, route_left
from controller_fmu.planning.room import see_room
from controller_fmu.planning.setting import add_edges, is_inside
from controller_fmu.planning.shorten import begin_path, path_cost, shorten
from controller_fmu.planning.task import Corner, Request, Task
from controller_fmu.planning.transitions import begin_transitions, try_transitions
from controller_fmu.planning.tree import FOUND, SEARCHING, begin_tree, grow

SCENE = 0
PLANT = 1
GROW = 2
SHORTEN = 3
TURN = 4
SEE = 5
OVER = 6

PLANNING = 0
PLANNED = 1
NO_WAY = 2
START_BLOCKED = 3
GOAL_BLOCKED = 4
TOO_MANY_EDGES = 5
NO_ROOM = 6
"""Free at start and goal, but with less than the least margin."""

OTHER_SCENE = -1
"""Instead of a count of steps: the scene has changed since."""
PATH = 96
MOST_CUSPS = 25


class Piece(NamedTuple):
    """A piece of a path."""

    way: float = 0.0
    """[m], reverse negative."""
    k: float = 0.0
    """Curvature [1/m]."""
    room: float = 0.0
    """Where the path begins what is free beyond the margin [m]; where the gear changes how far the piece before may go
    on; else how far beside the path a wheel that turns on the move may take the car."""
    speed: float = 0.0
    """Largest speed [m/s] of a piece of a transition, on which the wheel turns; 0: it is not one."""


class Path(NamedTuple):
    """What the planner gives: pieces from the start on, those past ``used`` are not; its margin and cost [m]."""

    used: int = 0
    margin: float = 0.0
    cost: float = 0.0
    pieces: tuple[Piece, ...] = (Piece(),) * PATH


def search_to(store: PlanStore, request: Request, count: int) -> None:
    """Bring the search for a path in the scene taken over to ``count`` steps."""
    if store.mark[COUNT] > count or not is_of(store, request):
        begin(store, request)
    for _ in range(store.mark[COUNT], count):
        step(store, request)


def search_on(store: PlanStore, request: Request, count: int, most: int) -> int:
    """Bring the search to ``count`` steps and on by at most ``most``, fewer where one is long; returns the count."""
    search_to(store, request, count)
    for number in range(most):
        phase = store.mark[PHASE]
        is_long = phase < GROW
        if phase == OVER or (is_long and number > 0):
            return store.mark[COUNT]
        step(store, request)
        if is_long:
            return store.mark[COUNT]
    return store.mark[COUNT]


def status_of(store: PlanStore) -> int:
    """Return what has become of the search."""
    return store.mark[STATUS]


def is_of(store: PlanStore, request: Request) -> bool:
    """Return whether the store holds the search for this request, in the scene that it holds."""
    numbers = _numbers(request)
    for which in range(ASKED):
        if store.asked[which] != numbers[which]:
            return False
    return store.mark[COUNT] != OTHER_SCENE


def take_corner(store: PlanStore, number: int, corner: Corner) -> None:
    """Take over a corner of the scene; the search in the store is of another scene if the corner is new."""
    if (
        store.corner_of[number] != corner.polygon
        or store.corner_x[number] != corner.x
        or store.corner_y[number] != corner.y
    ):
        put_corner(store, number, corner.x, corner.y, corner.polygon)
        put_mark(store, COUNT, OTHER_SCENE)


def begin(store: PlanStore, request: Request) -> None:
    """Forget all but the scene, and remember what is asked."""
    numbers = _numbers(request)
    for which in range(ASKED):
        put_asked(store, which, numbers[which])
    put_mark(store, COUNT, 0)
    put_mark(store, PHASE, SCENE)
    put_mark(store, RUNG, 0)
    put_mark(store, STATUS, PLANNING)
    put_mark(store, KEPT_COUNT, 0)


def step(store: PlanStore, request: Request) -> None:
    """Do one bounded piece of work: lay out a scene, plant a tree, take up a node, try a shorter span, see a joint."""
    put_mark(store, COUNT, store.mark[COUNT] + 1)
    phase = store.mark[PHASE]
    task = task_of(store, request)
    if phase == SCENE:
        _lay_out(store, request)
    elif phase == PLANT:
        _plant(store, request, task)
    elif phase == GROW:
        status = grow(store, task)
        if status == FOUND:
            begin_path(store, task)
            put_mark(store, PHASE, SHORTEN)
        elif status != SEARCHING:
            _next_rung(store, request)
    elif phase == SHORTEN:
        more = shorten(store, task)
        if not more:
            _keep(store, task)
            _next_rung(store, request)
    elif phase == TURN:
        more = try_transitions(store, request, task, PATH)
        if not more:
            put_mark(store, SEEN, 0)
            put_mark(store, PHASE, SEE)
    elif phase == SEE:
        more = see_room(store, request, task)
        if not more:
            _over(store, PLANNED)


def path_of(store: PlanStore) -> Path:
    """Return the path that was found."""
    pieces = tuple(_piece(store, number) if number < store.mark[KEPT_COUNT] else Piece() for number in range(PATH))
    return Path(store.mark[KEPT_COUNT], store.measure[KEPT_MARGIN], store.measure[KEPT_COST], pieces)


def _piece(store: PlanStore, number: int) -> Piece:
    """Return a piece of the path that was found."""
    return Piece(store.kept_way[number], store.kept_k[number], store.kept_room[number], store.kept_speed[number])


def _numbers(request: Request) -> tuple[float, ...]:
    start = request.start
    goal = request.goal
    car = request.car
    dynamics = request.dynamics
    return (
        start.x,
        start.y,
        start.heading,
        goal.x,
        goal.y,
        goal.heading,
        car.ahead,
        car.half_length,
        car.half_width,
        car.curvature,
        request.margin,
        dynamics.wheelbase,
        dynamics.rate,
        dynamics.curvature,
        dynamics.speed,
        dynamics.acceleration,
        dynamics.deceleration,
    )


def _over(store: PlanStore, status: int) -> None:
    put_mark(store, PHASE, OVER)
    put_mark(store, STATUS, status)


def _lay_out(store: PlanStore, request: Request) -> None:
    """Take over the scene's edges, list them by cell, and see whether the car can stand at start and goal."""
    window = window_of(request)
    edges = add_edges(store, request.goal, window)
    put_mark(store, EDGE_COUNT, edges)
    if edges > len(store.edge_x1):
        _over(store, TOO_MANY_EDGES)
        return
    fits = list_near(store, edges, window, request.car)
    if not fits:
        _over(store, TOO_MANY_EDGES)
        return
    task = task_of(store, request)
    start = task.target if task.from_goal else task.root
    goal = task.root if task.from_goal else task.target
    at_start = 0.0 if is_inside(store, request.start) else clearance(store, start, task)
    at_goal = 0.0 if is_inside(store, request.goal) else clearance(store, goal, task)
    put_measure(store, ROOM, at_start if at_start < at_goal else at_goal)
    put_mark(store, GOAL_TIGHTER, 0 if at_start < at_goal else 1)
    if at_start <= 0.0:
        _over(store, START_BLOCKED)
    elif at_goal <= 0.0:
        _over(store, GOAL_BLOCKED)
    elif store.measure[ROOM] < MIN_MARGIN + ROOM_RESERVE:
        _over(store, NO_ROOM)
    else:
        put_mark(store, PHASE, PLANT)


def _plant(store: PlanStore, request: Request, task: Task) -> None:
    """Begin the search of the rung in hand, unless not even a point could get through."""
    block_route(store, store.mark[EDGE_COUNT], task)
    measure_route(store, task)
    if route_left(store, task.root.x, task.root.y, task.window) >= FAR:
        _next_rung(store, request)
        return
    begin_tree(store, task)
    put_mark(store, PHASE, GROW)


def _keep(store: PlanStore, task: Task) -> None:
    """Keep the path if it is the best yet; from a pose to itself it is one piece without a way."""
    if store.mark[PIECE_COUNT] == 0:
        put_piece(store, 0, task.root, 0.0, 0.0)
        put_mark(store, PIECE_COUNT, 1)
    cost = path_cost(store, task)
    count = store.mark[PIECE_COUNT]
    kept = store.mark[KEPT_COUNT]
    if count > PATH or cusps_of(store) > MOST_CUSPS or (kept > 0 and store.measure[KEPT_COST] <= cost):
        return
    for number in range(count):
        if task.from_goal:
            last = count - 1 - number
            put_kept(store, number, -store.piece_way[last], store.piece_k[last])
        else:
            put_kept(store, number, store.piece_way[number], store.piece_k[number])
    put_mark(store, KEPT_COUNT, count)
    put_mark(store, KEPT_RUNG, store.mark[RUNG])
    put_measure(store, KEPT_COST, cost)
    put_measure(store, KEPT_MARGIN, task.margin)


def cusps_of(store: PlanStore) -> int:
    """Return how often the path in hand changes its direction."""
    found = 0
    for piece in range(1, store.mark[PIECE_COUNT]):
        if store.piece_way[piece] * store.piece_way[piece - 1] < 0.0:
            found += 1
    return found


def _next_rung(store: PlanStore, request: Request) -> None:
    """Go on to the next search, or end."""
    rung = store.mark[RUNG] + 1
    kept = store.mark[KEPT_COUNT] > 0
    last = rung >= len(LADDER)
    if kept and (last or not LADDER[rung].also):
        put_mark(store, SEEN, 0)
        tries = begin_transitions(store, request, PATH)
        put_mark(store, PHASE, TURN if tries else SEE)
    elif last:
        _over(store, NO_WAY)
    else:
        put_mark(store, RUNG, rung)
        put_mark(store, PHASE, PLANT)
