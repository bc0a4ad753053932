"""From piece to piece without a stop: the way beside the path is the one that the ramp's curvature makes."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller_fmu.common.ramp import off_behind, ramp_length
from controller_fmu.planning.plan import Path, Piece
from controller_fmu.planning.stretch import trimmed
from controller_fmu.planning.task import drive
from controller_fmu.valet.params import ValetDriveParams, ValetParams
from controller_fmu.valet.rolling import FARTHER, ROOMIEST, SLOWEST, ahead_of, aim_at, joint_of, rest_before
from controller_fmu.valet.slot import QUICKEST
from modelkit.vocabulary import Pose

PARAMS = ValetParams()
MOST = ROOMIEST * PARAMS.drive.rolling
curvature = st.floats(-0.3, 0.3)


def path_of(*pieces: tuple[float, float], room: float = 0.1) -> Path:
    """Return a path of (way, curvature) with 15 cm of margin."""
    found = Path()
    made = tuple(Piece(way, k, room) for way, k in pieces)
    return found._replace(used=len(made), margin=0.15, pieces=made + found.pieces[len(made) :])


def driven(path: Path) -> list[tuple[float, float, float]]:
    """Return (aim's lateral, heading, less where the curvature leads; how far beside), every 5 mm."""
    step, pose, begin, rows = 0.005, Pose(), Pose(), []
    for number in range(path.used):
        way = path.pieces[number].way
        direction = math.copysign(1.0, way)
        for index in range(round(abs(way) / step)):
            left = abs(way) - (index + 1) * step
            middle = aim_at(path, number, left + 0.5 * step, PARAMS).curvature
            pose = drive(pose, direction * step, middle)
            at = drive(begin, direction * (abs(way) - left), path.pieces[number].k)
            beside = (pose.y - at.y) * math.cos(at.heading) - (pose.x - at.x) * math.sin(at.heading)
            aim = aim_at(path, number, left, PARAMS)
            rows.append((aim.lateral - beside, aim.heading - (pose.heading - at.heading), abs(beside)))
        begin = drive(begin, way, path.pieces[number].k)
    return rows


@settings(max_examples=12)
@given(k0=curvature, k1=curvature, length=st.floats(1.5, 2.5), direction=st.sampled_from([1.0, -1.0]))
def test_the_aim_is_where_its_curvature_leads(k0: float, k1: float, length: float, direction: float) -> None:
    length = round(length, 2)
    path = path_of((direction * length, k0), (direction * length, k1))
    joint = joint_of(path, 0, PARAMS)
    rows = driven(path)
    half = int((length + 0.5 * joint.ramp) / 0.005) - 2
    bent = max(abs(k0), abs(k1)) ** 2  # beside a bend the way is as much longer as it is off, which the aim leaves out
    assert max(abs(row[1]) for row in rows) < 1e-3 + 0.5 * bent * MOST * joint.ramp
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
    rows, ramps = driven(path), joint_of(path, 0, PARAMS).ramp + joint_of(path, 1, PARAMS).ramp
    assert max(abs(row[1]) for row in rows) < 1e-3 + max(number * number for number in k) * MOST * ramps
    assert max(row[2] for row in rows) <= 2.0 * MOST + 5e-3
    assert max(abs(aim_at(path, 1, 0.01 * n, PARAMS).curvature) for n in range(round(100 * ways[1]))) < 0.31


def test_of_a_short_arc_between_two_lines_little_is_left() -> None:
    path = path_of((2.0, 0.0), (0.06, 0.33), (2.0, 0.0))
    assert abs(aim_at(path, 1, 0.03, PARAMS).curvature) < 0.33 * 0.06 / 1.0
    assert ahead_of(path, 0, 1.9, PARAMS).left == pytest.approx(3.96)
    assert ahead_of(path, 0, 0.5, PARAMS).speed == PARAMS.drive.speed


@settings(max_examples=40)
@given(k0=curvature, k1=curvature, way=st.floats(0.1, 5.0))
def test_the_wheel_can_follow_a_ramp(k0: float, k1: float, way: float) -> None:
    path = path_of((way, k0), (way, k1))
    joint = joint_of(path, 0, PARAMS)
    if joint.ramp > 0.0 and abs(k1 - k0) > 1e-3:
        base, car = PARAMS.car.wheelbase, PARAMS.car.steering
        assert joint.ramp <= 2.0 * way
        for share in (0.49, 0.2, 0.01, -0.2, -0.49):
            left, piece = share * joint.ramp, 0
            if left < 0.0:
                left, piece = way + left, 1
            near = [math.atan(base * aim_at(path, piece, left + off, PARAMS).curvature) for off in (1e-6, -1e-6)]
            speed = ahead_of(path, piece, left, PARAMS).speed
            assert speed * abs(near[1] - near[0]) / 2e-6 < car.rate_limit / car.ratio
            assert speed >= 0.5 * SLOWEST


def turned_round(path: Path) -> tuple[float, float]:
    """Return (heading, offset) against the second of two pieces of a car whose wheel turns about the cusp between."""
    rest, step, law = rest_before(path, 1, PARAMS), 4e-4, PARAMS.drive
    base, car = PARAMS.car.wheelbase, PARAMS.car.steering
    first, second = path.pieces[:2]
    direction, speed, left = math.copysign(1.0, first.way), 0.8, abs(first.way) + rest.over
    pose, phi, last = Pose(), math.atan(base * first.k), math.atan(base * second.k)

    def turned(phi: float) -> float:
        rate = step * car.rate_limit / car.ratio
        return phi + max(-rate, min(rate, last - phi))

    while left > 0.0:
        speed = min(speed, math.sqrt(2.0 * law.deceleration * left))
        phi = turned(phi) if left < 0.5 * law.deceleration * rest.before**2 else phi
        pose, left = drive(pose, direction * speed * step, math.tan(phi) / base), left - speed * step - 1e-12
    while abs(last - phi) > rest.after * car.rate_limit / car.ratio:
        phi = turned(phi)
    speed, way = 0.0, 0.0
    while way < 1.0:
        phi, speed = turned(phi), min(0.8, speed + QUICKEST * step)
        pose, way = drive(pose, -direction * speed * step, math.tan(phi) / base), way + speed * step
    at = drive(drive(Pose(), first.way, first.k), -direction * (way - rest.over), second.k)
    return pose.heading - at.heading, (pose.y - at.y) * math.cos(at.heading) - (pose.x - at.x) * math.sin(at.heading)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize(("k0", "k1"), [(0.3, -0.3), (0.0, 0.3), (-0.25, 0.1), (0.2, 0.18)])
def test_a_car_that_turns_its_wheel_about_a_cusp_is_on_its_path_behind_it(
    k0: float, k1: float, direction: float
) -> None:
    path = path_of((direction * 1.5, k0), (-direction * 2.0, k1))
    rest = rest_before(path, 1, PARAMS)
    assert rest.before > 0.0 < rest.after
    assert rest.then == k1
    assert rest.over <= FARTHER * PARAMS.drive.rolling
    assert ahead_of(path, 0, 1.0, PARAMS).left == pytest.approx(1.0 + rest.over)
    heading, offset = turned_round(path)
    assert abs(heading) < max(1e-3, 0.25 * abs(k1 - k0) * rest.over)
    assert abs(offset) < 3e-3
    without = turned_round(path._replace(margin=0.04))
    assert abs(without[0]) < 1e-3, "at rest nothing is lost"


def without_room(path: Path) -> Path:
    """Return the path with nothing free about it but its margin."""
    return path._replace(pieces=tuple(piece._replace(room=0.0) for piece in path.pieces))


def test_where_there_is_room_the_wheel_turns_longer_on_the_move() -> None:
    path = path_of((1.5, 0.3), (-2.0, -0.3))
    wide, narrow = rest_before(path, 1, PARAMS), rest_before(without_room(path), 1, PARAMS)
    assert narrow.over <= 0.01 < 0.05 < wide.over <= path.pieces[1].room
    assert wide.before + wide.after > 1.5 * (narrow.before + narrow.after)
    assert rest_before(path, 0, PARAMS).after > 1.2 * rest_before(without_room(path), 0, PARAMS).after
    onto = path_of((2.0, 0.0), (2.0, 0.3))
    tight = path_of((2.0, 0.0), (2.0, 0.3), room=0.01)
    assert joint_of(onto, 0, PARAMS).ramp > 1.1 * joint_of(tight, 0, PARAMS).ramp > 0.5
    assert joint_of(without_room(onto), 0, PARAMS).ramp == 0.0, "it stands"
    stands = path_of((1.5, 0.3), (0.02, -0.3))
    assert joint_of(stands, 0, PARAMS).ramp == 0.0
    assert rest_before(stands, 1, PARAMS) == rest_before(without_room(stands), 1, PARAMS), "nothing is got back"


def test_without_room_a_jump_has_no_ramp_and_no_jump_has_the_longest() -> None:
    assert ramp_length(0.0, 0.2, 3.0) == 0.0
    assert ramp_length(0.0, 0.0, 3.0) == ramp_length(0.02, 0.0, 3.0) == 3.0
    assert off_behind(0.2, ramp_length(0.02, -0.2, 3.0)) == pytest.approx(0.02)


def test_a_last_piece_of_millimetres_is_left_out() -> None:
    path = path_of((2.0, 0.2), (-3.0, 0.0), (-0.004, 0.3))
    assert trimmed(path).used == 2
    assert rest_before(trimmed(path), 2, PARAMS).then == 0.0
    assert trimmed(path_of((0.004, 0.2))).used == 1


@pytest.mark.parametrize(
    ("pieces", "params"),
    [
        (((2.0, 0.2), (-2.0, 0.0)), PARAMS),
        (((2.0, 0.2),), PARAMS),
        (((2.0, 0.3), (0.02, -0.3)), PARAMS),
        (((2.0, 0.2), (2.0, 0.0)), PARAMS._replace(drive=ValetDriveParams(rolling=0.0))),
    ],
    ids=["change of gear", "last piece", "too short", "asked to stand"],
)
def test_where_it_has_to_stand(pieces: tuple[tuple[float, float], ...], params: ValetParams) -> None:
    path = path_of(*pieces)
    assert joint_of(path, 0, params).ramp == 0.0
    assert ahead_of(path, 0, 1.0, params).left == pytest.approx(1.0 + rest_before(path, 1, params).over)


def test_what_lies_ahead_reaches_to_the_next_change_of_gear() -> None:
    path = path_of((2.0, 0.35), (3.0, -0.3), (-1.0, 0.0))
    assert ahead_of(path, 0, 0.5, PARAMS).left == pytest.approx(3.5 + rest_before(path, 2, PARAMS).over)
    on_the_ramp = ahead_of(path, 0, 0.0, PARAMS).speed
    assert on_the_ramp < ahead_of(path, 0, 0.5, PARAMS).speed < PARAMS.drive.speed
    assert ahead_of(path, 1, 3.0, PARAMS).speed == pytest.approx(on_the_ramp, rel=1e-3)
    assert ahead_of(path, 1, 1.0, PARAMS).speed == PARAMS.drive.speed
