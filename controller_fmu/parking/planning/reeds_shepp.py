"""Reeds-Shepp words: short paths between two poses on free ground, of arcs at full lock (L, R) and lines (S).

A car with both gears gets from any pose to any other by three of them (J. A. Reeds, L. A. Shepp, "Optimal paths for a
car that goes both forwards and backwards", Pacific J. Math. 145 (1990)): CSC or CCC, listed in full here, each outer
arc driven forward or, the other way round its circle, in reverse. The source has words of four and five segments, too,
which may be shorter on free ground. Among obstacles the tree in front of a word has as many segments as it needs.

Lengths are in radii of the smallest circle, angles of an L positive to the left; forward positive.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.planning.problem import CUSP_COST, STEERING_COST, SearchProblem
from controller_fmu.parking.planning.work import WORD_SEGMENTS, PlanningWork, PlanValue
from modelkit.maths import PI, TWO_PI, sign, wrap_angle
from modelkit.vocabulary import Pose

LEFT_TURN = 2
STRAIGHT_LINE = 1
RIGHT_TURN = 0
MIN_WORD_LENGTH = 1e-6
"""A segment shorter than this, in radii, is left out."""


def word_code(a: int, b: int, c: int) -> int:
    """Return three turns (``LEFT_TURN``, ``STRAIGHT_LINE``, ``RIGHT_TURN``) as one number of two bits each."""
    return a + 4 * (b + 4 * c)


def turn_of(code: int, segment: int) -> int:
    """Return the turn of a segment (0 to 2) of a word."""
    return (code >> 2 * segment) & 3


def word_curvature(work: PlanningWork, word: int, segment: int, problem: SearchProblem) -> float:
    """Return the curvature [1/m] of a segment (0 to 2) of a listed word."""
    return (turn_of(work.word_code[word], segment) - 1) * problem.car.max_curvature


LSL = word_code(LEFT_TURN, STRAIGHT_LINE, LEFT_TURN)
LSR = word_code(LEFT_TURN, STRAIGHT_LINE, RIGHT_TURN)
LRL = word_code(LEFT_TURN, RIGHT_TURN, LEFT_TURN)
"""Words by their turns."""


class WordRequest(NamedTuple):
    """How the car comes to the start of a word, which prices its first changes, and what the word may cost."""

    gear: float
    """1.0, -1.0; 0.0: none."""
    lock: float
    """Its curvature over the largest, -1.0 to 1.0."""
    limit: float
    """Words that cost as much [m] are not listed."""
    only_cheaper: bool = False
    """Each word listed costs less than those before."""
    radius: float = 0.0
    """Of the smallest circle [m]: the problem's."""


class WordEnd(NamedTuple):
    """The pose at a word's end, seen from its start, in radii, with sine and cosine of its heading."""

    x: float
    y: float
    heading: float
    sin: float
    cos: float


def least_word_cost(work: PlanningWork, start: Pose, end: Pose, request: WordRequest, problem: SearchProblem) -> float:
    """Return the cost [m] of the cheapest word from ``start`` to ``end``, or the limit [m] if that is less."""
    count = list_words(work, start, end, request._replace(only_cheaper=True), problem)
    return work.word_cost[count - 1] if count > 0 else request.limit


def list_words(work: PlanningWork, start: Pose, end: Pose, request: WordRequest, problem: SearchProblem) -> int:
    """List the words from ``start`` to ``end`` that cost less than the limit [m] in ``work``; returns how many."""
    k = problem.car.max_curvature
    request = request._replace(radius=1.0 / k)
    work.values[PlanValue.WORD_LIMIT] = request.limit
    at = point_to_frame((end.x - start.x) * k, (end.y - start.y) * k, Pose(heading=start.heading))
    h = end.heading - start.heading
    sin = math.sin(h)
    cos = math.cos(h)
    count = 0
    for side in (1.0, -1.0):
        goal = WordEnd(at.x, at.y * side, h * side, sin * side, cos)
        count = _words_to(work, count, goal, side, request)
    return count


def _is_too_long(work: PlanningWork, length: float, request: WordRequest) -> bool:
    """Return whether a word at least so long costs more than the limit, even without segments that are left out."""
    return (length - WORD_SEGMENTS * MIN_WORD_LENGTH) * request.radius >= work.values[PlanValue.WORD_LIMIT]


def _words_to(work: PlanningWork, count: int, goal: WordEnd, side: float, request: WordRequest) -> int:
    """List LSL, LSR and LRL (``side`` 1), or their mirror images (-1)."""
    h = goal.heading
    sx = goal.x - goal.sin
    sy = goal.y - 1.0 + goal.cos
    apart = math.sqrt(sx * sx + sy * sy)
    # on the arc between two others the centre of their circles moves by 2 for each radian
    if not _is_too_long(work, apart if apart > 4.0 else 0.5 * apart, request):
        towards = math.atan2(sy, sx)
        count = _arcs(work, count, LSL, (towards, apart, h - towards), side, request)
        count = _arcs(work, count, LSL, (towards + PI, -apart, h - towards - PI), side, request)
        if apart <= 4.0:
            open_by = math.acos(0.25 * apart)
            for b in (open_by, -open_by):
                # from centre to centre: towards + b, then towards - b
                first = towards + b + 0.5 * PI
                second = towards - b - 0.5 * PI
                u = wrap_angle(first - second)
                count = _arcs(work, count, LRL, (first, u, h - second), side, request)
                count = _arcs(work, count, LRL, (first, _complementary_arc(u), h - second), side, request)
    sx = goal.x + goal.sin
    sy = goal.y - 1.0 - goal.cos
    square = sx * sx + sy * sy
    line = math.sqrt(max(square - 4.0, 0.0))
    if square >= 4.0 and not _is_too_long(work, line, request):
        for u in (line, -line):
            along = math.atan2(sy, sx) + math.atan2(2.0, u)
            count = _arcs(work, count, LSR, (along, u, along - h), side, request)
    return count


def _complementary_arc(angle: float) -> float:
    """Return the arc [rad] in the opposite direction that ends where one of ``angle`` does."""
    return angle - TWO_PI if angle > 0.0 else angle + TWO_PI


def _arcs(
    work: PlanningWork, count: int, code: int, lengths: tuple[float, float, float], side: float, request: WordRequest
) -> int:
    """List a word of three segments with each outer arc driven forward, or in reverse the other way round."""
    t = wrap_angle(lengths[0])
    u = lengths[1]
    v = wrap_angle(lengths[2])
    if _is_too_long(work, abs(t) + abs(u) + abs(v), request):
        return count
    for last in (v, _complementary_arc(v)):
        for first in (t, _complementary_arc(t)):
            count = _add(work, count, code, (first, u, last), side, request)
    return count


def _add(
    work: PlanningWork, count: int, code: int, lengths: tuple[float, float, float], side: float, request: WordRequest
) -> int:
    """List a word with its cost [m]: length, changes of direction, and of the wheel, if low enough.

    ``side`` -1: left and right are exchanged.
    """
    if _is_too_long(work, abs(lengths[0]) + abs(lengths[1]) + abs(lengths[2]), request):
        return count
    gear = request.gear
    lock = request.lock
    cost = 0.0
    used = 0
    for number in range(WORD_SEGMENTS):
        distance = lengths[number] if abs(lengths[number]) > MIN_WORD_LENGTH else 0.0
        work.word_distance[WORD_SEGMENTS * count + number] = distance * request.radius
        turn = side * float(turn_of(code, number) - 1)
        used += math.floor(turn + 1.0) << 2 * number
        if distance != 0.0:
            direction = sign(distance)
            cost += abs(distance) * request.radius + abs(turn - lock) * STEERING_COST
            if direction * gear < 0.0:
                cost += CUSP_COST
            gear = direction
            lock = turn
    if cost >= work.values[PlanValue.WORD_LIMIT]:
        return count
    if request.only_cheaper:
        work.values[PlanValue.WORD_LIMIT] = cost
    work.word_code[count] = used
    work.word_cost[count] = cost
    return count + 1
