"""The work arrays of a search, and functions that write to them; those of the tree are written in ``tree_store.py``."""

from typing import Annotated, NamedTuple

from controller_fmu.planning.task import CORNERS
from modelkit.geometry import Point
from modelkit.store import Column, Floats, Ints
from modelkit.vocabulary import Pose

EDGES = 512
NEAR_SIDE = 64
NEAR_ITEMS = 32768
ROUTE_SIDE = 128
NODES = 20_000
SLOTS = 32768
"""Of the hash table, a power of two."""
BUCKETS = 2048
TALLIES = 8192
WORDS = 128
PIECES = 256
ASKED = 17
HEARD = 128
"""Places kept of what one side's sensor has heard."""
SIDES = 2
"""Right and left, as the car drives past."""
EARS = 6
"""Besides, corner and side sensor, right and left, at the end that leads into a slot."""
RAYS = 256
"""Echoes kept of one side: what they say is free."""
NONE = -1


class PlanStore(NamedTuple):
    """Edges with their rasters, the tree with its table and queue, the words tried, the path found.

    All of these are a memo. What was heard (``heard_*``, ``around_*``) is not: it is remembered here, and nowhere else.
    """

    edge_x1: Annotated[Floats, Column("d", EDGES, "m", "x of an edge's first end")]
    edge_y1: Annotated[Floats, Column("d", EDGES, "m", "y of an edge's first end")]
    edge_x2: Annotated[Floats, Column("d", EDGES, "m", "x of an edge's second end")]
    edge_y2: Annotated[Floats, Column("d", EDGES, "m", "y of an edge's second end")]
    near_first: Annotated[Ints, Column("i", NEAR_SIDE * NEAR_SIDE + 1, "1", "where a cell's list of edges begins")]
    near_edge: Annotated[Ints, Column("h", NEAR_ITEMS, "1", "edges by cell")]
    route: Annotated[Floats, Column("f", ROUTE_SIDE * ROUTE_SIDE, "m", "way of a point to the target")]
    route_next: Annotated[Ints, Column("i", ROUTE_SIDE * ROUTE_SIDE, "1", "next cell of the same bucket")]
    bucket: Annotated[Ints, Column("i", BUCKETS, "1", "first node, or cell, of a bucket of the queue")]
    slot: Annotated[Ints, Column("i", SLOTS, "1", "first node of a slot of the hash table")]
    node_x: Annotated[Floats, Column("f", NODES, "m", "x of the rear axle")]
    node_y: Annotated[Floats, Column("f", NODES, "m", "y of the rear axle")]
    node_h: Annotated[Floats, Column("f", NODES, "rad", "heading")]
    node_cost: Annotated[Floats, Column("f", NODES, "m", "cost from the root")]
    node_rest: Annotated[Floats, Column("f", NODES, "m", "what the way from it to the target is thought to cost")]
    node_way: Annotated[Floats, Column("f", NODES, "m", "way from the parent, reverse negative")]
    node_k: Annotated[Floats, Column("f", NODES, "1/m", "curvature of that way")]
    node_parent: Annotated[Ints, Column("h", NODES, "1", "the node before")]
    node_key: Annotated[Ints, Column("i", NODES, "1", "cell of poses")]
    node_queue: Annotated[Ints, Column("h", NODES, "1", "next node of the same bucket")]
    node_slot: Annotated[Ints, Column("h", NODES, "1", "next node of the same slot")]
    node_state: Annotated[Ints, Column("h", NODES, "1", "0 guessed, 1 looked at, 2 done with")]
    tally: Annotated[Ints, Column("h", TALLIES, "1", "how often nodes of a region have been taken up")]
    word_cost: Annotated[Floats, Column("d", WORDS, "m", "cost of a word")]
    word_code: Annotated[Ints, Column("i", WORDS, "1", "its turns, digits to the base of 3")]
    word_a: Annotated[Floats, Column("d", WORDS, "m", "way of its first piece")]
    word_b: Annotated[Floats, Column("d", WORDS, "m", "way of its second piece")]
    word_c: Annotated[Floats, Column("d", WORDS, "m", "way of its third piece")]
    word_d: Annotated[Floats, Column("d", WORDS, "m", "way of its fourth piece")]
    word_e: Annotated[Floats, Column("d", WORDS, "m", "way of its fifth piece")]
    piece_way: Annotated[Floats, Column("d", PIECES, "m", "way of a piece of the path")]
    piece_k: Annotated[Floats, Column("d", PIECES, "1/m", "its curvature")]
    piece_speed: Annotated[Floats, Column("d", PIECES, "m/s", "its largest speed if its curvature is a transition's")]
    piece_x: Annotated[Floats, Column("d", PIECES, "m", "x where it begins")]
    piece_y: Annotated[Floats, Column("d", PIECES, "m", "y where it begins")]
    piece_h: Annotated[Floats, Column("d", PIECES, "rad", "heading where it begins")]
    kept_way: Annotated[Floats, Column("d", PIECES, "m", "way of a piece of the best path yet")]
    kept_k: Annotated[Floats, Column("d", PIECES, "1/m", "its curvature")]
    kept_speed: Annotated[Floats, Column("d", PIECES, "m/s", "its largest speed: see Piece")]
    joint_share: Annotated[Floats, Column("d", PIECES, "1", "share of the transition wished for about its begin")]
    arc_k: Annotated[Floats, Column("d", PIECES, "1/m", "curvature of a piece between its transitions")]
    kept_room: Annotated[Floats, Column("d", PIECES, "m", "room about its begin: see Piece")]
    corner_x: Annotated[Floats, Column("d", CORNERS, "m", "x of a corner of the scene asked about")]
    corner_y: Annotated[Floats, Column("d", CORNERS, "m", "its y")]
    corner_of: Annotated[Ints, Column("i", CORNERS, "1", "its polygon")]
    asked: Annotated[Floats, Column("d", ASKED, "1", "the numbers of the request")]
    heard_x: Annotated[Floats, Column("d", EARS * HEARD, "m", "x of a place heard, by ear")]
    heard_y: Annotated[Floats, Column("d", EARS * HEARD, "m", "its y")]
    heard_count: Annotated[Ints, Column("i", EARS * HEARD, "1", "echoes from there; 0: unused")]
    heard_joint: Annotated[Ints, Column("i", EARS * HEARD, "1", "1: of the same thing as the place before")]
    ray_x: Annotated[Floats, Column("d", SIDES * RAYS, "m", "x of a sensor that has listened, right side then left")]
    ray_y: Annotated[Floats, Column("d", SIDES * RAYS, "m", "its y")]
    ray_end_x: Annotated[Floats, Column("d", SIDES * RAYS, "m", "x up to where nothing stands along its axis")]
    ray_end_y: Annotated[Floats, Column("d", SIDES * RAYS, "m", "the same, y")]
    around_x: Annotated[Floats, Column("d", CORNERS, "m", "x of a corner of the map made of what was heard")]
    around_y: Annotated[Floats, Column("d", CORNERS, "m", "its y")]
    around_of: Annotated[Ints, Column("i", CORNERS, "1", "its polygon")]
    mark: Annotated[Ints, Column("i", 32, "1", "counts and places, see below")]
    measure: Annotated[Floats, Column("d", 32, "1", "numbers, see below")]


NODE_COUNT = 0
LOWEST = 1
"""Bucket of the queue below which all are empty."""
EXPANDED = 2
BEST_NODE = 3
BEST_CODE = 4
FOUND_AT = 5
"""Expansions until the first way was found."""
PIECE_COUNT = 6
SPAN = 7
PLACE = 8
GAINED = 9
PASSES = 10
LOOKED = 11
TREE_MARKS = 12
"""So many are of one search."""
COUNT = 19
"""Steps done for the request."""
PHASE = 12
RUNG = 13
STATUS = 14
EDGE_COUNT = 15
KEPT_COUNT = 16
KEPT_RUNG = 17
GOAL_TIGHTER = 18
SEEN = 20
"""Pieces of the path kept about whose begin the room is known."""
JOINT = 21
"""The transition that is tried now."""
SLICES = 22
"""Arcs of a transition on one side of a stop."""
WORDS_NODE = 23
"""The node whose words are listed."""
WORD_COUNT = 24

BEST_COST = 0
BEST_WAY = 1
"""And four more: the ways of the word that leads from the best node to the target."""
FREE_AT_TARGET = 6
"""And five more: how far the car can drive from the target, by gear and turn."""
FREE_AT_NODE = 12
"""And nine more: the same at the node in hand, by gear and five turns."""
ROOM = 22
"""Clearance [m] at start or goal, whichever has less."""
KEPT_COST = 23
KEPT_MARGIN = 24


def put_mark(store: PlanStore, which: int, value: int) -> None:
    """Set one of the counts and places."""
    store.mark[which] = value


def put_measure(store: PlanStore, which: int, value: float) -> None:
    """Set one of the numbers."""
    store.measure[which] = value


def put_edge(store: PlanStore, edge: int, start: Point, end: Point) -> None:
    """Set an edge."""
    store.edge_x1[edge] = start.x
    store.edge_y1[edge] = start.y
    store.edge_x2[edge] = end.x
    store.edge_y2[edge] = end.y


def put_near_first(store: PlanStore, cell: int, place: int) -> None:
    """Set where a cell's list of edges begins."""
    store.near_first[cell] = place


def put_near(store: PlanStore, place: int, edge: int) -> None:
    """Set an item of the lists of edges."""
    store.near_edge[place] = edge


def clear_route(store: PlanStore, cells: int) -> None:
    """Make every cell of the map of ways free and unmeasured."""
    for cell in range(cells):
        store.route[cell] = 1e6
        store.route_next[cell] = -2


def put_route(store: PlanStore, cell: int, way: float) -> None:
    """Set a cell's way to the target."""
    store.route[cell] = way


def put_route_next(store: PlanStore, cell: int, after: int) -> None:
    """Set the cell after this one in its bucket."""
    store.route_next[cell] = after


def put_bucket(store: PlanStore, bucket: int, first: int) -> None:
    """Set the first of a bucket."""
    store.bucket[bucket] = first


def put_word(
    store: PlanStore, word: int, code: int, cost: float, ways: tuple[float, float, float, float, float]
) -> None:
    """Set a word."""
    store.word_code[word] = code
    store.word_cost[word] = cost
    store.word_a[word] = ways[0]
    store.word_b[word] = ways[1]
    store.word_c[word] = ways[2]
    store.word_d[word] = ways[3]
    store.word_e[word] = ways[4]


def drop_word(store: PlanStore, word: int) -> None:
    """Take a word out of the choice."""
    store.word_cost[word] = 1e9


def put_piece(store: PlanStore, piece: int, pose: Pose, way: float, k: float) -> None:
    """Set a piece of the path that begins at ``pose``."""
    store.piece_way[piece] = way
    store.piece_k[piece] = k
    store.piece_x[piece] = pose.x
    store.piece_y[piece] = pose.y
    store.piece_h[piece] = pose.heading


def move_pieces(store: PlanStore, start: int, count: int, by: int) -> None:
    """Move ``count`` pieces of the path from ``start`` on by some places."""
    for number in range(count):
        piece = start + (number if by < 0 else count - 1 - number)
        store.piece_way[piece + by] = store.piece_way[piece]
        store.piece_k[piece + by] = store.piece_k[piece]
        store.piece_x[piece + by] = store.piece_x[piece]
        store.piece_y[piece + by] = store.piece_y[piece]
        store.piece_h[piece + by] = store.piece_h[piece]


def put_corner(store: PlanStore, corner: int, x: float, y: float, polygon: int) -> None:
    """Remember a corner of the scene."""
    store.corner_x[corner] = x
    store.corner_y[corner] = y
    store.corner_of[corner] = polygon


def put_asked(store: PlanStore, which: int, value: float) -> None:
    """Remember a number of the request."""
    store.asked[which] = value


def put_kept(store: PlanStore, piece: int, way: float, k: float) -> None:
    """Set a piece of the best path yet; of its room nothing is known."""
    store.kept_way[piece] = way
    store.kept_k[piece] = k
    store.kept_speed[piece] = 0.0
    put_room(store, piece, 0.0)


def put_kept_speed(store: PlanStore, piece: int, speed: float) -> None:
    """Set the largest speed of a piece of the best path yet."""
    store.kept_speed[piece] = speed


def put_piece_speed(store: PlanStore, piece: int, speed: float) -> None:
    """Set the largest speed of a piece of the path."""
    store.piece_speed[piece] = speed


def put_share(store: PlanStore, joint: int, share: float) -> None:
    """Set the share of the transition about the begin of a piece."""
    store.joint_share[joint] = share


def put_arc_curvature(store: PlanStore, piece: int, k: float) -> None:
    """Set the curvature of a piece between its transitions."""
    store.arc_k[piece] = k


def put_piece_way(store: PlanStore, piece: int, way: float) -> None:
    """Set the way of a piece of the path."""
    store.piece_way[piece] = way


def put_room(store: PlanStore, piece: int, room: float) -> None:
    """Set what room there is where a piece of the best path begins."""
    store.kept_room[piece] = room
