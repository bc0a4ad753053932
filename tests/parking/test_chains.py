"""Chains of echoes: ends by least squares, rows separated, surfaces that a bumper approaches, start positions."""

import math

import numpy as np
import pytest

from controller_fmu.parking.map.chain_update import (
    ChainUpdate,
    as_point,
    chain_ending,
    edge_guess,
    first_of_body,
    fit_chain,
    is_better,
    is_explained,
    next_chain,
    same_side,
)
from controller_fmu.parking.map.echo_chain import (
    EchoChain,
    Ending,
    append_echo,
    begin_chain,
    continues,
    is_passed,
    without_echoes_before,
)
from controller_fmu.parking.map.facing_surface import facing_segment
from controller_fmu.parking.map.landmark import (
    MAX_LANDMARKS,
    Landmark,
    LandmarkType,
    end_point,
    length_of,
    offset_of,
    start_point,
)
from controller_fmu.parking.map.local_map import LandmarkMap, update_map
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.map.segment_fit import EndGuess, SegmentGuess, fit_segment
from controller_fmu.parking.measurement.sensor import Measurement, ReadingStatus, SensorPose
from modelkit.geometry import Box
from modelkit.vocabulary import Pose
from tests.parking.simulated_pass import CAR, drive_past

PARAMS = MappingParams()
DOWN = SensorPose(0.0, 1.0, 0.0, -1.0, math.cos(0.52), math.sin(0.52))


def chain_past(start: float, end: float, noise: float, seed: int = 0) -> EchoChain:
    """Return the echoes of a side from ``start`` to ``end`` on y = 0, heard from y = 1 with a cone of 30 deg."""
    rng = np.random.default_rng(seed)
    chain = EchoChain()
    for x in np.arange(start - 0.5, end + 0.5, 0.08):
        nearest = min(max(x, start), end)
        measured = float(math.hypot(x - nearest, 1.0) + noise * rng.standard_normal())
        sensor = DOWN._replace(x=float(x))
        chain = begin_chain(sensor, measured, True) if chain.used == 0 else append_echo(chain, sensor, measured)
    return chain


def test_fit_finds_both_ends_and_their_deviations() -> None:
    errors = []
    for seed in range(40):
        chain = chain_past(0.0, 1.8, 0.01, seed)
        line = Landmark(LandmarkType.SEGMENT, 0.9, 0.02, 0.03)
        fit = fit_segment(chain, 0, chain.used - 1, SegmentGuess(line, EndGuess(-1.0, 0.3), EndGuess(1.0, 0.3)), 1e-4)
        found = fit.landmark
        errors.append((start_point(found).x - 0.0) ** 2 / found.start_variance)
        errors.append((end_point(found).x - 1.8) ** 2 / found.end_variance)
    assert 0.5 < np.mean(errors) < 1.5


def test_exact_ranges_give_the_exact_segment() -> None:
    chain = chain_past(0.0, 1.8, 0.0)
    line = Landmark(LandmarkType.SEGMENT, 0.9, 0.1, -0.05)
    found = fit_segment(
        chain, 0, chain.used - 1, SegmentGuess(line, EndGuess(-1.1, 1.0), EndGuess(1.1, 1.0)), 1e-4
    ).landmark
    assert start_point(found).x == pytest.approx(0.0, abs=0.002)
    assert end_point(found).x == pytest.approx(1.8, abs=0.002)
    assert offset_of(found, 0.9, 0.0) == pytest.approx(0.0, abs=0.002)


def test_an_edge_is_guessed_where_the_cone_met_it() -> None:
    """A sensor turned by 8 deg against the side; the first echo comes up to a step after its cone met the edge."""
    half, tilt, step = math.radians(30.0), math.radians(8.0), 0.4
    sensor = SensorPose(0.0, 0.0, math.sin(tilt), -math.cos(tilt), math.cos(half), math.sin(half))
    line = Landmark(LandmarkType.SEGMENT, 0.0, -1.0)
    errors = []
    for late in np.linspace(0.0, step, 9):
        x = late - math.tan(half + tilt)
        echo = begin_chain(sensor._replace(x=x), math.hypot(x, 1.0) if x < 0.0 else 1.0, True).echoes[0]
        guess = edge_guess(line, echo, sensor, 1.0, step)
        errors.append(guess.along / guess.sigma)
    assert np.mean(np.square(errors)) < 1.0
    assert np.max(np.abs(errors)) < 2.0


def gap_evidence_of(bodies: tuple[tuple[float, float], ...], noise: float, seed: int) -> float:
    """Return the evidence for a gap in the first side mapped of bodies passed at 1.4 m with an echo every 0.2 m."""
    rng = np.random.default_rng(seed)
    chain = EchoChain()
    for x in np.arange(bodies[0][0] - 0.5, bodies[-1][1] + 0.5, 0.2):
        ranges = (math.hypot(x - min(max(x, start), end), 1.4) for start, end in bodies)
        measured = float(min(ranges) + noise * rng.standard_normal())
        sensor = DOWN._replace(x=float(x), y=1.4)
        chain = begin_chain(sensor, measured, True) if chain.used == 0 else append_echo(chain, sensor, measured)
    reading = Measurement(sensor, ReadingStatus.NO_ECHO, 5.0, 1e-4)
    return fit_chain(ChainUpdate(chain=chain), reading, True, PARAMS).landmarks[0].gap_evidence


def test_echoes_tell_two_cars_from_one_even_where_the_map_does_not_part_them() -> None:
    """With noise of 2.5 cm: the ranges rise by 9 cm over a gap of 1 m, one or two echoes of it."""
    one = [gap_evidence_of(((0.0, 4.4),), 0.025, seed) for seed in range(30)]
    two = [gap_evidence_of(((0.0, 1.7), (2.7, 4.4)), 0.025, seed) for seed in range(30)]
    assert np.median(one) < -1.0 < 3.0 < np.median(two)
    assert gap_evidence_of(((0.0, 4.4),), 0.0, 0) < -1.0


def test_a_hump_beyond_the_end_of_a_side_is_no_gap_between_two_cars() -> None:
    """The first echoes are of what stands before the car: nearer, then farther than the corner of its side."""
    others = (-0.16, -0.07, 0.05, 0.08, 0.03, 0.05, 0.05)
    chain = EchoChain()
    for number, x in enumerate(np.arange(-1.6, 5.4, 0.16)):
        measured = math.hypot(x - min(max(x, 0.0), 4.4), 2.0) + (others[number] if number < len(others) else 0.0)
        sensor = DOWN._replace(x=float(x), y=2.0)
        chain = begin_chain(sensor, measured, True) if chain.used == 0 else append_echo(chain, sensor, measured)
    reading = Measurement(sensor, ReadingStatus.NO_ECHO, 5.0, 1e-4)
    assert fit_chain(ChainUpdate(chain=chain), reading, True, PARAMS).landmarks[0].gap_evidence < 1.0


def test_echoes_of_the_body_that_hid_the_next_are_left_out() -> None:
    """Ranges rise off the corner that is left, then fall towards the next body: its side does not begin before."""
    ranges = (3.32, 3.50, 3.38, 3.31, 3.27, 3.20, 3.14, 3.11, 3.09, 3.10)
    chain = EchoChain()
    for number, measured in enumerate(ranges):
        sensor = DOWN._replace(x=0.2 * number)
        chain = begin_chain(sensor, measured, False) if chain.used == 0 else append_echo(chain, sensor, measured)
    assert first_of_body(chain, 1e-4) == 1
    assert first_of_body(chain._replace(begins_at_edge=True), 1e-4) == 0
    assert first_of_body(chain_past(0.0, 1.8, 0.01)._replace(begins_at_edge=False), 1e-4) == 0


def test_echoes_off_the_boundary_of_the_cone_make_no_side() -> None:
    """A vehicle that turns away from a side: the ranges are of where its sensor's cone ends, not of feet on it."""
    chain = EchoChain()
    sensor = DOWN
    half = math.radians(30.0)
    for number in range(13):
        turn = math.radians(45.0 - number)
        sensor = SensorPose(0.05 * number, 1.6, math.sin(turn), -math.cos(turn), math.cos(half), math.sin(half))
        measured = 1.6 / math.cos(turn - half)
        chain = begin_chain(sensor, measured, True) if chain.used == 0 else append_echo(chain, sensor, measured)
    side = Landmark(LandmarkType.SEGMENT, 0.0, 0.4, 0.0, start=0.2, end=2.0)
    assert not is_explained(chain, side, sensor, 1e-4)
    assert is_explained(chain_past(0.0, 1.8, 0.0), side._replace(y=0.0, start=0.0, end=1.8), DOWN, 1e-4)


def test_a_chain_ends_at_a_jump_and_after_lost_echoes() -> None:
    chain = chain_past(0.0, 1.8, 0.0)
    last = DOWN._replace(x=2.3)
    assert continues(chain, last, 1.12, 1e-4)
    assert not continues(chain, last, 1.6, 1e-4)
    assert not is_passed(chain._replace(lost=1), last)
    assert is_passed(chain._replace(lost=3), last._replace(x=2.6))


def test_echoes_of_a_face_at_the_boundary_of_the_cone_end_a_chain_of_a_slow_pass() -> None:
    """Every 4 cm their ranges fall by 8 cm, which the noise explains; over 16 cm it does not."""
    chain = EchoChain()
    for number in range(8):
        sensor = SensorPose(0.04 * number, 0.0, 0.0, -1.0)
        measured = 3.0 - 2.0 * sensor.x
        if chain.used == 0 or not continues(chain, sensor, measured, 1e-4):
            chain = begin_chain(sensor, measured, False)
        else:
            chain = append_echo(chain, sensor, measured)
        assert chain.used < 4, "four echoes make a landmark"


def test_a_chain_refers_to_no_deleted_landmark() -> None:
    """Both flank sensors measure the wall on the left: one side took the place of the other, then a car its place."""
    wall = Box(0.0, 4.9, 0.0, 30.0, 1.8)
    boxes = [wall, *(Box(x, -2.3, 0.0, 1.8, 4.6) for x in (-0.9, 4.05))]
    local_map = LandmarkMap()
    for _, believed, readings in drive_past(boxes, Pose(-9.0, 1.5, math.radians(5.0)), 18.0, 3):
        local_map = update_map(local_map, readings, believed, CAR.ultrasonic, PARAMS)
        for chain in local_map.chains:
            assert chain.landmark < 0 or local_map.landmarks[chain.landmark].type != LandmarkType.NONE


@pytest.mark.parametrize("lateral", [0.5, 1.0])
def test_a_slow_pass_finds_both_cars(lateral: float) -> None:
    boxes = [Box(x, -2.3, 0.0, 1.8, 4.6) for x in (-0.9, 4.05)]
    local_map = LandmarkMap()
    start = Pose(-6.8, CAR.width / 2 + lateral - 5.0 * math.tan(math.radians(5.0)), math.radians(5.0))
    for _, believed, readings in drive_past(boxes, start, 10.5, 167, speed=1.0):
        local_map = update_map(local_map, readings, believed, CAR.ultrasonic, PARAMS)
    found = [item for item in local_map.landmarks if item.type == LandmarkType.SEGMENT and item.confirmations > 9]
    ends = sorted((min(start_point(item).x, end_point(item).x), length_of(item)) for item in found)
    assert [begin for begin, _ in ends] == pytest.approx([-1.8, 3.15], abs=0.15)
    assert [length for _, length in ends] == pytest.approx([1.8, 1.8], abs=0.2)


def test_a_long_chain_keeps_its_ends() -> None:
    chain = chain_past(0.0, 12.0, 0.0)
    assert chain.echoes[0].x == pytest.approx(-0.5)
    assert chain.echoes[chain.used - 1].x > 12.0
    rest = without_echoes_before(chain, 10)
    assert rest.echoes[0] == chain.echoes[10]


@pytest.mark.parametrize(("gap", "lateral"), [(0.7, 0.7), (0.8, 1.0), (1.0, 1.4)])
def test_cars_beside_each_other_are_told_apart(gap: float, lateral: float) -> None:
    """A car of 6 m or two of 1.8 m: perpendicular rows were taken for parallel ones."""
    boxes = [Box(x, -2.25, 0.0, 1.8, 4.5) for x in (-0.9 - 0.5 * gap, 0.9 + 0.5 * gap)]
    local_map = LandmarkMap()
    start = Pose(-8.0, CAR.width / 2 + lateral, 0.0)
    for _, believed, readings in drive_past(boxes, start, 14.0, 3, noise=0.005):
        local_map = update_map(local_map, readings, believed, CAR.ultrasonic, PARAMS)
    found = [item for item in local_map.landmarks if item.type == LandmarkType.SEGMENT and item.confirmations > 9]
    assert len(found) == 2, "one side"
    assert all(length_of(item) == pytest.approx(1.8, abs=0.35) for item in found)


def test_a_better_look_at_a_side_replaces_the_other() -> None:
    known = Landmark(
        LandmarkType.SEGMENT, 0.0, 0.0, 0.0, xx=1e-3, yy=1e-3, hh=1e-4, start=-1.0, end=1.0, start_known=True
    )
    landmarks = (known,) + (Landmark(),) * (MAX_LANDMARKS - 1)
    assert same_side(landmarks, known._replace(y=0.03), -1, PARAMS) == 0
    assert same_side(landmarks, known._replace(y=0.03), 0, PARAMS) == -1
    assert same_side(landmarks, known._replace(y=0.6), -1, PARAMS) == -1
    assert same_side(landmarks, known._replace(x=2.0), -1, PARAMS) == -1
    assert is_better(known, known._replace(start_known=False))


def test_a_short_segment_becomes_a_point_of_its_extent() -> None:
    point = as_point(
        Landmark(
            LandmarkType.SEGMENT, 1.0, 2.0, 0.0, yy=1e-4, start=-0.05, end=0.05, start_variance=0.04, end_variance=0.04
        )
    )
    assert point.type == LandmarkType.POINT
    assert (point.x, point.y, point.xx, point.yy) == pytest.approx((1.0, 2.0, 0.04, 1e-4))


def test_two_sensors_of_a_bumper_give_the_surface_before_them() -> None:
    a = SensorPose(0.0, 0.3, 1.0, 0.0)
    b = SensorPose(0.0, -0.3, 1.0, 0.0)
    wall = facing_segment(a, 0.8, b, 0.85, 1e-4)
    assert wall.type == LandmarkType.SEGMENT
    assert offset_of(wall, a.x, a.y) == pytest.approx(0.8), "sensors are on the left, as of every side"
    assert offset_of(wall, b.x, b.y) == pytest.approx(0.85)
    assert facing_segment(a, 0.8, b, 1.4, 1e-4).type == LandmarkType.NONE


def test_a_sensor_that_looks_aside_measures_the_same_wall() -> None:
    inner = SensorPose(0.0, 0.25, 1.0, 0.0)
    outer = SensorPose(-0.1, -0.25, math.cos(0.4), -math.sin(0.4))
    wall = facing_segment(inner, 0.8, outer, 0.9, 1e-4)
    assert [start_point(wall).x, end_point(wall).x] == pytest.approx([0.8, 0.8])


@pytest.mark.parametrize(("measured", "is_edge"), [(3.0, True), (4.8, False)])
def test_a_side_is_open_where_it_leaves_the_range_of_the_sensor(measured: float, is_edge: bool) -> None:
    """On a pass oblique to the row a car begins to be measured at 5 m, though it began long before."""
    echo = Measurement(DOWN, ReadingStatus.ECHO, measured, 1e-4)
    chain = next_chain(EchoChain(lost=3), echo, Ending.CONTINUES)
    assert chain.begins_at_edge == is_edge
    beyond = Measurement(DOWN._replace(x=1.0), ReadingStatus.NO_ECHO, 5.0, 1e-4)
    assert (chain_ending(chain._replace(lost=3), beyond) == Ending.EDGE) == is_edge
