"""Clearance beside the path at each segment joint: what steering while rolling may use of it.

On a transition (``curvature_transition.py``) the car is off its direction, and behind it beside its path. So the
outline is examined as it stands on the transition, not on the path alone.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.outline import pose_along_arc
from controller_fmu.parking.planning.collision import MAX_CLEARANCE, clearance, free_distance
from controller_fmu.parking.planning.curvature_transition import (
    SAME_CURVATURE,
    lateral_offset_after,
    transition_length,
    transition_state,
)
from controller_fmu.parking.planning.problem import PlanningRequest, SearchProblem
from controller_fmu.parking.planning.work import PlanCount, PlanningWork, PlanValue
from modelkit.maths import sign
from modelkit.vocabulary import Pose

EXAMINED_DISTANCE = 1.25
"""Distance [m] before and behind where a segment begins along which clearances are examined."""
EXAMINED_STEP = 0.125
"""Distance [m] between two examined poses."""
MAX_OVERRUN = 0.2
"""Examined no farther [m] beyond a change of gear."""
MARGIN_FRACTION = 0.2
"""Fraction of the margin that steering while rolling may take, at most ``MAX_MARGIN_OFFSET`` [m]."""
MAX_MARGIN_OFFSET = 0.02
"""[m]"""
CLEARANCE_FRACTION = 0.25
"""And of what there is beyond the margin: a transition up to ``MAX_OFFSET`` in all."""
MAX_OFFSET = 0.03
"""[m]"""
OFFSET_FRACTIONS = (1.0, 0.7, 0.5, 0.35, 0.2, 0.1)
"""Of that; the first is taken that leaves enough."""
MARGIN_LEFT = 0.75
"""Share of the margin that is left on a transition, for what tracking and odometry are off."""
TRACKING_RATE = 1.3
"""How fast [1/m] tracking takes back what a transition leaves: as e^(-RATE s) (1 + RATE s) over the distance s."""
EXAMINED_AFTER = 2.0
"""Distance [m] behind a transition over which clearances are examined."""


def measure_clearance(work: PlanningWork, request: PlanningRequest, problem: SearchProblem) -> bool:
    """Measure the clearance about the start of the next segment of the path kept; returns whether there is one more."""
    segment = work.counts[PlanCount.MEASURED_SEGMENTS]
    problem = problem._replace(margin=work.values[PlanValue.BEST_PATH_MARGIN])
    start = Pose(request.start.x - request.goal.x, request.start.y - request.goal.y, request.start.heading)
    if work.best_speed[segment] > 0.0 or (segment > 0 and work.best_speed[segment - 1] > 0.0):
        work.best_clearance[segment] = 0.0
    elif segment == 0:
        work.best_clearance[segment] = _clearance_about(work, start, segment, problem)
    elif work.best_length[segment - 1] * work.best_length[segment] < 0.0:
        work.best_clearance[segment] = _overrun(work, start, segment, problem)
    else:
        _set_transition(work, start, segment, problem)
    work.counts[PlanCount.MEASURED_SEGMENTS] = segment + 1
    return segment + 1 < work.counts[PlanCount.BEST_SEGMENT_COUNT]


def _clearance_about(work: PlanningWork, start: Pose, segment: int, problem: SearchProblem) -> float:
    """Return the least clearance [m] beyond the margin within ``EXAMINED_DISTANCE`` of where a segment begins."""
    joint = 0.0
    for number in range(segment):
        joint += abs(work.best_length[number])
    least = clearance(work, start, problem) if segment == 0 else MAX_CLEARANCE
    pose = start
    at = 0.0
    for number in range(work.counts[PlanCount.BEST_SEGMENT_COUNT]):
        distance = work.best_length[number]
        place = max(0.0, joint - EXAMINED_DISTANCE - at)
        last = min(abs(distance), joint + EXAMINED_DISTANCE - at)
        while place <= last:
            there = pose_along_arc(pose, sign(distance) * place, work.best_curvature[number])
            least = min(least, clearance(work, there, problem))
            place += EXAMINED_STEP
        at += abs(distance)
        pose = pose_along_arc(pose, distance, work.best_curvature[number])
    return max(0.0, least - problem.margin)


class PathOffset(NamedTuple):
    """Where a car is whose curvature changes over transitions."""

    lateral: float = 0.0
    """Beside the path, to the left [m]."""
    turned: float = 0.0
    """Off its direction [rad], as the curvature takes it when it goes forward."""


def _set_transition(work: PlanningWork, start: Pose, segment: int, problem: SearchProblem) -> None:
    """Set how far [m] a transition may take the car beside the path where a segment begins; 0: it has to stand."""
    joint = _joint_pose(work, start, segment)
    most = min(
        MAX_OFFSET,
        min(MAX_MARGIN_OFFSET, MARGIN_FRACTION * problem.margin)
        + CLEARANCE_FRACTION * _clearance_about(work, start, segment, problem),
    )
    if abs(work.best_curvature[segment] - work.best_curvature[segment - 1]) < SAME_CURVATURE:
        work.best_clearance[segment] = most
        return
    for number in range(len(OFFSET_FRACTIONS)):
        work.best_clearance[segment] = OFFSET_FRACTIONS[number] * most
        if _is_transition_free(work, joint, segment, problem):
            return
    work.best_clearance[segment] = 0.0


def _is_transition_free(work: PlanningWork, joint: Pose, segment: int, problem: SearchProblem) -> bool:
    """Return whether the car keeps enough of the margin on a transition and behind it, those before counted."""
    direction = sign(work.best_length[segment])
    past = -0.5 * _transition(work, segment)
    last = min(_gear_distance(work, segment, 1), EXAMINED_AFTER - past)
    while past <= last:
        at = _along(work, joint, segment, past)
        off = _offset_at(work, segment, past)
        x = at.x - off.lateral * math.sin(at.heading)
        y = at.y + off.lateral * math.cos(at.heading)
        if clearance(work, Pose(x, y, at.heading + direction * off.turned), problem) < MARGIN_LEFT * problem.margin:
            return False
        past += EXAMINED_STEP
    return True


def _offset_at(work: PlanningWork, segment: int, past: float) -> PathOffset:
    """Return where the car is ``past`` [m] behind the start of a segment, by the transitions before it in its gear."""
    lateral = 0.0
    turned = 0.0
    distance = past
    number = segment
    while number > 0 and work.best_length[number - 1] * work.best_length[segment] > 0.0:
        jump = work.best_curvature[number] - work.best_curvature[number - 1]
        transition = _transition(work, number)
        on = distance + 0.5 * transition
        if 0.0 < on < transition:
            more = transition_state(jump, transition, distance, distance > 0.0)
            lateral += more.lateral
            turned += more.turned
        if 0.0 < transition <= on:
            behind = TRACKING_RATE * (on - transition)
            off = lateral_offset_after(jump, transition) * math.exp(-behind)
            lateral += off * (1.0 + behind)
            turned -= off * TRACKING_RATE * behind
        number -= 1
        distance += abs(work.best_length[number])
    return PathOffset(lateral, turned)


def _transition(work: PlanningWork, segment: int) -> float:
    """Return the length [m] of the transition about the start of a segment, by what it may take the car off."""
    longest = 2.0 * min(_gear_distance(work, segment, -1), _gear_distance(work, segment, 1))
    return transition_length(
        work.best_clearance[segment], work.best_curvature[segment] - work.best_curvature[segment - 1], longest
    )


def _gear_distance(work: PlanningWork, segment: int, turn: int) -> float:
    """Return the distance [m] in a gear from a segment's start on (``turn`` 1) or before (-1), up to a transition."""
    distance = 0.0
    number = segment if turn > 0 else segment - 1
    while (
        0 <= number < work.counts[PlanCount.BEST_SEGMENT_COUNT]
        and work.best_length[number] * work.best_length[segment] > 0.0
    ):
        if work.best_speed[number] > 0.0:
            return distance
        distance += abs(work.best_length[number])
        number += turn
    return distance


def _joint_pose(work: PlanningWork, start: Pose, segment: int) -> Pose:
    """Return the pose where a segment begins."""
    pose = start
    for number in range(segment):
        pose = pose_along_arc(pose, work.best_length[number], work.best_curvature[number])
    return pose


def _along(work: PlanningWork, joint: Pose, segment: int, past: float) -> Pose:
    """Return the pose on the path ``past`` [m] behind the start of a segment, or before it, in the same gear."""
    pose = joint
    left = abs(past)
    number = segment if past > 0.0 else segment - 1
    turn = 1 if past > 0.0 else -1
    while left > abs(work.best_length[number]) and 0 <= number + turn < work.counts[PlanCount.BEST_SEGMENT_COUNT]:
        pose = pose_along_arc(pose, turn * work.best_length[number], work.best_curvature[number])
        left -= abs(work.best_length[number])
        number += turn
    return pose_along_arc(pose, turn * sign(work.best_length[number]) * left, work.best_curvature[number])


def _overrun(work: PlanningWork, start: Pose, segment: int, problem: SearchProblem) -> float:
    """Return how far [m] the segment before may go on, at the margin."""
    pose = _joint_pose(work, start, segment)
    return free_distance(
        work, pose, sign(work.best_length[segment - 1]), work.best_curvature[segment - 1], MAX_OVERRUN, problem
    )
