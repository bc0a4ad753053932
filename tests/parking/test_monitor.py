"""The collision monitor: the braking invariant by interval splitting, and what it must and must not stop for."""

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller_fmu.parking.chart import TRANSITIONS, Condition, ParkingState, next_parking_state
from controller_fmu.parking.geometry.outline import pose_along_arc, vehicle_outline
from controller_fmu.parking.map.landmark import MAX_LANDMARKS, Landmark, LandmarkType
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.measurement.predicted_range import (
    EchoSurface,
    predict_range_to_point,
    predict_range_to_segment,
)
from controller_fmu.parking.measurement.sensor import sensor_pose
from controller_fmu.parking.monitor.collision_monitor import (
    NO_LIMIT,
    EchoObstacle,
    MonitorVerdict,
    VehicleMotion,
    monitor_collision,
    side_end,
    side_start,
    speed_for_distance,
    stopping_distance,
)
from controller_fmu.parking.monitor.params import MonitorParams
from controller_fmu.parking.objects.track import (
    MAX_COASTING,
    ObjectTrack,
    closing_speed,
    is_lost_at_once,
    is_yielded_to,
    range_in_blind_zone,
    static_approach,
    update_track,
    with_approach,
    with_expectation,
)
from controller_fmu.parking.outputs import parking_outputs
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.perception import echo_obstacle, surface_near
from controller_fmu.parking.signals import ParkingSystemInput
from controller_fmu.parking.state import ParkingMemory
from controller_fmu.parking.system import enter_state
from modelkit.car import Car, SensorMount
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

OUTLINE = vehicle_outline(Car(), 1.0)
NOTHING = (EchoObstacle(),) * 12
EMPTY = (Landmark(),) * MAX_LANDMARKS
FRONT = OUTLINE.centre_ahead + OUTLINE.half_length


def verdict(
    speed: float, landmarks: tuple[Landmark, ...] = EMPTY, echoes: tuple[EchoObstacle, ...] = NOTHING, **more: float
) -> MonitorVerdict:
    motion = VehicleMotion(
        Pose(), more.get("direction", 1.0), speed, more.get("curvature", 0.0), more.get("remaining", 10.0), 0.1, 2.0
    )
    return monitor_collision(motion, OUTLINE, landmarks, echoes, MonitorParams(), MappingParams())


def wall_at(x: float) -> tuple[Landmark, ...]:
    wall = Landmark(LandmarkType.SEGMENT, x, 0.0, math.pi / 2, start=-2.0, end=2.0, confirmations=9)
    return (wall,) + EMPTY[1:]


def test_stopping_distance_never_exceeds_the_free_distance() -> None:
    """Over boxes of (free distance, delay, deceleration): both functions are monotone, so corners bound a box."""
    for f in range(60):
        for d in range(12):
            for b in range(1, 12):
                low, high = 0.05 * f, 0.05 * (f + 1)
                for delay in (0.05 * d, 0.05 * (d + 1)):
                    for brake in (0.5 * b, 0.5 * (b + 1)):
                        speed = speed_for_distance(low, delay, brake)
                        assert stopping_distance(speed, delay, brake) <= low + 1e-9
                        assert speed <= speed_for_distance(high, delay, brake) + 1e-12


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("delay", [0.0, 0.15, 0.3])
def test_the_vehicle_stops_before_a_wall_from_any_speed_gap_and_delay(direction: float, delay: float) -> None:
    """Boxes of gaps 4 cm wide. A farther wall never makes the allowed speed smaller, so the far end of a box, judged by
    the gap of its near end, bounds all of it.
    """
    params, mapping = MonitorParams(), MappingParams()
    edge = FRONT if direction > 0.0 else OUTLINE.half_length - OUTLINE.centre_ahead
    brake = params.brake_deceleration
    for box, step in itertools.product(range(40), range(13)):
        near, speed = 0.04 * box, 0.1 * step
        wall = wall_at(direction * (edge + near + 0.04))
        motion = VehicleMotion(Pose(), direction, speed, 0.0, 10.0, delay, brake)
        allowed = min(monitor_collision(motion, OUTLINE, wall, NOTHING, params, mapping).speed_limit, speed)
        assert stopping_distance(allowed, delay, brake) <= near + 1e-9, (near, speed)


@given(st.floats(0.0, 3.0), st.floats(0.0, 1.0), st.floats(0.1, 10.0))
def test_speed_for_a_distance_is_the_inverse_of_the_stopping_distance(
    free: float, delay: float, deceleration: float
) -> None:
    speed = speed_for_distance(free, delay, deceleration)
    assert stopping_distance(speed, delay, deceleration) == pytest.approx(free, abs=1e-9)


def test_a_vehicle_that_follows_the_speed_limit_late_is_not_stopped_far_from_a_wall() -> None:
    params, lag, dt = MonitorParams(), 0.2, 0.01
    x, speed = 0.0, 0.8
    for _ in range(1000):
        motion = VehicleMotion(Pose(x, 0.0, 0.0), 1.0, speed, 0.0, 10.0, params.brake_delay, params.brake_deceleration)
        seen = monitor_collision(motion, OUTLINE, wall_at(FRONT + 2.0), NOTHING, params, MappingParams())
        if seen.is_blocked:
            break
        speed += (min(seen.speed_limit, 0.8) - speed) * dt / lag
        x += speed * dt
    assert 0.04 < 2.0 - x < 0.45


def test_a_wall_ahead_stops_and_one_beside_or_behind_does_not() -> None:
    assert verdict(0.8, wall_at(FRONT + 0.2)).is_blocked
    assert verdict(0.8, wall_at(FRONT + 0.2)).is_mapped
    assert verdict(0.8, wall_at(FRONT + 2.0)).speed_limit == NO_LIMIT
    assert verdict(0.8, wall_at(-0.7)).speed_limit == NO_LIMIT
    beside = Landmark(LandmarkType.SEGMENT, 0.0, -1.0, 0.0, start=-5.0, end=5.0, confirmations=9)
    assert verdict(0.8, (beside,) + EMPTY[1:]).speed_limit == NO_LIMIT


def test_an_unconfirmed_landmark_does_not_stop() -> None:
    tentative = wall_at(FRONT + 0.2)[0]._replace(confirmations=1)
    assert not verdict(0.8, (tentative,) + EMPTY[1:]).is_blocked


def test_an_unexplained_echo_stops_at_once() -> None:
    echo = EchoObstacle(FRONT + 0.35, 0.1, 0.0, True, True)
    assert verdict(0.8, echoes=(echo,) + NOTHING[1:]).is_blocked
    assert not verdict(0.8, echoes=(echo._replace(is_present=False),) + NOTHING[1:]).is_blocked


def test_what_the_map_predicts_is_kept_clear_of_where_it_is_measured() -> None:
    """A neighbour 15 cm nearer than mapped was driven into at 0.6 m/s: its echoes were explained."""
    echo = EchoObstacle(FRONT + 0.15, 0.1, 0.0, True)
    assert verdict(0.5, echoes=(echo,) + NOTHING[1:]).free_distance < 0.15
    assert not verdict(0.1, echoes=(echo,) + NOTHING[1:]).is_blocked, "unlike an unexplained one"


def rear_corner_echo(shift: float) -> EchoObstacle:
    """The echo of the rear left sensor from a wall ``shift`` nearer than mapped, 5 cm beside a rear corner.

    The wall lies at an angle at which the cone's boundary cuts it 0.3 m before the foot of the perpendicular.
    """
    sensor = sensor_pose(Car().ultrasonic.mounts[4], math.radians(30.0), Pose())
    turn = math.radians(25.0)
    ux, uy = math.cos(turn), math.sin(turn)
    corner = Point(-0.6, 0.825)
    foot = Point(corner.x - 0.05 * uy, corner.y + 0.05 * ux)
    a = Point(foot.x - 3.0 * ux, foot.y - 3.0 * uy)
    expected = predict_range_to_segment(sensor, a, Point(foot.x + 3.0 * ux, foot.y + 3.0 * uy))
    measured = expected.distance - shift
    share = measured / expected.distance
    x, y = sensor.x + share * (expected.x - sensor.x), sensor.y + share * (expected.y - sensor.y)
    return EchoObstacle(x, y, is_present=True, surface=surface_near(expected, measured, MonitorParams()))


def test_a_rear_corner_is_kept_clear_of_the_wall_beside_it() -> None:
    """The corner swept along a wall into it: the wall's echo was a point, on the cone's boundary beside the corner."""
    echo = rear_corner_echo(0.02)
    assert verdict(0.0, echoes=(echo,) + NOTHING[1:], direction=-1.0).is_blocked
    assert not verdict(0.0, echoes=(echo,) + NOTHING[1:], direction=1.0).is_blocked


def test_an_echo_far_from_where_a_side_is_expected_is_not_of_that_side() -> None:
    assert rear_corner_echo(-0.25).surface == EchoSurface()


def test_an_echo_nearer_than_the_corner_expected_may_come_from_anywhere_in_the_cone() -> None:
    """A pillar whose road side was mapped was touched by its next corner, at the boundary of an outer sensor's cone."""
    params = ParkingParams()
    sensor = sensor_pose(params.car.ultrasonic.mounts[3], params.car.ultrasonic.half_angle, Pose())
    corner = ObjectTrack(0.22, confirmations=9, expected=0.40, ux=sensor.axis_x, uy=sensor.axis_y)
    echo = echo_obstacle(corner, 3, ParkingSystemInput(), params)
    axis = math.atan2(sensor.axis_y, sensor.axis_x)
    for end, side in ((side_start(echo), -1.0), (side_end(echo), 1.0)):
        bearing = axis + side * params.car.ultrasonic.half_angle
        assert end.x == pytest.approx(sensor.x + 0.22 * math.cos(bearing))
        assert end.y == pytest.approx(sensor.y + 0.22 * math.sin(bearing))
    where_expected = echo_obstacle(corner._replace(expected=0.24), 3, ParkingSystemInput(), params)
    assert where_expected.surface == EchoSurface()


def test_an_echo_in_no_known_direction_is_no_obstacle() -> None:
    """One that had come from beyond the monitored range stood ahead in the odometry frame, inside the vehicle."""
    beyond = ObjectTrack(1.49, confirmations=9)
    assert not echo_obstacle(beyond, 11, ParkingSystemInput(), ParkingParams()).is_present


def test_an_approaching_object_stops_earlier() -> None:
    still = EchoObstacle(FRONT + 0.6, 0.0, 0.0, True, True)
    free = verdict(0.5, echoes=(still,) + NOTHING[1:]).free_distance
    assert verdict(0.5, echoes=(still._replace(closing_speed=1.5),) + NOTHING[1:]).free_distance < free


def test_the_vehicle_may_leave_what_it_stands_beside() -> None:
    assert not verdict(0.0, wall_at(FRONT + 0.02), direction=-1.0).is_blocked
    assert verdict(0.0, wall_at(FRONT + 0.02)).is_blocked


def side_wall(gap: float, turn: float) -> tuple[Landmark, ...]:
    """Return a wall ``gap`` [m] to the left of a vehicle at the origin, which drives at an angle towards it."""
    y = OUTLINE.half_width + gap
    wall = Landmark(LandmarkType.SEGMENT, OUTLINE.centre_ahead, y, -turn, start=-9.0, end=9.0, confirmations=9)
    return (wall,) + EMPTY[1:]


@pytest.mark.parametrize("turn", [0.005, 0.02, 0.05])
def test_a_vehicle_does_not_scrape_along_a_wall_by_a_little_at_each_sample(turn: float) -> None:
    """Each sample allowed 5 mm more: a neighbour was scraped 33 cm deep, and what overlapped limited nothing."""
    wall = side_wall(0.03 + turn * OUTLINE.half_length, turn)
    x = 0.0
    for _ in range(2000):
        motion = VehicleMotion(Pose(x, 0.0, 0.0), 1.0, 0.1, 0.0, 10.0, 0.1, 2.0, Pose())
        seen = monitor_collision(motion, OUTLINE, wall, NOTHING, MonitorParams(), MappingParams())
        if seen.is_blocked:
            break
        x += 0.1 * 0.01
    assert seen.is_blocked
    assert turn * x <= 0.0055


def test_what_overlaps_the_vehicle_may_be_left_but_not_driven_into() -> None:
    """Of an echo beside a front corner the nearest way out was aside: the vehicle drove on ahead, 33 cm deep."""
    corner = Landmark(
        LandmarkType.SEGMENT, FRONT - 0.05, OUTLINE.half_width - 0.03, 2.1, start=-0.1, end=0.1, confirmations=9
    )
    for inside in (wall_at(FRONT - 0.1), (corner,) + EMPTY[1:]):
        assert verdict(0.0, inside).is_blocked
        assert not verdict(0.0, inside, direction=-1.0).is_blocked


def test_of_a_side_that_overlaps_the_vehicle_only_the_point_measured_counts() -> None:
    """The side expected before an outer sensor reached into the vehicle: it stood still with 20 cm to go."""
    side = EchoSurface(0.0, 1.0, -0.25, 0.25)
    echo = EchoObstacle(FRONT - 0.05, OUTLINE.half_width + 0.1, is_present=True, surface=side)
    assert not verdict(0.0, echoes=(echo,) + NOTHING[1:]).is_blocked
    inside = echo._replace(y=OUTLINE.half_width - 0.05)
    assert verdict(0.0, echoes=(inside,) + NOTHING[1:]).is_blocked


def test_a_track_finds_the_closing_speed() -> None:
    track, distance = ObjectTrack(), 2.0
    for _ in range(12):
        distance -= 1.5 * 0.04
        track = update_track(track, True, distance, 0.0, 1e-4, 0.04)
    assert (track.confirmations, track.missed) == (12, 0)
    assert closing_speed(with_expectation(track, 2.0, 1.0, 0.0, EchoSurface(), True)) == pytest.approx(1.5, abs=0.2)
    assert closing_speed(with_expectation(track, 1.3, 1.0, 0.0, EchoSurface(), False)) == 0.0, (
        "the vehicle approaches a wall"
    )


def test_own_motion_is_no_closing_speed() -> None:
    track, distance = ObjectTrack(), 2.0
    for _ in range(12):
        distance -= 0.8 * 0.04
        track = update_track(track, True, distance, 0.8 * 0.04, 1e-4, 0.04)
    assert closing_speed(with_expectation(track, 2.0, 1.0, 0.0, EchoSurface(), True)) == 0.0


def test_what_came_into_the_blind_zone_comes_nearer_as_the_vehicle_does() -> None:
    """The sensor reports 0.15 m for anything nearer: a neighbour was passed at 2 mm."""
    track, distance = ObjectTrack(), 0.3
    for _ in range(20):
        distance -= 0.01
        reading = max(distance, 0.15)
        if reading == 0.15:
            reading = range_in_blind_zone(track, 0.01, reading)
        track = update_track(track, True, reading, 0.01, 1e-4, 0.04)
    assert track.range == pytest.approx(distance, abs=0.02)


def tracked(readings: list[float], poses: list[Pose], mount: SensorMount) -> list[ObjectTrack]:
    """Return the tracks of a sensor that measures ``readings`` [m] every 40 ms from a vehicle at ``poses``."""
    track, tracks = ObjectTrack(), []
    before = sensor_pose(mount, math.radians(30.0), poses[0])
    for reading, pose in zip(readings, poses, strict=True):
        sensor = sensor_pose(mount, math.radians(30.0), pose)
        along = (sensor.x - before.x) * sensor.axis_x + (sensor.y - before.y) * sensor.axis_y
        after = update_track(track, reading < 5.0, reading, along, 1e-4, 0.04)
        track = with_approach(track, after, static_approach(before, sensor))
        tracks.append(track)
        before = sensor
    return tracks


FLANK = SensorMount(3.0, 0.9, math.pi / 2)


def test_a_vehicle_yields_to_a_pedestrian_at_its_flank() -> None:
    """He comes within 0.5 m at 1.2 m/s, and walks on along the flank, where no range changes."""
    readings = [max(2.5 - 1.2 * 0.04 * n, 0.5) for n in range(60)]
    yields = list(map(is_yielded_to, tracked(readings, [Pose()] * 60, FLANK)))
    assert not any(yields[:10]), "he is far off"
    assert yields[10 : readings.index(0.5) + 1].count(True) > 3
    assert not any(map(is_yielded_to, tracked([0.5] * 60, [Pose()] * 60, FLANK))), "what has always stood there"


@given(st.floats(-0.8, 0.8), st.floats(-0.2, 0.2), st.floats(0.3, 2.5), st.floats(-2.0, 6.0))
def test_no_static_corner_counts_as_moving(speed: float, curvature: float, lateral: float, x: float) -> None:
    poses = [pose_along_arc(Pose(), speed * 0.04 * n, curvature) for n in range(80)]
    readings = []
    for pose in poses:
        sensor = sensor_pose(FLANK, math.radians(30.0), pose)
        readings.append(min(predict_range_to_point(sensor, x, 0.9 + lateral).distance, 5.0))
    assert not any(map(is_yielded_to, tracked(readings, poses, FLANK)))


def test_many_echoes_lost_in_one_cycle_show_silent_sensors() -> None:
    lost = ObjectTrack(1.0, confirmations=9)
    for _ in range(MAX_COASTING):
        lost = update_track(lost, False, 5.0, 0.0, 1e-4, 0.04)
    seen = update_track(ObjectTrack(1.0, rr=1e-4, confirmations=9), True, 1.0, 0.0, 1e-4, 0.04)
    before = update_track(lost, False, 5.0, 0.0, 1e-4, 0.04)
    assert is_lost_at_once((lost,) * 4 + (seen,) * 8)
    assert not is_lost_at_once((lost,) * 3 + (seen,) * 9)
    assert not is_lost_at_once((lost,) * 3 + (before,) * 9), "they were lost before"


def test_a_track_coasts_and_ends() -> None:
    track = ObjectTrack()
    for _ in range(4):
        track = update_track(track, True, 1.0, 0.0, 1e-4, 0.04)
    track = update_track(track, False, 0.0, 0.0, 1e-4, 0.04)
    assert (track.confirmations, track.missed) == (4, 1)
    for _ in range(6):
        track = update_track(track, False, 0.0, 0.0, 1e-4, 0.04)
    assert track == ObjectTrack()


def test_every_state_has_a_way_out_and_faults_win() -> None:
    for state in ParkingState:
        assert [row for row in TRANSITIONS if row[0] == state], state
    for state in (ParkingState.PLANNING, ParkingState.STEERING, ParkingState.DRIVING, ParkingState.STOPPING):
        others = sum(1 << condition for condition in Condition if condition > Condition.FAULT)
        assert next_parking_state(state, others | 1 << Condition.FAULT) == ParkingState.FAILED
        assert next_parking_state(state, others | 1 << Condition.TAKEN_OVER) == ParkingState.TAKEOVER


def test_the_requested_speed_falls_gently_at_a_planned_stop_and_at_once_where_the_monitor_brakes() -> None:
    params, inputs = ParkingParams(), ParkingSystemInput(apa_switch=True)
    stopping = ParkingMemory(state=ParkingState.STOPPING, speed=-0.12)
    after = enter_state(stopping, ParkingState.STOPPING, inputs, params)
    assert after.speed == pytest.approx(-0.12 + 1.0 * params.sample_time)
    assert not parking_outputs(after, params).brake_request
    blocked = stopping._replace(verdict=MonitorVerdict(is_blocked=True))
    after = enter_state(blocked, ParkingState.STOPPING, inputs, params)
    assert after.speed == 0.0
    assert parking_outputs(after, params).brake_request
