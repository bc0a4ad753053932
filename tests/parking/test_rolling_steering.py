"""From piece to piece without a stop: the way beside the path is the one that the ramp's curvature makes."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller_fmu.common.chart import bit
from controller_fmu.parking.chart import Condition, ParkingState
from controller_fmu.parking.following.params import START_ACCELERATION, FollowingContext, FollowingParams
from controller_fmu.parking.following.path_tracking import (
    PathProgress,
    SpeedTracking,
    begin_path,
    learn_speed_delay,
    must_stop,
    next_segment,
    profile_speed,
)
from controller_fmu.parking.following.rolling_steering import (
    MIN_ROLLING_SPEED,
    OVERRUN_FACTOR,
    ROOMY_FACTOR,
    UpcomingStop,
    reference_at,
    standstill_before,
    transition_after,
    transition_length,
    upcoming_stop,
)
from controller_fmu.parking.geometry.outline import pose_along_arc
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.planning.gear_segments import without_short_end
from controller_fmu.parking.planning.planner import PathSegment, PlannedPath
from controller_fmu.parking.signals import ParkingSystemInput
from controller_fmu.parking.state import ParkingMemory
from controller_fmu.parking.system import conditions_of
from modelkit.car import Car
from modelkit.maths import move_towards
from modelkit.vocabulary import Pose

CONTEXT = FollowingContext(Car(), FollowingParams())
MOST = ROOMY_FACTOR * CONTEXT.drive.rolling_offset
curvature = st.floats(-0.3, 0.3)


def path_of(*pieces: tuple[float, float], margin: float = 0.15, overrun: float = 0.1) -> PlannedPath:
    """Return a path of (way, curvature) with a margin [m], free so far [m] beyond its cusps."""
    found = PlannedPath()
    made = tuple(PathSegment(way, k, overrun=overrun) for way, k in pieces)
    return found._replace(used=len(made), margin=margin, segments=made + found.segments[len(made) :])


def driven(path: PlannedPath) -> list[tuple[float, float, float]]:
    """Return (aim's lateral, heading, less where the curvature leads; how far beside), every 5 mm."""
    step, pose, begin, rows = 0.005, Pose(), Pose(), []
    for number in range(path.used):
        way = path.segments[number].distance
        direction = math.copysign(1.0, way)
        for index in range(round(abs(way) / step)):
            left = abs(way) - (index + 1) * step
            middle = reference_at(path, number, left + 0.5 * step, CONTEXT).curvature
            pose = pose_along_arc(pose, direction * step, middle)
            at = pose_along_arc(begin, direction * (abs(way) - left), path.segments[number].curvature)
            beside = (pose.y - at.y) * math.cos(at.heading) - (pose.x - at.x) * math.sin(at.heading)
            aim = reference_at(path, number, left, CONTEXT)
            rows.append((aim.lateral - beside, aim.heading - (pose.heading - at.heading), abs(beside)))
        begin = pose_along_arc(begin, way, path.segments[number].curvature)
    return rows


@settings(max_examples=12)
@given(k0=curvature, k1=curvature, length=st.floats(1.5, 2.5), direction=st.sampled_from([1.0, -1.0]))
def test_the_aim_is_where_its_curvature_leads(k0: float, k1: float, length: float, direction: float) -> None:
    length = round(length, 2)
    path = path_of((direction * length, k0), (direction * length, k1))
    joint = transition_after(path, 0, CONTEXT)
    rows = driven(path)
    half = int((length + 0.5 * joint.transition) / 0.005) - 2
    bent = max(abs(k0), abs(k1)) ** 2  # beside a bend the way is as much longer as it is off, which the aim leaves out
    assert max(abs(row[1]) for row in rows) < 1e-3 + 0.5 * bent * MOST * joint.transition
    assert max(abs(row[0]) for row in rows[:half]) < 2e-3, "until the ramp is over"
    assert max(row[2] for row in rows) <= MOST + 3e-3


@settings(max_examples=12)
@given(
    k=st.tuples(curvature, curvature, curvature), middle=st.floats(0.05, 1.0), direction=st.sampled_from([1.0, -1.0])
)
def test_ramps_that_overlap_lead_back_to_the_path(
    k: tuple[float, float, float], middle: float, direction: float
) -> None:
    ways = (2.0, round(middle, 2), 2.0)
    path = path_of(*((direction * way, number) for way, number in zip(ways, k, strict=True)))
    rows, ramps = (
        driven(path),
        transition_after(path, 0, CONTEXT).transition + transition_after(path, 1, CONTEXT).transition,
    )
    assert max(abs(row[1]) for row in rows) < 1e-3 + max(number * number for number in k) * MOST * ramps
    assert max(row[2] for row in rows) <= 2.0 * MOST + 5e-3
    assert max(abs(reference_at(path, 1, 0.01 * n, CONTEXT).curvature) for n in range(round(100 * ways[1]))) < 0.31


def test_of_a_short_arc_between_two_lines_little_is_left() -> None:
    path = path_of((2.0, 0.0), (0.06, 0.33), (2.0, 0.0))
    assert abs(reference_at(path, 1, 0.03, CONTEXT).curvature) < 0.33 * 0.06 / 1.0
    assert upcoming_stop(path, 0, 1.9, CONTEXT).left == pytest.approx(3.96)
    assert upcoming_stop(path, 0, 0.5, CONTEXT).speed == CONTEXT.drive.speed


@settings(max_examples=40)
@given(k0=curvature, k1=curvature, way=st.floats(0.1, 5.0))
def test_the_wheel_can_follow_a_ramp(k0: float, k1: float, way: float) -> None:
    path = path_of((way, k0), (way, k1))
    joint = transition_after(path, 0, CONTEXT)
    if joint.transition > 0.0 and abs(k1 - k0) > 1e-3:
        base, car = CONTEXT.car.wheelbase, CONTEXT.car.steering
        assert joint.transition <= 2.0 * way
        for share in (0.49, 0.2, 0.01, -0.2, -0.49):
            left, piece = share * joint.transition, 0
            if left < 0.0:
                left, piece = way + left, 1
            near = [math.atan(base * reference_at(path, piece, left + off, CONTEXT).curvature) for off in (1e-6, -1e-6)]
            speed = upcoming_stop(path, piece, left, CONTEXT).speed
            assert speed * abs(near[1] - near[0]) / 2e-6 < car.rate_limit / car.ratio
            assert speed >= 0.5 * MIN_ROLLING_SPEED


def turned_round(path: PlannedPath) -> tuple[float, float]:
    """Return (heading, offset) against the second of two pieces of a car whose wheel turns about the cusp between."""
    rest, step, law = standstill_before(path, 1, CONTEXT), 4e-4, CONTEXT.drive
    base, car = CONTEXT.car.wheelbase, CONTEXT.car.steering
    first, second = path.segments[:2]
    direction, speed, left = math.copysign(1.0, first.distance), 0.8, abs(first.distance) + rest.overrun
    pose, phi, last = Pose(), math.atan(base * first.curvature), math.atan(base * second.curvature)

    def turned(phi: float) -> float:
        rate = step * car.rate_limit / car.ratio
        return phi + max(-rate, min(rate, last - phi))

    while left > 0.0:
        speed = min(speed, math.sqrt(2.0 * law.deceleration * left))
        phi = turned(phi) if left < 0.5 * law.deceleration * rest.before**2 else phi
        pose, left = pose_along_arc(pose, direction * speed * step, math.tan(phi) / base), left - speed * step - 1e-12
    while abs(last - phi) > rest.after * car.rate_limit / car.ratio:
        phi = turned(phi)
    speed, way = 0.0, 0.0
    while way < 1.0:
        phi, speed = turned(phi), min(0.8, speed + START_ACCELERATION * step)
        pose, way = pose_along_arc(pose, -direction * speed * step, math.tan(phi) / base), way + speed * step
    at = pose_along_arc(
        pose_along_arc(Pose(), first.distance, first.curvature), -direction * (way - rest.overrun), second.curvature
    )
    return pose.heading - at.heading, (pose.y - at.y) * math.cos(at.heading) - (pose.x - at.x) * math.sin(at.heading)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize(("k0", "k1"), [(0.3, -0.3), (0.0, 0.3), (-0.25, 0.1), (0.2, 0.18)])
def test_a_car_that_turns_its_wheel_about_a_cusp_is_on_its_path_behind_it(
    k0: float, k1: float, direction: float
) -> None:
    path = path_of((direction * 1.5, k0), (-direction * 2.0, k1))
    rest = standstill_before(path, 1, CONTEXT)
    assert rest.before > 0.0 < rest.after
    assert rest.next_curvature == k1
    assert rest.overrun <= OVERRUN_FACTOR * CONTEXT.drive.rolling_offset
    assert upcoming_stop(path, 0, 1.0, CONTEXT).left == pytest.approx(1.0 + rest.overrun)
    heading, offset = turned_round(path)
    assert abs(heading) < max(1e-3, 0.25 * abs(k1 - k0) * rest.overrun)
    assert abs(offset) < 3e-3
    without = turned_round(path._replace(margin=0.04))
    assert abs(without[0]) < 1e-3, "at rest nothing is lost"


def test_the_wider_the_margin_the_longer_the_wheel_turns_on_the_move() -> None:
    path = path_of((1.5, 0.3), (-2.0, -0.3))
    tight = path_of((1.5, 0.3), (-2.0, -0.3), margin=0.06, overrun=0.0)
    wide, narrow = standstill_before(path, 1, CONTEXT), standstill_before(tight, 1, CONTEXT)
    assert narrow.overrun <= 0.01 < 0.05 < wide.overrun <= path.segments[1].overrun
    assert wide.before + wide.after > 1.5 * (narrow.before + narrow.after)
    assert standstill_before(path, 0, CONTEXT).after > 1.1 * standstill_before(tight, 0, CONTEXT).after
    onto = path_of((2.0, 0.0), (2.0, 0.3))
    near = path_of((2.0, 0.0), (2.0, 0.3), margin=0.05)
    assert transition_after(onto, 0, CONTEXT).transition > 1.1 * transition_after(near, 0, CONTEXT).transition > 0.5
    assert transition_after(onto._replace(margin=0.0), 0, CONTEXT).transition == 0.0, "it stands"
    stands = path_of((1.5, 0.3), (0.02, -0.3))
    assert transition_after(stands, 0, CONTEXT).transition == 0.0


def test_without_room_a_jump_has_no_ramp_and_no_jump_has_the_longest() -> None:
    assert transition_length(0.0, 0.2, 3.0) == 0.0
    assert transition_length(0.0, 0.0, 3.0) == transition_length(0.02, 0.0, 3.0) == 3.0
    assert 0.2 * transition_length(0.02, -0.2, 3.0) ** 2 / 24.0 == pytest.approx(0.02)


def test_a_last_piece_of_millimetres_is_left_out() -> None:
    path = path_of((2.0, 0.2), (-3.0, 0.0), (-0.004, 0.3))
    assert without_short_end(path).used == 2
    assert standstill_before(without_short_end(path), 2, CONTEXT).next_curvature == 0.0
    assert without_short_end(path_of((0.004, 0.2))).used == 1


@pytest.mark.parametrize(
    ("pieces", "context"),
    [
        (((2.0, 0.2), (-2.0, 0.0)), CONTEXT),
        (((2.0, 0.2),), CONTEXT),
        (((2.0, 0.3), (0.02, -0.3)), CONTEXT),
        (((2.0, 0.2), (2.0, 0.0)), CONTEXT._replace(drive=FollowingParams(rolling_offset=0.0))),
    ],
    ids=["change of gear", "last piece", "too short", "asked to stand"],
)
def test_where_it_has_to_stand(pieces: tuple[tuple[float, float], ...], context: FollowingContext) -> None:
    path = path_of(*pieces)
    assert transition_after(path, 0, context).transition == 0.0
    assert upcoming_stop(path, 0, 1.0, context).left == pytest.approx(1.0 + standstill_before(path, 1, context).overrun)


def test_what_lies_ahead_reaches_to_the_next_change_of_gear() -> None:
    path = path_of((2.0, 0.35), (3.0, -0.3), (-1.0, 0.0))
    assert upcoming_stop(path, 0, 0.5, CONTEXT).left == pytest.approx(3.5 + standstill_before(path, 2, CONTEXT).overrun)
    on_the_ramp = upcoming_stop(path, 0, 0.0, CONTEXT).speed
    assert on_the_ramp < upcoming_stop(path, 0, 0.5, CONTEXT).speed < CONTEXT.drive.speed
    assert upcoming_stop(path, 1, 3.0, CONTEXT).speed == pytest.approx(on_the_ramp, rel=1e-3)
    assert upcoming_stop(path, 1, 1.0, CONTEXT).speed == CONTEXT.drive.speed


@pytest.mark.parametrize(("share", "sets_out"), [(0.9, True), (1.1, False)])
def test_the_vehicle_sets_out_when_its_wheel_may_turn_the_rest_on_the_move(share: float, sets_out: bool) -> None:
    """What the next stop allows is more: setting out by that, the vehicle left its path by 9 cm."""
    path = path_of((1.5, 0.1), (-2.0, 0.0), (2.0, 0.3))
    here, stop = standstill_before(path, 1, CONTEXT), standstill_before(path, 2, CONTEXT)
    before = begin_path(PathProgress(), path, Pose(), CONTEXT)
    progress = next_segment(before._replace(remaining=0.0), Pose(), CONTEXT)
    params = ParkingParams()
    assert progress.upcoming.standstill == stop
    assert stop.after > 1.2 * here.after > 0.0
    rest = share * here.after * params.car.steering.rate_limit
    memory = ParkingMemory(state=ParkingState.STEERING, progress=progress, steering_wheel_angle=0.0)
    inputs = ParkingSystemInput(steering_wheel_angle=rest)
    bits = conditions_of(memory, inputs, params)
    assert bool(bits & bit(Condition.WHEEL_TURNED, True)) == sets_out


def stop_from_speed(lag: float, delay: float) -> tuple[float, float, float]:
    """Return where a vehicle with a lag [s] stops (m before the end), its largest deceleration, the delay learnt."""
    law, dt = CONTEXT.drive, 0.01
    progress, speed, requested, hardest = (
        PathProgress(upcoming=UpcomingStop(3.0, 0.8), speed_delay=delay),
        0.8,
        0.8,
        0.0,
    )
    stops = False
    while speed > 1e-3:
        tracking = SpeedTracking(speed, requested, max(law.brake_delay, progress.speed_delay))
        if not stops:
            progress = learn_speed_delay(progress, tracking, dt, CONTEXT)
        stops = stops or must_stop(progress, tracking, CONTEXT)
        slower = move_towards(requested, 0.0, law.brake_deceleration * dt)
        requested = slower if stops else profile_speed(progress, tracking, 9.0, CONTEXT)
        after = speed + (requested - speed) * dt / lag
        hardest = max(hardest, (speed - after) / dt)
        ahead = progress.upcoming._replace(left=progress.upcoming.left - 0.5 * (speed + after) * dt)
        progress, speed = progress._replace(upcoming=ahead), after
    return progress.upcoming.left, hardest, progress.speed_delay


@pytest.mark.parametrize("lag", [0.02, 0.1, 0.2])
def test_a_vehicle_stops_gently_and_in_place_however_late_its_speed_follows(lag: float) -> None:
    """The first stop teaches the delay, so the next one ends in place."""
    _, hardest, delay = stop_from_speed(lag, 0.0)
    left, harder, _ = stop_from_speed(lag, delay)
    assert delay == pytest.approx(lag, abs=0.06)
    assert abs(left) < 0.012
    assert max(hardest, harder) < 1.2
