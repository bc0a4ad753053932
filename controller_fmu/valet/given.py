"""A slot from outside at run time: corners, kind and direction as inputs, and whether it can be, by what was heard."""

import math

from controller_fmu.common.external_slot import (
    AT_THE_ROAD,
    MIN_CONTRADICTING_ECHOES,
    WELL_IN,
    ExternalSlot,
    SlotKind,
    depth_of,
    is_usable_slot,
)
from controller_fmu.interface import Reason
from controller_fmu.planning.plan_store import HEARD, PlanStore
from controller_fmu.sensing.gap import DEEP, Gap, GapLayout
from controller_fmu.sensing.in_gap import along_of, in_gap
from controller_fmu.valet.params import GivenSlot, ValetParams
from controller_fmu.valet.slot import body_of
from modelkit.vocabulary import Pose

ROOM = 0.3
"""A slot is wider, or along the road longer, than the car by this [m]."""


def as_parameter(told: ExternalSlot, slot: GivenSlot) -> GivenSlot:
    """Return the slot that is told, or that of the parameters if none is; its depth too where that is not told."""
    if told.kind == SlotKind.NONE:
        return slot
    depth = depth_of(told)
    return GivenSlot(told.kind, told.ax, told.ay, told.bx, told.by, told.heading, depth if depth < DEEP else slot.depth)


def gap_told(told: ExternalSlot, params: ValetParams) -> Gap:
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


def told_reason(store: PlanStore, told: ExternalSlot, params: ValetParams) -> int:
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
    return Reason.SLOT_CONTRADICTED if count >= MIN_CONTRADICTING_ECHOES else Reason.NONE


def _is_well_in(store: PlanStore, place: int, gap: Gap, deep: float) -> bool:
    """Return whether a place lies where a car would stand in a gap."""
    at = in_gap(store, place, gap)
    end = gap.front + min(deep, gap.depth)
    return WELL_IN < at.across < gap.width - WELL_IN and -AT_THE_ROAD < at.deep < end - WELL_IN
