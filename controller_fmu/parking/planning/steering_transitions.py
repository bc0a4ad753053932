"""The path found, with curvature transitions: the vehicle turns its wheel while it drives, also about a stop.

Where the curvature jumps, the front wheels turn at their rate for as long as that takes: at speed within a gear, else
while the vehicle slows down to a stop and while it sets out again. A transition is a row of short arcs of equal
duration. Then the lengths of the segments between are solved, so that the path still ends at the goal: Newton's method,
least squares of changes in proportion to the lengths. A transition is shortened where a segment would have no length
left, or the outline would come too near to an obstacle.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.outline import pose_along_arc
from controller_fmu.parking.planning.collision import clearance, sweep_arc
from controller_fmu.parking.planning.problem import SAME_CURVATURE, DrivingDynamics, PlanningRequest, SearchProblem
from controller_fmu.parking.planning.shortcut_smoothing import pose_at
from controller_fmu.parking.planning.work import PlanCount, PlanningWork, PlanValue, set_best_segment, set_segment
from modelkit.maths import clamp, sign, wrap_angle
from modelkit.vocabulary import Pose

MAX_ARCS, MIN_ARCS = 4, 2
"""Arcs of a transition on one side of a stop; half as many on one side of a joint in one gear."""
MAX_ITERATIONS = 10
MARGIN_FRACTION = 0.8
"""Fraction of the margin that a path with transitions keeps."""
SHORTENING_FACTOR = 0.5
"""A transition that does not fit is shortened by this factor ..."""
MIN_FRACTION, MIN_FRACTION_IN_GEAR = 0.25, 0.5
"""... and left out if less than this is left of it; a ramp beside the path is as good in one gear."""
UNBENDING_FACTOR = 0.6
"""A segment that is too short for its transitions is bent less by this factor ..."""
MIN_CURVATURE_FRACTION = 0.3
"""... but no less than this fraction of its curvature."""
MIN_ARC = 0.01
"""Least length [m] of an arc or a line between two transitions."""
MAX_END_ERROR = 1e-8
"""Distance [m] and heading [rad] that the path's end may be off the goal."""
MIN_RELATIVE_DETERMINANT = 1e-6
"""Least determinant, as a fraction of what it is of directions at right angles."""
EQUATION_SOLVED = -1
EQUATION_UNSOLVED = -2
ALL_JOINTS = -1
NO_JOINT = -2


class SteeringTransition(NamedTuple):
    """How the front wheels turn about the start of a segment."""

    stops: bool = False
    angle_before: float = 0.0
    """[rad]"""
    angle_after: float = 0.0
    early: float = 0.0
    """Time [s] for which they turn before the start of the segment."""
    late: float = 0.0
    """And behind it."""
    speed: float = 0.0
    """Largest speed [m/s]."""


def begin_transitions(work: PlanningWork, request: PlanningRequest, max_segments: int) -> bool:
    """Request all transitions in full; returns whether the path, of at most ``max_segments``, can have any."""
    count = work.counts[PlanCount.BEST_SEGMENT_COUNT]
    work.counts[PlanCount.TRANSITION_TRIED] = ALL_JOINTS
    work.counts[PlanCount.ARC_COUNT] = MAX_ARCS
    for joint in range(count + 1):
        work.transition_fraction[joint] = 1.0
    _unbend(work, request.dynamics)
    if request.dynamics.rate <= 0.0 or count < 3:
        return False
    while work.counts[PlanCount.ARC_COUNT] > MIN_ARCS and _segments_with(work, request.dynamics) > max_segments:
        work.counts[PlanCount.ARC_COUNT] = work.counts[PlanCount.ARC_COUNT] - 1
    return True


def try_transitions(work: PlanningWork, request: PlanningRequest, problem: SearchProblem, max_segments: int) -> bool:
    """Try all transitions, or one more; returns whether there is more to try, else the path has those that fit.

    If not all of them fit, one is tried after the other, if the path fits with what tracking needs of the lock: first
    those about a stop, where the vehicle would stand for as long as the wheel turns.
    """
    joints = work.counts[PlanCount.BEST_SEGMENT_COUNT] + 1
    fits = _fit(work, request, problem, max_segments)
    number = work.counts[PlanCount.TRANSITION_TRIED]
    if number == ALL_JOINTS:
        if fits:
            _keep(work)
            return False
        for joint in range(joints):
            work.transition_fraction[joint] = 0.0
        work.counts[PlanCount.TRANSITION_TRIED] = NO_JOINT
        return True
    if number == NO_JOINT:
        if not fits:
            return False
        number = 0
    elif not fits:
        joint = number % joints
        fraction = SHORTENING_FACTOR * work.transition_fraction[joint]
        least = MIN_FRACTION if number < joints else MIN_FRACTION_IN_GEAR
        work.transition_fraction[joint] = fraction if fraction >= least else 0.0
        number = number if fraction >= least else number + 1
    else:
        number += 1
    while number < 2 * joints and not _is_worth(work, number, joints):
        number += 1
    work.counts[PlanCount.TRANSITION_TRIED] = number
    if number < 2 * joints:
        if work.transition_fraction[number % joints] <= 0.0:
            work.transition_fraction[number % joints] = 1.0
        return True
    fits = _fit(work, request, problem, max_segments)
    if fits:
        _keep(work)
    return False


def _is_worth(work: PlanningWork, number: int, joints: int) -> bool:
    """Return whether a transition is to be tried: in a first round those about a stop, in a second one the others."""
    joint = number % joints
    k0 = work.best_curvature[joint - 1] if joint > 0 else 0.0
    k1 = work.best_curvature[joint] if joint + 1 < joints else 0.0
    return abs(k1 - k0) >= SAME_CURVATURE and _stops_at(work, joint) == (number < joints)


def _stops_at(work: PlanningWork, joint: int) -> bool:
    """Return whether the vehicle stands where a segment begins."""
    if joint == 0 or joint == work.counts[PlanCount.BEST_SEGMENT_COUNT]:
        return True
    return work.best_length[joint - 1] * work.best_length[joint] < 0.0


def _fit(work: PlanningWork, request: PlanningRequest, problem: SearchProblem, max_segments: int) -> bool:
    """Lay out the path with the transitions wished for; returns whether it fits.

    Pieces too short for their transitions are bent less.
    """
    _unbend(work, request.dynamics)
    if _segments_with(work, request.dynamics) > max_segments:
        return False
    start = Pose(request.start.x - request.goal.x, request.start.y - request.goal.y, request.start.heading)
    short = _solve(work, start, request.goal.heading, request.dynamics)
    while short >= 0:
        if abs(work.arc_curvature[short]) <= MIN_CURVATURE_FRACTION * abs(work.best_curvature[short]):
            return False
        work.arc_curvature[short] = UNBENDING_FACTOR * work.arc_curvature[short]
        short = _solve(work, start, request.goal.heading, request.dynamics)
    return short == EQUATION_SOLVED and _is_free(
        work, problem._replace(margin=MARGIN_FRACTION * work.values[PlanValue.BEST_PATH_MARGIN])
    )


def _unbend(work: PlanningWork, dynamics: DrivingDynamics) -> None:
    """Give all segments the curvature that they were found with, but for what tracking needs of the lock."""
    for segment in range(work.counts[PlanCount.BEST_SEGMENT_COUNT]):
        work.arc_curvature[segment] = clamp(work.best_curvature[segment], -dynamics.curvature, dynamics.curvature)


def _segments_with(work: PlanningWork, dynamics: DrivingDynamics) -> int:
    """Return how many segments the path has with its transitions."""
    segments = work.counts[PlanCount.BEST_SEGMENT_COUNT]
    for joint in range(work.counts[PlanCount.BEST_SEGMENT_COUNT] + 1):
        transition = _transition(work, joint, dynamics)
        segments += _arc_count(work, transition.stops, transition.early) + _arc_count(
            work, transition.stops, transition.late
        )
    return segments


def _arc_count(work: PlanningWork, stops: bool, time: float) -> int:
    """Return the number of arcs on one side of a transition."""
    if time <= 0.0:
        return 0
    return work.counts[PlanCount.ARC_COUNT] if stops else work.counts[PlanCount.ARC_COUNT] // 2


def _transition(work: PlanningWork, joint: int, dynamics: DrivingDynamics) -> SteeringTransition:
    """Return the transition about the start of segment ``joint``; their count: that at the end.

    A fraction of it in one gear is driven at that fraction of the speed. About a stop it is that fraction of the turn:
    the wheel turns longer where the vehicle slows down than where it sets out, by the root of the accelerations, as the
    same distance costs the same time there.
    """
    count = work.counts[PlanCount.BEST_SEGMENT_COUNT]
    k0 = work.arc_curvature[joint - 1] if joint > 0 else 0.0
    k1 = work.arc_curvature[joint] if joint < count else 0.0
    before = math.atan(dynamics.wheelbase * k0)
    after = math.atan(dynamics.wheelbase * k1)
    ends = joint == 0 or joint == count
    stops = _stops_at(work, joint)
    fraction = work.transition_fraction[joint]
    if abs(k1 - k0) < SAME_CURVATURE or fraction <= 0.0:
        return SteeringTransition(stops, before, after)
    time = abs(after - before) / dynamics.rate
    if not stops:
        return SteeringTransition(stops, before, after, 0.5 * time, 0.5 * time, fraction * dynamics.speed)
    early = 0.0 if joint == 0 else 1.0
    if not ends:
        quick = math.sqrt(dynamics.acceleration)
        early = quick / (quick + math.sqrt(dynamics.deceleration))
    return SteeringTransition(
        stops, before, after, early * fraction * time, (1.0 - early) * fraction * time, dynamics.speed
    )


def _distance_in(time: float, transition: SteeringTransition, acceleration: float) -> float:
    """Return the distance [m] from the start of a segment, a stop or not, that takes ``time`` [s]."""
    speed = transition.speed
    if not transition.stops:
        return speed * time
    ramp = speed / acceleration
    return 0.5 * acceleration * time * time if time < ramp else speed * (time - 0.5 * ramp)


def _bent_length(work: PlanningWork, segment: int) -> float:
    """Return the length [m] in which a segment turns as it did, with the curvature in hand."""
    k = work.arc_curvature[segment]
    return abs(work.best_length[segment] * (work.best_curvature[segment] / k if k != 0.0 else 1.0))


def _solve(work: PlanningWork, start: Pose, heading: float, dynamics: DrivingDynamics) -> int:
    """Lay out the path with lengths so that it ends at the goal; returns a segment that is too short if any is."""
    _lay_out(work, dynamics)
    for _ in range(MAX_ITERATIONS):
        end = _end(work, start)
        turn = wrap_angle(heading - end.heading)
        if abs(end.x) + abs(end.y) + abs(turn) < MAX_END_ERROR:
            return _too_short(work)
        solved = _correct_lengths(work, end, turn)
        if not solved:
            return EQUATION_UNSOLVED
    return EQUATION_UNSOLVED


def _lay_out(work: PlanningWork, dynamics: DrivingDynamics) -> None:
    """Write the segments of the path with transitions; those between become shorter by what transitions take."""
    work.counts[PlanCount.SEGMENT_COUNT] = 0
    count = work.counts[PlanCount.BEST_SEGMENT_COUNT]
    before = _transition(work, 0, dynamics)
    for segment in range(count):
        direction = sign(work.best_length[segment])
        after = _transition(work, segment + 1, dynamics)
        late = _distance_in(before.late, before, dynamics.acceleration)
        early = _distance_in(after.early, after, dynamics.deceleration)
        _add_half(work, before, True, direction, dynamics)
        _add(work, direction * (_bent_length(work, segment) - late - early), work.arc_curvature[segment], 0.0)
        _add_half(work, after, False, direction, dynamics)
        before = after


def _add_half(
    work: PlanningWork, transition: SteeringTransition, late: bool, direction: float, dynamics: DrivingDynamics
) -> None:
    """Add the arcs of a transition before or behind (``late``) the start of a segment; none sets out too fast."""
    time = transition.late if late else transition.early
    count = _arc_count(work, transition.stops, time)
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
        length = _distance_in(far, transition, acceleration) - _distance_in(near, transition, acceleration)
        _add(work, direction * length, math.tan(angle) / dynamics.wheelbase, speed)


def _add(work: PlanningWork, distance: float, k: float, speed: float) -> None:
    """Add a segment; where it begins is not known yet."""
    number = work.counts[PlanCount.SEGMENT_COUNT]
    set_segment(work, number, Pose(), distance, k)
    work.segment_speed[number] = speed
    work.counts[PlanCount.SEGMENT_COUNT] = number + 1


def _end(work: PlanningWork, start: Pose) -> Pose:
    """Set where the segments laid out begin; returns where the path ends."""
    pose = start
    for number in range(work.counts[PlanCount.SEGMENT_COUNT]):
        distance = work.segment_length[number]
        k = work.segment_curvature[number]
        set_segment(work, number, pose, distance, k)
        pose = pose_along_arc(pose, distance, k)
    return pose


def _too_short(work: PlanningWork) -> int:
    """Return the first segment that is too short between its transitions, or ``EQUATION_SOLVED``."""
    segment = 0
    for number in range(work.counts[PlanCount.SEGMENT_COUNT]):
        if work.segment_speed[number] == 0.0:
            if work.segment_length[number] * sign(work.best_length[segment]) < MIN_ARC:
                return segment
            segment += 1
    return EQUATION_SOLVED


class GoalNormalMatrix(NamedTuple):
    """J W J^T: symmetric, three by three, by position and heading of the end."""

    xx: float
    xy: float
    xh: float
    yy: float
    yh: float
    hh: float


class EndDerivative(NamedTuple):
    """By how much the path's end moves where a segment becomes longer [m/m, rad/m]."""

    x: float
    y: float
    heading: float


def _end_derivative(work: PlanningWork, number: int, direction: float, end: Pose) -> EndDerivative:
    """Return by how much the end moves with the length of a segment laid out."""
    k = work.segment_curvature[number]
    heading = work.segment_heading[number]
    return EndDerivative(
        direction * (math.cos(heading) - k * (end.y - work.segment_y[number])),
        direction * (math.sin(heading) + k * (end.x - work.segment_x[number])),
        direction * k,
    )


def _normal_matrix(work: PlanningWork, end: Pose) -> GoalNormalMatrix:
    """Return J W J^T of the slopes J of the end and the lengths W of the segments without transitions."""
    xx = 0.0
    xy = 0.0
    xh = 0.0
    yy = 0.0
    yh = 0.0
    hh = 0.0
    segment = 0
    for number in range(work.counts[PlanCount.SEGMENT_COUNT]):
        if work.segment_speed[number] == 0.0:
            distance = work.best_length[segment]
            slope = _end_derivative(work, number, sign(distance), end)
            weight = _bent_length(work, segment)
            xx += weight * slope.x * slope.x
            xy += weight * slope.x * slope.y
            xh += weight * slope.x * slope.heading
            yy += weight * slope.y * slope.y
            yh += weight * slope.y * slope.heading
            hh += weight * slope.heading * slope.heading
            segment += 1
    return GoalNormalMatrix(xx, xy, xh, yy, yh, hh)


def _correct_lengths(work: PlanningWork, end: Pose, turn: float) -> bool:
    """Change the lengths so that the end moves to the goal, to first order; returns whether they can.

    With J the slopes and W the lengths, the change is W J^T (J W J^T)^-1 e: a matrix of three by three, by its minors.
    """
    sums = _normal_matrix(work, end)
    m00 = sums.yy * sums.hh - sums.yh * sums.yh
    m01 = sums.xh * sums.yh - sums.xy * sums.hh
    m02 = sums.xy * sums.yh - sums.xh * sums.yy
    size = sums.xx * m00 + sums.xy * m01 + sums.xh * m02
    if size < MIN_RELATIVE_DETERMINANT * (sums.xx + sums.yy) * (sums.xx + sums.yy) * sums.hh:
        return False
    m11 = sums.xx * sums.hh - sums.xh * sums.xh
    m12 = sums.xy * sums.xh - sums.xx * sums.yh
    m22 = sums.xx * sums.yy - sums.xy * sums.xy
    x = (-m00 * end.x - m01 * end.y + m02 * turn) / size
    y = (-m01 * end.x - m11 * end.y + m12 * turn) / size
    h = (-m02 * end.x - m12 * end.y + m22 * turn) / size
    segment = 0
    for number in range(work.counts[PlanCount.SEGMENT_COUNT]):
        if work.segment_speed[number] == 0.0:
            distance = work.best_length[segment]
            slope = _end_derivative(work, number, sign(distance), end)
            change = _bent_length(work, segment) * (slope.x * x + slope.y * y + slope.heading * h)
            work.segment_length[number] = work.segment_length[number] + sign(distance) * change
            segment += 1
    return True


def _is_free(work: PlanningWork, problem: SearchProblem) -> bool:
    """Return whether the path laid out keeps its margin."""
    gap = clearance(work, pose_at(work, 0), problem) - problem.margin
    for number in range(work.counts[PlanCount.SEGMENT_COUNT]):
        distance = work.segment_length[number]
        driven = sweep_arc(work, pose_at(work, number), gap, distance, work.segment_curvature[number], problem)
        if driven.distance < abs(distance):
            return False
        gap = driven.gap
    return True


def _keep(work: PlanningWork) -> None:
    """Keep the path as it is laid out."""
    for number in range(work.counts[PlanCount.SEGMENT_COUNT]):
        set_best_segment(work, number, work.segment_length[number], work.segment_curvature[number])
        work.best_speed[number] = work.segment_speed[number]
    work.counts[PlanCount.BEST_SEGMENT_COUNT] = work.counts[PlanCount.SEGMENT_COUNT]
