"""The search tree in its work arrays: nodes, the table that finds them by pose, the queue."""

from controller_fmu.parking.planning.problem import Successor
from controller_fmu.parking.planning.work import (
    BUCKET_COUNT,
    CROWDING_CELLS,
    HASH_SIZE,
    NO_INDEX,
    TREE_COUNTS,
    WORD_SEGMENTS,
    PlanCount,
    PlanningWork,
    PlanValue,
    word_length,
)


def clear_tree(work: PlanningWork) -> None:
    """Empty tree, table and queue."""
    for slot in range(HASH_SIZE):
        work.slot[slot] = NO_INDEX
    for bucket in range(BUCKET_COUNT):
        work.bucket[bucket] = NO_INDEX
    for region in range(CROWDING_CELLS):
        work.crowding[region] = 0
    for which in range(TREE_COUNTS):
        work.counts[which] = 0
    work.counts[PlanCount.LOWEST_BUCKET] = BUCKET_COUNT
    work.counts[PlanCount.BEST_NODE] = NO_INDEX


def add_node(work: PlanningWork, successor: Successor, key: int, slot: int) -> int:
    """Add a node to the tree and to its slot of the table; returns its number."""
    node = work.counts[PlanCount.NODE_COUNT]
    work.counts[PlanCount.NODE_COUNT] = node + 1
    work.node_x[node] = successor.pose.x
    work.node_y[node] = successor.pose.y
    work.node_heading[node] = successor.pose.heading
    work.node_cost[node] = successor.cost
    work.node_length[node] = successor.distance
    work.node_curvature[node] = successor.curvature
    work.node_parent[node] = successor.parent
    work.node_key[node] = key
    work.node_state[node] = 0
    work.node_cost_estimate[node] = 0.0
    work.node_slot[node] = work.slot[slot]
    work.slot[slot] = node
    return node


def push_bucket(work: PlanningWork, node: int, bucket: int) -> None:
    """Put a node first into a bucket."""
    work.node_queue[node] = work.bucket[bucket]
    work.bucket[bucket] = node
    if bucket < work.counts[PlanCount.LOWEST_BUCKET]:
        work.counts[PlanCount.LOWEST_BUCKET] = bucket


def pop_lowest(work: PlanningWork) -> int:
    """Take the first node out of the lowest bucket that has any; returns it, or ``NO_INDEX``."""
    bucket = work.counts[PlanCount.LOWEST_BUCKET]
    while bucket < BUCKET_COUNT and work.bucket[bucket] == NO_INDEX:
        bucket += 1
    work.counts[PlanCount.LOWEST_BUCKET] = bucket
    if bucket >= BUCKET_COUNT:
        return NO_INDEX
    node = work.bucket[bucket]
    work.bucket[bucket] = work.node_queue[node]
    return node


def set_best(work: PlanningWork, node: int, word: int, cost: float) -> None:
    """Remember the best path to the target, of ``cost`` [m]: along the tree to ``node``, then along ``word``."""
    work.counts[PlanCount.BEST_NODE] = node
    work.counts[PlanCount.BEST_CODE] = work.word_code[word]
    work.values[PlanValue.BEST_COST] = cost
    for segment in range(WORD_SEGMENTS):
        work.values[PlanValue.BEST_LENGTHS + segment] = word_length(work, word, segment)
