"""The search: a tree of poses from the root, grown where it promises most, joined to the target by a word."""

import math

from controller_fmu.planning.clearance import clearance, sweep
from controller_fmu.planning.joining import LONGEST, cheapest, join
from controller_fmu.planning.plan_store import (
    BEST_NODE,
    BUCKETS,
    EXPANDED,
    FOUND_AT,
    FREE_AT_NODE,
    FREE_AT_TARGET,
    LOOKED,
    LOWEST,
    NODE_COUNT,
    NODES,
    NONE,
    SLOTS,
    TALLIES,
    WORD_COUNT,
    WORDS_NODE,
    PlanStore,
    put_mark,
    put_measure,
)
from controller_fmu.planning.rasters import route_left
from controller_fmu.planning.task import CUSP, STEER, Child, Task, drive
from controller_fmu.planning.tree_store import (
    clear_tree,
    count_up,
    dequeue,
    enqueue,
    put_node,
    put_rest,
    put_state,
)
from controller_fmu.planning.words import list_words
from modelkit.maths import PI, TWO_PI, sign, wrap_angle
from modelkit.vocabulary import Pose

SEARCHING = 0
FOUND = 1
NOTHING = 2

GUESSED = 0
KNOWN = 1
DONE = 2

FIRST_CHILD = 0.35
NEXT_CHILD = 2.3
PER_METRE = 4.0
"""Buckets of the queue for each metre of cost."""
SHORTEST = 0.02
MOST_CHILDREN = 70
AT_ONCE = 32
"""Nodes looked at in one step at the most."""
LOOKS = 20
"""A search also gives up after so many times as many nodes looked at as it may take up."""
FINE = 2.5
"""Within this distance [m] of the root the cells are finer."""
REGION = 1.5
"""Side [m] of a region, in which nodes make each other less wanted."""


def begin_tree(store: PlanStore, task: Task) -> None:
    """Plant the root, and measure how far the car can drive from the target."""
    clear_tree(store)
    put_mark(store, WORDS_NODE, NONE)
    gap = clearance(store, task.target, task) - task.margin
    for gear in range(2):
        for turn in range(3):
            k = (turn - 1) * task.car.curvature
            longest = 60.0 if turn == 1 else TWO_PI / abs(k)
            free = sweep(store, task.target, gap, (2.0 * gear - 1.0) * longest, k, task)
            put_measure(store, FREE_AT_TARGET + 3 * gear + turn, free.way)
    offer(store, Child(task.root, 0.0, 0.0, 0.0, NONE), task)


def grow(store: PlanStore, task: Task) -> int:
    """Take up the node that promises most; returns the status.

    A node's place in the queue is a first guess, made better when its turn comes: then it may have to wait again.
    """
    for _ in range(AT_ONCE):
        node = dequeue(store)
        while node != NONE and store.node_state[node] == DONE:
            node = dequeue(store)
        put_mark(store, LOOKED, store.mark[LOOKED] + 1)
        if node == NONE or is_spent(store, task):
            return NOTHING if store.mark[BEST_NODE] == NONE else FOUND
        waits = look_at(store, node, task)
        if not waits:
            take_up(store, node, task)
            return FOUND if is_settled(store) else SEARCHING
    return SEARCHING


def is_spent(store: PlanStore, task: Task) -> bool:
    """Return whether the search has done all the work it may."""
    most = task.rung.most
    full = store.mark[NODE_COUNT] > NODES - MOST_CHILDREN
    return full or store.mark[EXPANDED] >= most or store.mark[LOOKED] >= LOOKS * most


def is_settled(store: PlanStore) -> bool:
    """Return whether a way is found and some more have been looked for."""
    found_at = store.mark[FOUND_AT]
    return store.mark[BEST_NODE] != NONE and store.mark[EXPANDED] > found_at + found_at // 2 + 20


def look_at(store: PlanStore, node: int, task: Task) -> bool:
    """Work out what a way through a node will cost; returns whether it has to wait, put back into the queue."""
    pose = pose_of(store, node)
    if store.node_state[node] == GUESSED:
        words = words_of(store, node, task)
        shortest = store.word_cost[cheapest(store, words)]
        route = route_left(store, pose.x, pose.y, task.window)
        put_rest(store, node, shortest if shortest > route else route)
        put_state(store, node, KNOWN)
    crowd = task.rung.shy * store.tally[region_of(pose, task)]
    bucket = bucket_of(store.node_cost[node] + task.rung.weight * store.node_rest[node] + crowd)
    if bucket <= store.mark[LOWEST] + 1:
        return False
    enqueue(store, node, bucket)
    return True


def take_up(store: PlanStore, node: int, task: Task) -> None:
    """Join a node to the target if that can be, and let it branch."""
    pose = pose_of(store, node)
    gear = gear_of(store, node)
    lock = lock_of(store, node, task)
    none_yet = store.mark[BEST_NODE] == NONE
    count_up(store, region_of(pose, task))
    put_state(store, node, DONE)
    put_mark(store, EXPANDED, store.mark[EXPANDED] + 1)
    look_around(store, pose, task)
    words = words_of(store, node, task)
    join(store, node, pose, words, task)
    branch(store, node, pose, gear, lock, task)
    if none_yet and store.mark[BEST_NODE] != NONE:
        put_mark(store, FOUND_AT, store.mark[EXPANDED])


def words_of(store: PlanStore, node: int, task: Task) -> int:
    """List the words from a node to the target, unless it is they that are listed; returns how many."""
    if store.mark[WORDS_NODE] != node:
        gear = gear_of(store, node)
        words = list_words(store, pose_of(store, node), task.target, gear, lock_of(store, node, task), task)
        put_mark(store, WORDS_NODE, node)
        put_mark(store, WORD_COUNT, words)
    return store.mark[WORD_COUNT]


def pose_of(store: PlanStore, node: int) -> Pose:
    """Return the pose of a node."""
    return Pose(store.node_x[node], store.node_y[node], store.node_h[node])


def gear_of(store: PlanStore, node: int) -> float:
    """Return 1.0 or -1.0: the direction in which a node was reached; 0.0 for the root."""
    return sign(store.node_way[node])


def lock_of(store: PlanStore, node: int, task: Task) -> float:
    """Return the curvature with which a node was reached, over the largest."""
    return store.node_k[node] / task.car.curvature


def bucket_of(cost: float) -> int:
    """Return the bucket of the queue for a cost [m]."""
    bucket = math.floor(cost * PER_METRE)
    return bucket if bucket < BUCKETS else BUCKETS - 1


def region_of(pose: Pose, task: Task) -> int:
    """Return the number of the region of poses that ``pose`` lies in."""
    across = math.floor((pose.x - task.window.x0) / REGION)
    along = math.floor((pose.y - task.window.y0) / REGION)
    turns = math.floor((wrap_angle(pose.heading) + PI) * 8.0 / PI)
    return (((along * 256 + across) * 17 + turns) * 40503 // 16) % TALLIES


def guess(store: PlanStore, pose: Pose, cost: float, task: Task) -> float:
    """Return what a way through ``pose`` will cost at the least, as far as can be said quickly."""
    route = route_left(store, pose.x, pose.y, task.window)
    turn = abs(wrap_angle(task.target.heading - pose.heading)) / task.car.curvature
    return cost + task.rung.weight * (route if route > turn else turn)


def look_around(store: PlanStore, pose: Pose, task: Task) -> None:
    """Measure how far the car can drive from a node, in both gears at five curvatures."""
    gap = clearance(store, pose, task) - task.margin
    for gear in range(2):
        for turn in range(5):
            k = 0.5 * (turn - 2) * task.car.curvature
            free = sweep(store, pose, gap, (2.0 * gear - 1.0) * LONGEST, k, task)
            put_measure(store, FREE_AT_NODE + 5 * gear + turn, free.way)


def branch(store: PlanStore, node: int, pose: Pose, gear: float, lock: float, task: Task) -> None:
    """Add the children of a node: at growing ways along each arc, and where it is blocked."""
    for number in range(10):
        direction = 2.0 * (number // 5) - 1.0
        turn = 0.5 * (number % 5 - 2)
        free = store.measure[FREE_AT_NODE + number]
        same = abs(turn - lock) < 1e-3
        longest = abs(store.node_way[node]) >= LONGEST - 0.01
        if not same or gear == 0.0 or (longest and direction == gear):
            cost = store.node_cost[node] + abs(turn - lock) * STEER
            if direction * gear < 0.0:
                cost += CUSP
            k = turn * task.car.curvature
            here = Child(pose, cost, 0.0, k, node)
            way = FIRST_CHILD
            while way < free - SHORTEST:
                offer(store, _driven(here, direction, way), task)
                way = way * NEXT_CHILD
            if SHORTEST < free < 1.0:
                for part in range(1, 4):
                    way = 0.25 * part * free
                    offer(store, _driven(here, direction, way), task)
            if free > SHORTEST:
                offer(store, _driven(here, direction, free), task)


def _driven(here: Child, direction: float, way: float) -> Child:
    """Return the child ``way`` [m] further on."""
    return Child(drive(here.pose, direction * way, here.k), here.cost + way, direction * way, here.k, here.parent)


def offer(store: PlanStore, child: Child, task: Task) -> None:
    """Add a node unless its cell has one that is as cheap."""
    key = key_of(child.pose, child.way, task)
    slot = (key * 40503 // 64) % SLOTS
    other = store.slot[slot]
    while other != NONE:
        if store.node_key[other] == key and store.node_cost[other] <= child.cost + 0.02:
            return
        if store.node_key[other] == key:
            put_state(store, other, DONE)
        other = store.node_slot[other]
    node = put_node(store, child, key, slot)
    enqueue(store, node, bucket_of(guess(store, child.pose, child.cost, task)))


def key_of(pose: Pose, way: float, task: Task) -> int:
    """Return the number of the cell of poses, by the gear that it was reached in."""
    dx = pose.x - task.root.x
    dy = pose.y - task.root.y
    fine = task.rung.finer if dx * dx + dy * dy < FINE * FINE else 1.0
    across = math.floor((pose.x - task.window.x0) * fine / task.rung.cell)
    along = math.floor((pose.y - task.window.y0) * fine / task.rung.cell)
    turns = math.floor((wrap_angle(pose.heading) + PI) * fine / task.rung.turn_cell)
    key = (along * 16384 + across) * 4096 + turns
    return (2 * key + (1 if way > 0.0 else 0)) % 2147483647
