"""All short ways from one pose to another on free ground: words of arcs at full lock (L, R) and lines (S).

A car that may drive both ways gets from any pose to any other by at most five pieces (J. A. Reeds, L. A. Shepp,
"Optimal paths for a car that goes both forwards and backwards", Pacific J. Math. 145 (1990)); the shortest is among
48 words. What is best among obstacles, or with a price on each change of direction, need not be among them. So the
words of three pieces are listed in full here: every way to lay CSC and CCC, each arc driven forward or, the other way
round its circle, in reverse. Those of four and five pieces are Reeds' and Shepp's.

Lengths are in radii of the smallest circle, angles of an L positive to the left; forward positive.
"""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import PlanStore, put_word
from controller_fmu.planning.task import CUSP, STEER, Task
from modelkit.maths import PI, TWO_PI, sign, wrap_angle
from modelkit.vocabulary import Pose

LEFT = 2
LINE = 1
RIGHT = 0
UNUSED = 1
TINY = 1e-6
"""A piece shorter than this, in radii, is left out."""


def word_code(a: int, b: int, c: int, d: int, e: int) -> int:
    """Return the turns of five pieces as one number."""
    return a + 3 * (b + 3 * (c + 3 * (d + 3 * e)))


def turn_of(code: int, piece: int) -> float:
    """Return 1.0, 0.0 or -1.0: the turn of a word's piece, left positive."""
    for _ in range(piece):
        code = code // 3
    return float(code % 3 - 1)


class Arrival(NamedTuple):
    """How the car comes to the start of a word: what the first change of direction and of the wheel are priced by."""

    gear: float
    """1.0, -1.0; 0.0: none."""
    lock: float
    """-1.0 to 1.0."""
    radius: float
    """Of the smallest circle [m]."""


class Symmetry(NamedTuple):
    """One of the four images of a word: mirrored or not, driven forward or in reverse."""

    left: int
    right: int
    time: float
    """1.0, or -1.0: each piece the other way."""


def list_words(store: PlanStore, start: Pose, end: Pose, gear: float, lock: float, task: Task) -> int:
    """List the words from ``start`` to ``end`` with their costs; returns how many.

    ``gear`` (1.0, -1.0; 0.0: none) and ``lock`` (-1.0 to 1.0) are those the car arrives with at ``start``.
    """
    k = task.car.curvature
    cos = math.cos(start.heading)
    sin = math.sin(start.heading)
    dx = (end.x - start.x) * k
    dy = (end.y - start.y) * k
    x = dx * cos + dy * sin
    y = dy * cos - dx * sin
    h = end.heading - start.heading
    arrival = Arrival(gear, lock, 1.0 / k)
    count = 0
    for side in range(2):
        mirror = 1.0 if side == 0 else -1.0
        left = LEFT if side == 0 else RIGHT
        right = RIGHT if side == 0 else LEFT
        goal = Pose(x, y * mirror, h * mirror)
        count = _three_pieces(store, count, goal, Symmetry(left, right, 1.0), arrival)
        for way in range(2):
            time = 1.0 if way == 0 else -1.0
            goal = Pose(x * time, y * mirror, h * mirror * time)
            count = _more_pieces(store, count, goal, Symmetry(left, right, time), arrival)
    return count


def _three_pieces(store: PlanStore, count: int, goal: Pose, image: Symmetry, arrival: Arrival) -> int:
    """List LSL, LSR and LRL, or their mirror images."""
    h = goal.heading
    sx = goal.x - math.sin(h)
    sy = goal.y - 1.0 + math.cos(h)
    apart = math.sqrt(sx * sx + sy * sy)
    towards = math.atan2(sy, sx)
    code = word_code(image.left, LINE, image.left, UNUSED, UNUSED)
    count = _arcs(store, count, code, (towards, apart, h - towards), arrival)
    count = _arcs(store, count, code, (towards + PI, -apart, h - towards - PI), arrival)
    if apart <= 4.0:
        code = word_code(image.left, image.right, image.left, UNUSED, UNUSED)
        open_by = math.acos(0.25 * apart)
        for side in range(2):
            b = open_by if side == 0 else -open_by
            # from centre to centre: towards + b, then towards - b
            first = towards + b + 0.5 * PI
            second = towards - b - 0.5 * PI
            u = wrap_angle(first - second)
            count = _arcs(store, count, code, (first, u, h - second), arrival)
            other = u - TWO_PI if u > 0.0 else u + TWO_PI
            count = _arcs(store, count, code, (first, other, h - second), arrival)
    sx = goal.x + math.sin(h)
    sy = goal.y - 1.0 - math.cos(h)
    square = sx * sx + sy * sy
    if square >= 4.0:
        code = word_code(image.left, LINE, image.right, UNUSED, UNUSED)
        line = math.sqrt(square - 4.0)
        towards = math.atan2(sy, sx)
        along = towards + math.atan2(2.0, line)
        count = _arcs(store, count, code, (along, line, along - h), arrival)
        along = towards + math.atan2(2.0, -line)
        count = _arcs(store, count, code, (along, -line, along - h), arrival)
    return count


def _arcs(store: PlanStore, count: int, code: int, ways: tuple[float, float, float], arrival: Arrival) -> int:
    """List a word of three pieces with its outer arcs driven either way round."""
    t = wrap_angle(ways[0])
    u = ways[1]
    v = wrap_angle(ways[2])
    t_other = t - TWO_PI if t > 0.0 else t + TWO_PI
    v_other = v - TWO_PI if v > 0.0 else v + TWO_PI
    count = _add(store, count, code, (t, u, v, 0.0, 0.0), arrival)
    count = _add(store, count, code, (t_other, u, v, 0.0, 0.0), arrival)
    count = _add(store, count, code, (t, u, v_other, 0.0, 0.0), arrival)
    return _add(store, count, code, (t_other, u, v_other, 0.0, 0.0), arrival)


def _more_pieces(store: PlanStore, count: int, goal: Pose, image: Symmetry, arrival: Arrival) -> int:
    """List words of four and five pieces: CCCC, CCSC, CSCC and CCSCC, equations 8.7 to 8.11 of the source."""
    h = goal.heading
    time = image.time
    px = goal.x + math.sin(h)
    py = goal.y - 1.0 - math.cos(h)
    square = px * px + py * py
    rho = 0.25 * (2.0 + math.sqrt(square))
    code = word_code(image.left, image.right, image.left, image.right, UNUSED)
    if rho <= 1.0:
        u = math.acos(rho)
        t = _first_of_four(u, -u, px, py)
        v = wrap_angle(t - 2.0 * u - h)
        count = _add(store, count, code, (time * t, time * u, -time * u, time * v, 0.0), arrival)
    rho = (20.0 - square) / 16.0
    if 0.0 <= rho <= 1.0:
        u = -math.acos(rho)
        t = _first_of_four(u, u, px, py)
        v = wrap_angle(t - h)
        count = _add(store, count, code, (time * t, time * u, time * u, time * v, 0.0), arrival)
    if square >= 4.0:
        u = 4.0 - math.sqrt(square - 4.0)
        if u <= 0.0:
            t = wrap_angle(math.atan2((4.0 - u) * px - 2.0 * py, -2.0 * px + (u - 4.0) * py))
            v = wrap_angle(t - h)
            q = -0.5 * PI * time
            code = word_code(image.left, image.right, LINE, image.left, image.right)
            count = _add(store, count, code, (time * t, q, time * u, q, time * v), arrival)
    count = _four_with_line(store, count, goal, image, False, arrival)
    back_x = goal.x * math.cos(h) + goal.y * math.sin(h)
    back_y = goal.x * math.sin(h) - goal.y * math.cos(h)
    return _four_with_line(store, count, Pose(back_x, back_y, h), image, True, arrival)


def _four_with_line(
    store: PlanStore, count: int, goal: Pose, image: Symmetry, backwards: bool, arrival: Arrival
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
            code = word_code(image.left, LINE, image.right, image.left, UNUSED)
            count = _add(store, count, code, (v, u, q, t, 0.0), arrival)
        else:
            code = word_code(image.left, image.right, LINE, image.left, UNUSED)
            count = _add(store, count, code, (t, q, u, v, 0.0), arrival)
    px = goal.x + math.sin(h)
    py = goal.y - 1.0 - math.cos(h)
    rho = math.sqrt(px * px + py * py)
    if rho >= 2.0:
        t = image.time * math.atan2(px, -py)
        u = image.time * (2.0 - rho)
        v = image.time * wrap_angle(t * image.time + 0.5 * PI - h)
        if backwards:
            code = word_code(image.right, LINE, image.right, image.left, UNUSED)
            count = _add(store, count, code, (v, u, q, t, 0.0), arrival)
        else:
            code = word_code(image.left, image.right, LINE, image.right, UNUSED)
            count = _add(store, count, code, (t, q, u, v, 0.0), arrival)
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
    store: PlanStore, count: int, code: int, ways: tuple[float, float, float, float, float], arrival: Arrival
) -> int:
    """List one word with its cost [m]: its length, changes of direction, and of the wheel."""
    gear = arrival.gear
    lock = arrival.lock
    cost = 0.0
    rest = code
    for number in range(5):
        way = _whole(ways[number])
        turn = float(rest % 3 - 1)
        rest = rest // 3
        if way != 0.0:
            direction = sign(way)
            cost += abs(way) * arrival.radius + abs(turn - lock) * STEER
            if direction * gear < 0.0:
                cost += CUSP
            gear = direction
            lock = turn
    r = arrival.radius
    a, b, c, d, e = ways
    put_word(store, count, code, cost, (_whole(a) * r, _whole(b) * r, _whole(c) * r, _whole(d) * r, _whole(e) * r))
    return count + 1


def _whole(way: float) -> float:
    return way if abs(way) > TINY else 0.0
