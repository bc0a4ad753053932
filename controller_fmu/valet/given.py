"""A slot from outside at run time: corners, kind and direction as inputs, and whether it can be, by what was heard."""

import math
from typing import Annotated, NamedTuple

from controller_fmu.common.told import AT_THE_ROAD, ECHOES, WELL_IN, SlotKind, ToldSlot, depth_of, is_usable_slot
from controller_fmu.interface import ControllerInput, Reason
from controller_fmu.planning.plan_store import HEARD, PlanStore
from controller_fmu.sensing.gap import DEEP, Gap, GapLayout
from controller_fmu.sensing.in_gap import along_of, in_gap
from controller_fmu.valet.params import GivenSlot, ValetParams
from controller_fmu.valet.slot import body_of
from modelkit.signal import Group, Signal
from modelkit.vocabulary import Pose

ROOM = 0.3
"""A slot is wider, or along the road longer, than the car by this [m]."""


class ValetInput(NamedTuple):
    """From the vehicle, as every controller has it, and a slot from outside."""

    odometry: Annotated[Pose, Group("rear-axle midpoint as the car believes it")] = Pose()
    measured_speed: Annotated[float, Signal("m/s", "speed, reverse negative")] = 0.0
    steering_wheel_angle: Annotated[float, Signal("rad", "steering-wheel angle, left positive")] = 0.0
    driver_takeover: Annotated[bool, Signal("1", "the driver has taken over")] = False
    vehicle_fault: Annotated[int, Signal("1", "why the vehicle brakes by itself; 0: it does not")] = 0
    ultrasonic: tuple[
        Annotated[float, Signal("m", "distance heard: 1-4 front, 5-8 rear, 9-10 left, 11-12 right")], ...
    ] = (5.0,) * 12
    apa_switch: Annotated[bool, Signal("1", "the driver has switched the parking assist on")] = False
    driver_confirm: Annotated[bool, Signal("1", "the driver presses the confirm button")] = False
    told: Annotated[ToldSlot, Group("a slot from outside: a camera, a map, a test bench")] = ToldSlot()


def of_the_car(inputs: ValetInput) -> ControllerInput:
    """Return what every controller is told."""
    return ControllerInput(
        odometry=inputs.odometry,
        measured_speed=inputs.measured_speed,
        steering_wheel_angle=inputs.steering_wheel_angle,
        driver_takeover=inputs.driver_takeover,
        vehicle_fault=inputs.vehicle_fault,
        ultrasonic=inputs.ultrasonic,
        apa_switch=inputs.apa_switch,
        driver_confirm=inputs.driver_confirm,
    )


def as_parameter(told: ToldSlot, slot: GivenSlot) -> GivenSlot:
    """Return the slot that is told, or that of the parameters if none is; its depth too where that is not told."""
    if told.kind == SlotKind.NONE:
        return slot
    depth = depth_of(told)
    return GivenSlot(told.kind, told.ax, told.ay, told.bx, told.by, told.heading, depth if depth < DEEP else slot.depth)


def gap_told(told: ToldSlot, params: ValetParams) -> Gap:
    """Return the slot that is told as a gap; a car stands in its middle, or flush with A and B if it has no end."""
    lengthwise = told.kind == SlotKind.PARALLEL
    body = body_of(params)
    needed = 2.0 * (body.half_width if lengthwise else body.half_length)
    a = Pose(told.ax, told.ay, 0.0)
    b = Pose(told.bx, told.by, 0.0)
    layout = GapLayout.ALONG if lengthwise else GapLayout.ACROSS
    made = Gap(layout, a, b, told.heading, row=math.atan2(told.by - told.ay, told.bx - told.ax))
    e = along_of(made)
    dx = told.bx - told.ax
    dy = told.by - told.ay
    middle = 0.5 * (dx * math.cos(told.heading) + dy * math.sin(told.heading))
    depth = depth_of(told)
    back = 0.5 * (depth - needed) if needed < depth < DEEP and not lengthwise else 0.0
    return made._replace(width=dx * e.x + dy * e.y, front=middle + back, depth=depth - back if depth < DEEP else DEEP)


def told_reason(store: PlanStore, told: ToldSlot, params: ValetParams) -> int:
    """Return why a slot that is told cannot be one, ``NONE`` if it may be."""
    if not is_usable_slot(told):
        return Reason.BAD_INPUT
    gap = gap_told(told, params)
    body = body_of(params)
    lengthwise = gap.layout == GapLayout.ALONG
    across = 2.0 * (body.half_length if lengthwise else body.half_width)
    if gap.width < across + ROOM:
        return Reason.SLOT_TOO_SHORT
    deep = 2.0 * (body.half_width if lengthwise else body.half_length)
    least = deep if lengthwise else deep + params.search.behind - params.search.stand_out
    if depth_of(told) < least:
        return Reason.SLOT_TOO_SHALLOW
    count = 0
    for place in range(2 * HEARD):
        if store.heard_count[place] > 0 and _is_well_in(store, place, gap, deep):
            count = count + store.heard_count[place]
    return Reason.SLOT_CONTRADICTED if count >= ECHOES else Reason.NONE


def _is_well_in(store: PlanStore, place: int, gap: Gap, deep: float) -> bool:
    """Return whether a place lies where a car would stand in a gap."""
    at = in_gap(store, place, gap)
    end = gap.front + min(deep, gap.depth)
    return WELL_IN < at.across < gap.width - WELL_IN and -AT_THE_ROAD < at.deep < end - WELL_IN
