"""The path that a search has found, made shorter: spans of it replaced by cheaper words that are free."""

from controller_fmu.planning.joining import cheapest, is_word_free, word_way
from controller_fmu.planning.plan_store import (
    BEST_CODE,
    BEST_NODE,
    BEST_WAY,
    GAINED,
    NONE,
    PASSES,
    PIECE_COUNT,
    PIECES,
    PLACE,
    SPAN,
    PlanStore,
    drop_word,
    move_pieces,
    put_mark,
    put_piece,
)
from controller_fmu.planning.task import CUSP, STEER, Task, drive
from controller_fmu.planning.words import list_words
from modelkit.maths import sign
from modelkit.vocabulary import Pose

LONGEST_SPAN = 12
MOST_PASSES = 4
TRIES = 4
GAIN = 0.01
"""A word has to be cheaper by so much [m]."""
SAME = 1e-9


def begin_path(store: PlanStore, task: Task) -> None:
    """Copy the way that was found from tree and word to the pieces of the path."""
    put_mark(store, PIECE_COUNT, 0)
    depth = 0
    node = store.mark[BEST_NODE]
    while node != NONE and store.node_parent[node] != NONE:
        depth += 1
        node = store.node_parent[node]
    pose = task.root
    for level in range(depth):
        node = store.mark[BEST_NODE]
        for _ in range(depth - 1 - level):
            node = store.node_parent[node]
        pose = add_piece(store, pose, store.node_way[node], store.node_k[node])
    rest = store.mark[BEST_CODE]
    for number in range(5):
        k = (rest % 3 - 1) * task.car.curvature
        rest = rest // 3
        pose = add_piece(store, pose, store.measure[BEST_WAY + number], k)
    put_mark(store, SPAN, store.mark[PIECE_COUNT])
    put_mark(store, PLACE, 0)
    put_mark(store, GAINED, 0)
    put_mark(store, PASSES, 0)


def add_piece(store: PlanStore, pose: Pose, way: float, k: float) -> Pose:
    """Add a piece to the end of the path, or to its last piece if that goes on alike; returns where it ends."""
    count = store.mark[PIECE_COUNT]
    if way == 0.0 or count >= PIECES:
        return pose
    if count > 0:
        last = store.piece_way[count - 1]
        if last * way > 0.0 and abs(store.piece_k[count - 1] - k) < SAME:
            begin = pose_at(store, count - 1)
            put_piece(store, count - 1, begin, last + way, k)
            return drive(begin, last + way, k)
    put_piece(store, count, pose, way, k)
    put_mark(store, PIECE_COUNT, count + 1)
    return drive(pose, way, k)


def shorten(store: PlanStore, task: Task) -> bool:
    """Try the next span; returns whether there is more to try."""
    count = store.mark[PIECE_COUNT]
    span = store.mark[SPAN]
    place = store.mark[PLACE]
    if place + span > count:
        span = span - 1 if span <= count else count
        place = 0
    if span > LONGEST_SPAN:
        span = LONGEST_SPAN
    if span < 2:
        if store.mark[GAINED] == 0 or store.mark[PASSES] >= MOST_PASSES:
            return False
        put_mark(store, GAINED, 0)
        put_mark(store, PASSES, store.mark[PASSES] + 1)
        put_mark(store, SPAN, count)
        put_mark(store, PLACE, 0)
        return True
    replaced = _replace_span(store, place, span, task)
    put_mark(store, SPAN, span)
    put_mark(store, PLACE, place if replaced else place + 1)
    if replaced:
        put_mark(store, GAINED, 1)
    return True


def pose_at(store: PlanStore, piece: int) -> Pose:
    """Return where a piece of the path begins."""
    return Pose(store.piece_x[piece], store.piece_y[piece], store.piece_h[piece])


def end_of(store: PlanStore, piece: int) -> Pose:
    """Return where a piece of the path ends."""
    return drive(pose_at(store, piece), store.piece_way[piece], store.piece_k[piece])


def join_cost(way: float, k: float, next_way: float, next_k: float, task: Task) -> float:
    """Return the cost [m] of going on from one piece to the next."""
    cost = abs(next_k - k) / task.car.curvature * STEER
    return cost + CUSP if way * next_way < 0.0 else cost


def span_cost(store: PlanStore, place: int, span: int, task: Task) -> float:
    """Return the cost [m] of some pieces of the path with the joints at their ends."""
    count = store.mark[PIECE_COUNT]
    cost = 0.0
    for piece in range(place, place + span):
        cost += abs(store.piece_way[piece])
    for piece in range(place, place + span + 1):
        if piece == 0:
            cost += abs(store.piece_k[piece]) / task.car.curvature * STEER
        elif piece < count:
            before = piece - 1
            cost += join_cost(
                store.piece_way[before], store.piece_k[before], store.piece_way[piece], store.piece_k[piece], task
            )
    return cost


def path_cost(store: PlanStore, task: Task) -> float:
    """Return the cost [m] of the path."""
    return span_cost(store, 0, store.mark[PIECE_COUNT], task)


def _replace_span(store: PlanStore, place: int, span: int, task: Task) -> bool:
    """Replace some pieces by the cheapest free word if that is cheaper; returns whether it was."""
    count = store.mark[PIECE_COUNT]
    start = pose_at(store, place)
    end = end_of(store, place + span - 1)
    gear = sign(store.piece_way[place - 1]) if place > 0 else 0.0
    lock = store.piece_k[place - 1] / task.car.curvature if place > 0 else 0.0
    limit = span_cost(store, place, span, task) - GAIN
    words = list_words(store, start, end, gear, lock, task)
    tries = 0
    while tries < TRIES:
        word = cheapest(store, words)
        if store.word_cost[word] >= limit:
            return False
        cost = store.word_cost[word]
        if place + span < count:
            cost += _join_after(store, word, place + span, task)
        if cost < limit:
            tries += 1
            if is_word_free(store, word, start, task):
                return _put_span(store, place, span, word, task)
        drop_word(store, word)
    return False


def _join_after(store: PlanStore, word: int, piece: int, task: Task) -> float:
    """Return the cost [m] of going on from a word to a piece of the path."""
    rest = store.word_code[word]
    way = 0.0
    k = 0.0
    for number in range(5):
        if word_way(store, word, number) != 0.0:
            way = word_way(store, word, number)
            k = (rest % 3 - 1) * task.car.curvature
        rest = rest // 3
    return join_cost(way, k, store.piece_way[piece], store.piece_k[piece], task)


def _put_span(store: PlanStore, place: int, span: int, word: int, task: Task) -> bool:
    """Put a word in place of some pieces; returns whether there was room."""
    count = store.mark[PIECE_COUNT]
    used = 0
    for number in range(5):
        if word_way(store, word, number) != 0.0:
            used += 1
    if count + used - span > PIECES:
        return False
    pose = pose_at(store, place)
    move_pieces(store, place + span, count - place - span, used - span)
    rest = store.word_code[word]
    piece = place
    for number in range(5):
        way = word_way(store, word, number)
        k = (rest % 3 - 1) * task.car.curvature
        rest = rest // 3
        if way != 0.0:
            put_piece(store, piece, pose, way, k)
            pose = drive(pose, way, k)
            piece += 1
    put_mark(store, PIECE_COUNT, count + used - span)
    return True
