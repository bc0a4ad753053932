"""From piece to piece without a stop: the way beside the path is the one that the ramp's curvature makes."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller_fmu.planning.plan import Path, Piece
from controller_fmu.planning.task import drive
from controller_fmu.valet.params import ValetDriveParams, ValetParams
from controller_fmu.valet.rolling import SLOWEST, ahead_of, aim_at, joint_of
from modelkit.vocabulary import Pose

PARAMS = ValetParams()
curvature = st.floats(-0.3, 0.3)


def path_of(*pieces: tuple[float, float]) -> Path:
    """Return a path of (way, curvature) with 15 cm of margin."""
    found = Path()
    made = tuple(Piece(way, k, k) for way, k in pieces)
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
            at = drive(begin, direction * (abs(way) - left), path.pieces[number].k0)
            beside = (pose.y - at.y) * math.cos(at.heading) - (pose.x - at.x) * math.sin(at.heading)
            aim = aim_at(path, number, left, PARAMS)
            rows.append((aim.lateral - beside, aim.heading - (pose.heading - at.heading), abs(beside)))
        begin = drive(begin, way, path.pieces[number].k0)
    return rows


@settings(max_examples=12, deadline=None)
@given(k0=curvature, k1=curvature, length=st.floats(1.5, 2.5), direction=st.sampled_from([1.0, -1.0]))
def test_the_aim_is_where_its_curvature_leads(k0: float, k1: float, length: float, direction: float) -> None:
    length = round(length, 2)
    path = path_of((direction * length, k0), (direction * length, k1))
    joint = joint_of(path, 0, PARAMS)
    rows = driven(path)
    half = int((length + 0.5 * joint.ramp) / 0.005) - 2
    assert max(abs(row[1]) for row in rows) < 2e-3
    assert max(abs(row[0]) for row in rows[:half]) < 2e-3, "until the ramp is over"
    assert max(row[2] for row in rows) <= PARAMS.drive.rolling + 3e-3


@given(k0=curvature, k1=curvature, way=st.floats(0.1, 5.0))
def test_the_wheel_can_follow_a_ramp(k0: float, k1: float, way: float) -> None:
    joint = joint_of(path_of((way, k0), (way, k1)), 0, PARAMS)
    if joint.ramp > 0.0 and abs(k1 - k0) > 1e-3:
        base, car = PARAMS.car.wheelbase, PARAMS.car.steering
        swing = abs(math.atan(base * k1) - math.atan(base * k0))
        assert joint.speed * swing / joint.ramp < car.rate_limit / car.ratio
        assert joint.speed >= SLOWEST
        assert joint.ramp <= way


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
    assert ahead_of(path, 0, 1.0, params).left == 1.0


def test_what_lies_ahead_reaches_to_the_next_change_of_gear() -> None:
    path = path_of((2.0, 0.35), (3.0, -0.3), (-1.0, 0.0))
    assert ahead_of(path, 0, 0.5, PARAMS).left == pytest.approx(3.5)
    assert ahead_of(path, 0, 0.5, PARAMS).speed < PARAMS.drive.speed
    assert ahead_of(path, 1, 2.9, PARAMS).speed == pytest.approx(joint_of(path, 0, PARAMS).speed)
    assert ahead_of(path, 1, 1.0, PARAMS).speed == PARAMS.drive.speed
