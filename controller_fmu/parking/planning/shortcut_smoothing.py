"""Shortcut smoothing: spans of the path found are replaced by cheaper words that are free of collision."""

from controller_fmu.parking.geometry.outline import SAME_CURVATURE, pose_along_arc
from controller_fmu.parking.planning.analytic_expansion import cheapest_word, is_word_collision_free
from controller_fmu.parking.planning.problem import CUSP_COST, STEERING_COST, SearchProblem
from controller_fmu.parking.planning.reeds_shepp import WordRequest, list_words, turn_of, word_curvature
from controller_fmu.parking.planning.work import (
    NO_INDEX,
    WORD_SEGMENTS,
    WORK_SEGMENTS,
    PlanCount,
    PlanningWork,
    PlanValue,
    discard_word,
    move_segments,
    pose_at,
    set_segment,
    word_length,
)
from modelkit.maths import sign
from modelkit.vocabulary import Pose

MAX_SPAN = 12
MAX_PASSES = 4
MAX_TRIES = 4
MIN_GAIN = 0.01
"""A word has to be cheaper by so much [m]."""


def begin_smoothing(work: PlanningWork, problem: SearchProblem) -> None:
    """Copy the path that was found from tree and word to the segments of ``work``."""
    work.counts[PlanCount.SEGMENT_COUNT] = 0
    depth = 0
    node = work.counts[PlanCount.BEST_NODE]
    while node != NO_INDEX and work.node_parent[node] != NO_INDEX:
        depth += 1
        node = work.node_parent[node]
    pose = problem.root
    for level in range(depth):
        node = work.counts[PlanCount.BEST_NODE]
        for _ in range(depth - 1 - level):
            node = work.node_parent[node]
        pose = append_segment(work, pose, work.node_length[node], work.node_curvature[node])
    for number in range(WORD_SEGMENTS):
        k = (turn_of(work.counts[PlanCount.BEST_CODE], number) - 1) * problem.car.max_curvature
        pose = append_segment(work, pose, work.values[PlanValue.BEST_LENGTHS + number], k)
    work.counts[PlanCount.SPAN] = work.counts[PlanCount.SEGMENT_COUNT]
    work.counts[PlanCount.SPAN_START] = 0
    work.counts[PlanCount.HAS_GAINED] = 0
    work.counts[PlanCount.PASS_COUNT] = 0


def append_segment(work: PlanningWork, pose: Pose, distance: float, k: float) -> Pose:
    """Append ``distance`` [m] of curvature ``k`` [1/m] to the path, merged with a like segment; returns its end."""
    count = work.counts[PlanCount.SEGMENT_COUNT]
    if distance == 0.0 or count >= WORK_SEGMENTS:
        return pose
    if count > 0:
        last = work.segment_length[count - 1]
        if last * distance > 0.0 and abs(work.segment_curvature[count - 1] - k) < SAME_CURVATURE:
            begin = pose_at(work, count - 1)
            set_segment(work, count - 1, begin, last + distance, k)
            return pose_along_arc(begin, last + distance, k)
    set_segment(work, count, pose, distance, k)
    work.counts[PlanCount.SEGMENT_COUNT] = count + 1
    return pose_along_arc(pose, distance, k)


def smooth(work: PlanningWork, problem: SearchProblem) -> bool:
    """Try the next span; returns whether there is more to try."""
    count = work.counts[PlanCount.SEGMENT_COUNT]
    span = work.counts[PlanCount.SPAN]
    place = work.counts[PlanCount.SPAN_START]
    if place + span > count:
        span = span - 1 if span <= count else count
        place = 0
    span = min(span, MAX_SPAN)
    if span < 2:
        if work.counts[PlanCount.HAS_GAINED] == 0 or work.counts[PlanCount.PASS_COUNT] >= MAX_PASSES:
            return False
        work.counts[PlanCount.HAS_GAINED] = 0
        work.counts[PlanCount.PASS_COUNT] = work.counts[PlanCount.PASS_COUNT] + 1
        work.counts[PlanCount.SPAN] = count
        work.counts[PlanCount.SPAN_START] = 0
        return True
    replaced = _replace_span(work, place, span, problem)
    work.counts[PlanCount.SPAN] = span
    work.counts[PlanCount.SPAN_START] = place if replaced else place + 1
    if replaced:
        work.counts[PlanCount.HAS_GAINED] = 1
    return True


def joint_cost(work: PlanningWork, distance: float, k: float, segment: int, problem: SearchProblem) -> float:
    """Return the cost [m] of a joint: a segment behind ``distance`` [m], reverse negative, of curvature ``k`` [1/m]."""
    cost = abs(work.segment_curvature[segment] - k) / problem.car.max_curvature * STEERING_COST
    return cost + CUSP_COST if distance * work.segment_length[segment] < 0.0 else cost


def span_cost(work: PlanningWork, place: int, span: int, problem: SearchProblem) -> float:
    """Return the cost [m] of ``span`` segments of the path from number ``place`` on, with the joints at their ends."""
    count = work.counts[PlanCount.SEGMENT_COUNT]
    cost = 0.0
    for segment in range(place, place + span):
        cost += abs(work.segment_length[segment])
    for segment in range(place, place + span + 1):
        if segment == 0:
            cost += joint_cost(work, 0.0, 0.0, segment, problem)
        elif segment < count:
            before = segment - 1
            cost += joint_cost(work, work.segment_length[before], work.segment_curvature[before], segment, problem)
    return cost


def _replace_span(work: PlanningWork, place: int, span: int, problem: SearchProblem) -> bool:
    """Replace some segments by the cheapest free word if that is cheaper; returns whether it was."""
    count = work.counts[PlanCount.SEGMENT_COUNT]
    start = pose_at(work, place)
    last = place + span - 1
    end = pose_along_arc(pose_at(work, last), work.segment_length[last], work.segment_curvature[last])
    gear = sign(work.segment_length[place - 1]) if place > 0 else 0.0
    lock = work.segment_curvature[place - 1] / problem.car.max_curvature if place > 0 else 0.0
    limit = span_cost(work, place, span, problem) - MIN_GAIN
    words = list_words(work, start, end, WordRequest(gear, lock, limit), problem)
    tries = 0
    while tries < MAX_TRIES:
        word = cheapest_word(work, words)
        if word == NO_INDEX:
            return False
        cost = work.word_cost[word]
        if place + span < count:
            cost += _cost_after(work, word, place + span, problem)
        if cost < limit:
            tries += 1
            if is_word_collision_free(work, word, start, problem):
                return _set_span(work, place, span, word, problem)
        discard_word(work, word)
    return False


def _cost_after(work: PlanningWork, word: int, segment: int, problem: SearchProblem) -> float:
    """Return the cost [m] of going on from a word to a segment of the path."""
    distance = 0.0
    k = 0.0
    for number in range(WORD_SEGMENTS):
        if word_length(work, word, number) != 0.0:
            distance = word_length(work, word, number)
            k = word_curvature(work, word, number, problem)
    return joint_cost(work, distance, k, segment, problem)


def _set_span(work: PlanningWork, place: int, span: int, word: int, problem: SearchProblem) -> bool:
    """Put a word in place of some segments; returns whether there was room."""
    count = work.counts[PlanCount.SEGMENT_COUNT]
    used = sum(1 if word_length(work, word, number) != 0.0 else 0 for number in range(WORD_SEGMENTS))
    if count + used - span > WORK_SEGMENTS:
        return False
    pose = pose_at(work, place)
    move_segments(work, place + span, count - place - span, used - span)
    segment = place
    for number in range(WORD_SEGMENTS):
        distance = word_length(work, word, number)
        k = word_curvature(work, word, number, problem)
        if distance != 0.0:
            set_segment(work, segment, pose, distance, k)
            pose = pose_along_arc(pose, distance, k)
            segment += 1
    work.counts[PlanCount.SEGMENT_COUNT] = count + used - span
    return True
