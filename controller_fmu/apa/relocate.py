"""Corner re-location: where the neighbours really are, heard at standstill in the slot.

The two middle sensors of the front (rear) hear the nearest point of what lies across their way, which
for a flat obstacle is the distance along its normal, whatever the car's heading within the cone. If both
agree, the corner of a parallel slot is moved there, at most by ``FURTHEST``; a wall beside is moved nearer
where the rear corner sensor hears it nearer.
"""

import math

from controller_fmu.apa.outline import Obstacles
from controller_fmu.apa.parking import shape_of
from controller_fmu.apa.slot import LESS_BESIDE, UNSEEN, Kind, Margins, Site, Slot, mirror_of, site_of
from controller_fmu.apa.supervisor import WRONG, expected
from controller_fmu.common.slot_frame import SlotFrame, to_slot, to_world
from controller_fmu.interface import ControllerInput, ControllerParams
from modelkit.car import CarUltrasonic
from modelkit.maths import wrap_angle
from modelkit.vocabulary import Pose

NOTHING = 1e3
NEAR = 0.9
AGREE = 0.15
FURTHEST = 0.15
STEEPEST = 0.45
SQUARE = 0.55
"""A wall along the road is heard square to it up to about this heading [rad]."""
FRONT = 1
REAR_LEFT = 4
REAR_RIGHT = 7
REAR = 5
SIDES = ((8, 9), (10, 11))
"""Sensors of the left and of the right side, front and rear."""
INSIDE = -0.15
"""A sensor is in a perpendicular slot if it is so deep [m] in it."""
BESIDE = 0.35
"""A neighbour of a perpendicular slot stands at most this much [m] from where it was found."""
FARTHEST = 1.3
GAIN = 0.12
"""Share of what one reading says."""
OUT = 0.01
RIM = 0.05
"""Nearer than this [rad] to the rim of its cone a sensor is not taken to hear what is square to it."""
ACROSS = 0.45
"""A neighbour is heard square to its side up to this heading [rad]."""


def relocated(slot: Slot, inputs: ControllerInput, stopped: bool, params: ControllerParams) -> Slot:
    """Return the slot with what the front and rear sensors of a car standing in it say.

    ``stopped``: the car stands before something that nobody knew of.
    """
    pose = to_slot(inputs.odometry, SlotFrame(slot.a, mirror_of(slot)))
    if slot.kind == Kind.PERPENDICULAR and stopped:
        return _closed(slot, pose, inputs, params)
    if slot.kind != Kind.PARALLEL or abs(pose.heading) > SQUARE or pose.y > 0.0:
        return slot
    slot = _walled(slot, inputs, params)
    if abs(pose.heading) > STEEPEST:
        return slot
    start = _heard_at(pose, mirror_of(slot), inputs, REAR, params)
    if abs(start) <= FURTHEST:
        slot = _moved(slot, start, 0.0)
        pose = pose._replace(x=pose.x - start)
    end = _heard_at(pose, mirror_of(slot), inputs, FRONT, params) - slot.length
    if abs(end) <= FURTHEST:
        slot = _moved(slot, 0.0, end)
    return _shallower(slot, inputs, params)


def _closed(slot: Slot, pose: Pose, inputs: ControllerInput, params: ControllerParams) -> Slot:
    """Return a perpendicular slot that nothing was heard behind with the wall that both middle rear sensors hear."""
    if slot.depth < UNSEEN or abs(pose.heading - 0.5 * math.pi) > ACROSS:
        return slot
    lowest = nearest_told(params.car.ultrasonic)
    one = inputs.ultrasonic[REAR]
    two = inputs.ultrasonic[REAR + 1]
    if not lowest < one < NEAR or not lowest < two < NEAR or abs(one - two) > AGREE:
        return slot
    mirror = mirror_of(slot)
    heard = 0.5 * (_y_of(pose, mirror, params, REAR) - one + _y_of(pose, mirror, params, REAR + 1) - two)
    return slot._replace(depth=-heard) if heard < INSIDE else slot


def _walled(slot: Slot, inputs: ControllerInput, params: ControllerParams) -> Slot:
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


def between(slot: Slot, inputs: ControllerInput, params: ControllerParams) -> Slot:
    """Return a perpendicular slot with its neighbours a little nearer to where the side sensors in it hear them.

    Told once for each new reading of the sensors, also while the car drives in: what the odometry has
    drifted since the corners were heard is found again.
    """
    pose = to_slot(inputs.odometry, SlotFrame(slot.a, mirror_of(slot)))
    if slot.kind != Kind.PERPENDICULAR or abs(pose.heading - 0.5 * math.pi) > ACROSS:
        return slot
    mirror = mirror_of(slot)
    start = _side_at(pose, mirror, inputs, -1.0, params)
    end = _side_at(pose, mirror, inputs, 1.0, params) - slot.length
    start = GAIN * start if abs(start) <= BESIDE else 0.0
    end = GAIN * end if abs(end) <= BESIDE else 0.0
    return _moved(slot, start, end) if start != 0.0 or end != 0.0 else slot


def along(slot: Slot, inputs: ControllerInput, params: ControllerParams) -> Slot:
    """Return a parallel slot moved a little across the road to where its kerb or wall is heard.

    The wall was heard from the road, as far behind the neighbours' sides as ``depth`` says; what its distance
    differs by as the car comes in is what the odometry has drifted. Told once for each new reading. The slot
    ends ``OUT`` further out than heard: short moves in it need the room, see docs/apa.md.
    """
    if slot.kind != Kind.PARALLEL or slot.depth >= UNSEEN:
        return slot
    mirror = mirror_of(slot)
    pose = to_slot(inputs.odometry, SlotFrame(slot.a, mirror))
    site = site_of(slot, shape_of(params), Margins(0.0, LESS_BESIDE - OUT, 0.0))
    total = 0.0
    heard = 0.0
    for number in (SIDES[1][0], SIDES[1][1], REAR_RIGHT) if mirror > 0.0 else (SIDES[0][0], SIDES[0][1], REAR_LEFT):
        off = _off_wall(pose, site, number, inputs, params)
        if abs(off) < FURTHEST:
            total += off
            heard += 1.0
    if heard == 0.0:
        return slot
    a = to_world(Pose(0.0, GAIN * total / heard, 0.0), SlotFrame(slot.a, mirror))
    return slot._replace(a=a)


def _off_wall(pose: Pose, site: Site, number: int, inputs: ControllerInput, params: ControllerParams) -> float:
    """Return how much further out [m] than it should be a sensor hears the wall beside; far if it does not hear it.

    ``pose`` is the car's in A's frame. The wall must be square to a ray of the cone, and nearer than the neighbours.
    """
    mirror = site.frame.mirror
    sensors = params.car.ultrasonic
    mount = sensors.mounts[number]
    reading = inputs.ultrasonic[number]
    square = abs(wrap_angle(pose.heading + mirror * mount.yaw + 0.5 * math.pi)) < sensors.half_angle - RIM
    inside = _y_of(pose, mirror, params, number) < INSIDE
    if not square or not inside or not nearest_told(sensors) < reading < FARTHEST:
        return NOTHING
    in_target = to_slot(inputs.odometry, site.frame)
    nothing = site.obstacles.opposite
    alone = Obstacles(nothing, nothing, site.obstacles.beside, nothing)
    should = expected(mount, in_target, mirror, alone, sensors)
    if should > expected(mount, in_target, mirror, site.obstacles, sensors):
        return NOTHING
    return should - reading


def _side_at(pose: Pose, mirror: float, inputs: ControllerInput, sense: float, params: ControllerParams) -> float:
    """Return x [m] in A's frame of what the sensors on one side hear, the mean; far away if they hear nothing."""
    total = 0.0
    heard = 0.0
    for number in SIDES[0 if sense * mirror < 0.0 else 1]:
        y = _y_of(pose, mirror, params, number)
        reading = inputs.ultrasonic[number]
        if y < INSIDE and nearest_told(params.car.ultrasonic) < reading < FARTHEST:
            total += _x_of(pose, mirror, params, number) + sense * reading
            heard += 1.0
    return total / heard if heard > 0.0 else NOTHING


def _shallower(slot: Slot, inputs: ControllerInput, params: ControllerParams) -> Slot:
    """Return the slot with the wall beside as near as the rear corner sensor on its side hears it."""
    site = site_of(slot, shape_of(params), Margins(0.0, 0.0, 0.0))
    pose = to_slot(inputs.odometry, site.frame)
    number = REAR_RIGHT if site.frame.mirror > 0.0 else REAR_LEFT
    nothing = site.obstacles.opposite
    sensors = params.car.ultrasonic
    mount = sensors.mounts[number]
    mirror = site.frame.mirror
    alone = Obstacles(nothing, nothing, site.obstacles.beside, nothing)
    should = expected(mount, pose, mirror, alone, sensors)
    lacks = should - inputs.ultrasonic[number]
    if lacks <= WRONG or lacks > FURTHEST or should > expected(mount, pose, mirror, site.obstacles, sensors):
        return slot
    return slot._replace(depth=slot.depth - lacks)


def _heard_at(pose: Pose, mirror: float, inputs: ControllerInput, first: int, params: ControllerParams) -> float:
    """Return x [m] in A's frame of what two middle sensors hear; far away if they do not agree."""
    one = inputs.ultrasonic[first]
    two = inputs.ultrasonic[first + 1]
    lowest = nearest_told(params.car.ultrasonic)
    if one > NEAR or two > NEAR or one < lowest or two < lowest:
        return NOTHING
    sense = 1.0 if first == FRONT else -1.0
    a = _x_of(pose, mirror, params, first) + sense * one
    b = _x_of(pose, mirror, params, first + 1) + sense * two
    return 0.5 * (a + b) if abs(a - b) <= AGREE else NOTHING


def _x_of(pose: Pose, mirror: float, params: ControllerParams, number: int) -> float:
    mount = params.car.ultrasonic.mounts[number]
    return pose.x + mount.x * math.cos(pose.heading) - mirror * mount.y * math.sin(pose.heading)


def _y_of(pose: Pose, mirror: float, params: ControllerParams, number: int) -> float:
    mount = params.car.ultrasonic.mounts[number]
    return pose.y + mount.x * math.sin(pose.heading) + mirror * mount.y * math.cos(pose.heading)


def braked(slot: Slot, speed: float, params: ControllerParams) -> Slot:
    """Return the slot seen from a car that has braked from ``speed`` [m/s] to standstill since it heard the corners.

    Braked wheels slip in proportion to the deceleration a, so the way the odometry misses is the integral
    of s a v dt = s v^2 / 2, however hard the car braked.
    """
    missed = 0.5 * params.apa.search.slip * speed * speed
    return _moved(slot, -missed, -missed, slot.unsure)


def nearest_told(sensors: CarUltrasonic) -> float:
    """Return the distance [m] above which a reading is one: the nearest told says that something is nearer still."""
    return sensors.min_range + 1.1 * sensors.resolution


def _moved(slot: Slot, start: float, end: float, unsure: float = 0.0) -> Slot:
    a = to_world(Pose(start, 0.0, 0.0), SlotFrame(slot.a, mirror_of(slot)))
    return slot._replace(a=a, length=slot.length - start + end, unsure=unsure)
