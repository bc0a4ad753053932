"""The moves that a way out is made of, each as far as nothing is near, and when the car is out.

In the target's frame a slot along the road lies at y < 0 and the car turns to the left; out of one across the road it
drives ahead and turns to the left, too. Forward to the left and back to the right both turn the car to the road.
"""

from controller_fmu.apa.outline import CREPT, Obstacles, Shape, clearance, outline_rate, sure_steps
from controller_fmu.apa.slot import Kind, Site
from controller_fmu.apa.ways.move import NO_PIECE, Move, Piece
from controller_fmu.apa.ways.turns import two_arcs
from controller_fmu.common.curve import advance
from modelkit.vocabulary import Pose

CLEAR = 4.0
"""So far [m] straight ahead nothing of the slot may stand when the car is handed over."""
TURNED = 1.0
"""Out of a slot across the road the car has turned by so much [rad] to the side it goes to."""
STEEPEST = 1.2
ROUND = 1.75
"""Turned the farthest [rad] out of a slot along the road, and across."""
LONGEST = 3.0
LONGEST_OUT = 10.0
STEP = 0.025
"""The car is looked at each so much [m] of a move."""
NO_WAY = Move()
ARCS = (1.0, 0.5, 0.25, 0.0)
"""Curvature of a move over the largest."""
ASIDE = (1.0, 0.5)
"""The same of moves of two arcs that lead aside, the heading as before."""
HALVES = (1.2, 0.8, 0.5, 0.35, 0.25, 0.18, 0.12)
"""Lengths [m] of such an arc."""
LINES = 12
LINE = 0.3
"""Out of a slot across the road the car drives straight so many times so far [m] before it turns."""
CHOICES = len(ARCS) + len(ASIDE) + LINES


def is_out(pose: Pose, site: Site, car: Shape) -> bool:
    """Return whether a car at ``pose`` could drive straight on, out of the slot."""
    far = car._replace(front=car.front + CLEAR)
    if site.kind == Kind.PERPENDICULAR:
        return pose.heading >= TURNED and clearance(pose, far, site.obstacles, 0.0) > 0.0
    return clearance(pose, far, Obstacles(ahead=site.obstacles.ahead), 0.0) > 0.0


def last_move(pose: Pose, site: Site, car: Shape) -> Move:
    """Return the move forward at full lock, or straight and then at full lock, that ends out of the slot."""
    if site.kind != Kind.PERPENDICULAR:
        return _out_after(pose, 0.0, site, car)
    for number in range(LINES):
        move = _out_after(pose, LINE * number, site, car)
        if move.direction != 0:
            return move
    return NO_WAY


def next_move(pose: Pose, direction: int, number: int, site: Site, car: Shape) -> Move:
    """Return a move from ``pose`` as far as nothing is near; ``NO_WAY`` or one of no length if there is none."""
    if number < len(ARCS):
        c = direction * ARCS[number] * car.curvature
        return _move(pose, direction, (0.0, free_out(pose, direction, c, LONGEST, car, site.obstacles)), c)
    if number < len(ARCS) + len(ASIDE):
        return _aside(pose, ASIDE[number - len(ARCS)], site, car) if direction > 0 else NO_WAY
    if direction < 0 or site.kind != Kind.PERPENDICULAR:
        return NO_WAY
    line = LINE * (number - len(ARCS) - len(ASIDE) + 1)
    if free_out(pose, 1, 0.0, line, car, site.obstacles) < line:
        return NO_WAY
    there = advance(pose, 1.0, line, 0.0, 0.0)
    return _move(pose, 1, (line, free_out(there, 1, car.curvature, LONGEST_OUT, car, site.obstacles)), car.curvature)


def free_out(pose: Pose, direction: int, c: float, longest: float, car: Shape, obstacles: Obstacles) -> float:
    """Return how far [m] the car can drive at curvature ``c``; where it begins within a margin it may leave that."""
    gap = clearance(pose, car, obstacles, CREPT)
    least = gap - CREPT if gap <= 0.0 else 0.0
    moved = STEP * outline_rate(c, car)
    way = 0.0
    sure = 0
    while way < longest:
        further = min(way + STEP, longest)
        if sure > 0:
            sure -= 1
        else:
            gap = clearance(advance(pose, float(direction), further, c, c), car, obstacles, CREPT)
            if gap <= least:
                return way
            least = max(least, gap - CREPT) if gap <= 0.0 else 0.0
            sure = sure_steps(gap, moved)
        way = further
    return longest


def _move(pose: Pose, direction: int, ways: tuple[float, float], c: float) -> Move:
    """Return a line and an arc of curvature ``c``, both of these lengths [m]."""
    line, arc = ways
    pieces = (Piece(line, 0.0, 0.0), Piece(arc, c, c), NO_PIECE, NO_PIECE, NO_PIECE, NO_PIECE, NO_PIECE)
    return Move(pose, direction, pieces)


def _aside(pose: Pose, share: float, site: Site, car: Shape) -> Move:
    """Return the longest move forward of an arc to the left and one to the right, each of this share of the lock."""
    c = share * car.curvature
    for half in HALVES:
        if free_out(pose, 1, c, half, car, site.obstacles) >= half:
            there = advance(pose, 1.0, half, c, c)
            if free_out(there, 1, -c, half, car, site.obstacles) >= half:
                return two_arcs(pose, 1, c, half, half, 0.0)
    return NO_WAY


def _out_after(pose: Pose, line: float, site: Site, car: Shape) -> Move:
    """Return the move of a line [m] and an arc to the left that ends where the car is out, if that can be driven."""
    if line > 0.0 and free_out(pose, 1, 0.0, line, car, site.obstacles) < line:
        return NO_WAY
    begin = advance(pose, 1.0, line, 0.0, 0.0)
    c = car.curvature
    most = ROUND if site.kind == Kind.PERPENDICULAR else STEEPEST
    free = free_out(begin, 1, c, min(LONGEST_OUT, max(0.0, most - begin.heading) / c), car, site.obstacles)
    way = STEP
    while way <= free:
        if is_out(advance(begin, 1.0, way, c, c), site, car):
            return _move(pose, 1, (line, way), c)
        way += STEP
    return NO_WAY
