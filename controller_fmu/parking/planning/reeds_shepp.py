"""Reeds-Shepp words: short paths between two poses on free ground, of arcs at full lock (L, R) and lines (S).

A car with both gears gets from any pose to any other by at most five segments (J. A. Reeds, L. A. Shepp,
"Optimal paths for a car that goes both forwards and backwards", Pacific J. Math. 145 (1990)); the shortest is among
48 words. What is best among obstacles, or with a price on each change of direction, need not be among them. So the
words of three segments are listed in full here: CSC and CCC, each arc driven forward or, the other way round its
circle, in reverse. Those of four and five segments are Reeds' and Shepp's.

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
UNUSED_PIECE = 1
MIN_WORD_LENGTH = 1e-6
"""A segment shorter than this, in radii, is left out."""


def word_code(a: int, b: int, c: int, d: int = UNUSED_PIECE, e: int = UNUSED_PIECE) -> int:
    """Return five turns (``LEFT_TURN``, ``STRAIGHT_LINE``, ``RIGHT_TURN``) as one number of two bits each."""
    return a + 4 * (b + 4 * (c + 4 * (d + 4 * e)))


def turn_of(code: int, segment: int) -> int:
    """Return the turn of a segment (0 to 4) of a word."""
    return (code >> 2 * segment) & 3


def word_curvature(work: PlanningWork, word: int, segment: int, problem: SearchProblem) -> float:
    """Return the curvature [1/m] of a segment (0 to 4) of a listed word."""
    return (turn_of(work.word_code[word], segment) - 1) * problem.car.max_curvature


LSL = word_code(LEFT_TURN, STRAIGHT_LINE, LEFT_TURN)
LSR = word_code(LEFT_TURN, STRAIGHT_LINE, RIGHT_TURN)
LRL = word_code(LEFT_TURN, RIGHT_TURN, LEFT_TURN)
LRLR = word_code(LEFT_TURN, RIGHT_TURN, LEFT_TURN, RIGHT_TURN)
LRSL = word_code(LEFT_TURN, RIGHT_TURN, STRAIGHT_LINE, LEFT_TURN)
LRSR = word_code(LEFT_TURN, RIGHT_TURN, STRAIGHT_LINE, RIGHT_TURN)
LRSLR = word_code(LEFT_TURN, RIGHT_TURN, STRAIGHT_LINE, LEFT_TURN, RIGHT_TURN)
"""Words by their turns."""


class WordRequest(NamedTuple):
    """How the car comes to the start of a word, which prices its first changes, and what the word may cost."""

    gear: float
    """1.0, -1.0; 0.0: none."""
    lock: float
    """Its curvature over the largest, -1.0 to 1.0."""
    limit: float
    """Words that cost as much [m] are not listed."""


class WordChoice(NamedTuple):
    """Which words are listed."""

    request: WordRequest
    radius: float
    """Of the smallest circle [m]."""
    only_cheaper: bool
    """Each word costs less than those before; else all that cost less than the limit are listed."""


class WordEnd(NamedTuple):
    """The pose at a word's end, seen from its start, in radii, with sine and cosine of its heading."""

    x: float
    y: float
    heading: float
    sin: float
    cos: float


class WordSymmetry(NamedTuple):
    """One of the eight images of a word: mirrored or not, driven forward or in reverse, from either end."""

    side: float
    """1.0, or -1.0: left and right are exchanged."""
    time: float = 1.0
    """1.0, or -1.0: each segment in the other direction of travel."""
    is_backwards: bool = False
    """Its segments in the opposite order."""


def least_word_cost(work: PlanningWork, start: Pose, end: Pose, request: WordRequest, problem: SearchProblem) -> float:
    """Return the cost [m] of the cheapest word from ``start`` to ``end``, or the limit [m] if that is less."""
    count = list_words(work, start, end, request, problem, True)
    return work.word_cost[count - 1] if count > 0 else request.limit


def list_words(
    work: PlanningWork, start: Pose, end: Pose, request: WordRequest, problem: SearchProblem, only_cheaper: bool = False
) -> int:
    """List the words from ``start`` to ``end`` that cost less than the limit [m] in ``work``; returns how many."""
    k = problem.car.max_curvature
    choice = WordChoice(request, 1.0 / k, only_cheaper)
    work.values[PlanValue.WORD_LIMIT] = request.limit
    at = point_to_frame((end.x - start.x) * k, (end.y - start.y) * k, Pose(heading=start.heading))
    h = end.heading - start.heading
    sin = math.sin(h)
    cos = math.cos(h)
    count = 0
    for side in (1.0, -1.0):
        goal = WordEnd(at.x, at.y * side, h * side, sin * side, cos)
        count = _three_pieces(work, count, goal, WordSymmetry(side), choice)
        for time in (1.0, -1.0):
            goal = WordEnd(at.x * time, at.y * side, h * side * time, sin * side * time, cos)
            count = _more_pieces(work, count, goal, WordSymmetry(side, time), choice)
    return count


def _is_too_long(work: PlanningWork, length: float, choice: WordChoice) -> bool:
    """Return whether a word at least so long costs more than the limit, even without segments that are left out."""
    return (length - 5.0 * MIN_WORD_LENGTH) * choice.radius >= work.values[PlanValue.WORD_LIMIT]


def _three_pieces(work: PlanningWork, count: int, goal: WordEnd, image: WordSymmetry, choice: WordChoice) -> int:
    """List LSL, LSR and LRL, or their mirror images."""
    h = goal.heading
    sx = goal.x - goal.sin
    sy = goal.y - 1.0 + goal.cos
    apart = math.sqrt(sx * sx + sy * sy)
    # on the arc between two others the centre of their circles moves by 2 for each radian
    if not _is_too_long(work, apart if apart > 4.0 else 0.5 * apart, choice):
        towards = math.atan2(sy, sx)
        count = _arcs(work, count, LSL, (towards, apart, h - towards), image, choice)
        count = _arcs(work, count, LSL, (towards + PI, -apart, h - towards - PI), image, choice)
        if apart <= 4.0:
            open_by = math.acos(0.25 * apart)
            for b in (open_by, -open_by):
                # from centre to centre: towards + b, then towards - b
                first = towards + b + 0.5 * PI
                second = towards - b - 0.5 * PI
                u = wrap_angle(first - second)
                count = _arcs(work, count, LRL, (first, u, h - second), image, choice)
                count = _arcs(work, count, LRL, (first, _complementary_arc(u), h - second), image, choice)
    sx = goal.x + goal.sin
    sy = goal.y - 1.0 - goal.cos
    square = sx * sx + sy * sy
    line = math.sqrt(max(square - 4.0, 0.0))
    if square >= 4.0 and not _is_too_long(work, line, choice):
        for u in (line, -line):
            along = math.atan2(sy, sx) + math.atan2(2.0, u)
            count = _arcs(work, count, LSR, (along, u, along - h), image, choice)
    return count


def _complementary_arc(angle: float) -> float:
    """Return the arc [rad] in the opposite direction that ends where one of ``angle`` does."""
    return angle - TWO_PI if angle > 0.0 else angle + TWO_PI


def _arcs(
    work: PlanningWork,
    count: int,
    code: int,
    lengths: tuple[float, float, float],
    image: WordSymmetry,
    choice: WordChoice,
) -> int:
    """List a word of three segments with each outer arc driven forward, or in reverse the other way round."""
    t = wrap_angle(lengths[0])
    u = lengths[1]
    v = wrap_angle(lengths[2])
    if _is_too_long(work, abs(t) + abs(u) + abs(v), choice):
        return count
    for last in (v, _complementary_arc(v)):
        for first in (t, _complementary_arc(t)):
            count = _add(work, count, code, (first, u, last, 0.0, 0.0), image, choice)
    return count


def _more_pieces(work: PlanningWork, count: int, goal: WordEnd, image: WordSymmetry, choice: WordChoice) -> int:
    """List words of four and five segments: CCCC, CCSC, CSCC and CCSCC, equations 8.7 to 8.11 of the source."""
    h = goal.heading
    px = goal.x + goal.sin
    py = goal.y - 1.0 - goal.cos
    square = px * px + py * py
    rho = 0.25 * (2.0 + math.sqrt(square))
    if rho <= 1.0:
        u = math.acos(rho)
        if not _is_too_long(work, 2.0 * u, choice):
            t = _first_of_four(u, -u, px, py)
            count = _add(work, count, LRLR, (t, u, -u, wrap_angle(t - 2.0 * u - h), 0.0), image, choice)
    rho = (20.0 - square) / 16.0
    if 0.0 <= rho <= 1.0:
        u = -math.acos(rho)
        if not _is_too_long(work, -2.0 * u, choice):
            t = _first_of_four(u, u, px, py)
            count = _add(work, count, LRLR, (t, u, u, wrap_angle(t - h), 0.0), image, choice)
    if square >= 4.0:
        u = 4.0 - math.sqrt(square - 4.0)
        if u <= 0.0 and not _is_too_long(work, PI - u, choice):
            t = wrap_angle(math.atan2((4.0 - u) * px - 2.0 * py, -2.0 * px + (u - 4.0) * py))
            count = _add(work, count, LRSLR, (t, -0.5 * PI, u, -0.5 * PI, wrap_angle(t - h)), image, choice)
    count = _four_with_line(work, count, goal, image, choice)
    back_x = goal.x * goal.cos + goal.y * goal.sin
    back_y = goal.x * goal.sin - goal.y * goal.cos
    goal = WordEnd(back_x, back_y, h, goal.sin, goal.cos)
    return _four_with_line(work, count, goal, image._replace(is_backwards=True), choice)


def _four_with_line(work: PlanningWork, count: int, goal: WordEnd, image: WordSymmetry, choice: WordChoice) -> int:
    """List CCSC or, read backwards, CSCC."""
    h = goal.heading
    sx = goal.x - goal.sin
    sy = goal.y - 1.0 + goal.cos
    square = sx * sx + sy * sy
    r = math.sqrt(max(square - 4.0, 0.0))
    if square >= 4.0 and not _is_too_long(work, 0.5 * PI + abs(2.0 - r), choice):
        t = wrap_angle(math.atan2(sy, sx) + math.atan2(r, -2.0))
        v = wrap_angle(h - 0.5 * PI - t)
        count = _add(work, count, LRSL, (t, -0.5 * PI, 2.0 - r, v, 0.0), image, choice)
    px = goal.x + goal.sin
    py = goal.y - 1.0 - goal.cos
    rho = math.sqrt(px * px + py * py)
    if rho >= 2.0 and not _is_too_long(work, 0.5 * PI + rho - 2.0, choice):
        t = math.atan2(px, -py)
        v = wrap_angle(t + 0.5 * PI - h)
        count = _add(work, count, LRSR, (t, -0.5 * PI, 2.0 - rho, v, 0.0), image, choice)
    return count


def _first_of_four(u: float, v: float, x: float, y: float) -> float:
    """Return the first arc of CCCC whose middle arcs are ``u`` and ``v``."""
    d = wrap_angle(u - v)
    a = math.sin(u) - math.sin(d)
    b = math.cos(u) - math.cos(d) - 1.0
    t = math.atan2(y * a - x * b, x * a + y * b)
    if 2.0 * (math.cos(d) - math.cos(v) - math.cos(u)) + 3.0 < 0.0:
        return wrap_angle(t + PI)
    return wrap_angle(t)


def _add(
    work: PlanningWork,
    count: int,
    code: int,
    lengths: tuple[float, float, float, float, float],
    image: WordSymmetry,
    choice: WordChoice,
) -> int:
    """List an image of one word with its cost [m]: length, changes of direction, and of the wheel, if low enough."""
    a, b, c, d, e = lengths
    if _is_too_long(work, abs(a) + abs(b) + abs(c) + abs(d) + abs(e), choice):
        return count
    gear = choice.request.gear
    lock = choice.request.lock
    cost = 0.0
    used = 0
    for number in range(WORD_SEGMENTS):
        place = WORD_SEGMENTS - 1 - number if image.is_backwards else number
        distance = image.time * lengths[place] if abs(lengths[place]) > MIN_WORD_LENGTH else 0.0
        work.word_distance[WORD_SEGMENTS * count + number] = distance * choice.radius
        turn = image.side * float(turn_of(code, place) - 1)
        used += math.floor(turn + 1.0) << 2 * number
        if distance != 0.0:
            direction = sign(distance)
            cost += abs(distance) * choice.radius + abs(turn - lock) * STEERING_COST
            if direction * gear < 0.0:
                cost += CUSP_COST
            gear = direction
            lock = turn
    if cost >= work.values[PlanValue.WORD_LIMIT]:
        return count
    if choice.only_cheaper:
        work.values[PlanValue.WORD_LIMIT] = cost
    work.word_code[count] = used
    work.word_cost[count] = cost
    return count + 1
