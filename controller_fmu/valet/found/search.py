"""Looking for a slot: both side sensors listen while the driver drives past; is what they have heard a slot?"""

import math
from typing import NamedTuple

from controller_fmu.common.external_slot import ExternalSlot, SlotKind
from controller_fmu.common.sensors import LEFT_SENSOR, RIGHT_SENSOR, is_new_sample, sensor_at
from controller_fmu.interface import Reason
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.around import AroundGap, lay_around
from controller_fmu.sensing.ear import SideEar, listen
from controller_fmu.sensing.find_gap import find_gap
from controller_fmu.sensing.gap import Gap, GapLayout, Wanted
from controller_fmu.sensing.in_gap import along_of
from controller_fmu.sensing.street import street_of
from controller_fmu.valet.given import gap_told, told_reason
from controller_fmu.valet.params import SlotWish, ValetParams, WishedSide
from controller_fmu.valet.signals import ValetInput
from modelkit.car import car_length
from modelkit.vocabulary import Pose

FRONT_SENSOR = 1
RIGHT = 0
LEFT = 1
SLOWEST = 0.02
"""A car that moves slower [m/s] hears nothing new."""
INSIDE = 0.3
LEAST_DEPTH = 2.0
PASSED = 0.5
"""The sensor has passed a slot from outside by so much [m]."""
STRAIGHT = 0.9
"""What is heard so far [m] from a slot's edges and front by a sensor that looks along it is what the slot ends at."""
ACROSS = 0.5
"""Cosine of 60 deg: a gap turned by more against the one before lies across it."""
LAST = 0.5
"""Over the last of the way [m] that is searched, what is unclear is decided."""
BEHIND = 0.6
"""A slot is needed so much [m] deeper than the car, if nothing was heard that it ends at."""


class Search(NamedTuple):
    """What is remembered of a search beside the places heard."""

    clock_ns: int = 0
    right: SideEar = SideEar()
    left: SideEar = SideEar()
    way: float = 0.0
    """Driven since it began [m]."""
    gap: Gap = Gap()
    """The slot found; NONE: none yet."""
    side: int = RIGHT
    waited_ns: int = 0
    """For the driver to drive on, or to confirm."""
    refused: int = Reason.NONE
    """Why a slot was not taken."""
    told: int = SlotKind.NONE
    """How to stand in the slot, if it was told from outside."""
    lines: int = 0
    """Of the map around the slot."""
    pose: Pose = Pose()
    """Where the car stood when the slot was shown."""
    ahead: float = 0.0
    """Heard before the bumper there [m]."""
    again: bool = False
    """Its neighbours were thought to stand the other way before."""


def begin_search(clock_ns: int) -> Search:
    """Return a search that begins."""
    return Search(clock_ns=clock_ns)


def search(store: PlanStore, state: Search, inputs: ValetInput, params: ValetParams, dt_ns: int) -> Search:
    """Return the search after one sample; sensors tell something new every ``cycle``."""
    speed = abs(inputs.measured_speed)
    clock = state.clock_ns + dt_ns
    state = state._replace(clock_ns=clock, way=state.way + speed * dt_ns * 1e-9)
    if not is_new_sample(clock, dt_ns, params.car.ultrasonic.cycle) or speed < SLOWEST:
        return state
    right = _hear(store, state.right, RIGHT, RIGHT_SENSOR, inputs, params)
    left = _hear(store, state.left, LEFT, LEFT_SENSOR, inputs, params)
    new_right = right.rays > state.right.rays and params.search.side != WishedSide.LEFT
    new_left = left.rays > state.left.rays and params.search.side != WishedSide.RIGHT
    state = state._replace(right=right, left=left)
    if new_right and (state.gap.layout == GapLayout.NONE or state.side == RIGHT):
        state = _judged(store, state, RIGHT, RIGHT_SENSOR, inputs, params)
    if new_left and (state.gap.layout == GapLayout.NONE or state.side == LEFT):
        state = _judged(store, state, LEFT, LEFT_SENSOR, inputs, params)
    return state


def told_slot(store: PlanStore, state: Search, told: ExternalSlot, inputs: ValetInput, params: ValetParams) -> Search:
    """Return the search with the slot that is told from outside, once it has been passed; or why it cannot be one."""
    reason = told_reason(store, told, params)
    if reason != Reason.NONE:
        return state._replace(gap=Gap(), refused=reason)
    gap = gap_told(told, params)
    pose = inputs.odometry
    c = math.cos(pose.heading)
    s = math.sin(pose.heading)
    ahead = max((gap.a.x - pose.x) * c + (gap.a.y - pose.y) * s, (gap.b.x - pose.x) * c + (gap.b.y - pose.y) * s)
    left = (gap.b.y + gap.a.y - 2.0 * pose.y) * c - (gap.b.x + gap.a.x - 2.0 * pose.x) * s > 0.0
    if ahead > params.car.ultrasonic.mounts[RIGHT_SENSOR].x - PASSED:
        return state._replace(gap=Gap(), refused=Reason.NONE)
    return state._replace(gap=gap, side=LEFT if left else RIGHT, told=told.kind, refused=Reason.NONE)


def wanted(params: ValetParams) -> Wanted:
    """Return what the driver wants a slot to be."""
    car = params.car
    wish = params.search.wish
    length = car_length(car)
    return Wanted(
        length=length,
        width=car.width,
        room_along=params.search.room_along,
        room_across=params.search.room_across,
        along=wish in (SlotWish.ANY, SlotWish.PARALLEL),
        across=wish != SlotWish.PARALLEL,
        half_angle=params.car.ultrasonic.half_angle,
        deep=length + params.search.behind,
        open_ended=params.search.open_ended,
        stand_out=params.search.stand_out,
        tail_in=wish == SlotWish.TAIL_IN,
    )


def wanted_beside(store: PlanStore, state: Search, side: int, at: Pose, params: ValetParams) -> Wanted:
    """Return what is wanted of a slot on a side, with how the road goes there, as far as its other side was heard."""
    right = side == RIGHT
    places = state.left.places if right else state.right.places
    street = street_of(store, LEFT if right else RIGHT, places, at, params.car.ultrasonic.half_angle)
    return wanted(params)._replace(street=street)


def with_map(store: PlanStore, state: Search, inputs: ValetInput, params: ValetParams) -> Search:
    """Return the search whose slot is shown, with the map around it made."""
    ahead = min(inputs.ultrasonic[FRONT_SENSOR], inputs.ultrasonic[FRONT_SENSOR + 1])
    state = state._replace(waited_ns=0, pose=inputs.odometry, ahead=ahead, again=False)
    return mapped(store, state, params)


def mapped(store: PlanStore, state: Search, params: ValetParams) -> Search:
    """Return the search with the map made around its slot, as it was heard from where the slot was shown."""
    car = params.car
    sensors = car.ultrasonic
    length = car_length(car)
    across = state.gap.layout == GapLayout.ACROSS
    right_side = state.side == RIGHT
    what = AroundGap(
        side=state.side,
        here=state.right.places if right_side else state.left.places,
        opposite=state.left.places if right_side else state.right.places,
        pose=state.pose,
        reach=sensors.max_range,
        half_width=0.5 * car.width,
        front=car.wheelbase + car.front_overhang,
        rear=car.rear_overhang,
        ahead=state.ahead,
        length=(length if across else car.width) + BEHIND,
        half_angle=sensors.half_angle,
        told=state.told != SlotKind.NONE,
    )
    lines = lay_around(store, state.gap, what)
    return state._replace(lines=lines)


def _hear(store: PlanStore, ear: SideEar, side: int, sensor: int, inputs: ValetInput, params: ValetParams) -> SideEar:
    at = sensor_at(params.car.ultrasonic.mounts[sensor], inputs.odometry)
    return listen(store, ear, side, at, inputs.ultrasonic[sensor], params.car.ultrasonic)


def _judged(store: PlanStore, state: Search, side: int, sensor: int, inputs: ValetInput, params: ValetParams) -> Search:
    """Return the search with the gap that the places of one side make."""
    ear = state.right if side == RIGHT else state.left
    at = sensor_at(params.car.ultrasonic.mounts[sensor], inputs.odometry)._replace(heading=inputs.odometry.heading)
    want = wanted_beside(store, state, side, at, params)._replace(at_end=state.way > params.search.way - LAST)
    gap = find_gap(store, side, ear.places, at, want)
    lost = gap.layout == GapLayout.NONE and state.gap.layout != GapLayout.NONE
    if _is_across(gap, state.gap) or (lost and want.at_end):
        return state
    if gap.shallow:
        return state._replace(gap=Gap(), refused=Reason.SLOT_TOO_SHALLOW)
    return state._replace(gap=gap, side=side)


def _is_across(gap: Gap, before: Gap) -> bool:
    """Return whether a gap lies across the one found before, which the car is about to stop at: what is behind it."""
    both = gap.layout == GapLayout.ACROSS and before.layout == GapLayout.ACROSS
    return both and abs(math.cos(gap.into - before.into)) < ACROSS


def reason_to_end(state: Search, params: ValetParams) -> int:
    """Return why a search ends without a slot, ``NONE`` while it goes on."""
    if state.way > params.search.way and state.gap.layout == GapLayout.NONE:
        return state.refused if state.refused != Reason.NONE else Reason.NO_SLOT
    return Reason.NOT_MOVING if state.waited_ns * 1e-9 > params.search.confirm else Reason.NONE


def shallower(state: Search, echo: Pose) -> Search:
    """Return the search whose slot ends where something has been heard in it; as it was if that is not in the slot."""
    gap = state.gap
    if gap.layout == GapLayout.NONE:
        return state
    e = along_of(gap)
    x = echo.x - gap.a.x
    y = echo.y - gap.a.y
    s = x * e.x + y * e.y
    depth = x * math.cos(gap.into) + y * math.sin(gap.into) - gap.front
    straight = abs(math.cos(echo.heading - gap.into)) > STRAIGHT
    inside = INSIDE < s < gap.width - INSIDE and depth > LEAST_DEPTH and straight
    return state._replace(gap=gap._replace(depth=min(gap.depth, depth))) if inside else state
