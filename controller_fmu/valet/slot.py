"""Where to stand: at the target, in the middle of a slot that is given by its corners, or in one that was found."""

import math

from controller_fmu.common.external_slot import SlotKind
from controller_fmu.planning.task import Dynamics
from controller_fmu.planning.task import PlannedCar as Body
from controller_fmu.sensing.gap import Gap, GapLayout
from controller_fmu.sensing.in_gap import along_of
from controller_fmu.valet.params import GivenSlot, SlotWish, ValetParams
from modelkit.car import car_length, largest_curvature
from modelkit.maths import PI, wrap_angle
from modelkit.vocabulary import Pose

RATE_SHARE = 0.9
"""Of the wheel's rate that a transition asks for; the rest is for tracking."""
LOCK_SHARE = 0.95
"""Of the largest curvature that a path with all its transitions takes."""
QUICKEST = 1.0
"""Acceleration [m/s2] with which a car sets out, the lag of its drive counted."""
LEADS_ON = 0.34
"""A slot leads on along the way if the cosine between them is larger: it is turned by less than 70 deg."""

FARTHEST_KERB = 1.2
"""What lies farther [m] beside a car that stands flush with its neighbours is not its kerb."""


def body_of(params: ValetParams) -> Body:
    """Return the car as the planner sees it."""
    car = params.car
    length = car_length(car)
    curvature = params.plan.curvature_share * largest_curvature(car)
    return Body(0.5 * length - car.rear_overhang, 0.5 * length, 0.5 * car.width, curvature)


def dynamics_of(params: ValetParams) -> Dynamics:
    """Return how the car drives a path; its rate is 0 where the wheel may not turn on the move.

    Nor does a path into a slot that was found have transitions: its goal moves by what is measured on the way.
    """
    steering = params.car.steering
    law = params.drive
    rate = 0.0
    if law.rolling > 0.0 and not params.search.active:
        rate = RATE_SHARE * steering.rate_limit / steering.ratio
    curvature = LOCK_SHARE * largest_curvature(params.car)
    return Dynamics(params.car.wheelbase, rate, curvature, law.speed, QUICKEST, law.deceleration)


def goal_of(params: ValetParams, slot: GivenSlot, now: Pose) -> Pose:
    """Return the pose to park at, the target or in the middle of a slot, for a car that stands at ``now``."""
    if slot.kind == SlotKind.NONE:
        return params.target
    body = body_of(params)
    x = 0.5 * (slot.ax + slot.bx + slot.depth * math.cos(slot.heading))
    y = 0.5 * (slot.ay + slot.by + slot.depth * math.sin(slot.heading))
    heading = slot.heading
    if slot.kind == SlotKind.TAIL_IN:
        heading = slot.heading + PI
    if slot.kind == SlotKind.PARALLEL:
        heading = math.atan2(slot.by - slot.ay, slot.bx - slot.ax)
        if math.cos(heading - now.heading) < 0.0:
            heading = heading + PI
    return Pose(x - body.ahead * math.cos(heading), y - body.ahead * math.sin(heading), heading)


def goal_in(gap: Gap, way: float, wish: int, params: ValetParams) -> Pose:
    """Return the pose to park at in a gap found on a way of the direction ``way`` [rad], ``wish``: which end first.

    Flush with the neighbours, but where the gap ends at something as far from that as the parameters say.
    """
    body = body_of(params)
    search = params.search
    e = along_of(gap)
    tx = math.cos(gap.into)
    ty = math.sin(gap.into)
    front = gap.front
    width = 2.0 * body.half_width
    if gap.layout == GapLayout.ALONG:
        heading = math.atan2(e.y, e.x)
        left = gap.depth - width
        shift = 0.0
        if left < search.kerb_least:
            shift = left - search.kerb_least
        elif left > search.kerb_most and gap.depth < width + FARTHEST_KERB:
            shift = left - search.kerb_most
        t = front + body.half_width + shift
    else:
        t = front + body.half_length - stands_out(gap, params)
        nose = wish == SlotWish.NOSE_IN or (wish == SlotWish.ANY and math.cos(gap.into - way) > LEADS_ON)
        heading = gap.into if nose else gap.into + PI
    x = gap.a.x + t * tx + 0.5 * gap.width * e.x
    y = gap.a.y + t * ty + 0.5 * gap.width * e.y
    return Pose(x - body.ahead * math.cos(heading), y - body.ahead * math.sin(heading), heading)


def stands_out(gap: Gap, params: ValetParams) -> float:
    """Return how far [m] a car stands out of a gap across the road, which ends before the car would."""
    short = 2.0 * body_of(params).half_length + params.search.behind - gap.depth
    return short if short > 0.0 and gap.layout == GapLayout.ACROSS else 0.0


def stands_in_road(gap: Gap, params: ValetParams) -> float:
    """Return how far [m] into the road a car stands out of such a gap: less than along it if that is at an angle."""
    return stands_out(gap, params) * abs(math.sin(gap.into - gap.row))


def is_in_place(pose: Pose, goal: Pose, params: ValetParams) -> bool:
    """Return whether a pose is as near to the goal as the drive may end."""
    off = seen_from(goal, pose)
    end = params.end
    return abs(off.x) <= end.position and abs(off.y) <= end.position and abs(off.heading) <= end.heading


def seen_from(goal: Pose, pose: Pose) -> Pose:
    """Return a pose as the goal has it: along and across its heading [m], turned against it [rad]."""
    dx = pose.x - goal.x
    dy = pose.y - goal.y
    c = math.cos(goal.heading)
    s = math.sin(goal.heading)
    return Pose(dx * c + dy * s, dy * c - dx * s, wrap_angle(pose.heading - goal.heading))
