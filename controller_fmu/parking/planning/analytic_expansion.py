"""Analytic expansion: the cheapest Reeds-Shepp word from a node to the target that is free of collision."""

from controller_fmu.parking.geometry.outline import outline_frame, pose_along_arc
from controller_fmu.parking.planning.collision import clearance, sweep_arc
from controller_fmu.parking.planning.problem import SearchProblem
from controller_fmu.parking.planning.reeds_shepp import turn_of, word_curvature
from controller_fmu.parking.planning.work import (
    NO_INDEX,
    WORD_SEGMENTS,
    PlanningWork,
    PlanValue,
    discard_word,
    set_best,
    word_length,
)
from modelkit.vocabulary import Pose

MAX_LENGTH = 10.0
"""The free distance at a node is known up to this [m]."""
MAX_TRIES = 8


def try_analytic_expansion(work: PlanningWork, node: int, pose: Pose, words: int, problem: SearchProblem) -> None:
    """Try the cheapest of so many words from a node to the target; keep the first that is free."""
    for word in range(words):
        if not _ends_free(work, word):
            discard_word(work, word)
    for _ in range(MAX_TRIES):
        word = cheapest_word(work, words)
        if word == NO_INDEX:
            return
        if is_word_collision_free(work, word, pose, problem):
            set_best(work, node, word, work.node_cost[node] + work.word_cost[word])
            return
        discard_word(work, word)


def cheapest_word(work: PlanningWork, words: int) -> int:
    """Return the index of the word of least cost among the first ``words``; ``NO_INDEX`` if none is left."""
    best = NO_INDEX
    least = 1e9
    for word in range(words):
        cost = work.word_cost[word]
        if cost < least:
            best = word
            least = cost
    return best


def _ends_free(work: PlanningWork, word: int) -> bool:
    """Return whether the first and the last segment of a word fit what is free at the node and at the target."""
    first = True
    last = 0.0
    last_turn = 0
    for segment in range(WORD_SEGMENTS):
        distance = word_length(work, word, segment)
        turn = turn_of(work.word_code[word], segment)
        if distance != 0.0:
            if first:
                free = work.values[PlanValue.FREE_AT_NODE + (5 if distance > 0.0 else 0) + 2 * turn]
                if abs(distance) > free and free < MAX_LENGTH:
                    return False
            first = False
            last = distance
            last_turn = turn
    return abs(last) <= work.values[PlanValue.FREE_AT_TARGET + (0 if last > 0.0 else 3) + last_turn]


def is_word_collision_free(work: PlanningWork, word: int, pose: Pose, problem: SearchProblem) -> bool:
    """Return whether the car can drive a word from ``pose``."""
    gap = clearance(work, outline_frame(pose), problem) - problem.margin
    for segment in range(WORD_SEGMENTS):
        distance = word_length(work, word, segment)
        k = word_curvature(work, word, segment, problem)
        if distance != 0.0:
            driven = sweep_arc(work, pose, gap, distance, k, problem)
            if driven.distance < abs(distance):
                return False
            gap = driven.gap
            pose = pose_along_arc(pose, distance, k)
    return True
