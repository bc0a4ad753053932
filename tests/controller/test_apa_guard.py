"""The guard over its inputs: whatever stands where the car would be by the time it stops, it brakes."""

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller_fmu.apa.around.closing import SILENCES
from controller_fmu.apa.around.cone import ear_of, echo_of
from controller_fmu.apa.around.course import HeldCourse
from controller_fmu.apa.around.guard import GuardState, learn_brake, listen, stopping_way, watch_way
from controller_fmu.apa.around.local_map import LocalMap, _of
from controller_fmu.apa.around.row import is_certain
from controller_fmu.apa.around.surroundings import shape_of
from controller_fmu.apa.around.thing import Thing
from controller_fmu.apa.chart import Mode
from controller_fmu.apa.manoeuvre_chart import Step
from controller_fmu.apa.outline import Box, Obstacles, box_clearance
from controller_fmu.apa.slot import Kind
from controller_fmu.apa.system import apa_sample, apa_start
from controller_fmu.common.curve import advance
from controller_fmu.registry import ControllerInput, ControllerParams
from modelkit.car import CarUltrasonic
from modelkit.geometry import NO_HIT, Point, cone_line
from modelkit.vocabulary import Pose
from vehicle_fmu.scene import Obstacle, SceneParams
from vehicle_fmu.ultrasonic import range_measurements

PARAMS = ControllerParams()
CAR = shape_of(PARAMS)
SENSORS = CarUltrasonic()
NOTHING_HEARD = (SENSORS.max_range,) * 12
HERE = Pose(0.0, 0.0, 0.0)
EMPTY = LocalMap(kind=Kind.NONE)._replace(
    a=LocalMap().a._replace(x=-50.0, y=-50.0), b=LocalMap().b._replace(x=50.0, y=-50.0)
)
"""A map whose neighbours are far away."""

places = st.floats(-4.0, 7.0)
speeds = st.floats(0.05, 1.2)
curvatures = st.floats(-0.24, 0.24)
directions = st.sampled_from([-1, 1])
BRAKING = (
    (Mode.AUTO_PARKING_ASSIST, Step.HALT, True),
    (Mode.AUTO_PARKING_ASSIST, Step.SET_WHEEL, True),
    (Mode.POSITION_TUNING, Step.HALT, True),
    (Mode.AUTO_PARKING_ASSIST, Step.DRIVE, False),
    (Mode.PARKING_SPACE_APPEARS, Step.PLAN, False),
)
"""Mode, step of the manoeuvre, whether it brakes."""


def sees(state: Any, readings: Any, around: Any, direction: Any, speed: Any, curvature: Any) -> Any:
    return watch_way(
        state, readings, EMPTY, around, HeldCourse(HERE, direction, curvature, direction * speed, CAR), PARAMS
    )


@settings(max_examples=500)
@given(places, st.floats(-3.5, 3.5), directions, speeds, curvatures)
def test_a_known_thing_that_would_be_touched_is_braked_for(
    x: Any, y: Any, direction: Any, speed: Any, curvature: Any
) -> None:
    box = Box(x - 0.1, x + 0.1, y - 0.1, y + 0.1)
    stop = stopping_way(GuardState(), speed, PARAMS)
    there = advance(HERE, float(direction), stop, curvature, curvature)
    now = box_clearance(HERE, CAR, box)
    touched = now > 0.01 and box_clearance(there, CAR, box) <= 0.0
    sight = sees(GuardState(), NOTHING_HEARD, Obstacles(beside=box), direction, speed, curvature)
    if touched:
        assert sight.blocked
        assert not sight.unknown
    if now > 3.0:
        assert not sight.blocked


def heard_at(x: Any, y: Any) -> Any:
    """Return what the sensors of a car at the origin hear of a pole."""
    missing = len(SceneParams().boxes) - 1
    scene = SceneParams(boxes=(Obstacle(x, y, 0.0, 0.2, 0.2), *(Obstacle() for _ in range(missing))))
    return range_measurements(HERE, scene, SENSORS, 0.08, 0)


@settings(max_examples=500)
@given(places, st.floats(-3.5, 3.5), directions, speeds, curvatures)
def test_an_unknown_thing_that_is_heard_and_would_be_touched_is_braked_for(
    x: Any, y: Any, direction: Any, speed: Any, curvature: Any
) -> None:
    box = Box(x - 0.1, x + 0.1, y - 0.1, y + 0.1)
    readings = heard_at(x, y)
    stop = stopping_way(GuardState(), speed, PARAMS)
    there = advance(HERE, float(direction), stop, curvature, curvature)
    heard = any(0.2 < reading < 1.4 for reading in readings)
    touched = box_clearance(HERE, CAR, box) > 0.05 and box_clearance(there, CAR, box) <= 0.0
    state = listen(GuardState(), readings, EMPTY, PARAMS)
    sight = sees(state, readings, Obstacles(), direction, speed, curvature)
    if heard and touched:
        assert sight.blocked


def test_what_is_driven_away_from_is_no_reason_to_stand() -> None:
    wall = Obstacles(behind=Box(-20.0, -CAR.rear - 0.02, -10.0, 10.0))
    assert sees(GuardState(), NOTHING_HEARD, wall, -1, 0.3, 0.0).blocked
    assert not sees(GuardState(), NOTHING_HEARD, wall, 1, 0.3, 0.0).blocked


def test_flanks_are_guarded() -> None:
    """Somebody stands beside the front, where it swings out when the car reverses to the right."""
    readings = heard_at(2.9, 1.3)
    state = listen(GuardState(), readings, EMPTY, PARAMS)
    assert sees(state, readings, Obstacles(), -1, 0.8, -0.24).blocked
    assert not sees(state, readings, Obstacles(), -1, 0.8, 0.0).blocked


def test_a_thing_that_was_heard_is_remembered_until_a_sensor_hears_past_it() -> None:
    state = listen(GuardState(), heard_at(2.9, 1.3), EMPTY, PARAMS)
    assert state.unknown[8].there
    aside = EMPTY._replace(pose=Pose(1.2, 0.0, 0.0))
    assert listen(state, NOTHING_HEARD, aside, PARAMS).unknown[8].there
    for _ in range(SILENCES):
        assert state.unknown[8].there
        state = listen(state, NOTHING_HEARD, EMPTY, PARAMS)
    assert not state.unknown[8].there


def test_a_late_brake_is_learnt_and_counted_with() -> None:
    state = GuardState()
    speed = 0.8
    for number in range(200):
        state = learn_brake(state, speed, True, 10_000_000, PARAMS)
        speed = max(0.0, speed - 0.02) if number > 30 else speed
    assert 0.2 < state.delay < 0.45
    assert stopping_way(state, 0.8, PARAMS) > stopping_way(GuardState(), 0.8, PARAMS)
    again = learn_brake(state, 0.8, False, 10_000_000, PARAMS)
    assert again.delay == state.delay


@pytest.mark.parametrize(("a", "b"), [(0.5, 0.5), (0.5, 2.0), (2.0, 0.5), (2.0, 2.0)])
def test_neighbours_are_certain_only_both_together(a: float, b: float) -> None:
    limit = PARAMS.apa.map.certain
    here = LocalMap(a=Thing(xx=(a * limit) ** 2), b=Thing(xx=(b * limit) ** 2))
    assert is_certain(here, PARAMS.apa.map) == (a < 1.0 and b < 1.0)


@pytest.mark.parametrize("heading", [-0.5, 0.0, 0.5])
@pytest.mark.parametrize("at", [-3.9, -1.0, 1.0, 3.9])
def test_the_side_of_a_neighbour_askew_is_heard_square(heading: float, at: float) -> None:
    c, s = math.cos(heading), math.sin(heading)
    ear = ear_of(1.0 + at * c - s, 2.0 + at * s + c, heading - 0.5 * math.pi, math.radians(1.0))
    side = math.copysign(4.0, at)
    assert _of(ear, Thing(1.0, 2.0, heading), side, 2.0).distance == pytest.approx(1.0, abs=1e-3)
    assert _of(ear, Thing(1.0, 2.0, heading), -side, 2.0).distance > 10.0


@pytest.mark.parametrize(("mode", "step", "learns"), BRAKING)
def test_the_brake_is_learnt_while_the_assist_brakes_and_at_no_other_time(mode: int, step: int, learns: bool) -> None:
    inputs = ControllerInput(apa_switch=True, measured_speed=-0.6, ultrasonic=NOTHING_HEARD)
    state = apa_start(PARAMS)
    state = state._replace(mode=mode, parking=state.parking._replace(step=step))
    assert (apa_sample(state, inputs, PARAMS, 10_000_000).around.guard.braked_from > 0.0) == learns


@settings(max_examples=300)
@given(*(st.floats(-4.0, 4.0) for _ in range(4)), st.floats(-math.pi, math.pi))
def test_what_a_cone_hears_of_a_side_is_what_geometry_says(ax: Any, ay: Any, bx: Any, by: Any, axis: Any) -> None:
    a, b = Point(ax, ay), Point(bx, by)
    exact = cone_line(Point(0.1, -0.2), axis, SENSORS.half_angle, a, b)
    ours = echo_of(ear_of(0.1, -0.2, axis, SENSORS.half_angle), a, b)
    if exact < NO_HIT and abs(ax - bx) + abs(ay - by) > 1e-3:
        assert abs(ours.distance - exact) < 1e-6
        assert abs(math.hypot(ours.x - 0.1, ours.y + 0.2) - exact) < 1e-6


def test_a_car_goes_slowly_beside_what_is_heard_near_it_wherever_the_map_has_it() -> None:
    """The nearer the echo the slower, never slower than creeping; away from it as fast as one likes."""

    def speed(reading: float, direction: int) -> float:
        readings = (*NOTHING_HEARD[:7], reading, *NOTHING_HEARD[8:])
        return sees(GuardState(), readings, Obstacles(), direction, 0.8, 0.0).speed

    backwards = [speed(reading, -1) for reading in (0.85, 0.6, 0.4, 0.2)]
    assert backwards == sorted(backwards, reverse=True)
    assert backwards[0] > 0.6 > 0.3 > backwards[-1] >= 0.1
    assert speed(0.2, 1) > 1.0


def test_what_is_too_near_to_be_told_stays_where_it_was() -> None:
    """The reading is the least that can be told while the car swings on towards it: it is held, and braked for."""
    flank = (*NOTHING_HEARD[:8], SENSORS.min_range, *NOTHING_HEARD[9:])
    state = listen(GuardState(), flank, EMPTY, PARAMS)
    assert state.close[8].there
    turned = EMPTY._replace(pose=Pose(-0.1, 0.0, 0.035))
    state = listen(state, flank, turned, PARAMS)
    course = HeldCourse(turned.pose, -1, -0.2, -0.3, CAR)
    assert watch_way(state, flank, turned, Obstacles(), course, PARAMS).blocked
    farther = (*NOTHING_HEARD[:8], 0.5, *NOTHING_HEARD[9:])
    assert not listen(state, farther, turned, PARAMS).close[8].there
