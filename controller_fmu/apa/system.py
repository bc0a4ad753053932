"""The parking assist at one sample: watch, search, plan and park, and let the outer chart decide."""

from typing import NamedTuple

from controller_fmu.apa.around.comer import is_odd
from controller_fmu.apa.around.guard import GuardState, learn_brake, listen
from controller_fmu.apa.around.local_map import begin_map, heard, moved
from controller_fmu.apa.around.nearer import explained, nearer_than_thought, pressed
from controller_fmu.apa.around.relocate import braked, walled
from controller_fmu.apa.around.row import driven_on, slot_of_map
from controller_fmu.apa.around.shifted import followed, relocated
from controller_fmu.apa.around.surroundings import Around, shape_of
from controller_fmu.apa.chart import Guard, Mode, transition
from controller_fmu.apa.hearing.deaf import without_deaf
from controller_fmu.apa.hearing.mute import spared, usable
from controller_fmu.apa.hearing.search import SearchState, begin_search, number_chosen, search, without
from controller_fmu.apa.hearing.stir import QUIET
from controller_fmu.apa.manoeuvre_chart import Step
from controller_fmu.apa.out.standing_in import slot_around
from controller_fmu.apa.out.within import heard_within
from controller_fmu.apa.params import ApaSystemParams
from controller_fmu.apa.parking import (
    Parking,
    cut_short,
    has_failed,
    is_planned,
    is_planning,
    park,
    site_for,
    start_planning,
)
from controller_fmu.apa.signals import ApaInput
from controller_fmu.apa.slot import Kind, Slot
from controller_fmu.apa.told import ToldWatch, watch_told
from controller_fmu.apa.watch import STANDING, Duty, Watch, is_taken_over, reason_to_fail, watch
from controller_fmu.common.chart import bit
from controller_fmu.common.driver_selection import ChosenTask
from controller_fmu.common.external_slot import SlotKind
from controller_fmu.common.monitor import Command
from controller_fmu.common.sensors import RangeSample, update_sample
from controller_fmu.interface import Reason
from modelkit.vocabulary import Pose

DRIVEN_ON = 0.3
NEAR = 12.0
"""A slot that was driven into is still known so far [m] from it."""
LOST = 1.0
LOOKED_FOR = 3.0
"""What is still in the way after so long [s] is not passing by: a neighbour may stand nearer than the map has him.
So may one who was heard to move, before the car goes on."""
SHALLOWER = 0.3
"""A slot that turns out to be so much [m] less deep needs another plan."""


class ApaState(NamedTuple):
    """Everything the parking assist remembers."""

    mode: int = Mode.OFF
    reason: int = Reason.NONE
    taken_over: bool = False
    clock_ns: int = 0
    listened: RangeSample = RangeSample()
    """What the sensors told last."""
    search: SearchState = SearchState()
    around: Around = Around()
    parking: Parking = Parking()
    watch: Watch = Watch()
    waited_ns: int = 0
    """For the driver to confirm, or to drive on in the search."""
    pose: Pose = Pose()
    """Where the car stood when the slot was shown."""
    told: ToldWatch = ToldWatch()
    chosen: int = 0
    """Number of the slot remembered that the driver means; 0: none."""
    shown: int = 0
    """Number of the slot shown among those remembered; 0: it is none of them."""
    task: int = ChosenTask.PARK
    """What the driver wants."""
    resumes: bool = False
    """Switched off on the way; the slot is still known."""


def apa_start(params: ApaSystemParams) -> ApaState:
    """Return the system switched off."""
    return ApaState()


class Judged(NamedTuple):
    """Why the drive cannot go on, and whether the driver has taken the car back."""

    reason: int
    taken: bool


def apa_sample(state: ApaState, inputs: ApaInput, params: ApaSystemParams, dt_ns: int) -> ApaState:
    """Return the assist one sample of ``dt_ns`` later."""
    driving = state.mode in (Mode.AUTO_PARKING_ASSIST, Mode.POSITION_TUNING)
    heard_now = without_deaf(inputs.ultrasonic, state.around.guard.silences)
    inputs = inputs._replace(ultrasonic=usable(heard_now, params.car.ultrasonic.min_range))
    heard_last = update_sample(state.listened, inputs.ultrasonic, state.clock_ns, dt_ns, params.car.ultrasonic.cycle)
    state = state._replace(listened=heard_last)
    command = Command(state.parking.step, state.parking.wheel, state.parking.sight.blocked)
    looking = state.mode in (Mode.STANDBY, Mode.PARKING_SPACE_SEARCH) and not has_slot(state)
    out = state.parking.out or inputs.driver_selection.task == ChosenTask.PULL_OUT
    duty = Duty(driving, 0 if out else spared(inputs.ultrasonic, looking))
    state = state._replace(watch=watch(state.watch, command, inputs, duty, params, dt_ns))
    taken = driving and is_taken_over(state.watch, inputs, params)
    reason = reason_to_fail(state.watch, inputs, driving, params, state.task) if state.mode != Mode.OFF else Reason.NONE
    if reason == Reason.NONE and not taken:
        if state.mode in (Mode.PARKING_SPACE_SEARCH, Mode.PARKING_SPACE_APPEARS):
            state = state._replace(
                search=search(state.search, inputs, shape_of(params), params, dt_ns, state.listened.fresh)
            )
        if state.mode in (Mode.STANDBY, Mode.PARKING_SPACE_SEARCH):
            state = _chosen(state, inputs, params, dt_ns)
        elif state.mode == Mode.PARKING_SPACE_APPEARS:
            state = state._replace(
                chosen=number_chosen(state.search, inputs.driver_selection.side, inputs.driver_selection.slot)
            )
        if driving or state.mode == Mode.PARKING_SPACE_APPEARS:
            state = _parked_on(state, inputs, driving, params, dt_ns)
    judged = Judged(_later_reason(reason, state, params), taken)
    mode = transition(state.mode, _guards(state, inputs, judged, params))
    return _moved_on(state, mode, inputs, judged, params, dt_ns)


def _chosen(state: ApaState, inputs: ApaInput, params: ApaSystemParams, dt_ns: int) -> ApaState:
    """Return the assist that knows which slot is meant, of those that it has found or from outside."""
    told = watch_told(state.told, state.search, inputs, state.listened.fresh, shape_of(params), params)
    number = number_chosen(state.search, inputs.driver_selection.side, inputs.driver_selection.slot)
    if inputs.external_slot.kind != SlotKind.NONE:
        number = 0
    return state._replace(told=told, chosen=number, task=inputs.driver_selection.task)


def _parked_on(state: ApaState, inputs: ApaInput, driving: bool, params: ApaSystemParams, dt_ns: int) -> ApaState:
    """Return the assist that has listened, where its sensors tell something new, and gone on with the manoeuvre."""
    stopping = driving and state.parking.step != Step.DRIVE
    state = state._replace(
        around=state.around._replace(
            guard=learn_brake(state.around.guard, inputs.measured_speed, stopping, dt_ns, params),
            mute_ns=state.watch.mute,
        )
    )
    if state.listened.fresh:
        state = _listened(state, inputs, driving, params)
    steering = state.watch.wheel.steering
    return state._replace(parking=park(state.parking, state.around, inputs, steering, driving, params))


def _listened(state: ApaState, inputs: ApaInput, driving: bool, params: ApaSystemParams) -> ApaState:
    """Return the assist that has drawn what its sensors tell into its map."""
    parking = state.parking
    slot = state.around.slot
    here = state.around.map
    shifts = state.around.shifts
    guard = state.around.guard
    here = moved(here, inputs.odometry, params.apa.map)
    here = heard(here, inputs.ultrasonic, params.car.ultrasonic, params.apa.map)
    here = heard_within(here, inputs.ultrasonic, params.car.ultrasonic) if here.within else here
    halted = parking.step in (Step.HALT, Step.SET_WHEEL) and abs(inputs.measured_speed) <= STANDING
    if halted and guard.quiet >= QUIET:
        here = walled(here, slot, inputs, parking.sight.blocked, params)
    if abs(inputs.measured_speed) > STANDING:
        shifts = followed(shifts, here, inputs.ultrasonic, params.car.ultrasonic)
        found = relocated(here, shifts, inputs.ultrasonic, params.car.ultrasonic)
        here = found.map
        shifts = found.shifts
    guard = listen(guard, inputs.ultrasonic, here, params)
    if driving and abs(inputs.measured_speed) <= STANDING:
        here = driven_on(here, guard.tracks, inputs.ultrasonic, params)
    if halted and _may_stand_nearer(state, guard, params):
        there = nearer_than_thought(here, inputs.ultrasonic, params)
        if there.found:
            here = there.map
            guard = explained(guard, inputs.ultrasonic, here, params)
            parking = cut_short(parking)
    if parking.stuck:
        here = pressed(here, inputs.ultrasonic, params)
        parking = parking._replace(stuck=False)
    slot = slot_of_map(here, slot, params.apa.map)
    parking = cut_short(parking) if slot.depth < state.around.slot.depth - SHALLOWER else parking
    return state._replace(around=Around(slot, here, guard, shifts, state.around.mute_ns), parking=parking)


def _may_stand_nearer(state: ApaState, guard: GuardState, params: ApaSystemParams) -> bool:
    """Return whether a standing car asks if a neighbour is nearer than the map has him."""
    parking = state.parking
    stays = parking.sight.unknown and state.watch.blocked * 1e-9 > LOOKED_FOR
    goes_on = guard.quiet < QUIET <= guard.quiet + 2.0 * params.car.ultrasonic.cycle
    return stays or (goes_on and is_odd(guard.comers) and not parking.out)


def _later_reason(reason: int, state: ApaState, params: ApaSystemParams) -> int:
    if reason != Reason.NONE:
        return reason
    parking = state.parking
    if state.mode in (Mode.AUTO_PARKING_ASSIST, Mode.POSITION_TUNING):
        if has_failed(parking, state.around.slot.kind, params):
            return _no_way(state, params)
        if abs(parking.tracked.lateral_error) > LOST:
            return Reason.LEFT_PATH
    looking = state.mode == Mode.PARKING_SPACE_SEARCH or (state.mode == Mode.STANDBY and params.apa.search.given)
    if looking and state.told.refused != Reason.NONE:
        return state.told.refused
    if state.mode == Mode.PARKING_SPACE_SEARCH and state.search.way > params.apa.search.way:
        refused = Reason.SLOT_TOO_SHALLOW if state.search.refused.shallow else Reason.SLOT_TOO_SHORT
        return refused if state.search.refusals > 0 else Reason.NO_SLOT
    if state.waited_ns * 1e-9 > params.apa.guard.confirm:
        return Reason.TIMEOUT if state.mode == Mode.PARKING_SPACE_APPEARS else Reason.NOT_MOVING
    shows = state.mode == Mode.PARKING_SPACE_APPEARS and state.shown == 0
    if shows and has_failed(parking, state.around.slot.kind, params):
        return _no_way(state, params)
    return Reason.NONE


def _no_way(state: ApaState, params: ApaSystemParams) -> int:
    """Return why no way leads on: what ends a perpendicular slot may leave no place in line with the neighbours."""
    parking = state.parking
    site = site_for(state.around.slot, parking.attempt, parking.out, params)
    if site.x_high < site.x_low and not parking.out:
        return Reason.SLOT_TOO_SHALLOW
    if parking.missed:
        return Reason.MISSED_TARGET
    return Reason.TOO_MANY_SHIFTS if parking.plan.found else Reason.NO_PATH


def _guards(state: ApaState, inputs: ApaInput, judged: Judged, params: ApaSystemParams) -> int:
    given = params.apa.search.given
    speed = abs(inputs.measured_speed)
    standing = speed <= STANDING
    limit = params.apa.search.speed
    parking = state.parking
    dx = inputs.odometry.x - state.pose.x
    dy = inputs.odometry.y - state.pose.y
    moved = dx * dx + dy * dy > DRIVEN_ON * DRIVEN_ON
    out = inputs.driver_selection.task == ChosenTask.PULL_OUT
    told = inputs.external_slot.kind != SlotKind.NONE
    known = given and (state.told.slot.kind if told else params.apa.search.slot.kind) != Kind.NONE
    another = state.shown > 0 and state.chosen != state.shown
    return (
        bit(Guard.SWITCHED_OFF, not inputs.apa_switch)
        | bit(Guard.TAKEN_OVER, judged.taken or not inputs.apa_switch)
        | bit(Guard.FAULT, judged.reason != Reason.NONE)
        | bit(Guard.SWITCHED_ON, inputs.apa_switch)
        | bit(Guard.READY, not given and not out and speed <= limit)
        | bit(Guard.SLOT_GIVEN, (known or out or state.resumes) and standing)
        | bit(Guard.TOO_FAST, speed > 1.1 * limit)
        | bit(Guard.SLOT_AT_STANDSTILL, has_slot(state) and standing)
        | bit(Guard.NO_PLAN, state.shown > 0 and has_failed(state.parking, state.around.slot.kind, params))
        | bit(Guard.DRIVEN_ON, (not given and moved) or another)
        | bit(Guard.CONFIRMED, inputs.driver_confirm and standing and is_planned(parking))
        | bit(Guard.NEARLY, parking.step == Step.PLAN and parking.ended and is_planning(parking) and not parking.out)
        | bit(Guard.ENDED, parking.step == Step.DONE)
        | bit(Guard.WANTS_OUT, out)
    )


def _moved_on(
    state: ApaState, mode: int, inputs: ApaInput, judged: Judged, params: ApaSystemParams, dt_ns: int
) -> ApaState:
    """Return the assist in ``mode``."""
    before = state.mode
    had_taken_over = state.taken_over
    why = judged.reason if before != Mode.FAIL else state.reason
    waiting = mode == before and _is_waiting(mode, state.parking, inputs)
    state = state._replace(
        mode=mode, clock_ns=state.clock_ns + dt_ns, waited_ns=state.waited_ns + dt_ns if waiting else 0
    )
    if mode in (Mode.OFF, Mode.STANDBY) or before == Mode.STANDBY:
        state = state._replace(search=begin_search(inputs.odometry))
    state = state._replace(resumes=_resumes(state, before, inputs))
    if mode in (Mode.OFF, Mode.STANDBY):
        state = state._replace(parking=Parking(), watch=Watch())
    if mode == Mode.OFF and not state.resumes:
        state = state._replace(around=state.around._replace(slot=Slot()))
    if mode == Mode.PARKING_SPACE_SEARCH and before == Mode.PARKING_SPACE_APPEARS:
        state = _without_the_slot(state, has_failed(state.parking, state.around.slot.kind, params))
    if mode == Mode.PARKING_SPACE_APPEARS and before != Mode.PARKING_SPACE_APPEARS:
        state = _shown(state, inputs, params)
    over = mode == Mode.FAIL
    switched_off = before != Mode.FAIL and (judged.taken or not inputs.apa_switch)
    taken_over = (had_taken_over or switched_off) if over else False
    return state._replace(taken_over=taken_over, reason=why if over and not taken_over else Reason.NONE)


def has_slot(state: ApaState) -> bool:
    """Return whether there is a slot to be shown: one that was found and is meant, or one from outside."""
    return state.chosen > 0 or state.told.slot.kind != Kind.NONE


def _resumes(state: ApaState, before: int, inputs: ApaInput) -> bool:
    """Return whether the slot is still known that the car was driven into, or out of, and it is still there."""
    if state.mode == Mode.OFF and before == Mode.FAIL:
        return state.parking.direction != 0
    slot = state.around.slot
    dx = inputs.odometry.x - slot.a.x
    dy = inputs.odometry.y - slot.a.y
    near = dx * dx + dy * dy < NEAR * NEAR
    return state.resumes and near and state.mode in (Mode.OFF, Mode.STANDBY, Mode.PARKING_SPACE_APPEARS)


def _without_the_slot(state: ApaState, failed: bool) -> ApaState:
    """Return the assist that searches on; a slot that nothing leads into is not shown again."""
    if failed:
        state = state._replace(search=without(state.search, state.shown))
    return state._replace(parking=Parking(), around=state.around._replace(slot=Slot()))


def _is_waiting(mode: int, parking: Parking, inputs: ApaInput) -> bool:
    """Return whether the driver is to confirm, or stands in the search and is to drive on."""
    if mode == Mode.PARKING_SPACE_APPEARS:
        return is_planned(parking)
    return mode == Mode.PARKING_SPACE_SEARCH and abs(inputs.measured_speed) <= STANDING


def _shown(state: ApaState, inputs: ApaInput, params: ApaSystemParams) -> ApaState:
    """Return the assist that shows the slot that is meant, with its map of it, and plans the way in, or out."""
    out = inputs.driver_selection.task == ChosenTask.PULL_OUT
    number = state.chosen
    slot = params.apa.search.slot
    here = state.around.map
    if state.resumes:
        slot = state.around.slot
        number = 0
    elif out:
        slot = slot_around(inputs, shape_of(params), params)
        number = 0
    elif inputs.external_slot.kind != SlotKind.NONE:
        slot = state.told.slot
    elif number > 0:
        slot = braked(state.search.slots[number - 1], state.search.fastest, params)
    if not state.resumes:
        here = begin_map(slot, inputs.odometry, params.apa.map)._replace(within=out)
    return state._replace(
        around=Around(slot, here, GuardState(delay=state.around.guard.delay, shown=state.around.guard.shown)),
        parking=start_planning(slot, inputs.odometry, out, state.resumes, params),
        pose=inputs.odometry,
        shown=number,
    )
