"""The work arrays of a search and functions that write to them: nodes, their table and queue, words, the path."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from controller_fmu.parking.geometry.polygons import LOCAL_VERTICES, MAP_VERTICES
from controller_fmu.parking.planning.problem import Successor
from modelkit.store import Column, Floats, Ints
from modelkit.vocabulary import Pose

MAX_EDGES = 512
MAX_VERTICES = LOCAL_VERTICES + MAP_VERTICES
EDGE_CELLS = 64
EDGE_ITEMS = 32768
COST_TO_GO_CELLS = 128
MAX_NODES = 20_000
HASH_SIZE = 32768
"""Of the hash table, a power of two."""
BUCKET_COUNT = 2048
CROWDING_CELLS = 8192
MAX_WORDS = 64
WORD_SEGMENTS = 3
WORK_SEGMENTS = 256
REQUEST_SIZE = 13
MAX_CUSPS = REQUEST_SIZE - 1
"""Place of that number among those of the request."""
NO_INDEX = -1


class PlanningWork(NamedTuple):
    """A memo of request and step count: edges with their grids, tree with table and queue, words tried, path found."""

    edge_x1: Annotated[Floats, Column("d", MAX_EDGES, "m", "x of an edge's first end")]
    edge_y1: Annotated[Floats, Column("d", MAX_EDGES, "m", "y of an edge's first end")]
    edge_x2: Annotated[Floats, Column("d", MAX_EDGES, "m", "x of an edge's second end")]
    edge_y2: Annotated[Floats, Column("d", MAX_EDGES, "m", "y of an edge's second end")]
    cell_start: Annotated[Ints, Column("i", EDGE_CELLS * EDGE_CELLS + 1, "1", "where a cell's list of edges begins")]
    cell_edge: Annotated[Ints, Column("h", EDGE_ITEMS, "1", "edges by cell")]
    cost_to_go: Annotated[Floats, Column("f", COST_TO_GO_CELLS * COST_TO_GO_CELLS, "m", "distance to the target")]
    cost_to_go_next: Annotated[Ints, Column("i", COST_TO_GO_CELLS * COST_TO_GO_CELLS, "1", "next cell of its bucket")]
    bucket: Annotated[Ints, Column("i", BUCKET_COUNT, "1", "first node, or cell, of a bucket of the queue")]
    slot: Annotated[Ints, Column("i", HASH_SIZE, "1", "first node of a slot of the hash table")]
    node_x: Annotated[Floats, Column("f", MAX_NODES, "m", "x of the rear axle")]
    node_y: Annotated[Floats, Column("f", MAX_NODES, "m", "y of the rear axle")]
    node_heading: Annotated[Floats, Column("f", MAX_NODES, "rad", "heading")]
    node_cost: Annotated[Floats, Column("f", MAX_NODES, "m", "cost from the root")]
    node_cost_estimate: Annotated[Floats, Column("f", MAX_NODES, "m", "estimated cost from it to the target")]
    node_length: Annotated[Floats, Column("f", MAX_NODES, "m", "distance from the parent, reverse negative")]
    node_curvature: Annotated[Floats, Column("f", MAX_NODES, "1/m", "curvature of that segment")]
    node_parent: Annotated[Ints, Column("h", MAX_NODES, "1", "the node before")]
    node_key: Annotated[Ints, Column("i", MAX_NODES, "1", "cell of poses")]
    node_queue: Annotated[Ints, Column("h", MAX_NODES, "1", "next node of the same bucket")]
    node_slot: Annotated[Ints, Column("h", MAX_NODES, "1", "next node of the same slot")]
    node_state: Annotated[Ints, Column("h", MAX_NODES, "1", "0 estimated, 1 evaluated, 2 closed")]
    crowding: Annotated[Ints, Column("h", CROWDING_CELLS, "1", "how often nodes of a region have been taken up")]
    word_cost: Annotated[Floats, Column("d", MAX_WORDS, "m", "cost of a word")]
    word_code: Annotated[Ints, Column("i", MAX_WORDS, "1", "its turns, two bits each")]
    word_distance: Annotated[Floats, Column("d", WORD_SEGMENTS * MAX_WORDS, "m", "distances of its segments")]
    segment_length: Annotated[Floats, Column("d", WORK_SEGMENTS, "m", "distance of a segment of the path")]
    segment_curvature: Annotated[Floats, Column("d", WORK_SEGMENTS, "1/m", "its curvature")]
    segment_x: Annotated[Floats, Column("d", WORK_SEGMENTS, "m", "x where it begins")]
    segment_y: Annotated[Floats, Column("d", WORK_SEGMENTS, "m", "y where it begins")]
    segment_heading: Annotated[Floats, Column("d", WORK_SEGMENTS, "rad", "heading where it begins")]
    best_length: Annotated[Floats, Column("d", WORK_SEGMENTS, "m", "distance of a segment of the best path yet")]
    best_curvature: Annotated[Floats, Column("d", WORK_SEGMENTS, "1/m", "its curvature")]
    corner_x: Annotated[Floats, Column("d", MAX_VERTICES, "m", "x of a corner of the requested scene")]
    corner_y: Annotated[Floats, Column("d", MAX_VERTICES, "m", "its y")]
    corner_of: Annotated[Ints, Column("i", MAX_VERTICES, "1", "its polygon")]
    requested: Annotated[Floats, Column("d", REQUEST_SIZE, "1", "the numbers of the request")]
    counts: Annotated[Ints, Column("i", 32, "1", "counts and places, see below")]
    values: Annotated[Floats, Column("d", 32, "1", "numbers, see below")]


TREE_COUNTS = 12
"""So many are of one search."""


class PlanCount(IntEnum):
    """Places of the counts."""

    NODE_COUNT = 0
    LOWEST_BUCKET = 1
    """Bucket of the queue below which all are empty."""
    EXPANSIONS = 2
    BEST_NODE = 3
    BEST_CODE = 4
    FIRST_FOUND_AT = 5
    """Expansions until the first path was found."""
    SEGMENT_COUNT = 6
    SPAN = 7
    SPAN_START = 8
    HAS_GAINED = 9
    PASS_COUNT = 10
    EVALUATIONS = 11
    COUNT = 19
    """Steps done for the request."""
    PHASE = 12
    STAGE = 13
    STATUS = 14
    EDGE_COUNT = 15
    BEST_SEGMENT_COUNT = 16
    GOAL_TIGHTER = 18
    VERTEX_COUNT = 20
    """Vertices of the obstacle map in use."""


class PlanValue(IntEnum):
    """Places of the numbers."""

    BEST_COST = 0
    BEST_LENGTHS = 1
    """And two more: the lengths of the word that leads from the best node to the target."""
    FREE_AT_TARGET = 6
    """And five more: how far the car can drive from the target, by gear and turn."""
    FREE_AT_NODE = 12
    """And nine more: the same at the node in hand, by gear and five turns."""
    MIN_END_CLEARANCE = 22
    """Clearance [m] at start or goal, whichever has less."""
    BEST_PATH_COST = 23
    BEST_PATH_MARGIN = 24
    WORD_LIMIT = 25
    """Words that cost as much [m] are no use."""


def word_length(work: PlanningWork, word: int, segment: int) -> float:
    """Return the length [m] of a word's segment (0 to 2), reverse negative; 0: there is none."""
    return work.word_distance[WORD_SEGMENTS * word + segment]


def discard_word(work: PlanningWork, word: int) -> None:
    """Exclude a word from the choice of the cheapest."""
    work.word_cost[word] = 1e9


def set_segment(work: PlanningWork, segment: int, pose: Pose, distance: float, k: float) -> None:
    """Set a segment that begins at ``pose``: ``distance`` [m], reverse negative, and curvature ``k`` [1/m]."""
    work.segment_length[segment] = distance
    work.segment_curvature[segment] = k
    work.segment_x[segment] = pose.x
    work.segment_y[segment] = pose.y
    work.segment_heading[segment] = pose.heading


def pose_at(work: PlanningWork, segment: int) -> Pose:
    """Return where a segment of the path begins."""
    return Pose(work.segment_x[segment], work.segment_y[segment], work.segment_heading[segment])


def move_segments(work: PlanningWork, start: int, count: int, by: int) -> None:
    """Move ``count`` segments of the path from ``start`` on by some places."""
    for number in range(count):
        segment = start + (number if by < 0 else count - 1 - number)
        distance = work.segment_length[segment]
        set_segment(work, segment + by, pose_at(work, segment), distance, work.segment_curvature[segment])


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
