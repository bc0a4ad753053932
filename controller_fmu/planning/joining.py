"""The words that lead to the target, cheapest first, and whether the car can drive one: how a node is joined to it."""

from controller_fmu.planning.clearance import clearance, sweep
from controller_fmu.planning.plan_store import (
    BEST_COST,
    BEST_NODE,
    FREE_AT_NODE,
    FREE_AT_TARGET,
    NONE,
    PlanStore,
    drop_word,
)
from controller_fmu.planning.task import Task, drive
from controller_fmu.planning.tree_store import put_best
from modelkit.vocabulary import Pose

LONGEST = 10.0
"""The car is looked at no farther [m] from a node."""
TRIES = 8


def join(store: PlanStore, node: int, pose: Pose, words: int, task: Task) -> None:
    """Try the cheapest words from a node to the target; remember the first that is free if it is the best way yet."""
    tries = 0
    while tries < TRIES:
        word = cheapest(store, words)
        cost = store.node_cost[node] + store.word_cost[word]
        if store.word_cost[word] > 1e8 or (store.mark[BEST_NODE] != NONE and cost >= store.measure[BEST_COST]):
            return
        if _ends_free(store, word):
            tries += 1
            if is_word_free(store, word, pose, task):
                put_best(store, node, word, cost)
                return
        drop_word(store, word)


def cheapest(store: PlanStore, words: int) -> int:
    """Return the word of least cost."""
    best = 0
    least = store.word_cost[0]
    for word in range(1, words):
        cost = store.word_cost[word]
        if cost < least:
            best = word
            least = cost
    return best


def word_way(store: PlanStore, word: int, piece: int) -> float:
    """Return the way [m] of a word's piece."""
    if piece == 0:
        return store.word_a[word]
    if piece == 1:
        return store.word_b[word]
    if piece == 2:
        return store.word_c[word]
    return store.word_d[word] if piece == 3 else store.word_e[word]


def _ends_free(store: PlanStore, word: int) -> bool:
    """Return whether the first and the last piece of a word fit what is free at the node and at the target."""
    rest = store.word_code[word]
    first = True
    last = 0.0
    last_turn = 0
    for piece in range(5):
        way = word_way(store, word, piece)
        turn = rest % 3
        rest = rest // 3
        if way != 0.0:
            if first:
                free = store.measure[FREE_AT_NODE + (5 if way > 0.0 else 0) + 2 * turn]
                if abs(way) > free and free < LONGEST:
                    return False
            first = False
            last = way
            last_turn = turn
    return abs(last) <= store.measure[FREE_AT_TARGET + (0 if last > 0.0 else 3) + last_turn]


def is_word_free(store: PlanStore, word: int, pose: Pose, task: Task) -> bool:
    """Return whether the car can drive a word from ``pose``."""
    rest = store.word_code[word]
    gap = clearance(store, pose, task) - task.margin
    for piece in range(5):
        way = word_way(store, word, piece)
        k = (rest % 3 - 1) * task.car.curvature
        rest = rest // 3
        if way != 0.0:
            driven = sweep(store, pose, gap, way, k, task)
            if driven.way < abs(way):
                return False
            gap = driven.gap
            pose = drive(pose, way, k)
    return True
