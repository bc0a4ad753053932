"""The valet drives: where it is on its path, what is in the way, what it asks of wheel and speed."""

import math

from controller_fmu.common.path_law import TrackingError, angle_back, deviation
from controller_fmu.common.sensors import is_new_sample
from controller_fmu.planning.plan import (
    Path,
)
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.planning.task import drive
from controller_fmu.valet.chart import Step
from controller_fmu.valet.found.beside import SideEchoes
from controller_fmu.valet.found.nearby import Rest, hear_nearby, is_in_gap, put_nearby
from controller_fmu.valet.found.search import shallower
from controller_fmu.valet.found.way_back import WayBack, way_back
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.rolling import Ahead, ahead_of, aim_at, joint_of, turns_already
from controller_fmu.valet.sight import end_ahead, heard_again, look, remembered, take_scene
from controller_fmu.valet.signals import ValetInput
from controller_fmu.valet.state import Tracked, ValetState
from modelkit.car import largest_curvature
from modelkit.maths import clamp, sign

AT_END = 0.03
"""Left of a piece [m] that is not worth driving."""
LEARNT = 0.6
"""Share of what a stop is off its place that the next stop makes up for."""
EARLIEST = 0.02
REGAINED = 0.5
"""Way [m]."""
SLOT_END = 0.8
"""What a car hears so near [m] straight ahead, in a slot, is what that ends at."""
BACKS = 3
"""A car goes back the way it came no more often in one drive."""


def seen_on(store: PlanStore, state: ValetState, inputs: ValetInput, params: ValetParams) -> ValetState:
    """Return the valet that has looked where it is on its path, and what is in the way."""
    if state.tracked.left <= 0.0 and joint_of(state.path, state.piece, params).ramp > 0.0:
        state = rolled_on(state)
    way = state.path.pieces[state.piece].way
    curvature = state.path.pieces[state.piece].k
    direction = sign(way)
    pose = inputs.odometry
    at = drive(state.begin, direction * (abs(way) - state.tracked.left), curvature)
    left = state.tracked.left
    for _ in range(2):
        ahead = (pose.x - at.x) * math.cos(at.heading) + (pose.y - at.y) * math.sin(at.heading)
        left = left - direction * ahead
        at = drive(state.begin, direction * (abs(way) - left), curvature)
    off = deviation(pose, at)
    law = params.drive
    soon = left - abs(inputs.measured_speed) * law.wheel_delay
    aim = aim_at(state.path, state.piece, left, params)
    asked = aim_at(state.path, state.piece, soon, params).curvature
    beside = TrackingError(led_back(off.lateral - aim.lateral, asked, params), off.heading - aim.heading)
    angle = angle_back(beside, asked, direction, law.k1, law.k2, params.car.wheelbase)
    coming = ahead_of(state.path, state.piece, left, params)
    if turns_already(coming, params):
        angle = math.atan(params.car.wheelbase * coming.rest.then)
    take_scene(store, params, state.seen)
    rest = state.path.pieces[state.piece]._replace(way=direction * max(coming.left, AT_END))
    sight = look(store, inputs, rest, state.search.gap, params)
    tracked = Tracked(left, at, off.lateral, off.heading, angle, coming)
    return state._replace(tracked=tracked, sight=heard_again(sight, state.sight))


def led_back(lateral: float, curvature: float, params: ValetParams) -> float:
    """Return as much of what the car is off its path [m] as it can take back and be in its direction again.

    Inside a bend at full lock the car can turn out, but hardly in again: there it leaves its direction by no more than
    what it can steer beyond the bend over ``REGAINED``.
    """
    spare = largest_curvature(params.car) - sign(lateral) * curvature
    most = max(0.0, spare) * REGAINED * params.drive.k2 / params.drive.k1 if params.drive.k1 > 0.0 else 0.0
    return clamp(lateral, -most, most)


def heard_on(store: PlanStore, state: ValetState, inputs: ValetInput, params: ValetParams, dt_ns: int) -> ValetState:
    """Return the valet that has listened on its way into a slot; sensors tell something new every ``cycle``."""
    if not is_new_sample(state.watch.running, dt_ns, params.car.ultrasonic.cycle):
        return state
    rest = Rest(state.path, state.piece, state.begin, state.tracked.left)
    nearby = hear_nearby(store, state.nearby, inputs, rest, state.search.gap, params)
    end = end_ahead(inputs, state.direction > 0.0, params)
    sought = shallower(state.search, end.echo) if end.heard and end.reading < SLOT_END else state.search
    return state._replace(nearby=nearby, search=sought)


def moved_on(store: PlanStore, state: ValetState, step: int, inputs: ValetInput, params: ValetParams) -> ValetState:
    """Return the valet in ``step``, with what it asks of wheel and speed until the next sample."""
    before = state.step
    if step == Step.PLAN and before != Step.PLAN:
        state = _to_plan_anew(store, state, params)
    if step == Step.SET_WHEEL and before != Step.SET_WHEEL:
        state = _with_piece(state, before, params)
    wheel = state.wheel
    speed = 0.0
    limit = params.car.steering.angle_limit
    ratio = params.car.steering.ratio
    if step == Step.SET_WHEEL:
        curvature = aim_at(state.path, state.piece, state.tracked.left, params).curvature
        wheel = clamp(ratio * math.atan(params.car.wheelbase * curvature), -limit, limit)
    if step == Step.DRIVE or step == Step.HALT:
        wheel = clamp(ratio * state.tracked.front_wheel_angle, -limit, limit)
    if step == Step.STRAIGHTEN:
        wheel = 0.0
    if step == Step.DRIVE:
        if before != Step.DRIVE:
            state = _set_out(state)
        speed = state.direction * planned_speed(state.tracked.ahead, state.sight.speed, params)
    return state._replace(step=step, wheel=wheel, speed=speed)


def planned_speed(ahead: Ahead, most: float, params: ValetParams) -> float:
    """Return the speed [m/s] for what lies ahead, at most ``most`` but never less than creeping."""
    law = params.drive
    fast = math.sqrt(law.creep * law.creep + 2.0 * law.deceleration * (ahead.left if ahead.left > 0.0 else 0.0))
    return max(law.creep, min(ahead.speed, min(fast, most)))


def rolled_on(state: ValetState) -> ValetState:
    """Return the valet on the next piece, which it reached without a stop."""
    begin = drive(state.begin, state.path.pieces[state.piece].way, state.path.pieces[state.piece].k)
    left = state.tracked.left + abs(state.path.pieces[state.piece + 1].way)
    return state._replace(piece=state.piece + 1, begin=begin, tracked=state.tracked._replace(left=left))


def _to_plan_anew(store: PlanStore, state: ValetState, params: ValetParams) -> ValetState:
    """Return the valet about to plan from where it stands; what is in the way is remembered."""
    state = state._replace(nearby=state.nearby._replace(in_the_way=False))
    clocks = state.watch._replace(blocked=0)
    sought = shallower(state.search, state.sight.echo)
    back = WayBack()
    if params.search.active and state.backs < BACKS and state.path.margin > 0.0:
        back = way_back(state.path, state.piece, state.tracked.left)
    state = state._replace(searched=0, path=Path(), watch=clocks, back=back, beside=SideEchoes())
    if not state.sight.blocked:
        return state
    if sought.gap.depth < state.search.gap.depth and state.sight.ahead:
        return state._replace(search=sought)
    echo = state.sight.echo
    beside = params.search.active and not state.sight.ahead
    if beside and is_in_gap(echo.x, echo.y, sought.gap):
        nearby = put_nearby(store, state.nearby, echo)
        return state._replace(nearby=nearby)
    seen = remembered(state.seen, echo, state.seen_count, beside)
    return state._replace(seen=seen, seen_count=state.seen_count + 1)


def _with_piece(state: ValetState, before: int, params: ValetParams) -> ValetState:
    """Return the valet with the piece to drive next; where one was not driven to its end, that goes on."""
    piece = 0
    begin = state.request.start
    early = state.early
    if before != Step.PLAN and before != Step.SHOWN:
        piece = state.piece
        begin = state.begin
        if state.tracked.left > AT_END:
            return state
        begin = drive(begin, state.path.pieces[piece].way, state.path.pieces[piece].k)
        early = clamp(early + LEARNT * state.tracked.ahead.left, -EARLIEST, EARLIEST)
        piece = piece + 1
    left = abs(state.path.pieces[piece].way)
    tracked = Tracked(left, begin, ahead=ahead_of(state.path, piece, left, params))
    return state._replace(piece=piece, begin=begin, tracked=tracked, early=early)


def _set_out(state: ValetState) -> ValetState:
    """Return the valet that begins to drive; a change of direction is a shift, but for driving forward at first."""
    direction = sign(state.path.pieces[state.piece].way)
    manoeuvres = state.manoeuvres
    if direction != state.direction:
        manoeuvres = manoeuvres + 1 if manoeuvres > 0 or direction < 0.0 else manoeuvres
    return state._replace(direction=direction, manoeuvres=manoeuvres)
