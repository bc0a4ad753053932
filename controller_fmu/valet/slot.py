"""Where to stand: at the target, or in the middle of a slot that is given by its corners."""

import math

from controller_fmu.planning.task import PlannedCar as Body
from controller_fmu.valet.params import SlotKind, ValetParams
from modelkit.car import largest_curvature
from modelkit.maths import PI
from modelkit.vocabulary import Pose


def body_of(params: ValetParams) -> Body:
    """Return the car as the planner sees it."""
    car = params.car
    length = car.wheelbase + car.front_overhang + car.rear_overhang
    curvature = params.plan.curvature_share * largest_curvature(car)
    return Body(0.5 * length - car.rear_overhang, 0.5 * length, 0.5 * car.width, curvature)


def goal_of(params: ValetParams, now: Pose) -> Pose:
    """Return the pose to park at, for a car that stands at ``now``."""
    slot = params.slot
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
