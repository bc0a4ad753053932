"""A slot from outside, as the assist takes it: instead of one that the search finds, checked against what is heard."""

import math
from typing import NamedTuple

from controller_fmu.apa.hearing.search import SearchState
from controller_fmu.apa.outline import Shape
from controller_fmu.apa.params import ApaSystemParams
from controller_fmu.apa.signals import ApaInput
from controller_fmu.apa.slot import UNSEEN, Kind, Side, Slot, mirror_of
from controller_fmu.apa.ways.fit import fit_of
from controller_fmu.common.external_slot import (
    AT_THE_ROAD,
    MIN_CONTRADICTING_ECHOES,
    UNKNOWN_DEPTH,
    WELL_IN,
    ExternalSlot,
    SlotKind,
    depth_of,
    is_usable_slot,
)
from controller_fmu.common.sensors import LEFT_SENSOR, RIGHT_SENSOR, VALID_RANGE_FRACTION, sensor_at
from controller_fmu.common.slot_frame import SlotFrame, to_slot
from controller_fmu.interface import Reason
from modelkit.vocabulary import Pose

SQUARE = math.sin(0.15)
"""A slot whose direction leans by more than this sine against the square of its opening is an angled one."""
PASSED = 0.5
"""It is shown once the sensor has passed both corners by so much [m]."""
SAME = 0.1
"""Corners that move by less [m] are the same slot, seen again."""
ABOUT = 0.5
"""A slot heard whose corner A is not farther [m] from that of the slot told is the same."""
BESIDE = (0.2, 2.0)
FURTHER_IN = 0.8
LISTENED = 3
"""A neighbour is heard that far [m] from a corner, no further in [m] than this; nobody stands there if so many
readings are of none."""


class Beside(NamedTuple):
    """Readings next to a corner, and those that are of a neighbour."""

    readings: int = 0
    of_one: int = 0


class ToldWatch(NamedTuple):
    """What has become of the slot from outside."""

    slot: Slot = Slot()
    """Kind none: not told, not passed yet, or refused."""
    refused: int = Reason.NONE
    judged: ExternalSlot = ExternalSlot()
    """As it was told when it was judged."""
    echoes: int = 0
    """Heard in it since."""
    a: Beside = Beside()
    b: Beside = Beside()


def watch_told(
    state: ToldWatch, search: SearchState, inputs: ApaInput, fresh: bool, car: Shape, params: ApaSystemParams
) -> ToldWatch:
    """Return the slot that is told, as far as it may be shown; ``fresh``: the sensors tell something new."""
    told = inputs.external_slot
    if told.kind == SlotKind.NONE:
        return ToldWatch()
    if not is_usable_slot(told):
        return ToldWatch(refused=Reason.BAD_INPUT)
    slot = slot_of_told(told, search, inputs, car, params)
    same = _is_same(told, state.judged)
    refused = state.refused if same else reason_to_refuse(told, slot, car, params)
    echoes = state.echoes if same else 0
    a = state.a
    b = state.b
    if fresh and not params.apa.search.given:
        at = _sensor_in(slot, inputs, params)
        reading = _reading_of(slot, inputs)
        echoes = echoes + 1 if _is_inside(at, reading, slot, car, params) else echoes
        deep = at.y + reading * math.sin(at.heading)
        a = _listened(a, -at.x, deep)
        b = _listened(b, at.x - slot.length, deep)
    slot = slot._replace(empty_a=_is_nobody(a), empty_b=_is_nobody(b))
    if refused == Reason.NONE and echoes >= MIN_CONTRADICTING_ECHOES:
        refused = Reason.SLOT_CONTRADICTED
    shown = refused == Reason.NONE and (params.apa.search.given or _is_passed(slot, inputs, params))
    return ToldWatch(slot if shown else Slot(), refused, state.judged if same else told, echoes, a, b)


def slot_of_told(
    told: ExternalSlot, search: SearchState, inputs: ApaInput, car: Shape, params: ApaSystemParams
) -> Slot:
    """Return the slot that is told, corner A first on the car's way; a depth that is not told is the one heard."""
    pose = inputs.odometry
    dx = told.bx - told.ax
    dy = told.by - told.ay
    turned = dx * math.cos(pose.heading) + dy * math.sin(pose.heading) < 0.0
    ax = told.bx if turned else told.ax
    ay = told.by if turned else told.ay
    along = math.atan2(-dy, -dx) if turned else math.atan2(dy, dx)
    side = Side.LEFT if math.sin(told.heading - along) > 0.0 else Side.RIGHT
    kind = Kind.PARALLEL if told.kind == SlotKind.PARALLEL else Kind.PERPENDICULAR
    slot = Slot(
        kind=kind,
        side=side,
        a=Pose(ax, ay, along),
        length=math.sqrt(dx * dx + dy * dy),
        depth=depth_of(told),
        unsure=params.apa.search.told_unsure,
    )
    if slot.depth >= UNKNOWN_DEPTH:
        slot = slot._replace(depth=_depth_heard(search, slot))
    far = search.far_right if side == Side.LEFT else search.far_left
    if far < params.car.ultrasonic.max_range:
        slot = slot._replace(opposite=to_slot(pose, SlotFrame(slot.a, mirror_of(slot))).y + car.half_width + far)
    return slot


def reason_to_refuse(told: ExternalSlot, slot: Slot, car: Shape, params: ApaSystemParams) -> int:
    """Return why a car cannot park in a slot that is told, ``NONE`` if it may."""
    leaning = abs(math.cos(told.heading - slot.a.heading))
    if told.kind == SlotKind.NOSE_IN or leaning > SQUARE:
        return Reason.SLOT_NOT_SUPPORTED
    fit = fit_of(slot, car, params.apa)
    if fit.fits:
        return Reason.NONE
    return Reason.SLOT_TOO_SHALLOW if fit.shallow else Reason.SLOT_TOO_SHORT


def _depth_heard(search: SearchState, slot: Slot) -> float:
    """Return the depth [m] of the slot that was heard at the same place, ``UNSEEN`` if there is none."""
    depth = UNSEEN
    for heard in search.slots:
        dx = heard.a.x - slot.a.x
        dy = heard.a.y - slot.a.y
        if heard.kind != Kind.NONE and heard.side == slot.side and dx * dx + dy * dy < ABOUT * ABOUT:
            depth = heard.depth
    return depth


def _is_same(told: ExternalSlot, before: ExternalSlot) -> bool:
    """Return whether this is the slot told before, seen again."""
    return (
        told.kind == before.kind
        and abs(told.ax - before.ax) + abs(told.ay - before.ay) < SAME
        and abs(told.bx - before.bx) + abs(told.by - before.by) < SAME
        and abs(told.cx - before.cx) + abs(told.cy - before.cy) < SAME
        and abs(told.dx - before.dx) + abs(told.dy - before.dy) < SAME
    )


def _sensor_in(slot: Slot, inputs: ApaInput, params: ApaSystemParams) -> Pose:
    """Return the sensor that passes the slot, in A's frame."""
    mount = params.car.ultrasonic.mounts[LEFT_SENSOR if slot.side == Side.LEFT else RIGHT_SENSOR]
    return to_slot(sensor_at(mount, inputs.odometry), SlotFrame(slot.a, mirror_of(slot)))


def _is_passed(slot: Slot, inputs: ApaInput, params: ApaSystemParams) -> bool:
    """Return whether the sensor has passed both corners."""
    return _sensor_in(slot, inputs, params).x > slot.length + PASSED


def _reading_of(slot: Slot, inputs: ApaInput) -> float:
    """Return what the sensor that passes the slot tells [m]."""
    return inputs.ultrasonic[LEFT_SENSOR if slot.side == Side.LEFT else RIGHT_SENSOR]


def _is_inside(at: Pose, reading: float, slot: Slot, car: Shape, params: ApaSystemParams) -> bool:
    """Return whether an echo comes from where the car would stand, wherever in the cone it comes from."""
    sensors = params.car.ultrasonic
    if reading > VALID_RANGE_FRACTION * sensors.max_range:
        return False
    x = at.x + reading * math.cos(at.heading)
    y = at.y + reading * math.sin(at.heading)
    aside = reading * math.sin(sensors.half_angle)
    deep = 2.0 * car.half_width if slot.kind == Kind.PARALLEL else car.front + car.rear
    inside = x - aside > WELL_IN and x + aside < slot.length - WELL_IN
    return inside and WELL_IN - min(deep, slot.depth) < y < AT_THE_ROAD


def _listened(beside: Beside, away: float, y: float) -> Beside:
    """Return what is known of a neighbour after a reading ``away`` [m] from the corner, of something at ``y`` [m]."""
    if not BESIDE[0] < away < BESIDE[1]:
        return beside
    return Beside(beside.readings + 1, beside.of_one + 1 if y > -FURTHER_IN else beside.of_one)


def _is_nobody(beside: Beside) -> bool:
    return beside.readings >= LISTENED and beside.of_one < MIN_CONTRADICTING_ECHOES
