"""The valet at one sample: look for a slot, plan a bounded amount, set the wheel, drive a piece, halt, plan anew."""

from controller_fmu.common.chart import bit
from controller_fmu.common.external_slot import SlotKind
from controller_fmu.common.monitor import Command
from controller_fmu.interface import Reason
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.gap import GapLayout
from controller_fmu.sensing.heard_store import forget_side
from controller_fmu.valet.chart import Guard, Step, step_transition
from controller_fmu.valet.driven import AT_END, heard_on, moved_on, seen_on
from controller_fmu.valet.found.at_end import is_beside, listened_on, listens, waits
from controller_fmu.valet.found.nearby import forget_nearby
from controller_fmu.valet.found.search import Search, begin_search, reason_to_end, search, told_slot, with_map
from controller_fmu.valet.found.second_look import looked_again
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.planned import gap_now, goal_now, planned_on, room_beside_car
from controller_fmu.valet.rolling import rest_before
from controller_fmu.valet.signals import ValetInput
from controller_fmu.valet.slot import is_in_place
from controller_fmu.valet.state import ValetState
from controller_fmu.valet.watch import fault_of, reason_to_fail, watch

DRIVEN_ON = 0.3
CORRECTIONS = 4
"""After so many plans a car stays in a slot where it is, even if what it heard on the way in tells a better place."""
CORRECTION_ROOM = 0.55
"""And in a slot that leaves it less room [m] to its neighbours than this."""


def valet_sample(
    store: PlanStore, state: ValetState, inputs: ValetInput, params: ValetParams, dt_ns: int
) -> ValetState:
    """Return the valet one sample of ``dt_ns`` later."""
    if state.step in (Step.PARKED, Step.FAILED, Step.TAKEN_OVER):
        return _switched_off(state, inputs, params)
    if state.step in (Step.OFF, Step.SEARCH, Step.SHOWN):
        return sought_on(store, state, inputs, params, dt_ns)
    if state.step == Step.PLAN:
        state = planned_on(store, state, inputs, params)
        state = looked_again(store, state, params)
    else:
        state = seen_on(store, state, inputs, params)
        if params.search.active and state.step in (Step.DRIVE, Step.HALT):
            state = heard_on(store, state, inputs, params, dt_ns)
        if listens(state, inputs.odometry, params):
            state = listened_on(store, state, inputs, params, dt_ns)
    command = Command(state.step, state.wheel, state.sight.blocked)
    clocks = watch(state.watch, command, inputs, params, dt_ns)
    reason = state.reason
    if reason == Reason.NONE:
        reason = reason_to_fail(clocks, inputs, state.step, state.manoeuvres, params)
    state = state._replace(watch=clocks, reason=reason)
    step = step_transition(state.step, guards_of(store, state, inputs, params))
    return moved_on(store, state, step, inputs, params)


def guards_of(store: PlanStore, state: ValetState, inputs: ValetInput, params: ValetParams) -> int:
    """Return the bits of the conditions that hold."""
    guard = params.guard
    tracked = state.tracked
    speed = inputs.measured_speed
    standing = abs(speed) <= params.threshold.standstill
    wheel = inputs.steering_wheel_angle
    straight = abs(wheel) <= params.threshold.steering_angle_reached and not waits(state, inputs.odometry, params)
    rolls_after = rest_before(state.path, state.piece, params).after if state.step == Step.SET_WHEEL else 0.0
    turned = max(params.threshold.steering_angle_reached, params.car.steering.rate_limit * rolls_after)
    stop = abs(speed) * params.drive.delay + 0.5 * speed * speed / params.drive.brake
    lost = abs(tracked.lateral_error) > guard.corridor or abs(tracked.heading_error) > guard.corridor_heading
    lost = lost or state.nearby.in_the_way
    blocked_long = state.watch.blocked * 1e-9 > guard.wait
    at_end = tracked.left <= AT_END and state.piece + 1 >= state.path.used
    goal = state.request.goal
    moved = False
    if params.search.active and standing and (state.plans < CORRECTIONS or listens(state, inputs.odometry, params)):
        gap = gap_now(store, state, params)
        if room_beside_car(gap, params) > CORRECTION_ROOM:
            goal = goal_now(state, gap, params)
            moved = not is_in_place(state.request.goal, goal, params)
    in_place = is_in_place(inputs.odometry, goal, params) and not is_beside(state, inputs.odometry, goal, params)
    return (
        bit(Guard.TAKEN_OVER, inputs.driver_takeover or (params.search.active and not inputs.apa_switch))
        | bit(Guard.FAULT, state.reason != Reason.NONE)
        | bit(Guard.PLANNED, state.searched > 0 and state.path.used > 0)
        | bit(Guard.WHEEL_SET, abs(wheel - state.wheel) <= turned and not state.sight.blocked)
        | bit(Guard.MUST_HALT, tracked.ahead.left <= stop - state.early or state.sight.blocked or lost)
        | bit(Guard.STANDING_LOST, standing and (lost or blocked_long or moved))
        | bit(Guard.STANDING_AT_END, standing and at_end)
        | bit(Guard.STANDING, standing and not state.sight.blocked)
        | bit(Guard.IN_PLACE, straight and in_place)
        | bit(Guard.MISSED, straight and not in_place)
    )


def sought_on(store: PlanStore, state: ValetState, inputs: ValetInput, params: ValetParams, dt_ns: int) -> ValetState:
    """Return the valet after one sample in which the driver drives, or looks at the slot that is shown."""
    sought = state.search
    standing = abs(inputs.measured_speed) <= params.threshold.standstill
    reason = fault_of(inputs)
    if state.step == Step.SEARCH and reason == Reason.NONE:
        told = state.told.kind != SlotKind.NONE
        reason = sought.refused if told else reason
        sought = search(store, sought, inputs, params, dt_ns)
        if told and reason == Reason.NONE:
            sought = told_slot(store, sought, state.told, inputs, params)
        waits = standing and sought.gap.layout == GapLayout.NONE
        sought = sought._replace(waited_ns=sought.waited_ns + dt_ns if waits else 0)
        reason = reason if reason != Reason.NONE else reason_to_end(sought, params)
    if state.step == Step.SHOWN and reason == Reason.NONE:
        state = planned_on(store, state, inputs, params)
        state = looked_again(store, state, params)
        sought = state.search
        sought = sought._replace(waited_ns=sought.waited_ns + dt_ns if state.path.used > 0 else 0)
        reason = Reason.TIMEOUT if sought.waited_ns * 1e-9 > params.search.confirm else Reason.NONE
    if state.step == Step.SHOWN and state.reason != Reason.NONE:
        sought = sought._replace(refused=state.reason)
    step = step_transition(state.step, _sought_guards(state, sought, reason, inputs, standing))
    state = state._replace(search=sought, reason=reason)
    if step == Step.SEARCH and state.step != Step.SEARCH:
        state = _to_search(store, state)
    if step == Step.SHOWN and state.step != Step.SHOWN:
        state = _to_show(store, state, inputs, params)
    return moved_on(store, state, step, inputs, params)


def _sought_guards(state: ValetState, sought: Search, reason: int, inputs: ValetInput, standing: bool) -> int:
    """Return the bits of the conditions that hold while a slot is looked for, or shown."""
    dx = inputs.odometry.x - sought.pose.x
    dy = inputs.odometry.y - sought.pose.y
    return (
        bit(Guard.SWITCHED_ON, inputs.apa_switch)
        | bit(Guard.RESUMED, inputs.apa_switch and state.resumes and standing)
        | bit(Guard.SWITCHED_OFF, not inputs.apa_switch)
        | bit(Guard.FAULT, reason != Reason.NONE)
        | bit(Guard.FOUND, standing and sought.gap.layout != GapLayout.NONE)
        | bit(Guard.REFUSED, state.step == Step.SHOWN and state.reason != Reason.NONE)
        | bit(Guard.DRIVEN_ON, dx * dx + dy * dy > DRIVEN_ON * DRIVEN_ON)
        | bit(Guard.CONFIRMED, inputs.driver_confirm and standing and state.path.used > 0)
    )


def _to_search(store: PlanStore, state: ValetState) -> ValetState:
    """Return the valet that begins to search; a slot that was shown is forgotten, and why it was not taken is not."""
    forget_side(store, 0)
    forget_side(store, 1)
    sought = state.search
    begun = begin_search(sought.clock_ns)
    if state.step == Step.SHOWN:
        begun = begun._replace(way=sought.way, refused=sought.refused)
    return ValetState(step=state.step, reason=state.reason, search=begun, told=state.told)


def _to_show(store: PlanStore, state: ValetState, inputs: ValetInput, params: ValetParams) -> ValetState:
    """Return the valet that shows the slot found, or the one that it was on its way into, and plans."""
    sought = state.search
    if not state.resumes:
        sought = with_map(store, sought, inputs, params)
    sought = sought._replace(waited_ns=0)
    sought = sought._replace(pose=inputs.odometry) if state.resumes else sought
    forget_nearby(store)
    return ValetState(step=state.step, search=sought, told=state.told)


def _switched_off(state: ValetState, inputs: ValetInput, params: ValetParams) -> ValetState:
    """Return the valet that is over, or off if it was switched off."""
    off = params.search.active and not inputs.apa_switch
    step = step_transition(state.step, bit(Guard.SWITCHED_OFF, off))
    if step == state.step:
        return state
    resumes = state.step != Step.PARKED and state.search.gap.layout != GapLayout.NONE
    return ValetState(step=step, search=state.search, told=state.told, resumes=resumes)
