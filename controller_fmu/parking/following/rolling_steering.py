"""Steering while rolling from one segment of a path to the next, as far off the path as its margin allows.

Where the curvature jumps by dk it changes linearly over a transition of length r instead, half of it before the joint.
The heading behind it is the path's, and the vehicle is beside it by dk r2 / 24. Half way along it the vehicle is off
its direction by dk r / 8. Transitions may overlap: their offsets add up. They end where the gear changes.

About a standstill, too, the wheel turns while the vehicle still rolls, or rolls again: it begins a time before and goes
on a time behind. The curvature is off by then, which costs heading. Where the gear changes the vehicle gets it back by
going on by that heading over dk before it turns round, as far as that is free.

On a transition the steering turns by dphi per metre, which limits the speed. Where one alone asks for less than
``MIN_ROLLING_SPEED`` the vehicle stops, and the wheel turns at standstill.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.following.params import RATE_FRACTION, START_ACCELERATION, FollowingContext
from controller_fmu.parking.geometry.outline import SAME_CURVATURE
from controller_fmu.parking.planning.gear_segments import GearSegment, distance_before, gear_segment
from controller_fmu.parking.planning.planner import PlannedPath
from modelkit.maths import sign

MIN_ROLLING_SPEED = 0.12
"""Slower [m/s] than this it is quicker to stop and turn the wheel at standstill."""
MARGIN_FRACTION = 0.14
"""The vehicle leaves its path by at most ``drive.rolling_offset``, and by this fraction of the path's margin, ..."""
ROOMY_FACTOR = 1.5
"""... times this on a transition in one gear, ..."""
JUST_BEHIND = 1e-6
"""So far [m] behind its edge a transition has begun, or ended, in spite of rounding."""
STANDSTILL_FRACTION = 0.5
"""... and times this about a standstill."""
OVERRUN_FACTOR = 5.0
"""A vehicle may go farther before it turns round by so many times ``drive.rolling_offset``, where that is free."""
START_FACTOR = 2.0
"""As it sets out it may leave its path by so many times that, which tracking takes back."""
MIN_MARGIN = 0.05
"""Where the plan leaves less clearance [m] the steering wheel turns at rest."""
SETTLING_TIME = 0.3
"""So long [s] before its last standstill the car tracks no more: the steering wheel is at rest when it is straight."""


class CurvatureJoint(NamedTuple):
    """The end of a segment."""

    transition: float = 0.0
    """Length [m] over which the curvature changes there; 0: the car has to stand."""
    jump: float = 0.0
    """Of the curvature [1/m]."""


class PathReference(NamedTuple):
    """How to drive at a place of the path."""

    curvature: float = 0.0
    """[1/m]"""
    lateral: float = 0.0
    """Beside the path, to the left [m]."""
    heading: float = 0.0
    """Off its direction, to the left [rad]."""


class StandstillSteering(NamedTuple):
    """How the steering wheel turns about a standstill."""

    before: float = 0.0
    """It begins so long [s] before."""
    after: float = 0.0
    """The car sets out so long [s] before it is turned in full."""
    overrun: float = 0.0
    """The car stands so far [m] behind the end of its segment."""
    next_curvature: float = 0.0
    """What it turns to: curvature [1/m] behind the standstill, 0 at the end of the path."""


class UpcomingStop(NamedTuple):
    """What the segments ahead ask for."""

    left: float = 0.0
    """Distance to the next standstill [m]."""
    speed: float = 0.0
    """Largest speed [m/s] here, that the transitions here and ahead allow."""
    standstill: StandstillSteering = StandstillSteering()
    """That standstill."""


def transition_length(off: float, jump: float, longest: float) -> float:
    """Return the length [m], at most ``longest``, of a transition by ``jump`` [1/m] that ends ``off`` [m] aside."""
    return longest if abs(jump) * longest * longest <= 24.0 * off else math.sqrt(24.0 * off / abs(jump))


def transition_state(jump: float, length: float, past: float, is_past: bool) -> PathReference:
    """Return where a vehicle is on a transition, ``past`` [m] behind the joint; ``is_past``: on the path behind.

    Its heading is that of a vehicle that drives forward.
    """
    on = past + 0.5 * length
    share = on / length
    path_turned = 1.0 if is_past else 0.0
    lateral = jump * (on * on * share / 6.0 - path_turned * 0.5 * past * past)
    heading = jump * (0.5 * on * share - path_turned * past)
    return PathReference(jump * (share - path_turned), lateral, heading)


def transition_after(path: PlannedPath, segment: int, context: FollowingContext) -> CurvatureJoint:
    """Return the joint at the end of ``segment``."""
    whole = gear_segment(path, segment)
    return _transition_at(path, whole, segment, distance_before(path, whole, segment + 1), context)


def _transition_at(
    path: PlannedPath, whole: GearSegment, segment: int, at: float, context: FollowingContext
) -> CurvatureJoint:
    """Return the joint at the end of ``segment``, ``at`` [m] from the start of the gear segment."""
    offset = ROOMY_FACTOR * _max_offset(path, context)
    if segment >= whole.last or offset <= 0.0:
        return CurvatureJoint()
    longest = 2.0 * min(at, whole.length - at)
    k0 = path.segments[segment].curvature
    k1 = path.segments[segment + 1].curvature
    if abs(k1 - k0) < SAME_CURVATURE:
        return CurvatureJoint(longest)
    transition = transition_length(offset, k1 - k0, longest)
    base = context.car.wheelbase
    swing = math.atan(base * k1) - math.atan(base * k0)
    is_driven = steering_speed_limit(swing / transition, context) >= MIN_ROLLING_SPEED
    return CurvatureJoint(transition, k1 - k0) if is_driven else CurvatureJoint()


def steering_speed_limit(turning: float, context: FollowingContext) -> float:
    """Return the largest speed [m/s] where the front steering wheels turn by ``turning`` [rad/m]."""
    car = context.car.steering
    most = context.drive.speed
    rate = RATE_FRACTION * car.rate_limit / car.ratio
    return rate / abs(turning) if rate < most * abs(turning) else most


def reference_at(path: PlannedPath, segment: int, left: float, context: FollowingContext) -> PathReference:
    """Return how to drive ``left`` [m] before the end of ``segment``, transitions counted."""
    whole = gear_segment(path, segment)
    at = 0.0
    place = min(distance_before(path, whole, segment + 1) - left, whole.length - JUST_BEHIND)
    curvature = path.segments[segment].curvature
    lateral = 0.0
    heading = 0.0
    for number in range(whole.first, whole.last):
        at += abs(path.segments[number].distance)
        joint = _transition_at(path, whole, number, at, context)
        past = place - at
        if abs(past) < 0.5 * joint.transition:
            more = transition_state(joint.jump, joint.transition, past, number < segment)
            curvature += more.curvature
            heading += more.heading
            lateral += more.lateral
    k = path.segments[segment].curvature
    return PathReference(curvature * (1.0 + k * lateral), lateral, sign(path.segments[segment].distance) * heading)


def steering_rate_at(path: PlannedPath, whole: GearSegment, place: float, context: FollowingContext) -> float:
    """Return the turning of the front wheels [rad/m] at a place [m] of a gear segment: L k' / (1 + (L k)^2)."""
    at = 0.0
    curvature = path.segments[whole.first].curvature
    slope = 0.0
    for number in range(whole.first, whole.last):
        at += abs(path.segments[number].distance)
        joint = _transition_at(path, whole, number, at, context)
        on = place - at + 0.5 * joint.transition
        share = 1.0 if on >= joint.transition else 0.0
        if 0.0 < on < joint.transition:
            share = on / joint.transition
            slope += joint.jump / joint.transition
        curvature += share * (path.segments[number + 1].curvature - path.segments[number].curvature)
    bent = context.car.wheelbase * curvature
    return context.car.wheelbase * slope / (1.0 + bent * bent)


def upcoming_stop(path: PlannedPath, segment: int, left: float, context: FollowingContext) -> UpcomingStop:
    """Return what lies ahead of a car ``left`` [m] before the end of ``segment``."""
    whole = gear_segment(path, segment)
    here = distance_before(path, whole, segment + 1) - left
    speed = steering_speed_limit(steering_rate_at(path, whole, here, context), context)
    at = 0.0
    for number in range(whole.first, whole.last):
        at += abs(path.segments[number].distance)
        transition = _transition_at(path, whole, number, at, context).transition
        if segment <= number and transition <= 0.0:
            return UpcomingStop(at - here, speed, standstill_before(path, number + 1, context))
        for share in (-0.5, 0.0, 0.5):
            place = at + share * transition
            if transition > 0.0 and place > here:
                there = steering_speed_limit(steering_rate_at(path, whole, place + JUST_BEHIND, context), context)
                speed = min(speed, math.sqrt(there * there + 2.0 * context.drive.deceleration * (place - here)))
    standstill = standstill_before(path, whole.last + 1, context)
    return UpcomingStop(whole.length + standstill.overrun - here, speed, standstill)


def standstill_before(path: PlannedPath, segment: int, context: FollowingContext) -> StandstillSteering:
    """Return the standstill before ``segment``; ``path.used``: that at the end of the path."""
    before = reference_at(path, segment - 1, 0.0, context).curvature if segment > 0 else 0.0
    ends = segment >= path.used
    next_curvature = 0.0
    if not ends:
        next_curvature = reference_at(path, segment, abs(path.segments[segment].distance), context).curvature
    offset = _overrun_before(path, segment, context)
    settled = SETTLING_TIME if ends else 0.0
    if offset <= 0.0 or path.margin < MIN_MARGIN:
        return StandstillSteering(next_curvature=next_curvature)
    if abs(next_curvature - before) < SAME_CURVATURE:
        return StandstillSteering(settled, next_curvature=next_curvature)
    early = SteeringWhileMoving()
    late = SteeringWhileMoving()
    if segment > 0:
        room = 2.0 * offset if ends else offset
        early = _steering_while_moving(room, before, next_curvature, context.drive.deceleration, context)
    if not ends:
        late = _steering_while_moving(offset, next_curvature, before, START_ACCELERATION, context)
    same_gear = segment > 0 and not ends and path.segments[segment - 1].distance * path.segments[segment].distance > 0.0
    overrun = 0.0 if same_gear or segment == 0 else early.overrun + late.overrun
    return StandstillSteering(max(early.time, settled), late.time, overrun, next_curvature)


class SteeringWhileMoving(NamedTuple):
    """How long [s] the wheel turns while the vehicle moves beside a standstill, and how far [m] that takes it."""

    time: float = 0.0
    overrun: float = 0.0


def _steering_while_moving(
    offset: float, near: float, far: float, acceleration: float, context: FollowingContext
) -> SteeringWhileMoving:
    """Return the turn from curvature ``near`` [1/m] towards ``far`` that takes the car half of ``offset`` [m] at most.

    The heading lost is the integral of (k - near) v, by Simpson's rule: at both ends it is 0.
    """
    base = context.car.wheelbase
    car = context.car.steering
    rate = car.rate_limit / car.ratio
    angle = math.atan(base * near)
    swing = math.atan(base * far) - angle
    steepest = rate * (1.0 + base * base * max(near * near, far * far)) / base
    cube = 3.0 * offset * abs(far - near) / (steepest * acceleration)
    time = min(0.5 * abs(swing) / rate, math.exp(math.log(cube) / 3.0))
    middle = math.tan(angle + sign(swing) * 0.5 * rate * time) / base
    return SteeringWhileMoving(time, abs(middle - near) * acceleration * time * time / (3.0 * abs(far - near)))


def steers_for_next(ahead: UpcomingStop, context: FollowingContext) -> bool:
    """Return whether the standstill ahead is so near that the steering wheel turns to what comes behind it."""
    before = ahead.standstill.before
    return before > 0.0 and ahead.left < 0.5 * context.drive.deceleration * before * before


def _max_offset(path: PlannedPath, context: FollowingContext) -> float:
    """Return how far [m] off its path the vehicle may come by turning its steering wheel on the move."""
    return min(context.drive.rolling_offset, MARGIN_FRACTION * path.margin)


def _overrun_before(path: PlannedPath, segment: int, context: FollowingContext) -> float:
    """Return how far [m] the car may go on before ``segment`` begins, for turning its wheel on the move."""
    offset = _max_offset(path, context)
    if segment == 0:
        return START_FACTOR * offset
    overrun = path.segments[segment].overrun if segment < path.used else 0.0
    return max(STANDSTILL_FRACTION * offset, min(OVERRUN_FACTOR * context.drive.rolling_offset, overrun))
