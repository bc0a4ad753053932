"""All short ways from one pose to another on free ground: words of arcs at full lock (L, R) and lines (S).

A car that may drive both ways gets from any pose to any other by at most five pieces (J. A. Reeds, L. A. Shepp,
"Optimal paths for a car that goes both forwards and backwards", Pacific J. Math. 145 (1990)); the shortest is among
48 words. What is best among obstacles, or with a price on each change of direction, need not be among them. So the
words of three pieces are listed in full here: every way to lay CSC and CCC, each arc driven forward or, the other way
round its circle, in reverse. Those of four and five pieces are Reeds' and Shepp's.

Lengths are in radii of the smallest circle, angles of an L positive to the left; forward positive.
"""

import math

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
    count = 0
    for side in range(2):
        mirror = 1.0 if side == 0 else -1.0
        count = _three_pieces(store, count, x, y * mirror, h * mirror, mirror, gear, lock, task)
        for way in range(2):
            time = 1.0 if way == 0 else -1.0
            count = _more_pieces(store, count, x * time, y * mirror, h * mirror * time, mirror, time, gear, lock, task)
    return count


def _three_pieces(
    store: PlanStore, count: int, x: float, y: float, h: float, mirror: float, gear: float, lock: float, task: Task
) -> int:
    """List LSL, LSR and LRL, or their mirror images."""
    left = LEFT if mirror > 0.0 else RIGHT
    right = RIGHT if mirror > 0.0 else LEFT
    sx = x - math.sin(h)
    sy = y - 1.0 + math.cos(h)
    apart = math.sqrt(sx * sx + sy * sy)
    towards = math.atan2(sy, sx)
    code = word_code(left, LINE, left, UNUSED, UNUSED)
    count = _arcs(store, count, code, towards, apart, h - towards, gear, lock, task)
    count = _arcs(store, count, code, towards + PI, -apart, h - towards - PI, gear, lock, task)
    if apart <= 4.0:
        code = word_code(left, right, left, UNUSED, UNUSED)
        open_by = math.acos(0.25 * apart)
        for side in range(2):
            b = open_by if side == 0 else -open_by
            # from centre to centre: towards + b, then towards - b
            first = towards + b + 0.5 * PI
            second = towards - b - 0.5 * PI
            u = wrap_angle(first - second)
            count = _arcs(store, count, code, first, u, h - second, gear, lock, task)
            other = u - TWO_PI if u > 0.0 else u + TWO_PI
            count = _arcs(store, count, code, first, other, h - second, gear, lock, task)
    sx = x + math.sin(h)
    sy = y - 1.0 - math.cos(h)
    square = sx * sx + sy * sy
    if square >= 4.0:
        code = word_code(left, LINE, right, UNUSED, UNUSED)
        line = math.sqrt(square - 4.0)
        towards = math.atan2(sy, sx)
        along = towards + math.atan2(2.0, line)
        count = _arcs(store, count, code, along, line, along - h, gear, lock, task)
        along = towards + math.atan2(2.0, -line)
        count = _arcs(store, count, code, along, -line, along - h, gear, lock, task)
    return count


def _arcs(
    store: PlanStore, count: int, code: int, t: float, u: float, v: float, gear: float, lock: float, task: Task
) -> int:
    """List a word of three pieces with its outer arcs driven either way round."""
    t = wrap_angle(t)
    v = wrap_angle(v)
    t_other = t - TWO_PI if t > 0.0 else t + TWO_PI
    v_other = v - TWO_PI if v > 0.0 else v + TWO_PI
    count = _add(store, count, code, t, u, v, 0.0, 0.0, gear, lock, task)
    count = _add(store, count, code, t_other, u, v, 0.0, 0.0, gear, lock, task)
    count = _add(store, count, code, t, u, v_other, 0.0, 0.0, gear, lock, task)
    return _add(store, count, code, t_other, u, v_other, 0.0, 0.0, gear, lock, task)


def _more_pieces(
    store: PlanStore,
    count: int,
    x: float,
    y: float,
    h: float,
    mirror: float,
    time: float,
    gear: float,
    lock: float,
    task: Task,
) -> int:
    """List words of four and five pieces: CCCC, CCSC, CSCC and CCSCC, equations 8.7 to 8.11 of the source."""
    left = LEFT if mirror > 0.0 else RIGHT
    right = RIGHT if mirror > 0.0 else LEFT
    px = x + math.sin(h)
    py = y - 1.0 - math.cos(h)
    square = px * px + py * py
    rho = 0.25 * (2.0 + math.sqrt(square))
    code = word_code(left, right, left, right, UNUSED)
    if rho <= 1.0:
        u = math.acos(rho)
        t = _first_of_four(u, -u, px, py)
        v = wrap_angle(t - 2.0 * u - h)
        count = _add(store, count, code, time * t, time * u, -time * u, time * v, 0.0, gear, lock, task)
    rho = (20.0 - square) / 16.0
    if 0.0 <= rho <= 1.0:
        u = -math.acos(rho)
        t = _first_of_four(u, u, px, py)
        v = wrap_angle(t - h)
        count = _add(store, count, code, time * t, time * u, time * u, time * v, 0.0, gear, lock, task)
    if square >= 4.0:
        u = 4.0 - math.sqrt(square - 4.0)
        if u <= 0.0:
            t = wrap_angle(math.atan2((4.0 - u) * px - 2.0 * py, -2.0 * px + (u - 4.0) * py))
            v = wrap_angle(t - h)
            q = -0.5 * PI * time
            code = word_code(left, right, LINE, left, right)
            count = _add(store, count, code, time * t, q, time * u, q, time * v, gear, lock, task)
    count = _four_with_line(store, count, x, y, h, left, right, time, False, gear, lock, task)
    back_x = x * math.cos(h) + y * math.sin(h)
    back_y = x * math.sin(h) - y * math.cos(h)
    return _four_with_line(store, count, back_x, back_y, h, left, right, time, True, gear, lock, task)


def _four_with_line(
    store: PlanStore,
    count: int,
    x: float,
    y: float,
    h: float,
    left: int,
    right: int,
    time: float,
    backwards: bool,
    gear: float,
    lock: float,
    task: Task,
) -> int:
    """List CCSC or, read backwards, CSCC."""
    q = -0.5 * PI * time
    sx = x - math.sin(h)
    sy = y - 1.0 + math.cos(h)
    square = sx * sx + sy * sy
    if square >= 4.0:
        r = math.sqrt(square - 4.0)
        t = time * wrap_angle(math.atan2(sy, sx) + math.atan2(r, -2.0))
        u = time * (2.0 - r)
        v = time * wrap_angle(h - 0.5 * PI - t * time)
        if backwards:
            code = word_code(left, LINE, right, left, UNUSED)
            count = _add(store, count, code, v, u, q, t, 0.0, gear, lock, task)
        else:
            code = word_code(left, right, LINE, left, UNUSED)
            count = _add(store, count, code, t, q, u, v, 0.0, gear, lock, task)
    px = x + math.sin(h)
    py = y - 1.0 - math.cos(h)
    rho = math.sqrt(px * px + py * py)
    if rho >= 2.0:
        t = time * math.atan2(px, -py)
        u = time * (2.0 - rho)
        v = time * wrap_angle(t * time + 0.5 * PI - h)
        if backwards:
            code = word_code(right, LINE, right, left, UNUSED)
            count = _add(store, count, code, v, u, q, t, 0.0, gear, lock, task)
        else:
            code = word_code(left, right, LINE, right, UNUSED)
            count = _add(store, count, code, t, q, u, v, 0.0, gear, lock, task)
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
    store: PlanStore,
    count: int,
    code: int,
    a: float,
    b: float,
    c: float,
    d: float,
    e: float,
    gear: float,
    lock: float,
    task: Task,
) -> int:
    """List one word with its cost [m]: its length, changes of direction, and of the wheel."""
    ways = (_whole(a), _whole(b), _whole(c), _whole(d), _whole(e))
    radius = 1.0 / task.car.curvature
    cost = 0.0
    rest = code
    for number in range(5):
        way = ways[number]
        turn = float(rest % 3 - 1)
        rest = rest // 3
        if way != 0.0:
            direction = sign(way)
            cost += abs(way) * radius + abs(turn - lock) * STEER
            if direction * gear < 0.0:
                cost += CUSP
            gear = direction
            lock = turn
    put_word(
        store,
        count,
        code,
        cost,
        ways[0] * radius,
        ways[1] * radius,
        ways[2] * radius,
        ways[3] * radius,
        ways[4] * radius,
    )
    return count + 1


def _whole(way: float) -> float:
    return way if abs(way) > TINY else 0.0
