"""The four stages: which key point is steered for, and when the next stage begins."""

from typing import NamedTuple

from controller_fmu.hsic.characteristic_states import Errors, HsicStage, errors
from controller_fmu.hsic.key_points import KeyPoints, key_points
from controller_fmu.hsic.params import HsicParams
from modelkit.car import Car
from modelkit.vocabulary import Pose

READY_REACH = 0.3
"""Distance [m] from P1 along the road within which the car stands ready."""


class Course(NamedTuple):
    """Stage, key points, and the point steered for."""

    stage: int = HsicStage.READY
    points: KeyPoints = KeyPoints()
    goal: Pose = Pose()
    done: bool = False
    hold: bool = True
    """Stand until the wheel is where it should be."""
    way: int = 1
    """Direction in which the goal is approached, +1 forward."""


def is_parked(pose: Pose, share: float, params: HsicParams) -> bool:
    """Return whether heading and lateral error are within a share of the paper's limits: 5 deg, 0.1 m."""
    threshold = params.threshold
    return abs(pose.heading) < share * threshold.parked_heading and abs(pose.y) < share * threshold.parked_lateral


def advance(course: Course, pose: Pose, found: Errors, car: Car, params: HsicParams) -> Course:
    """Return the course after looking at the pose (slot frame) and its errors to the goal."""
    arrived = course.way * found.ahead >= -params.threshold.reached
    if course.stage == HsicStage.READY:
        return _ready(course, pose, found, arrived, car, params)
    if course.stage == HsicStage.TURN_IN:
        if arrived or pose.heading >= course.goal.heading - params.threshold.turned:
            return _go(course, HsicStage.TANGENT, course.points.p3, False, pose)
        return course
    if course.stage == HsicStage.TANGENT:
        return _go(course, HsicStage.COUNTER, Pose(0.0, 0.0, 0.0), True, pose) if arrived else course
    if course.stage == HsicStage.COUNTER:
        return _counter(course, pose, arrived, params)
    return _shuffle(course, pose, arrived, params)


def _ready(course: Course, pose: Pose, found: Errors, arrived: bool, car: Car, params: HsicParams) -> Course:
    """Return P2 as goal if the car stands ready, else another approach to P1 with more room."""
    threshold = params.threshold
    if not arrived:
        return course
    p1 = course.points.p1
    at_p1 = course.goal.x == p1.x
    aligned = abs(found.heading) <= threshold.ready_heading and abs(found.lateral) <= threshold.ready_lateral
    if aligned and abs(pose.x - p1.x) <= READY_REACH:
        points = key_points(pose, params.slot, car, course.points.radius)
        if points.found:
            return Course(HsicStage.TURN_IN, points, points.p2, way=-1)
    farther = Pose(p1.x + threshold.retry_distance, p1.y, 0.0)
    return _go(course, HsicStage.READY, farther if at_p1 else p1, True, pose)


def _counter(course: Course, pose: Pose, arrived: bool, params: HsicParams) -> Course:
    """Return done at P4 if parked; otherwise on to the slot's end, then the shuffle."""
    if arrived and is_parked(pose, 1.0, params):
        return _finish(course)
    if arrived and pose.x <= course.points.rearmost + params.threshold.reached:
        return _go(course, HsicStage.SHUFFLE, Pose(course.points.foremost, 0.0, 0.0), True, pose)
    if arrived:
        return _go(course, HsicStage.COUNTER, Pose(course.points.rearmost, 0.0, 0.0), False, pose)
    return course


def _shuffle(course: Course, pose: Pose, arrived: bool, params: HsicParams) -> Course:
    """Return done as soon as the car is parked, else the other end of the slot when this one is reached."""
    if is_parked(pose, params.threshold.shuffle_share, params):
        return _finish(course)
    if not arrived:
        return course
    front = course.points.foremost
    rear = course.points.rearmost
    return _go(course, HsicStage.SHUFFLE, Pose(rear if course.goal.x == front else front, 0.0, 0.0), True, pose)


def _go(course: Course, stage: int, goal: Pose, hold: bool, pose: Pose) -> Course:
    return Course(stage, course.points, goal, hold=hold, way=way_to(goal, pose))


def way_to(goal: Pose, pose: Pose) -> int:
    """Return +1 if the goal is approached forward from ``pose``, -1 in reverse."""
    return -1 if errors(pose, goal, 0.0, 1).ahead > 0.0 else 1


def _finish(course: Course) -> Course:
    return course._replace(done=True, hold=True)
