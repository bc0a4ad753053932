"""How the car rolls from one piece of its path to the next: the wheel turns on the move where that is near enough.

Where the curvature jumps by dk it changes linearly over a ramp of length r instead, half of it before the joint. The
heading behind it is the path's, and the car is beside it by dk r^2 / 24. Ramps may overlap, what they do adds up: of
two jumps there and back close together little is left, and the wheel hardly turns. They end where the gear changes.

About a standstill, too, the wheel turns while the car still rolls, or rolls again: it begins a time before and goes on
a time behind. The curvature is off by then, which costs heading. Where the gear changes a car that goes farther by that
heading over dk before it turns round gets it back. The times are so long that this is as far as it may go: where there
is room for that with the path's margin, ``FARTHER`` times ``drive.rolling``.

On ramps the wheel turns by dphi for each metre driven, so the car may go its rate over that. Where one ramp alone asks
for less than ``SLOWEST`` on the average the car stands, and the wheel turns at rest.
"""

import math
from typing import NamedTuple

from controller_fmu.common.ramp import on_ramp, ramp_length
from controller_fmu.planning.plan import Path, Piece
from controller_fmu.planning.room import OF_MARGIN, OF_ROOM, SAME
from controller_fmu.planning.stretch import OneGear, stretch_of, way_before
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.slot import QUICKEST, RATE_SHARE
from modelkit.maths import sign

SLOWEST = 0.12
"""[m/s]"""
ROOMIEST = 1.5
"""A ramp takes the car off by ``drive.rolling`` times this at most, and by what the planner finds room for."""
BEHIND = 1e-6
"""So far [m] behind its edge a ramp has begun, or ended, in spite of rounding."""
REST_SHARE = 0.5
"""Share of what ramps may take that turning about a standstill may, if there is no room beyond it."""
FARTHER = 5.0
"""A car may go farther before it turns round by so many times ``drive.rolling``, where there is room."""
AT_FIRST = 2.0
"""And by so many times that it might have to as it sets out on its path, which tracking takes back."""
ROOMY = 0.05
"""Where the plan leaves less clearance [m] the wheel turns at rest."""
SETTLED = 0.3
"""So long [s] before its last standstill the car tracks no more: the wheel is at rest when it is straight."""


class Joint(NamedTuple):
    """The end of a piece."""

    ramp: float = 0.0
    """Way [m] over which the curvature changes there; 0: the car has to stand."""
    jump: float = 0.0
    """Of the curvature [1/m]."""


class Aim(NamedTuple):
    """How to drive at a place of the path."""

    curvature: float = 0.0
    """[1/m]"""
    lateral: float = 0.0
    """Beside the path, to the left [m]."""
    heading: float = 0.0
    """Off its direction, to the left [rad]."""


class WheelAtRest(NamedTuple):
    """How the wheel turns about a standstill."""

    before: float = 0.0
    """It begins so long [s] before."""
    after: float = 0.0
    """The car sets out so long [s] before it is turned in full."""
    over: float = 0.0
    """The car stands so far [m] behind the end of its piece."""
    then: float = 0.0
    """What it turns to: curvature [1/m] behind the standstill, 0 at the end of the path."""


class Ahead(NamedTuple):
    """What the pieces ahead ask for."""

    left: float = 0.0
    """Way to the next standstill [m]."""
    speed: float = 0.0
    """Largest speed [m/s] here, that the ramps here and ahead allow."""
    rest: WheelAtRest = WheelAtRest()
    """That standstill."""


def joint_of(path: Path, piece: int, params: ValetParams) -> Joint:
    """Return the joint at the end of ``piece``."""
    whole = stretch_of(path, piece)
    return _joint(path, whole, piece, way_before(path, whole, piece + 1), params)


def _joint(path: Path, whole: OneGear, piece: int, at: float, params: ValetParams) -> Joint:
    """Return the joint at the end of ``piece``, ``at`` [m] from the begin of the stretch."""
    if piece >= whole.last:
        return Joint()
    if is_transition(path, piece + 1):
        way = min(abs(path.pieces[piece].way), abs(path.pieces[piece + 1].way))
        return Joint(way, path.pieces[piece + 1].k - path.pieces[piece].k)
    off = _off_about(path, piece + 1, params)
    if off <= 0.0:
        return Joint()
    longest = 2.0 * min(_way_to_transition(path, whole, piece, -1), _way_to_transition(path, whole, piece + 1, 1))
    k0 = path.pieces[piece].k
    k1 = path.pieces[piece + 1].k
    if abs(k1 - k0) < SAME:
        return Joint(longest)
    ramp = ramp_length(off, k1 - k0, longest)
    base = params.car.wheelbase
    swing = math.atan(base * k1) - math.atan(base * k0)
    return Joint(ramp, k1 - k0) if speed_on(swing / ramp, params) >= SLOWEST else Joint()


def _way_to_transition(path: Path, whole: OneGear, piece: int, turn: int) -> float:
    """Return the way [m] from a piece on (``turn`` 1), or back (-1), to a transition or to the end of the stretch."""
    way = 0.0
    number = piece
    while whole.first <= number <= whole.last:
        if path.pieces[number].speed > 0.0:
            return way
        way += abs(path.pieces[number].way)
        number += turn
    return way


def is_transition(path: Path, piece: int) -> bool:
    """Return whether the path has a transition about the begin of ``piece``; of the number of pieces: at its end."""
    before = path.pieces[piece - 1].speed if piece > 0 else 0.0
    return before > 0.0 or (piece < path.used and path.pieces[piece].speed > 0.0)


def speed_on(turning: float, params: ValetParams) -> float:
    """Return the largest speed [m/s] where the front wheels turn by ``turning`` [rad/m]."""
    car = params.car.steering
    most = params.drive.speed
    rate = RATE_SHARE * car.rate_limit / car.ratio
    return rate / abs(turning) if rate < most * abs(turning) else most


def aim_at(path: Path, piece: int, left: float, params: ValetParams) -> Aim:
    """Return how to drive ``left`` [m] before the end of ``piece``, ramps counted; behind a stretch as at its end."""
    whole = stretch_of(path, piece)
    at = 0.0
    place = min(way_before(path, whole, piece + 1) - left, whole.length - BEHIND)
    curvature = path.pieces[piece].k
    lateral = 0.0
    heading = 0.0
    for number in range(whole.first, whole.last):
        at += abs(path.pieces[number].way)
        joint = _joint(path, whole, number, at, params)
        past = place - at
        if abs(past) < 0.5 * joint.ramp:
            more = on_ramp(joint.jump, joint.ramp, past, number < piece)
            curvature += more.curvature
            heading += more.turned
            lateral += more.lateral
    k = path.pieces[piece].k
    return Aim(curvature * (1.0 + k * lateral), lateral, sign(path.pieces[piece].way) * heading)


def turning_at(path: Path, whole: OneGear, place: float, params: ValetParams) -> float:
    """Return by how much the front wheels turn [rad/m] at a place [m] of a stretch: L k' / (1 + (L k)^2)."""
    at = 0.0
    curvature = path.pieces[whole.first].k
    slope = 0.0
    for number in range(whole.first, whole.last):
        at += abs(path.pieces[number].way)
        joint = _joint(path, whole, number, at, params)
        on = place - at + 0.5 * joint.ramp
        share = 1.0 if on >= joint.ramp else 0.0
        if 0.0 < on < joint.ramp:
            share = on / joint.ramp
        if 0.0 < on < joint.ramp and not is_transition(path, number + 1):
            slope += joint.jump / joint.ramp
        curvature += share * (path.pieces[number + 1].k - path.pieces[number].k)
    bent = params.car.wheelbase * curvature
    return params.car.wheelbase * slope / (1.0 + bent * bent)


def ahead_of(path: Path, piece: int, left: float, params: ValetParams) -> Ahead:
    """Return what lies ahead of a car ``left`` [m] before the end of ``piece``."""
    whole = stretch_of(path, piece)
    here = way_before(path, whole, piece + 1) - left
    speed = speed_on(turning_at(path, whole, here, params), params)
    at = 0.0
    for number in range(whole.first, whole.last + 1):
        limit = path.pieces[number].speed
        if number >= piece and limit > 0.0:
            speed = min(speed, math.sqrt(limit * limit + 2.0 * params.drive.deceleration * max(at - here, 0.0)))
        at += abs(path.pieces[number].way)
        ramp = _joint(path, whole, number, at, params).ramp
        if piece <= number < whole.last and ramp <= 0.0:
            return Ahead(at - here, speed, rest_before(path, number + 1, params))
        if number == whole.last or is_transition(path, number + 1):
            ramp = 0.0
        for share in (-0.5, 0.0, 0.5):
            place = at + share * ramp
            if ramp > 0.0 and place > here:
                there = speed_on(turning_at(path, whole, place + BEHIND, params), params)
                speed = min(speed, math.sqrt(there * there + 2.0 * params.drive.deceleration * (place - here)))
    rest = rest_before(path, whole.last + 1, params)
    return Ahead(whole.length + rest.over - here, speed, rest)


def rest_before(path: Path, piece: int, params: ValetParams) -> WheelAtRest:
    """Return the standstill before ``piece``; of the number of pieces: that at the end."""
    before = aim_at(path, piece - 1, 0.0, params).curvature if piece > 0 else 0.0
    then = aim_at(path, piece, abs(path.pieces[piece].way), params).curvature if piece < path.used else 0.0
    base = params.car.wheelbase
    off = _off_at_rest(path, piece, params)
    ends = piece >= path.used
    settled = SETTLED if ends else 0.0
    if is_transition(path, piece):
        return _rest_in_transition(path, piece, abs(math.atan(base * then) - math.atan(base * before)), then, params)
    if off <= 0.0 or path.margin < ROOMY:
        return WheelAtRest(then=then)
    if abs(then - before) < SAME:
        return WheelAtRest(settled, then=then)
    early = WheelTurn()
    late = WheelTurn()
    if piece > 0:
        early = _turn_while(2.0 * off if ends else off, before, then, params.drive.deceleration, params)
    if not ends:
        late = _turn_while(off, then, before, QUICKEST, params)
    same_gear = piece > 0 and not ends and path.pieces[piece - 1].way * path.pieces[piece].way > 0.0
    return WheelAtRest(
        max(early.time, settled), late.time, 0.0 if same_gear or piece == 0 else early.over + late.over, then
    )


def _rest_in_transition(path: Path, piece: int, swing: float, then: float, params: ValetParams) -> WheelAtRest:
    """Return the standstill within a transition: the wheel turns for half of an arc's time before and behind it."""
    law = params.drive
    rate = params.car.steering.rate_limit / params.car.steering.ratio
    most = swing / rate
    early = path.pieces[piece - 1] if piece > 0 else Piece()
    late = path.pieces[piece] if piece < path.used else Piece()
    before = 0.5 * math.sqrt(2.0 * abs(early.way) / law.deceleration) if early.speed > 0.0 else 0.0
    after = 0.5 * math.sqrt(2.0 * abs(late.way) / QUICKEST) if late.speed > 0.0 else 0.0
    settled = 0.0 if piece < path.used else SETTLED
    return WheelAtRest(max(min(before, most), settled), min(after, most), then=then)


class WheelTurn(NamedTuple):
    """How long [s] the wheel turns while the car moves on one side of a standstill, and how far [m] that takes it."""

    time: float = 0.0
    over: float = 0.0


def _turn_while(off: float, near: float, far: float, acceleration: float, params: ValetParams) -> WheelTurn:
    """Return the turn from curvature ``near`` [1/m] towards ``far`` that takes the car half of ``off`` [m] at most.

    The heading lost is the integral of (k - near) v, by Simpson's rule: at both ends it is 0.
    """
    base = params.car.wheelbase
    car = params.car.steering
    rate = car.rate_limit / car.ratio
    angle = math.atan(base * near)
    swing = math.atan(base * far) - angle
    steepest = rate * (1.0 + base * base * max(near * near, far * far)) / base
    cube = 3.0 * off * abs(far - near) / (steepest * acceleration)
    time = min(0.5 * abs(swing) / rate, math.exp(math.log(cube) / 3.0))
    half_way = math.tan(angle + sign(swing) * 0.5 * rate * time) / base
    return WheelTurn(time, abs(half_way - near) * acceleration * time * time / (3.0 * abs(far - near)))


def turns_already(ahead: Ahead, params: ValetParams) -> bool:
    """Return whether the standstill ahead is so near that the wheel turns to what comes behind it."""
    return (
        ahead.rest.before > 0.0 and ahead.left < 0.5 * params.drive.deceleration * ahead.rest.before * ahead.rest.before
    )


def _largest_off(path: Path, params: ValetParams) -> float:
    """Return how far [m] off its path the car may come by turning its wheel on the move."""
    return min(params.drive.rolling, OF_MARGIN * path.margin)


def _off_about(path: Path, piece: int, params: ValetParams) -> float:
    """Return the same where ``piece`` begins in the gear of the one before: more where there is room."""
    return min(ROOMIEST * params.drive.rolling, path.pieces[piece].room)


def _off_at_rest(path: Path, piece: int, params: ValetParams) -> float:
    """Return how far [m] farther the car may go before ``piece`` begins, for turning its wheel on the move."""
    least = REST_SHARE * _largest_off(path, params)
    if piece == 0:
        return min(AT_FIRST * params.drive.rolling, least + OF_ROOM * path.pieces[0].room)
    if piece >= path.used or path.pieces[piece - 1].way * path.pieces[piece].way > 0.0:
        return least
    return max(least, min(FARTHER * params.drive.rolling, path.pieces[piece].room))
