"""The parking manoeuvre at one sample: plan, set the wheel, drive, halt, plan again, straighten."""

import math
from typing import NamedTuple

from controller_fmu.apa.around.guard import Sight
from controller_fmu.apa.around.surroundings import (
    Around,
    Settled,
    is_rest_free,
    is_sure,
    settled_in,
    shape_of,
    sight_of,
)
from controller_fmu.apa.manoeuvre_chart import Guard as StepGuard
from controller_fmu.apa.manoeuvre_chart import Step, step_transition
from controller_fmu.apa.out.limits import CUTS, MOVES, SHIFTS, margins_out, next_attempt_out, with_lock
from controller_fmu.apa.out.pull_out import OutSearch, plan_out
from controller_fmu.apa.outline import Shape
from controller_fmu.apa.params import ApaSystemParams
from controller_fmu.apa.signals import ApaInput
from controller_fmu.apa.slot import Kind, Margins, Site, Slot, no_deeper, site_of
from controller_fmu.apa.speed import planned_speed, stopping_way
from controller_fmu.apa.tracking import Leg, Tracked, next_standstill, set_wheel, track
from controller_fmu.apa.watch import STANDING
from controller_fmu.apa.ways.fit import closer, following, is_wide, margins_of, under_way
from controller_fmu.apa.ways.move import length_of
from controller_fmu.apa.ways.planner import FOUND, NOTHING, SEARCHING, PlanSearch, new_search, search_on
from controller_fmu.common.chart import bit
from controller_fmu.common.params import Longitudinal
from controller_fmu.common.slot_frame import to_slot
from controller_fmu.common.steering_monitor import Steering, rate_of
from controller_fmu.common.steering_wheel import wheel_request
from modelkit.vocabulary import Pose

AT_END = 0.04
"""Left of a move [m] that is not worth driving."""
AT_JUMP = 0.06
"""A car that halts nearer than this [m] to a jump of curvature has halted for it."""
X_TOLERANCE = 0.08
LEAD = 0.15
"""A drive is asked for no more than this [m/s] above the speed it has: on a slippery slope a larger error makes the
pedals wind up, the driven wheels spin at full lock, and the car turns by twice what its odometry says."""
SHIFTED = 0.08
TURNED = 0.03
"""A plan is made again where the slot turns out to lie so far [m] elsewhere, or turned so much [rad]."""
LEVEL_OUT = 0.035
"""A car beside the road is worth tuning, too, while its nose or tail stands out of the line by more than this [m]."""
SHIFTS_PERPENDICULAR = 7
"""Most manoeuvres into a perpendicular slot (GB/T 41630)."""
TRIED = 6
"""After so many manoeuvres a car in place does not drive deeper only to be surer that it is in the slot."""
MOST_CUTS = 8
"""A car whose moves were cut short more often than this finds no way."""


class Parking(NamedTuple):
    """Everything the manoeuvre remembers."""

    step: int = Step.IDLE
    plan: PlanSearch = PlanSearch()
    out: bool = False
    """On the way out of the slot."""
    way_out: OutSearch = OutSearch()
    attempt: int = 0
    """Odd: the car may stand out of the slot a little; each two more: smaller margins, see ``fit``."""
    leg: Leg = Leg()
    tracked: Tracked = Tracked()
    manoeuvres: int = 0
    direction: int = 0
    """Last driven, 0: not yet."""
    ended: bool = False
    """The last of the planned moves is driven."""
    cut: bool = False
    """The move was cut short by something of the slot that is nearer than thought: plan again."""
    missed: bool = False
    """The car stands as planned, the sensors say that it is not in the slot, and no move leads deeper."""
    cuts: int = 0
    """Moves that were cut short so far."""
    stuck: bool = False
    """The last one was before the car had moved."""
    sight: Sight = Sight()
    wheel: float = 0.0
    """Steering-wheel angle asked for [rad]."""
    speed: float = 0.0
    """Speed asked for or advised [m/s], reverse negative."""


def site_for(slot: Slot, attempt: int, out: bool, params: ApaSystemParams) -> Site:
    """Return the slot as the planner sees it in this attempt to come in, or ``out``."""
    car = shape_of(params)
    if out:
        return site_of(slot, car, margins_out(attempt, params.apa))
    margins = margins_of(attempt, params.apa)
    return site_of(no_deeper(slot, car, margins), car, margins)


class CarAtSite(NamedTuple):
    """The slot as the planner sees it in an attempt, and where the car is in the frame of its target."""

    site: Site
    pose: Pose


def place_for(slot: Slot, attempt: int, out: bool, odometry: Pose, params: ApaSystemParams) -> CarAtSite:
    """Return the slot of an attempt and the car in it."""
    site = site_for(slot, attempt, out, params)
    return CarAtSite(site, to_slot(odometry, site.frame))


def next_attempt(state: Parking, plan: PlanSearch, site: Site, params: ApaSystemParams) -> int:
    """Return the attempt to make after a search that led nowhere; the same if there is none.

    Before it sets out, a car that needs more than few manoeuvres is tried with closer margins first; then a
    parallel one may stand out, then come closer still. A car under way may come closer step by step.
    """
    nothing = plan.status == NOTHING
    if state.out:
        return next_attempt_out(state.attempt, plan, more_shifts(state, plan), state.direction)
    sparing = (state.direction == 0 and state.attempt == 0) or (site.kind == Kind.PARALLEL and is_wide(state.attempt))
    most = params.apa.end.few if sparing else most_shifts(site.kind, False, params)
    too_many = plan.status == FOUND and more_shifts(state, plan) > most
    if not (nothing or too_many):
        return state.attempt
    return following(state.attempt, site.kind) if state.direction == 0 else closer(state.attempt)


def is_in_place(place: CarAtSite, lateral: float, heading: float) -> bool:
    """Return whether the car is within these limits of its target, and its x where it may end."""
    pose = place.pose
    site = place.site
    return (
        abs(pose.y) <= lateral
        and abs(pose.heading) <= heading
        and site.x_low - X_TOLERANCE <= pose.x <= site.x_high + X_TOLERANCE
    )


def end_out(place: CarAtSite, car: Shape) -> float:
    """Return how far [m] nose or tail of a car in a parallel slot stand out further than its side should; else 0."""
    if place.site.kind != Kind.PARALLEL:
        return 0.0
    s = math.sin(place.pose.heading)
    return place.pose.y + max(car.front * s, -car.rear * s)


def park(
    state: Parking,
    around: Around,
    inputs: ApaInput,
    steering: Steering,
    allowed: bool,
    params: ApaSystemParams,
) -> Parking:
    """Return the manoeuvre one sample later; while not ``allowed`` the first plan is made, and no more."""
    place = place_for(around.slot, state.attempt, state.out, inputs.odometry, params)
    if state.step == Step.PLAN:
        car = shape_of(params)
        if has_shifted(state, place.pose) or (around.mute_ns > 0 and state.plan.barred != 0):
            state = state._replace(plan=new_search(place.pose))
        if state.out:
            car = with_lock(car, params.apa)
            looked = plan_out(state.way_out, place.pose, place.site, car, MOVES[state.attempt])
            plan = looked.plan
            state = state._replace(way_out=looked.search)
        else:
            plan = search_on(state.plan, place.site, car, params.apa.plan.at_a_time)
        attempt = next_attempt(state, plan, place.site, params)
        if attempt != state.attempt and plan.barred != 0:
            plan = new_search(place.pose)
            attempt = state.attempt
        if attempt != state.attempt:
            place = place_for(around.slot, attempt, state.out, inputs.odometry, params)
            plan = new_search(place.pose)
            state = state._replace(way_out=OutSearch())
        state = state._replace(plan=plan, attempt=attempt)
    state = state._replace(sight=Sight())
    if state.step in (Step.DRIVE, Step.HALT, Step.SET_WHEEL):
        state = _looked_around(state, place, around, inputs, params)
    settled = settled_in(inputs, around, params) if state.step == Step.PLAN else Settled()
    step = step_transition(state.step, _guards(state, place, inputs, settled, allowed, params))
    limit = params.apa.end
    in_vain = state.step == Step.PLAN and not settled.enough and is_in_place(place, limit.lateral, limit.heading)
    missed = in_vain and not state.out and (state.plan.status == NOTHING or not is_sure(inputs, around, params))
    state = state._replace(missed=missed)
    return _moved_on(state, step, place, steering, inputs.measured_speed, params)


def has_shifted(state: Parking, pose: Pose) -> bool:
    """Return whether the slot has moved under a car at ``pose`` that has its first plan and has not set out."""
    start = state.plan.move.start
    dx = pose.x - start.x
    dy = pose.y - start.y
    far = dx * dx + dy * dy > SHIFTED * SHIFTED or abs(pose.heading - start.heading) > TURNED
    return far and state.plan.status == FOUND and state.direction == 0 and not state.out


def _looked_around(
    state: Parking, place: CarAtSite, around: Around, inputs: ApaInput, params: ApaSystemParams
) -> Parking:
    """Return the manoeuvre that has looked where it is along its move, and what is in the way."""
    move = state.plan.move
    tracked = track(move, state.leg, state.tracked.way, place.pose, params.apa.drive, params.car.wheelbase)
    bare = site_of(around.slot, shape_of(params), Margins(0.0, 0.0, 0.0))
    sight = sight_of(move.direction, bare, around, inputs, params)
    leads_away = state.out or state.manoeuvres <= 1
    if state.step == Step.DRIVE and not is_rest_free(move, tracked, place.site, bare, leads_away, params):
        sight = sight._replace(blocked=True, unknown=False)
    return state._replace(tracked=tracked, sight=sight)


def _guards(
    state: Parking, place: CarAtSite, inputs: ApaInput, settled: Settled, allowed: bool, params: ApaSystemParams
) -> int:
    apa = params.apa
    standing = abs(inputs.measured_speed) <= STANDING
    own = apa.drive.longitudinal == Longitudinal.OWN_SPEED
    stop = stopping_way(inputs.measured_speed, apa.drive, apa.drive.delay if own else apa.drive.reaction)
    limit = apa.end
    right = is_in_place(place, limit.lateral, limit.heading) and end_out(place, shape_of(params)) <= LEVEL_OUT
    if state.manoeuvres >= limit.few:
        right = right or is_in_place(place, limit.near_lateral, limit.near_heading)
    well_enough = is_in_place(place, limit.final_lateral_error, limit.final_heading_error)
    plan = state.plan
    sight = state.sight
    tracked = state.tracked
    stuck = (
        state.cuts > most_cuts(state.out)
        or plan.status == NOTHING
        or (plan.status == FOUND and more_shifts(state, plan) > most_shifts(place.site.kind, state.out, params))
    )
    wheel = inputs.steering_wheel_angle
    set_up = abs(wheel - state.wheel) <= params.threshold.steering_angle_reached
    at_end = tracked.left <= AT_END or state.cut
    well_settled = settled.surely or (settled.enough and state.manoeuvres >= TRIED)
    in_place = (well_settled and right) or (settled.enough and stuck and well_enough and allowed)
    if state.out:
        in_place = plan.status == FOUND and plan.moves == 0 and allowed
    return (
        (1 << StepGuard.STARTED)
        | bit(StepGuard.IN_PLACE, in_place)
        | bit(StepGuard.PLANNED, plan.status == FOUND and not stuck and allowed)
        | bit(StepGuard.WHEEL_SET, set_up and not (sight.blocked and sight.unknown))
        | bit(StepGuard.MUST_HALT, tracked.to_stop <= stop or sight.blocked)
        | bit(StepGuard.STANDING_AT_END, standing and at_end)
        | bit(StepGuard.STANDING_TO_GO_ON, standing and not at_end and not sight.blocked)
        | bit(StepGuard.WHEEL_STRAIGHT, abs(wheel) <= params.threshold.steering_angle_reached)
    )


def more_shifts(state: Parking, plan: PlanSearch) -> int:
    """Return the manoeuvres at the end of the plan: those driven and at least those to come."""
    first = 0 if plan.move.direction == state.direction or (state.manoeuvres == 0 and plan.move.direction > 0) else 1
    return state.manoeuvres + first + plan.moves - 1


def most_shifts(kind: int, out: bool, params: ApaSystemParams) -> int:
    """Return the most manoeuvres into a slot of this kind, or ``out`` of any."""
    if out:
        return SHIFTS
    most = params.apa.plan.manoeuvres
    return min(most, SHIFTS_PERPENDICULAR) if kind == Kind.PERPENDICULAR else most


def most_cuts(out: bool) -> int:
    """Return how many moves may be cut short, on the way in or ``out``."""
    return CUTS if out else MOST_CUTS


def has_failed(state: Parking, kind: int, params: ApaSystemParams) -> bool:
    """Return whether no way leads on from here into a slot of this kind."""
    stuck = state.plan.status == NOTHING or state.cuts > most_cuts(state.out) or state.missed
    return state.step == Step.PLAN and (
        stuck or (state.plan.status == FOUND and more_shifts(state, state.plan) > most_shifts(kind, state.out, params))
    )


def _moved_on(
    state: Parking, step: int, place: CarAtSite, steering: Steering, measured: float, params: ApaSystemParams
) -> Parking:
    """Return the manoeuvre in ``step``, with what it asks of wheel and speed until the next sample."""
    before = state.step
    mirror = place.site.frame.mirror
    state = state._replace(step=step, speed=0.0)
    if step == Step.HALT and before == Step.DRIVE:
        state = state._replace(cut=state.sight.blocked and not state.sight.unknown)
    if step == Step.PLAN and before != Step.PLAN:
        wide = place.site.kind == Kind.PARALLEL and state.manoeuvres < params.apa.end.few
        state = state._replace(
            cuts=state.cuts + 1 if state.cut else state.cuts,
            stuck=state.cut and state.tracked.way < AT_END,
            cut=False,
            ended=before == Step.HALT and state.plan.moves <= 1,
            attempt=max(state.attempt - 1, 0) if state.out else under_way(state.attempt, wide),
            plan=new_search(place.pose, state.plan.move.direction if _could_not_begin(state) else 0),
            way_out=OutSearch(),
        )
    if step == Step.SET_WHEEL:
        leg = _next_leg(state, before)
        if before == Step.PLAN:
            begun = Tracked(left=length_of(state.plan.move), to_stop=leg.end, reference=place.pose)
            state = state._replace(tracked=begun)
        front = set_wheel(state.plan.move, leg, state.tracked.way, params.car.wheelbase)
        state = state._replace(leg=leg, wheel=wheel_request(front, mirror, params))
    if step == Step.DRIVE:
        if before != Step.DRIVE:
            state = _set_out(state)
        state = state._replace(speed=state.direction * _speed(state, steering, measured, params))
    if step in (Step.DRIVE, Step.HALT):
        state = state._replace(wheel=wheel_request(state.tracked.front_wheel_angle, mirror, params))
    if step in (Step.STRAIGHTEN, Step.IDLE):
        state = state._replace(wheel=0.0)
    return state


def _could_not_begin(state: Parking) -> bool:
    """Return whether the guard, who may hear what the map does not have, let the car not begin its move."""
    return state.cut and state.tracked.way < AT_END and not state.out


def _set_out(state: Parking) -> Parking:
    """Return the manoeuvre at the begin of a leg; a change of direction is a shift, but for driving ahead at first."""
    direction = state.plan.move.direction
    if direction == state.direction:
        return state
    counted = state.manoeuvres > 0 or direction < 0
    return state._replace(manoeuvres=state.manoeuvres + 1 if counted else state.manoeuvres, direction=direction)


def _next_leg(state: Parking, before: int) -> Leg:
    """Return the part of the move to drive from this standstill on."""
    if before == Step.PLAN:
        return Leg(0.0, next_standstill(state.plan.move, 0.0))
    if before == Step.HALT and state.tracked.to_stop < AT_JUMP:
        return Leg(state.leg.end, next_standstill(state.plan.move, state.leg.end))
    return state.leg


def _speed(state: Parking, steering: Steering, measured: float, params: ApaSystemParams) -> float:
    """Return the speed [m/s] to ask for; of the drive no more than a little over the ``measured`` one: see LEAD."""
    tracked = state.tracked
    rate = rate_of(steering, params.car.steering.rate_limit) / params.car.steering.ratio
    speed = planned_speed(tracked.to_stop, tracked.slope, params.car.wheelbase, rate, params.apa.drive)
    if params.apa.drive.longitudinal == Longitudinal.OWN_SPEED:
        speed = min(speed, max(0.0, state.direction * measured) + LEAD)
    return max(params.apa.drive.creep, min(speed, state.sight.speed))


def start_planning(slot: Slot, pose: Pose, out: bool, resumes: bool, params: ApaSystemParams) -> Parking:
    """Return the manoeuvre at its beginning, ``out`` of the slot or into it, for a car at ``pose`` (world).

    A car that ``resumes`` may stand nearer to the neighbours than one that sets out: its margins are those under way.
    """
    attempt = under_way(0, True) if resumes and not out else 0
    site = site_for(slot, attempt, out, params)
    return Parking(step=Step.PLAN, plan=new_search(to_slot(pose, site.frame)), attempt=attempt, out=out)


def cut_short(state: Parking) -> Parking:
    """Return the manoeuvre whose move is not driven any further: it is planned again at standstill."""
    return state._replace(cut=True)


def is_planned(state: Parking) -> bool:
    """Return whether the first plan is found."""
    return state.step == Step.PLAN and state.plan.status == FOUND


def is_planning(state: Parking) -> bool:
    """Return whether the search for a plan goes on."""
    return state.step == Step.PLAN and state.plan.status == SEARCHING
