"""The search tree in its work arrays: nodes, the table that finds them by pose, the queue; only these write to them."""

from controller_fmu.planning.plan_store import (
    BEST_CODE,
    BEST_COST,
    BEST_NODE,
    BEST_WAY,
    BUCKETS,
    LOWEST,
    NODE_COUNT,
    NONE,
    SLOTS,
    TALLIES,
    TREE_MARKS,
    PlanStore,
)
from controller_fmu.planning.task import Child


def clear_tree(store: PlanStore) -> None:
    """Empty tree, table and queue."""
    for slot in range(SLOTS):
        store.slot[slot] = NONE
    for bucket in range(BUCKETS):
        store.bucket[bucket] = NONE
    for region in range(TALLIES):
        store.tally[region] = 0
    for which in range(TREE_MARKS):
        store.mark[which] = 0
    store.mark[LOWEST] = BUCKETS
    store.mark[BEST_NODE] = NONE


def put_node(store: PlanStore, child: Child, key: int, slot: int) -> int:
    """Add a node to the tree and to its slot of the table; returns its number."""
    node = store.mark[NODE_COUNT]
    store.mark[NODE_COUNT] = node + 1
    store.node_x[node] = child.pose.x
    store.node_y[node] = child.pose.y
    store.node_h[node] = child.pose.heading
    store.node_cost[node] = child.cost
    store.node_way[node] = child.way
    store.node_k[node] = child.k
    store.node_parent[node] = child.parent
    store.node_key[node] = key
    store.node_state[node] = 0
    store.node_rest[node] = 0.0
    store.node_slot[node] = store.slot[slot]
    store.slot[slot] = node
    return node


def put_rest(store: PlanStore, node: int, rest: float) -> None:
    """Set what the way from a node to the target is thought to cost [m]."""
    store.node_rest[node] = rest


def count_up(store: PlanStore, region: int) -> None:
    """Count a region once more."""
    if store.tally[region] < 30000:
        store.tally[region] += 1


def put_state(store: PlanStore, node: int, state: int) -> None:
    """Set what has been done with a node."""
    store.node_state[node] = state


def enqueue(store: PlanStore, node: int, bucket: int) -> None:
    """Put a node first into a bucket."""
    store.node_queue[node] = store.bucket[bucket]
    store.bucket[bucket] = node
    if bucket < store.mark[LOWEST]:
        store.mark[LOWEST] = bucket


def dequeue(store: PlanStore) -> int:
    """Take the first node out of the lowest bucket that has any; returns it, or ``NONE``."""
    bucket = store.mark[LOWEST]
    while bucket < BUCKETS and store.bucket[bucket] == NONE:
        bucket += 1
    store.mark[LOWEST] = bucket
    if bucket >= BUCKETS:
        return NONE
    node = store.bucket[bucket]
    store.bucket[bucket] = store.node_queue[node]
    return node


def put_best(store: PlanStore, node: int, word: int, cost: float) -> None:
    """Remember the best way to the target: along the tree to ``node``, then along ``word``."""
    store.mark[BEST_NODE] = node
    store.mark[BEST_CODE] = store.word_code[word]
    store.measure[BEST_COST] = cost
    store.measure[BEST_WAY] = store.word_a[word]
    store.measure[BEST_WAY + 1] = store.word_b[word]
    store.measure[BEST_WAY + 2] = store.word_c[word]
    store.measure[BEST_WAY + 3] = store.word_d[word]
    store.measure[BEST_WAY + 4] = store.word_e[word]
