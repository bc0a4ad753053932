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

from controller_fmu.parking.planning.problem import CUSP_COST, STEERING_COST, SearchProblem
from controller_fmu.parking.planning.work import PlanningWork, set_word
from modelkit.maths import PI, TWO_PI, sign, wrap_angle
from modelkit.vocabulary import Pose

LEFT_TURN = 2
STRAIGHT_LINE = 1
RIGHT_TURN = 0
UNUSED_PIECE = 1
MIN_WORD_LENGTH = 1e-6
"""A segment shorter than this, in radii, is left out."""


def word_code(a: int, b: int, c: int, d: int, e: int) -> int:
    """Return the turns of five segments (``LEFT_TURN``, ``STRAIGHT_LINE``, ``RIGHT_TURN``) as one number."""
    return a + 3 * (b + 3 * (c + 3 * (d + 3 * e)))


class ArrivalState(NamedTuple):
    """How the car comes to the start of a word: what the first change of direction and of the wheel are priced by."""

    gear: float
    """1.0, -1.0; 0.0: none."""
    lock: float
    """-1.0 to 1.0."""
    radius: float
    """Of the smallest circle [m]."""


class WordSymmetry(NamedTuple):
    """One of the four images of a word: mirrored or not, driven forward or in reverse."""

    left: int
    right: int
    time: float
    """1.0, or -1.0: each segment in the other direction of travel."""


def list_words(work: PlanningWork, start: Pose, end: Pose, gear: float, lock: float, problem: SearchProblem) -> int:
    """List the words from ``start`` to ``end`` with their costs [m] in ``work``; returns how many.

    ``gear`` (1.0, -1.0; 0.0: none) and ``lock`` (-1.0 to 1.0) are those with which the car arrives at
    ``start``: its direction, and its curvature over the largest.
    """
    k = problem.car.max_curvature
    cos = math.cos(start.heading)
    sin = math.sin(start.heading)
    dx = (end.x - start.x) * k
    dy = (end.y - start.y) * k
    x = dx * cos + dy * sin
    y = dy * cos - dx * sin
    h = end.heading - start.heading
    arrival = ArrivalState(gear, lock, 1.0 / k)
    count = 0
    for side in range(2):
        mirror = 1.0 if side == 0 else -1.0
        left = LEFT_TURN if side == 0 else RIGHT_TURN
        right = RIGHT_TURN if side == 0 else LEFT_TURN
        goal = Pose(x, y * mirror, h * mirror)
        count = _three_pieces(work, count, goal, WordSymmetry(left, right, 1.0), arrival)
        for distance in range(2):
            time = 1.0 if distance == 0 else -1.0
            goal = Pose(x * time, y * mirror, h * mirror * time)
            count = _more_pieces(work, count, goal, WordSymmetry(left, right, time), arrival)
    return count


def _three_pieces(work: PlanningWork, count: int, goal: Pose, image: WordSymmetry, arrival: ArrivalState) -> int:
    """List LSL, LSR and LRL, or their mirror images."""
    h = goal.heading
    sx = goal.x - math.sin(h)
    sy = goal.y - 1.0 + math.cos(h)
    apart = math.sqrt(sx * sx + sy * sy)
    towards = math.atan2(sy, sx)
    code = word_code(image.left, STRAIGHT_LINE, image.left, UNUSED_PIECE, UNUSED_PIECE)
    count = _arcs(work, count, code, (towards, apart, h - towards), arrival)
    count = _arcs(work, count, code, (towards + PI, -apart, h - towards - PI), arrival)
    if apart <= 4.0:
        code = word_code(image.left, image.right, image.left, UNUSED_PIECE, UNUSED_PIECE)
        open_by = math.acos(0.25 * apart)
        for side in range(2):
            b = open_by if side == 0 else -open_by
            # from centre to centre: towards + b, then towards - b
            first = towards + b + 0.5 * PI
            second = towards - b - 0.5 * PI
            u = wrap_angle(first - second)
            count = _arcs(work, count, code, (first, u, h - second), arrival)
            other = u - TWO_PI if u > 0.0 else u + TWO_PI
            count = _arcs(work, count, code, (first, other, h - second), arrival)
    sx = goal.x + math.sin(h)
    sy = goal.y - 1.0 - math.cos(h)
    square = sx * sx + sy * sy
    if square >= 4.0:
        code = word_code(image.left, STRAIGHT_LINE, image.right, UNUSED_PIECE, UNUSED_PIECE)
        line = math.sqrt(square - 4.0)
        towards = math.atan2(sy, sx)
        along = towards + math.atan2(2.0, line)
        count = _arcs(work, count, code, (along, line, along - h), arrival)
        along = towards + math.atan2(2.0, -line)
        count = _arcs(work, count, code, (along, -line, along - h), arrival)
    return count


def _arcs(work: PlanningWork, count: int, code: int, lengths: tuple[float, float, float], arrival: ArrivalState) -> int:
    """List a word of three segments with each outer arc driven forward, or in reverse the other way round."""
    t = wrap_angle(lengths[0])
    u = lengths[1]
    v = wrap_angle(lengths[2])
    t_other = t - TWO_PI if t > 0.0 else t + TWO_PI
    v_other = v - TWO_PI if v > 0.0 else v + TWO_PI
    count = _add(work, count, code, (t, u, v, 0.0, 0.0), arrival)
    count = _add(work, count, code, (t_other, u, v, 0.0, 0.0), arrival)
    count = _add(work, count, code, (t, u, v_other, 0.0, 0.0), arrival)
    return _add(work, count, code, (t_other, u, v_other, 0.0, 0.0), arrival)


def _more_pieces(work: PlanningWork, count: int, goal: Pose, image: WordSymmetry, arrival: ArrivalState) -> int:
    """List words of four and five segments: CCCC, CCSC, CSCC and CCSCC, equations 8.7 to 8.11 of the source."""
    h = goal.heading
    time = image.time
    px = goal.x + math.sin(h)
    py = goal.y - 1.0 - math.cos(h)
    square = px * px + py * py
    rho = 0.25 * (2.0 + math.sqrt(square))
    code = word_code(image.left, image.right, image.left, image.right, UNUSED_PIECE)
    if rho <= 1.0:
        u = math.acos(rho)
        t = _first_of_four(u, -u, px, py)
        v = wrap_angle(t - 2.0 * u - h)
        count = _add(work, count, code, (time * t, time * u, -time * u, time * v, 0.0), arrival)
    rho = (20.0 - square) / 16.0
    if 0.0 <= rho <= 1.0:
        u = -math.acos(rho)
        t = _first_of_four(u, u, px, py)
        v = wrap_angle(t - h)
        count = _add(work, count, code, (time * t, time * u, time * u, time * v, 0.0), arrival)
    if square >= 4.0:
        u = 4.0 - math.sqrt(square - 4.0)
        if u <= 0.0:
            t = wrap_angle(math.atan2((4.0 - u) * px - 2.0 * py, -2.0 * px + (u - 4.0) * py))
            v = wrap_angle(t - h)
            q = -0.5 * PI * time
            code = word_code(image.left, image.right, STRAIGHT_LINE, image.left, image.right)
            count = _add(work, count, code, (time * t, q, time * u, q, time * v), arrival)
    count = _four_with_line(work, count, goal, image, False, arrival)
    back_x = goal.x * math.cos(h) + goal.y * math.sin(h)
    back_y = goal.x * math.sin(h) - goal.y * math.cos(h)
    return _four_with_line(work, count, Pose(back_x, back_y, h), image, True, arrival)


def _four_with_line(
    work: PlanningWork, count: int, goal: Pose, image: WordSymmetry, backwards: bool, arrival: ArrivalState
) -> int:
    """List CCSC or, read backwards, CSCC."""
    h = goal.heading
    q = -0.5 * PI * image.time
    sx = goal.x - math.sin(h)
    sy = goal.y - 1.0 + math.cos(h)
    square = sx * sx + sy * sy
    if square >= 4.0:
        r = math.sqrt(square - 4.0)
        t = image.time * wrap_angle(math.atan2(sy, sx) + math.atan2(r, -2.0))
        u = image.time * (2.0 - r)
        v = image.time * wrap_angle(h - 0.5 * PI - t * image.time)
        if backwards:
            code = word_code(image.left, STRAIGHT_LINE, image.right, image.left, UNUSED_PIECE)
            count = _add(work, count, code, (v, u, q, t, 0.0), arrival)
        else:
            code = word_code(image.left, image.right, STRAIGHT_LINE, image.left, UNUSED_PIECE)
            count = _add(work, count, code, (t, q, u, v, 0.0), arrival)
    px = goal.x + math.sin(h)
    py = goal.y - 1.0 - math.cos(h)
    rho = math.sqrt(px * px + py * py)
    if rho >= 2.0:
        t = image.time * math.atan2(px, -py)
        u = image.time * (2.0 - rho)
        v = image.time * wrap_angle(t * image.time + 0.5 * PI - h)
        if backwards:
            code = word_code(image.right, STRAIGHT_LINE, image.right, image.left, UNUSED_PIECE)
            count = _add(work, count, code, (v, u, q, t, 0.0), arrival)
        else:
            code = word_code(image.left, image.right, STRAIGHT_LINE, image.right, UNUSED_PIECE)
            count = _add(work, count, code, (t, q, u, v, 0.0), arrival)
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
    work: PlanningWork, count: int, code: int, lengths: tuple[float, float, float, float, float], arrival: ArrivalState
) -> int:
    """List one word with its cost [m]: its length, changes of direction, and of the wheel."""
    gear = arrival.gear
    lock = arrival.lock
    cost = 0.0
    rest = code
    for number in range(5):
        distance = _without_tiny(lengths[number])
        turn = float(rest % 3 - 1)
        rest = rest // 3
        if distance != 0.0:
            direction = sign(distance)
            cost += abs(distance) * arrival.radius + abs(turn - lock) * STEERING_COST
            if direction * gear < 0.0:
                cost += CUSP_COST
            gear = direction
            lock = turn
    r = arrival.radius
    a, b, c, d, e = lengths
    set_word(
        work,
        count,
        code,
        cost,
        (_without_tiny(a) * r, _without_tiny(b) * r, _without_tiny(c) * r, _without_tiny(d) * r, _without_tiny(e) * r),
    )
    return count + 1


def _without_tiny(distance: float) -> float:
    return distance if abs(distance) > MIN_WORD_LENGTH else 0.0
