"""Hybrid A*: a tree of poses from the root, expanded at the least estimated cost, joined to the target by a word."""

import math

from controller_fmu.parking.geometry.outline import outline_frame, pose_along_arc
from controller_fmu.parking.planning.analytic_expansion import MAX_LENGTH, try_analytic_expansion
from controller_fmu.parking.planning.collision import clearance, sweep_arc
from controller_fmu.parking.planning.grids import UNREACHABLE_COST, holonomic_cost_to_go
from controller_fmu.parking.planning.problem import CUSP_COST, STEERING_COST, SearchProblem, Successor
from controller_fmu.parking.planning.reeds_shepp import WordRequest, least_word_cost, list_words
from controller_fmu.parking.planning.work import (
    BUCKET_COUNT,
    CROWDING_CELLS,
    HASH_SIZE,
    MAX_NODES,
    NO_INDEX,
    PlanCount,
    PlanningWork,
    PlanValue,
    add_node,
    clear_tree,
    pop_lowest,
    push_bucket,
)
from modelkit.maths import PI, TWO_PI, sign, wrap_angle
from modelkit.vocabulary import Pose

SEARCH_ACTIVE = 0
PATH_FOUND = 1
NO_PATH_FOUND = 2

COST_ESTIMATED = 0
COST_EVALUATED = 1
NODE_CLOSED = 2

FIRST_SUCCESSOR = 0.35
"""Length [m] of the shortest successor of a node."""
SUCCESSOR_RATIO = 2.3
"""Length of each longer successor over that of the one before."""
BUCKETS_PER_METRE = 4.0
"""Buckets of the queue for each metre of cost."""
MAX_CROWDING = 30000
"""Nodes counted in a region: what the column holds."""
MIN_LENGTH = 0.02
MAX_SUCCESSORS = 70
MAX_EVALUATIONS_PER_STEP = 32
"""Nodes evaluated in one step at most."""
EVALUATIONS_PER_EXPANSION = 20
"""A search also gives up after this many evaluations for each node that it may expand."""
REFINED_RADIUS = 2.5
"""Within this distance [m] of the root the cells are finer."""
CROWDING_CELL = 1.5
"""Side [m] of a region, in which each further node costs more (``crowding_cost``)."""


def begin_search(work: PlanningWork, problem: SearchProblem) -> None:
    """Insert the root into an empty tree, and measure how far the car can drive from the target."""
    clear_tree(work)
    gap = clearance(work, outline_frame(problem.target), problem) - problem.margin
    for gear in range(2):
        for turn in range(3):
            k = (turn - 1) * problem.car.max_curvature
            distance = (2.0 * gear - 1.0) * (60.0 if turn == 1 else TWO_PI / abs(k))
            driven = sweep_arc(work, problem.target, gap, distance, k, problem)
            work.values[PlanValue.FREE_AT_TARGET + 3 * gear + turn] = driven.distance
    push_open(work, Successor(problem.root, 0.0, 0.0, 0.0, NO_INDEX), problem)


def expand_next(work: PlanningWork, problem: SearchProblem) -> int:
    """Expand the node of least estimated cost; returns ``SEARCH_ACTIVE``, ``PATH_FOUND`` or ``NO_PATH_FOUND``.

    The estimate that orders the queue is a quick one; it is refined when a node is popped, which may push it back.
    """
    for _ in range(MAX_EVALUATIONS_PER_STEP):
        node = pop_lowest(work)
        while node != NO_INDEX and work.node_state[node] == NODE_CLOSED:
            node = pop_lowest(work)
        work.counts[PlanCount.EVALUATIONS] = work.counts[PlanCount.EVALUATIONS] + 1
        if node == NO_INDEX or is_spent(work, problem):
            return NO_PATH_FOUND if work.counts[PlanCount.BEST_NODE] == NO_INDEX else PATH_FOUND
        waits = evaluate(work, node, problem)
        if not waits:
            expand(work, node, problem)
            return PATH_FOUND if is_settled(work) else SEARCH_ACTIVE
    return SEARCH_ACTIVE


def is_spent(work: PlanningWork, problem: SearchProblem) -> bool:
    """Return whether the search has done all the work it may."""
    most = problem.stage.max_expansions
    is_full = work.counts[PlanCount.NODE_COUNT] > MAX_NODES - MAX_SUCCESSORS
    is_expanded = work.counts[PlanCount.EXPANSIONS] >= most
    return is_full or is_expanded or work.counts[PlanCount.EVALUATIONS] >= EVALUATIONS_PER_EXPANSION * most


def is_settled(work: PlanningWork) -> bool:
    """Return whether a path is found and the expansions since then have been enough to find a cheaper one."""
    found_at = work.counts[PlanCount.FIRST_FOUND_AT]
    is_found = work.counts[PlanCount.BEST_NODE] != NO_INDEX
    return is_found and work.counts[PlanCount.EXPANSIONS] > found_at + found_at // 2 + 20


def evaluate(work: PlanningWork, node: int, problem: SearchProblem) -> bool:
    """Refine the estimated cost of a path through a node; returns whether the node is closed or back in the queue."""
    pose = pose_of(work, node)
    if work.node_state[node] == COST_ESTIMATED:
        estimate = _cost_to_target(work, node, pose, problem)
        work.node_cost_estimate[node] = estimate
        work.node_state[node] = COST_EVALUATED
    if work.node_cost[node] + work.node_cost_estimate[node] >= bound_cost(work):
        work.node_state[node] = NODE_CLOSED
        return True
    crowd = problem.stage.resolution.crowding_cost * work.crowding[region_of(pose, problem)]
    weight = problem.stage.resolution.heuristic_weight
    bucket = bucket_of(work.node_cost[node] + weight * work.node_cost_estimate[node] + crowd)
    if bucket <= work.counts[PlanCount.LOWEST_BUCKET] + 1:
        return False
    push_bucket(work, node, bucket)
    return True


def _cost_to_target(work: PlanningWork, node: int, pose: Pose, problem: SearchProblem) -> float:
    """Return what a distance from a node to the target costs at least [m]; less if it is no use even so."""
    cost_to_go = holonomic_cost_to_go(work, pose.x, pose.y, problem.region)
    # more than what is of use, since costs of nodes are rounded to single precision
    limit = bound_cost(work) - work.node_cost[node] + MIN_LENGTH
    if cost_to_go >= limit:
        return cost_to_go
    request = WordRequest(gear_of(work, node), lock_of(work, node, problem), limit)
    shortest = least_word_cost(work, pose, problem.target, request, problem)
    return max(shortest, cost_to_go)


def bound_cost(work: PlanningWork) -> float:
    """Return the cost [m] of the best path found, by this search or one before it; nodes that cost more are no use."""
    known = work.values[PlanValue.BEST_PATH_COST] if work.counts[PlanCount.BEST_SEGMENT_COUNT] > 0 else UNREACHABLE_COST
    return min(known, best_cost(work))


def best_cost(work: PlanningWork) -> float:
    """Return the cost [m] of the best path that this search has found."""
    return work.values[PlanValue.BEST_COST] if work.counts[PlanCount.BEST_NODE] != NO_INDEX else UNREACHABLE_COST


def expand(work: PlanningWork, node: int, problem: SearchProblem) -> None:
    """Try to join a node to the target by a word, and add its successors."""
    pose = pose_of(work, node)
    gear = gear_of(work, node)
    lock = lock_of(work, node, problem)
    none_yet = work.counts[PlanCount.BEST_NODE] == NO_INDEX
    region = region_of(pose, problem)
    if work.crowding[region] < MAX_CROWDING:
        work.crowding[region] += 1
    work.node_state[node] = NODE_CLOSED
    work.counts[PlanCount.EXPANSIONS] = work.counts[PlanCount.EXPANSIONS] + 1
    measure_free_distances(work, pose, problem)
    request = WordRequest(gear, lock, best_cost(work) - work.node_cost[node])
    words = list_words(work, pose, problem.target, request, problem)
    try_analytic_expansion(work, node, pose, words, problem)
    generate_successors(work, node, pose, gear, lock, problem)
    if none_yet and work.counts[PlanCount.BEST_NODE] != NO_INDEX:
        work.counts[PlanCount.FIRST_FOUND_AT] = work.counts[PlanCount.EXPANSIONS]


def pose_of(work: PlanningWork, node: int) -> Pose:
    """Return the pose of a node."""
    return Pose(work.node_x[node], work.node_y[node], work.node_heading[node])


def gear_of(work: PlanningWork, node: int) -> float:
    """Return 1.0 or -1.0: the direction in which a node was reached; 0.0 for the root."""
    return sign(work.node_length[node])


def lock_of(work: PlanningWork, node: int, problem: SearchProblem) -> float:
    """Return the curvature with which a node was reached, over the largest: -1.0 to 1.0."""
    return work.node_curvature[node] / problem.car.max_curvature


def bucket_of(cost: float) -> int:
    """Return the bucket of the queue for a cost [m]."""
    return min(math.floor(cost * BUCKETS_PER_METRE), BUCKET_COUNT - 1)


def region_of(pose: Pose, problem: SearchProblem) -> int:
    """Return the number of the region of poses that ``pose`` lies in."""
    across = math.floor((pose.x - problem.region.x0) / CROWDING_CELL)
    along = math.floor((pose.y - problem.region.y0) / CROWDING_CELL)
    turns = math.floor((wrap_angle(pose.heading) + PI) * 8.0 / PI)
    return (((along * 256 + across) * 17 + turns) * 40503 // 16) % CROWDING_CELLS


def measure_free_distances(work: PlanningWork, pose: Pose, problem: SearchProblem) -> None:
    """Measure how far the car can drive from a node, in both gears at five curvatures."""
    gap = clearance(work, outline_frame(pose), problem) - problem.margin
    for gear in range(2):
        for turn in range(5):
            k = 0.5 * (turn - 2) * problem.car.max_curvature
            driven = sweep_arc(work, pose, gap, (2.0 * gear - 1.0) * MAX_LENGTH, k, problem)
            work.values[PlanValue.FREE_AT_NODE + 5 * gear + turn] = driven.distance


def generate_successors(
    work: PlanningWork, node: int, pose: Pose, gear: float, lock: float, problem: SearchProblem
) -> None:
    """Add a node's children along each arc; it was reached in ``gear`` (1.0, -1.0) with ``lock`` (-1.0 to 1.0)."""
    for number in range(10):
        direction = 2.0 * (number // 5) - 1.0
        turn = 0.5 * (number % 5 - 2)
        free = work.values[PlanValue.FREE_AT_NODE + number]
        same = abs(turn - lock) < 1e-3
        longest = abs(work.node_length[node]) >= MAX_LENGTH - 0.01
        if not same or gear == 0.0 or (longest and direction == gear):
            cost = work.node_cost[node] + abs(turn - lock) * STEERING_COST
            if direction * gear < 0.0:
                cost += CUSP_COST
            k = turn * problem.car.max_curvature
            here = Successor(pose, cost, 0.0, k, node)
            distance = FIRST_SUCCESSOR
            while distance < free - MIN_LENGTH:
                _push_driven(work, here, direction * distance, problem)
                distance = distance * SUCCESSOR_RATIO
            if MIN_LENGTH < free < 1.0:
                for part in range(1, 4):
                    _push_driven(work, here, direction * (0.25 * part * free), problem)
            if free > MIN_LENGTH:
                _push_driven(work, here, direction * free, problem)


def _push_driven(work: PlanningWork, here: Successor, distance: float, problem: SearchProblem) -> None:
    """Add the child ``distance`` [m] further on, reverse negative."""
    pose = pose_along_arc(here.pose, distance, here.curvature)
    push_open(work, Successor(pose, here.cost + abs(distance), distance, here.curvature, here.parent), problem)


def push_open(work: PlanningWork, successor: Successor, problem: SearchProblem) -> None:
    """Add a node unless its cell has one that is as cheap; a quick estimate of the cost to go orders the queue."""
    pose = successor.pose
    key = key_of(pose, successor.distance, problem)
    slot = (key * 40503 // 64) % HASH_SIZE
    other = work.slot[slot]
    while other != NO_INDEX:
        if work.node_key[other] == key and work.node_cost[other] <= successor.cost + 0.02:
            return
        if work.node_key[other] == key:
            work.node_state[other] = NODE_CLOSED
        other = work.node_slot[other]
    node = add_node(work, successor, key, slot)
    cost_to_go = holonomic_cost_to_go(work, pose.x, pose.y, problem.region)
    turn = abs(wrap_angle(problem.target.heading - pose.heading)) / problem.car.max_curvature
    weight = problem.stage.resolution.heuristic_weight
    push_bucket(work, node, bucket_of(successor.cost + weight * (cost_to_go if cost_to_go > turn else turn)))


def key_of(pose: Pose, distance: float, problem: SearchProblem) -> int:
    """Return the number of the cell of ``pose``, by the gear it was reached in: the sign of ``distance`` [m]."""
    dx = pose.x - problem.root.x
    dy = pose.y - problem.root.y
    fine = problem.stage.resolution.refinement if dx * dx + dy * dy < REFINED_RADIUS * REFINED_RADIUS else 1.0
    across = math.floor((pose.x - problem.region.x0) * fine / problem.stage.resolution.cell)
    along = math.floor((pose.y - problem.region.y0) * fine / problem.stage.resolution.cell)
    turns = math.floor((wrap_angle(pose.heading) + PI) * fine / problem.stage.resolution.heading_cell)
    key = (along * 16384 + across) * 4096 + turns
    return (2 * key + (1 if distance > 0.0 else 0)) % 2147483647
