"""What is found beside the map while the car parks: a wall not heard from the road, the slip of braking.

A kerb or wall behind the slot is entered when two sensors agree on it while the car stands.
"""

import math

from controller_fmu.apa.around.local_map import LocalMap
from controller_fmu.apa.around.near import nearest_told
from controller_fmu.apa.around.thing import thing_at
from controller_fmu.apa.hearing.mute import is_mute
from controller_fmu.apa.params import ApaSystemParams
from controller_fmu.apa.signals import ApaInput
from controller_fmu.apa.slot import UNSEEN, Kind, Slot, mirror_of
from controller_fmu.common.slot_frame import SlotFrame, to_slot, to_world
from modelkit.vocabulary import Pose

NEAR = 0.9
AGREE = 0.15
SQUARE = 0.55
"""A wall along the road is heard square to it up to about this heading [rad]."""
REAR_LEFT = 4
REAR_RIGHT = 7
REAR = 5
SIDES = ((8, 9), (10, 11))
"""Sensors of the left and of the right side, front and rear."""
INSIDE = -0.15
"""A wall lies so deep [m] in a slot at least."""
ACROSS = 0.45
"""A car in a perpendicular slot is turned by no more than this [rad] against it."""


def walled(here: LocalMap, slot: Slot, inputs: ApaInput, stopped: bool, params: ApaSystemParams) -> LocalMap:
    """Return the map with the kerb or wall that a standing car hears behind a slot of which none was heard.

    ``stopped``: the car stands before something that nobody knew of.
    """
    if here.walled:
        return here
    pose = to_slot(inputs.odometry, SlotFrame(slot.a, mirror_of(slot)))
    found = slot
    if slot.kind == Kind.PERPENDICULAR and stopped:
        found = _closed(slot, pose, inputs, params)
    if slot.kind == Kind.PARALLEL and abs(pose.heading) <= SQUARE and pose.y <= 0.0:
        found = _walled(slot, inputs, params)
    if found.depth >= UNSEEN:
        return here
    at = to_slot(to_world(Pose(0.5 * slot.length, -found.depth, 0.0), SlotFrame(slot.a, mirror_of(slot))), here.frame)
    turned = params.apa.map.turned
    return here._replace(walled=True, wall=thing_at(at.x, at.y, at.heading, params.apa.map.corner, turned))


def _closed(slot: Slot, pose: Pose, inputs: ApaInput, params: ApaSystemParams) -> Slot:
    """Return a perpendicular slot that nothing was heard behind with the wall that both middle rear sensors hear.

    One has to do where the other tells nothing.
    """
    if slot.depth < UNSEEN or abs(pose.heading - 0.5 * math.pi) > ACROSS:
        return slot
    lowest = nearest_told(params.car.ultrasonic)
    one = inputs.ultrasonic[REAR]
    two = inputs.ultrasonic[REAR + 1]
    if is_mute(one):
        one = two
    if is_mute(two):
        two = one
    if not lowest < one < NEAR or not lowest < two < NEAR or abs(one - two) > AGREE:
        return slot
    mirror = mirror_of(slot)
    heard = 0.5 * (_y_of(pose, mirror, params, REAR) - one + _y_of(pose, mirror, params, REAR + 1) - two)
    return slot._replace(depth=-heard) if heard < INSIDE else slot


def _walled(slot: Slot, inputs: ApaInput, params: ApaSystemParams) -> Slot:
    """Return a slot of which no kerb or wall was heard with the one that two sensors at its rear agree on."""
    mirror = mirror_of(slot)
    side = SIDES[1 if mirror > 0.0 else 0][1]
    corner = REAR_RIGHT if mirror > 0.0 else REAR_LEFT
    lowest = nearest_told(params.car.ultrasonic)
    one = inputs.ultrasonic[side]
    two = inputs.ultrasonic[corner]
    if slot.depth < UNSEEN or not lowest < one < NEAR or not lowest < two < NEAR:
        return slot
    pose = to_slot(inputs.odometry, SlotFrame(slot.a, mirror))
    first = one - _y_of(pose, mirror, params, side)
    second = two - _y_of(pose, mirror, params, corner)
    if abs(first - second) > AGREE:
        return slot
    return slot._replace(depth=min(second, first))


def _y_of(pose: Pose, mirror: float, params: ApaSystemParams, number: int) -> float:
    mount = params.car.ultrasonic.mounts[number]
    return pose.y + mount.x * math.sin(pose.heading) + mirror * mount.y * math.cos(pose.heading)


def braked(slot: Slot, speed: float, params: ApaSystemParams) -> Slot:
    """Return the slot seen from a car that has braked from ``speed`` [m/s] to standstill since it heard the corners.

    Braked wheels slip in proportion to the deceleration a, so the way the odometry misses is the integral
    of s a v dt = s v^2 / 2, however hard the car braked.
    """
    missed = 0.5 * params.apa.search.slip * speed * speed
    a = to_world(Pose(-missed, 0.0, 0.0), SlotFrame(slot.a, mirror_of(slot)))
    return slot._replace(a=a)
