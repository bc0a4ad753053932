"""The path found, with curvature transitions: the vehicle turns its wheel while it drives, also about a stop.

Where the curvature jumps, the front wheels turn at their rate for as long as that takes: at speed within a gear, else
while the vehicle slows down to a stop and while it sets out again. A transition is a row of short arcs of equal
duration. Then the lengths of the pieces between are solved, so that the path still ends at the goal: Newton's method,
least squares of changes in proportion to the lengths. A transition is shortened where a piece would have no length
left, or the outline would come too near to an obstacle.
"""

import math
from typing import NamedTuple

from controller_fmu.planning.clearance import clearance, sweep
from controller_fmu.planning.plan_store import (
    JOINT,
    KEPT_COUNT,
    KEPT_MARGIN,
    PIECE_COUNT,
    SLICES,
    PlanStore,
    put_arc_curvature,
    put_kept,
    put_kept_speed,
    put_mark,
    put_piece,
    put_piece_speed,
    put_piece_way,
    put_share,
)
from controller_fmu.planning.task import Dynamics, Request, Task, drive
from modelkit.maths import clamp, sign, wrap_angle
from modelkit.vocabulary import Pose

MAX_SLICES, MIN_SLICES = 4, 2
"""Arcs of a transition on one side of a stop; half as many on one side of a joint in one gear."""
MAX_ITERATIONS = 10
KEPT_SHARE = 0.8
"""Share of the margin that a path with transitions keeps."""
SHORTER = 0.5
"""A transition that does not fit is shortened by this factor ..."""
MIN_SHARE, MIN_SHARE_IN_GEAR = 0.25, 0.5
"""... and left out if less than this is left of it; a ramp beside the path is as good in one gear."""
LESS_BENT = 0.6
"""A piece that is too short for its transitions is bent less by this factor ..."""
MIN_BEND = 0.3
"""... but no less than this share of its curvature."""
MIN_ARC = 0.01
"""Least length [m] of an arc or a line between two transitions."""
CONVERGED = 1e-8
"""Distance [m] and heading [rad] that the path's end may be off the goal."""
SAME = 1e-6
"""Curvatures nearer than this [1/m] are one."""
SINGULAR = 1e-6
"""Least determinant, as a share of what it is of directions at right angles."""
SOLVED = -1
UNSOLVED = -2
ALL_JOINTS = -1
NO_JOINT = -2


class Transition(NamedTuple):
    """How the front wheels turn about the begin of a piece."""

    stops: bool = False
    angle_before: float = 0.0
    """[rad]"""
    angle_after: float = 0.0
    early: float = 0.0
    """Time [s] for which they turn before the begin of the piece."""
    late: float = 0.0
    """And behind it."""
    speed: float = 0.0
    """Largest speed [m/s]."""


def begin_transitions(store: PlanStore, request: Request, most: int) -> bool:
    """Wish for all transitions in full; returns whether the path, of at most ``most`` pieces, can have any."""
    count = store.mark[KEPT_COUNT]
    put_mark(store, JOINT, ALL_JOINTS)
    put_mark(store, SLICES, MAX_SLICES)
    for joint in range(count + 1):
        put_share(store, joint, 1.0)
    _unbend(store, request.dynamics)
    if request.dynamics.rate <= 0.0 or count < 3:
        return False
    while store.mark[SLICES] > MIN_SLICES and _pieces_with(store, request.dynamics) > most:
        put_mark(store, SLICES, store.mark[SLICES] - 1)
    return True


def try_transitions(store: PlanStore, request: Request, task: Task, most: int) -> bool:
    """Try all transitions, or one more; returns whether there is more to try, else the path has those that fit.

    If not all of them fit, one is tried after the other, if the path fits with what tracking needs of the lock: first
    those about a stop, where the vehicle would stand for as long as the wheel turns.
    """
    joints = store.mark[KEPT_COUNT] + 1
    fits = _fit(store, request, task, most)
    number = store.mark[JOINT]
    if number == ALL_JOINTS:
        if fits:
            _keep(store)
            return False
        for joint in range(joints):
            put_share(store, joint, 0.0)
        put_mark(store, JOINT, NO_JOINT)
        return True
    if number == NO_JOINT:
        if not fits:
            return False
        number = 0
    elif not fits:
        joint = number % joints
        share = SHORTER * store.joint_share[joint]
        least = MIN_SHARE if number < joints else MIN_SHARE_IN_GEAR
        put_share(store, joint, share if share >= least else 0.0)
        number = number if share >= least else number + 1
    else:
        number += 1
    while number < 2 * joints and not _is_worth(store, number, joints):
        number += 1
    put_mark(store, JOINT, number)
    if number < 2 * joints:
        if store.joint_share[number % joints] <= 0.0:
            put_share(store, number % joints, 1.0)
        return True
    fits = _fit(store, request, task, most)
    if fits:
        _keep(store)
    return False


def _is_worth(store: PlanStore, number: int, joints: int) -> bool:
    """Return whether a transition is to be tried: in a first round those about a stop, in a second one the others."""
    joint = number % joints
    k0 = store.kept_k[joint - 1] if joint > 0 else 0.0
    k1 = store.kept_k[joint] if joint + 1 < joints else 0.0
    return abs(k1 - k0) >= SAME and _stops_at(store, joint) == (number < joints)


def _stops_at(store: PlanStore, joint: int) -> bool:
    """Return whether the vehicle stands where a piece begins."""
    if joint == 0 or joint == store.mark[KEPT_COUNT]:
        return True
    return store.kept_way[joint - 1] * store.kept_way[joint] < 0.0


def _fit(store: PlanStore, request: Request, task: Task, most: int) -> bool:
    """Lay out the path with the transitions wished for; returns whether it fits.

    Pieces too short for their transitions are bent less.
    """
    _unbend(store, request.dynamics)
    if _pieces_with(store, request.dynamics) > most:
        return False
    start = Pose(request.start.x - request.goal.x, request.start.y - request.goal.y, request.start.heading)
    short = _solve(store, start, request.goal.heading, request.dynamics)
    while short >= 0:
        if abs(store.arc_k[short]) <= MIN_BEND * abs(store.kept_k[short]):
            return False
        put_arc_curvature(store, short, LESS_BENT * store.arc_k[short])
        short = _solve(store, start, request.goal.heading, request.dynamics)
    return short == SOLVED and _is_free(store, task._replace(margin=KEPT_SHARE * store.measure[KEPT_MARGIN]))


def _unbend(store: PlanStore, dynamics: Dynamics) -> None:
    """Give all pieces the curvature that they were found with, but for what tracking needs of the lock."""
    for piece in range(store.mark[KEPT_COUNT]):
        put_arc_curvature(store, piece, clamp(store.kept_k[piece], -dynamics.curvature, dynamics.curvature))


def _pieces_with(store: PlanStore, dynamics: Dynamics) -> int:
    """Return how many pieces the path has with its transitions."""
    pieces = store.mark[KEPT_COUNT]
    for joint in range(store.mark[KEPT_COUNT] + 1):
        transition = _transition(store, joint, dynamics)
        pieces += _slices(store, transition.stops, transition.early) + _slices(store, transition.stops, transition.late)
    return pieces


def _slices(store: PlanStore, stops: bool, time: float) -> int:
    """Return the number of arcs on one side of a transition."""
    if time <= 0.0:
        return 0
    return store.mark[SLICES] if stops else store.mark[SLICES] // 2


def _transition(store: PlanStore, joint: int, dynamics: Dynamics) -> Transition:
    """Return the transition about the begin of a piece; of the number of pieces: that at the end.

    A share of it in one gear is driven at that share of the speed. About a stop it is that share of the turn: the wheel
    turns longer where the vehicle slows down than where it sets out, by the root of the accelerations, as the same
    way costs the same time there.
    """
    count = store.mark[KEPT_COUNT]
    k0 = store.arc_k[joint - 1] if joint > 0 else 0.0
    k1 = store.arc_k[joint] if joint < count else 0.0
    before = math.atan(dynamics.wheelbase * k0)
    after = math.atan(dynamics.wheelbase * k1)
    ends = joint == 0 or joint == count
    stops = _stops_at(store, joint)
    share = store.joint_share[joint]
    if abs(k1 - k0) < SAME or share <= 0.0:
        return Transition(stops, before, after)
    time = abs(after - before) / dynamics.rate
    if not stops:
        return Transition(stops, before, after, 0.5 * time, 0.5 * time, share * dynamics.speed)
    early = 0.0 if joint == 0 else 1.0
    if not ends:
        quick = math.sqrt(dynamics.acceleration)
        early = quick / (quick + math.sqrt(dynamics.deceleration))
    return Transition(stops, before, after, early * share * time, (1.0 - early) * share * time, dynamics.speed)


def _way_of_time(time: float, transition: Transition, acceleration: float) -> float:
    """Return the way [m] from the begin of a piece, a stop or not, that takes ``time`` [s]."""
    speed = transition.speed
    if not transition.stops:
        return speed * time
    ramp = speed / acceleration
    return 0.5 * acceleration * time * time if time < ramp else speed * (time - 0.5 * ramp)


def _bent_way(store: PlanStore, piece: int) -> float:
    """Return the length [m] in which a piece turns as it did, with the curvature in hand."""
    k = store.arc_k[piece]
    return abs(store.kept_way[piece] * (store.kept_k[piece] / k if k != 0.0 else 1.0))


def _solve(store: PlanStore, start: Pose, heading: float, dynamics: Dynamics) -> int:
    """Lay out the path with lengths so that it ends at the goal; returns a piece that is too short if any is."""
    _lay_out(store, dynamics)
    for _ in range(MAX_ITERATIONS):
        end = _end(store, start)
        turn = wrap_angle(heading - end.heading)
        if abs(end.x) + abs(end.y) + abs(turn) < CONVERGED:
            return _too_short(store)
        solved = _correct_lengths(store, end, turn)
        if not solved:
            return UNSOLVED
    return UNSOLVED


def _lay_out(store: PlanStore, dynamics: Dynamics) -> None:
    """Write the pieces of the path with transitions; those between them become shorter by what transitions take."""
    put_mark(store, PIECE_COUNT, 0)
    count = store.mark[KEPT_COUNT]
    before = _transition(store, 0, dynamics)
    for piece in range(count):
        direction = sign(store.kept_way[piece])
        after = _transition(store, piece + 1, dynamics)
        late = _way_of_time(before.late, before, dynamics.acceleration)
        early = _way_of_time(after.early, after, dynamics.deceleration)
        _add_half(store, before, True, direction, dynamics)
        _add(store, direction * (_bent_way(store, piece) - late - early), store.arc_k[piece], 0.0)
        _add_half(store, after, False, direction, dynamics)
        before = after


def _add_half(store: PlanStore, transition: Transition, late: bool, direction: float, dynamics: Dynamics) -> None:
    """Add the arcs of a transition before or behind (``late``) the begin of a piece; none sets out too fast."""
    time = transition.late if late else transition.early
    count = _slices(store, transition.stops, time)
    rate = sign(transition.angle_after - transition.angle_before) * dynamics.rate
    acceleration = dynamics.acceleration if late else dynamics.deceleration
    for number in range(count):
        each = time / count
        far = (number + 1) * each if late else time - number * each
        near = number * each if late else far - each
        angle = transition.angle_before + rate * (number + 0.5) * each
        speed = transition.speed
        if late:
            angle = transition.angle_after - rate * (time - (number + 0.5) * each)
            speed = min(speed, acceleration * far) if transition.stops else speed
        way = _way_of_time(far, transition, acceleration) - _way_of_time(near, transition, acceleration)
        _add(store, direction * way, math.tan(angle) / dynamics.wheelbase, speed)


def _add(store: PlanStore, way: float, k: float, speed: float) -> None:
    """Add a piece; where it begins is not known yet."""
    number = store.mark[PIECE_COUNT]
    put_piece(store, number, Pose(), way, k)
    put_piece_speed(store, number, speed)
    put_mark(store, PIECE_COUNT, number + 1)


def _end(store: PlanStore, start: Pose) -> Pose:
    """Set where the pieces laid out begin; returns where the path ends."""
    pose = start
    for number in range(store.mark[PIECE_COUNT]):
        way = store.piece_way[number]
        k = store.piece_k[number]
        put_piece(store, number, pose, way, k)
        pose = drive(pose, way, k)
    return pose


def _too_short(store: PlanStore) -> int:
    """Return the first piece too short between its transitions, or ``SOLVED``."""
    piece = 0
    for number in range(store.mark[PIECE_COUNT]):
        if store.piece_speed[number] == 0.0:
            if store.piece_way[number] * sign(store.kept_way[piece]) < MIN_ARC:
                return piece
            piece += 1
    return SOLVED


class NormalMatrix(NamedTuple):
    """J W J^T: symmetric, three by three, by position and heading of the end."""

    xx: float
    xy: float
    xh: float
    yy: float
    yh: float
    hh: float


class EndSlope(NamedTuple):
    """By how much the path's end moves where a piece becomes longer [m/m, rad/m]."""

    x: float
    y: float
    heading: float


def _end_slope(store: PlanStore, number: int, direction: float, end: Pose) -> EndSlope:
    """Return by how much the end moves with the length of a piece laid out."""
    k = store.piece_k[number]
    heading = store.piece_h[number]
    return EndSlope(
        direction * (math.cos(heading) - k * (end.y - store.piece_y[number])),
        direction * (math.sin(heading) + k * (end.x - store.piece_x[number])),
        direction * k,
    )


def _normal_matrix(store: PlanStore, end: Pose) -> NormalMatrix:
    """Return J W J^T of the slopes J of the end and the lengths W of the pieces without transitions."""
    xx = 0.0
    xy = 0.0
    xh = 0.0
    yy = 0.0
    yh = 0.0
    hh = 0.0
    piece = 0
    for number in range(store.mark[PIECE_COUNT]):
        if store.piece_speed[number] == 0.0:
            way = store.kept_way[piece]
            slope = _end_slope(store, number, sign(way), end)
            weight = _bent_way(store, piece)
            xx += weight * slope.x * slope.x
            xy += weight * slope.x * slope.y
            xh += weight * slope.x * slope.heading
            yy += weight * slope.y * slope.y
            yh += weight * slope.y * slope.heading
            hh += weight * slope.heading * slope.heading
            piece += 1
    return NormalMatrix(xx, xy, xh, yy, yh, hh)


def _correct_lengths(store: PlanStore, end: Pose, turn: float) -> bool:
    """Change the lengths so that the end moves to the goal, to first order; returns whether they can.

    With J the slopes and W the lengths, the change is W J^T (J W J^T)^-1 e: a matrix of three by three, by its minors.
    """
    sums = _normal_matrix(store, end)
    m00 = sums.yy * sums.hh - sums.yh * sums.yh
    m01 = sums.xh * sums.yh - sums.xy * sums.hh
    m02 = sums.xy * sums.yh - sums.xh * sums.yy
    size = sums.xx * m00 + sums.xy * m01 + sums.xh * m02
    if size < SINGULAR * (sums.xx + sums.yy) * (sums.xx + sums.yy) * sums.hh:
        return False
    m11 = sums.xx * sums.hh - sums.xh * sums.xh
    m12 = sums.xy * sums.xh - sums.xx * sums.yh
    m22 = sums.xx * sums.yy - sums.xy * sums.xy
    x = (-m00 * end.x - m01 * end.y + m02 * turn) / size
    y = (-m01 * end.x - m11 * end.y + m12 * turn) / size
    h = (-m02 * end.x - m12 * end.y + m22 * turn) / size
    piece = 0
    for number in range(store.mark[PIECE_COUNT]):
        if store.piece_speed[number] == 0.0:
            way = store.kept_way[piece]
            slope = _end_slope(store, number, sign(way), end)
            change = _bent_way(store, piece) * (slope.x * x + slope.y * y + slope.heading * h)
            put_piece_way(store, number, store.piece_way[number] + sign(way) * change)
            piece += 1
    return True


def _is_free(store: PlanStore, task: Task) -> bool:
    """Return whether the path laid out keeps its margin."""
    gap = clearance(store, _begin(store, 0), task) - task.margin
    for number in range(store.mark[PIECE_COUNT]):
        way = store.piece_way[number]
        driven = sweep(store, _begin(store, number), gap, way, store.piece_k[number], task)
        if driven.way < abs(way):
            return False
        gap = driven.gap
    return True


def _begin(store: PlanStore, number: int) -> Pose:
    """Return where a piece laid out begins."""
    return Pose(store.piece_x[number], store.piece_y[number], store.piece_h[number])


def _keep(store: PlanStore) -> None:
    """Keep the path as it is laid out."""
    for number in range(store.mark[PIECE_COUNT]):
        put_kept(store, number, store.piece_way[number], store.piece_k[number])
        put_kept_speed(store, number, store.piece_speed[number])
    put_mark(store, KEPT_COUNT, store.mark[PIECE_COUNT])
