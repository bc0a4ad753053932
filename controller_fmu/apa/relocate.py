"""Corner re-location: where the neighbours really are, heard at standstill in the slot.

The two middle sensors of the front (rear) hear the nearest point of what lies across their way, which
for a flat obstacle is the distance along its normal, whatever the car's heading within the cone. If both
agree, the corner of a parallel slot is moved there, at most by ``FURTHEST``; a wall beside is moved nearer
where the rear corner sensor hears it nearer.
"""

import math

from controller_fmu.apa.outline import Obstacles
from controller_fmu.apa.parking import car_of
from controller_fmu.apa.slot import PARALLEL, Margins, Slot, mirror_of, site_of
from controller_fmu.apa.supervisor import WRONG, expected
from controller_fmu.interface import ControllerInput, ControllerParams
from controller_fmu.slot_frame import SlotFrame, to_slot, to_world
from modelkit.vocabulary import Pose

NEAR = 0.9
AGREE = 0.15
FURTHEST = 0.15
STEEPEST = 0.45
FRONT = 1
REAR_LEFT = 4
REAR_RIGHT = 7
REAR = 5


def relocated(slot: Slot, inputs: ControllerInput, params: ControllerParams) -> Slot:
    """Return the slot with what the front and rear sensors of a car standing in it say."""
    pose = to_slot(inputs.odometry, SlotFrame(slot.a, mirror_of(slot)))
    if slot.kind != PARALLEL or abs(pose.heading) > STEEPEST or pose.y > 0.0:
        return slot
    start = _heard_at(pose, mirror_of(slot), inputs, REAR, params)
    if abs(start) <= FURTHEST:
        slot = _moved(slot, start, 0.0)
        pose = Pose(pose.x - start, pose.y, pose.heading)
    end = _heard_at(pose, mirror_of(slot), inputs, FRONT, params) - slot.length
    if abs(end) <= FURTHEST:
        slot = _moved(slot, 0.0, end)
    return _shallower(slot, inputs, params)


def _shallower(slot: Slot, inputs: ControllerInput, params: ControllerParams) -> Slot:
    """Return the slot with the wall beside as near as the rear corner sensor on its side hears it."""
    site = site_of(slot, car_of(params), Margins(0.0, 0.0, 0.0))
    pose = to_slot(inputs.odometry, site.frame)
    number = REAR_RIGHT if site.frame.mirror > 0.0 else REAR_LEFT
    nothing = site.obstacles.opposite
    mount = params.apa.sensors.mounts[number]
    mirror = site.frame.mirror
    alone = Obstacles(nothing, nothing, site.obstacles.beside, nothing)
    should = expected(mount, pose, mirror, alone, params.apa)
    lacks = should - inputs.ultrasonic[number]
    if lacks <= WRONG or lacks > FURTHEST or should > expected(mount, pose, mirror, site.obstacles, params.apa):
        return slot
    a = Pose(slot.a.x, slot.a.y, slot.a.heading)
    return Slot(slot.kind, slot.side, a, slot.length, slot.b_out, slot.depth - lacks, slot.opposite, slot.unsure)


def _heard_at(pose: Pose, mirror: float, inputs: ControllerInput, first: int, params: ControllerParams) -> float:
    """Return x [m] in A's frame of what two middle sensors hear; far away if they do not agree."""
    one = inputs.ultrasonic[first]
    two = inputs.ultrasonic[first + 1]
    lowest = params.apa.sensors.min_range + 0.011
    nothing = 1e3
    if one > NEAR or two > NEAR or one < lowest or two < lowest:
        return nothing
    sense = 1.0 if first == FRONT else -1.0
    a = _x_of(pose, mirror, params, first) + sense * one
    b = _x_of(pose, mirror, params, first + 1) + sense * two
    return 0.5 * (a + b) if abs(a - b) <= AGREE else nothing


def _x_of(pose: Pose, mirror: float, params: ControllerParams, number: int) -> float:
    mount = params.apa.sensors.mounts[number]
    return pose.x + mount.x * math.cos(pose.heading) - mirror * mount.y * math.sin(pose.heading)


def _moved(slot: Slot, start: float, end: float) -> Slot:
    a = to_world(Pose(start, 0.0, 0.0), SlotFrame(slot.a, mirror_of(slot)))
    return Slot(slot.kind, slot.side, a, slot.length - start + end, slot.b_out, slot.depth, slot.opposite, 0.0)
