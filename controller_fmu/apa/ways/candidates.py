"""One candidate each: the first move of a way into the slot, how many moves in all, and what it costs."""

import math
from typing import NamedTuple

from controller_fmu.apa.outline import Shape
from controller_fmu.apa.slot import Site
from controller_fmu.apa.ways.exit import Exit
from controller_fmu.apa.ways.move import Move, end_of, is_move_free, length_of
from controller_fmu.apa.ways.shuffle import finish, full_lock
from controller_fmu.apa.ways.turns import forward_turn, reverse_s, reverse_turn, straight_move, turn_of, two_arcs
from modelkit.maths import sign
from modelkit.vocabulary import Pose

PREFIX_STEP = 0.25
REVERSE_PREFIXES = 41
STRAIGHT_PREFIXES = 32
BENT_PREFIXES = 16
BENT_S_PREFIXES = 8
FORWARD_PREFIXES = 88
BACK_WAYS = 16
SWING_WAYS = 13
SWING_ANGLES = 13
SHARES = 4
FINER = 2
"""A turn to be driven next is tried with so many times the radii of one that comes after other moves."""
BESIDE = 0.02
"""It may end so far [m] beside the slot's axis, on either side."""
BESIDES = 3
BESIDE_COST = 50.0
TURNS = BESIDES * (FINER * (SHARES - 1) + 1)
SHORTEST_LINE = 0.15
"""A turn after other moves should have lines of this length [m] before and behind it, for what they miss."""
LINE_COST = 20.0
PARTS = (1.0, 0.5, 1.0, 0.5, 1.0, 0.75, 0.25, 0.75)
CHOICES = 8
FEW_CHOICES = 4
ALL_CHOICES_UP_TO = 3
FEW_CHOICES_UP_TO = 4
ASIDES = 3
ASIDE = 0.008
ASIDE_COST = 10.0
LEAST_TURN = 1.0 * math.pi / 180.0
OFF_CENTRE_COST = 2.0


class Candidate(NamedTuple):
    """A first move and the price of the whole way."""

    found: bool
    move: Move
    moves: int
    """Moves in all; the first one counts."""
    cost: float
    """Way in all [m], and what else is not liked."""


def none_from(start: Pose) -> Candidate:
    """Return that there is nothing."""
    return Candidate(False, Move(start), 0, 0.0)


def into_parallel(start: Pose, number: int, way_in: Exit, site: Site, car: Shape) -> Candidate:
    """Return the reverse into a parallel slot, straight back at first, or after a move before it."""
    turn = turn_of(car.curvature, car.curvature, car.ramp)
    if number < REVERSE_PREFIXES:
        straight = PREFIX_STEP * number
        move = reverse_s(start, way_in.pose, straight, turn, turn)
        good = move.direction != 0 and is_move_free(move, car, site.obstacles)
        return Candidate(good, move, 1 + way_in.moves, length_of(move))
    ahead = _before(start, number - REVERSE_PREFIXES, car)
    after = reverse_s(end_of(ahead), way_in.pose, 0.0, turn, turn)
    good = (
        after.direction != 0 and is_move_free(ahead, car, site.obstacles) and is_move_free(after, car, site.obstacles)
    )
    return Candidate(good, ahead, 2 + way_in.moves, length_of(ahead) + length_of(after))


def _before(start: Pose, number: int, car: Shape) -> Move:
    """Return a move before the reverse: forward straight, bent to the left, or to the left and back to the
    same heading; or straight back, with the wheel turned at standstill after it.
    """
    if number < STRAIGHT_PREFIXES:
        return straight_move(start, 1, PREFIX_STEP * (number + 1))
    way = 2.0 * PREFIX_STEP * (number - STRAIGHT_PREFIXES + 1)
    if number < STRAIGHT_PREFIXES + BENT_PREFIXES:
        return two_arcs(start, 1, 0.4 * car.curvature, way, 0.0, 0.0)
    way = way - 2.0 * PREFIX_STEP * BENT_PREFIXES
    if number < STRAIGHT_PREFIXES + BENT_PREFIXES + BENT_S_PREFIXES:
        return two_arcs(start, 1, 0.6 * car.curvature, way, way, 0.0)
    way = PREFIX_STEP * (number - STRAIGHT_PREFIXES - BENT_PREFIXES - BENT_S_PREFIXES + 1)
    return straight_move(start, -1, way)


def turn_in(start: Pose, number: int, site: Site, car: Shape) -> Candidate:
    """Return the reverse line, arc, line into a perpendicular slot, at 1 to 0.55 of the lock, on its axis or beside."""
    share = number // BESIDES
    aside = BESIDE * (number % BESIDES - 1)
    return _turn_beside(start, share * (1.0 / FINER), aside, site, car)


def _turn_beside(start: Pose, share: float, aside: float, site: Site, car: Shape) -> Candidate:
    turn = turn_of((1.0 - 0.15 * share) * car.curvature, car.curvature, car.ramp)
    move = reverse_turn(start._replace(y=start.y - aside), turn)._replace(start=start)
    good = move.direction != 0 and is_move_free(move, car, site.obstacles)
    return Candidate(good, move, 1, length_of(move) + BESIDE_COST * abs(aside))


def into_perpendicular(start: Pose, share: int, site: Site, car: Shape) -> Candidate:
    """Return the same after other moves, at 1, 0.85, 0.7 or 0.55 of the lock; dearer with lines that are too short."""
    after = _turn_beside(start, float(share), 0.0, site, car)
    lack = 0.0
    for line in (after.move.pieces[0].length, after.move.pieces[4].length):
        lack += max(0.0, SHORTEST_LINE - line)
    return after._replace(cost=after.cost + LINE_COST * lack)


def swing(start: Pose, number: int, site: Site, car: Shape) -> Candidate:
    """Return the move forward and to the left from which :func:`into_perpendicular` leads in."""
    share = number % 2
    angle = (number // 2) % SWING_ANGLES
    ahead = number // (2 * SWING_ANGLES)
    gentle = turn_of((1.0 - 0.2 * share) * car.curvature, car.curvature, car.ramp)
    move = forward_turn(start, 0.5 * ahead, 2.0 * gentle.angle + angle * 5.0 * math.pi / 180.0, gentle)
    none = Candidate(False, move, 2, 0.0)
    if move.direction == 0:
        return none
    after = into_perpendicular(end_of(move), 2 * share, site, car)
    if not after.found or not is_move_free(move, car, site.obstacles):
        return none
    return Candidate(True, move, 2, length_of(move) + after.cost)


def back_and_forth(start: Pose, number: int, site: Site, car: Shape) -> Candidate:
    """Return the reverse at full lock to the right that, after one forward to the left, leads in."""
    back = full_lock(start, -1, -1.0, 1.5 * (1 + number % 4), site, car)
    if back.direction == 0:
        return none_from(start)
    ahead = full_lock(end_of(back), 1, 1.0, 1.0 * (1 + (number // 4) % 5), site, car)
    if ahead.direction == 0:
        return none_from(start)
    after = into_perpendicular(end_of(ahead), number // 20, site, car)
    return Candidate(after.found, back, 3, length_of(back) + length_of(ahead) + after.cost)


def back_and_swing(start: Pose, number: int, site: Site, car: Shape) -> Candidate:
    """Return the reverse, straight or a little bent, from which :func:`swing` at once leads in."""
    k = 0.35 * car.curvature * (number % 3 - 1)
    back = two_arcs(start, -1, k, 0.5 * (1 + (number // 3) % BACK_WAYS), 0.0, 0.0)
    after = swing(end_of(back), number // (3 * BACK_WAYS), site, car)
    good = after.found and is_move_free(back, car, site.obstacles)
    return Candidate(good, back, 3, length_of(back) + after.cost)


def ahead_back_and_swing(start: Pose, number: int, site: Site, car: Shape) -> Candidate:
    """Return the straight move forward from which :func:`back_and_swing` leads in."""
    ahead = straight_move(start, 1, 1.5 * (1 + number % 4))
    if not is_move_free(ahead, car, site.obstacles):
        return none_from(start)
    after = back_and_swing(end_of(ahead), number // 4, site, car)
    return Candidate(after.found, ahead, 4, length_of(ahead) + after.cost)


def swing_back_and_forth(start: Pose, number: int, site: Site, car: Shape) -> Candidate:
    """Return the move forward to the left from which :func:`back_and_forth` leads in."""
    full = turn_of(car.curvature, car.curvature, car.ramp)
    ahead = 1.0 * (number % 5)
    angle = 2.0 * full.angle + ((number // 5) % 4) * 12.0 * math.pi / 180.0
    move = forward_turn(start, ahead, angle, full)
    if move.direction == 0 or not is_move_free(move, car, site.obstacles):
        return none_from(start)
    after = back_and_forth(end_of(move), number // 20, site, car)
    return Candidate(after.found, move, 4, length_of(move) + after.cost)


def inside_count(moves: int) -> int:
    """Return how many candidates :func:`inside` has for this number of moves."""
    count = 4 * ASIDES
    for _ in range(moves - 1):
        count = count * choices(moves)
    return count


def choices(moves: int) -> int:
    """Return how many ways there are to drive each move but the last: fewer where there are many moves."""
    return CHOICES if moves <= ALL_CHOICES_UP_TO else FEW_CHOICES if moves <= FEW_CHOICES_UP_TO else 1


def inside(start: Pose, number: int, moves: int, site: Site, car: Shape) -> Candidate:
    """Return the first of ``moves`` short moves in the slot, of which the last ends as wished.

    Each but the last is an arc at full lock, to lessen the heading or the other way, as far as nothing
    is near or a part of that. The last ends on the slot's axis, or a little to a side of it.
    """
    direction = 1 if number % 2 == 0 else -1
    sense = 1.0 if (number // 2) % 2 == 0 else -1.0
    aside = ASIDE * ((number // 4) % ASIDES - 1)
    rest = number // (4 * ASIDES)
    most = choices(moves)
    pose = start
    way = 0.0
    first = Move(start)
    for step in range(moves - 1):
        move = _inside_step(pose, direction, _last_digit(rest, most), site, car)
        rest = rest // most
        if move.direction == 0:
            return none_from(start)
        if step == 0:
            first = move
        pose = end_of(move)
        way += length_of(move)
        direction = -direction
    last = finish(pose, direction, sense, aside, site, car)
    if moves == 1:
        first = last.move
    cost = way + length_of(last.move) + OFF_CENTRE_COST * last.off_centre + ASIDE_COST * abs(aside)
    return Candidate(last.found, first, moves, cost)


def _last_digit(number: int, base: int) -> int:
    return number % base


def _inside_step(pose: Pose, direction: int, choice: int, site: Site, car: Shape) -> Move:
    """Return an arc at full lock. Choices: to heading 0, half of what is free, all and half of it the other
    way; then all, 3/4 and 1/4 of it, and 3/4 the other way.
    """
    turned = abs(pose.heading) > LEAST_TURN
    lessening = -sign(pose.heading) * direction if turned else 1.0
    other = choice == 2 or choice == 3 or choice == 7
    sense = -lessening if other else lessening
    longest = 4.0
    if turned and choice == 0:
        longest = abs(pose.heading) / car.curvature
    move = full_lock(pose, direction, sense, longest, site, car)
    part = PARTS[choice]
    if part < 1.0 and move.direction != 0:
        return full_lock(pose, direction, sense, part * length_of(move), site, car)
    return move
