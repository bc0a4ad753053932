"""NTBPT along moves: errors die out as the law says, in both directions, whatever the path's heading."""

import math

import pytest

from controller_fmu.apa.params import ApaDriveParams
from controller_fmu.apa.speed import planned_speed, stopping_way
from controller_fmu.apa.tracking import Leg, next_standstill, set_wheel, track
from controller_fmu.apa.ways.move import Move, end_of, length_of, point_at
from controller_fmu.apa.ways.turns import forward_turn, reverse_turn, straight_move, turn_of, two_arcs
from controller_fmu.common.curve import advance
from modelkit.vocabulary import Pose

WHEELBASE = 2.6
TURN = turn_of(0.15, 0.15, 0.8)


def drive_along(move: Move, start: Pose, k1: float = 2.0, k2: float = 2.4) -> tuple[list[float], Pose]:
    """Return the lateral errors every centimetre, and the last pose, of an ideal car."""
    pose, way = start, 0.0
    errors: list[float] = []
    while True:
        tracked = track(move, Leg(0.0, length_of(move)), way, pose, ApaDriveParams(k1=k1, k2=k2), WHEELBASE)
        way = tracked.way
        if tracked.left <= 0.0:
            return errors, pose
        errors.append(tracked.lateral_error)
        curvature = math.tan(tracked.front_wheel_angle) / WHEELBASE
        pose = advance(pose, float(move.direction), 0.01, curvature, curvature)


@pytest.mark.parametrize("heading", [0.0, 1.0, 2.5, -2.0])
@pytest.mark.parametrize("direction", [1, -1])
def test_the_error_obeys_its_differential_equation(direction: int, heading: float) -> None:
    k1, k2 = 1.0, 0.8
    move = straight_move(Pose(3.0, -2.0, heading), direction, 6.0)
    start = Pose(3.0 - 0.02 * math.sin(heading), -2.0 + 0.02 * math.cos(heading), heading)
    errors, _ = drive_along(move, start, k1, k2)
    root = math.sqrt(k1 - 0.25 * k2 * k2)
    for n in range(0, 550, 25):
        s = 0.01 * n
        closed = 0.02 * math.exp(-0.5 * k2 * s) * (math.cos(root * s) + 0.5 * k2 / root * math.sin(root * s))
        assert errors[n] == pytest.approx(closed, abs=2e-4)


@pytest.mark.parametrize(
    "move", [reverse_turn(Pose(8.0, -9.0, -1.3), TURN), forward_turn(Pose(1.0, 2.0, 0.3), 2.0, 1.4, TURN)]
)
def test_a_path_that_turns_far_is_followed_to_its_end(move: Move) -> None:
    assert move.direction != 0
    start = Pose(move.start.x + 0.05, move.start.y - 0.05, move.start.heading + 0.02)
    _, pose = drive_along(move, start)
    end = end_of(move)
    assert math.hypot(pose.x - end.x, pose.y - end.y) < 0.02
    assert pose.heading == pytest.approx(end.heading, abs=0.02)


def test_on_the_path_the_wheel_is_the_paths() -> None:
    move = reverse_turn(Pose(8.0, -9.0, -1.3), TURN)
    for n in range(1, 90):
        point = point_at(move, 0.1 * n)
        tracked = track(move, Leg(0.0, length_of(move)), 0.1 * n, point.pose, ApaDriveParams(), WHEELBASE)
        assert tracked.lateral_error == pytest.approx(0.0, abs=1e-9)
        assert tracked.front_wheel_angle == pytest.approx(math.atan(WHEELBASE * point.curvature), abs=1e-9)


def test_a_jump_of_curvature_is_a_standstill() -> None:
    move = two_arcs(Pose(0.0, 0.0, 0.1), 1, 0.15, 0.5, 0.7, 0.0)
    first, second = Leg(0.0, next_standstill(move, 0.0)), Leg(0.5, next_standstill(move, 0.5))
    assert (first.end, second.end) == pytest.approx((0.5, 1.2))
    assert set_wheel(move, first, 0.0, WHEELBASE) == pytest.approx(math.atan(0.15 * WHEELBASE))
    for way in (0.47, 0.5, 0.53):
        assert set_wheel(move, second, way, WHEELBASE) == pytest.approx(-math.atan(0.15 * WHEELBASE))
        pose = point_at(move, way).pose
        angle = track(move, second, way, pose, ApaDriveParams(), WHEELBASE).front_wheel_angle
        assert angle == pytest.approx(-math.atan(0.15 * WHEELBASE), abs=0.03)


def test_speed_falls_towards_a_standstill_and_where_the_wheel_has_to_turn() -> None:
    drive = ApaDriveParams()
    speeds = [planned_speed(0.01 * n, 0.0, WHEELBASE, 0.5, drive) for n in range(200)]
    assert speeds == sorted(speeds)
    assert speeds[0] == drive.creep
    assert speeds[-1] == drive.speed
    slope = 0.15 / 0.4
    on_ramp = planned_speed(5.0, slope, WHEELBASE, 0.5, drive)
    assert on_ramp * slope * WHEELBASE <= 0.5 * drive.steering_reserve + 1e-12
    assert stopping_way(0.8, drive, 0.3) == pytest.approx(0.8 * 0.3 + 0.5 * 0.64 / drive.brake)
