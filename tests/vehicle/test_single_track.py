"""The single track against CommonRoad's ST, forward and in reverse, and by its own truths."""

import copy
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from vehiclemodels.vehicle_dynamics_st import vehicle_dynamics_st

from modelkit.car import Car
from modelkit.maths import clamp, sign
from modelkit.vocabulary import Pose
from tests.vehicle.cars import CARS, single_track_car
from vehicle_fmu.bodies.chassis import (
    GRAVITY_ACCELERATION,
    Build,
    ChassisParams,
    Gravity,
    Motion,
    RoadParams,
    Stance,
    Wrench,
    accelerations,
)
from vehicle_fmu.bodies.single_track import (
    AxleForces,
    SingleTrackParams,
    SingleTrackState,
    Slip,
    axle_loads,
    axle_stiffness,
    front_slip,
    rear_slip,
    step_single_track,
    wrench,
)
from vehicle_fmu.effort import Effort

CAR = st.sampled_from(CARS)
SPEED = st.floats(0.2, 18.0)  # beyond 18.2 m/s their engine of the first car gives less than 3 m/s2
BETA = st.floats(-0.03, 0.03)
CURVATURE = st.floats(-0.02, 0.02)
ANGLE = st.floats(-0.05, 0.05)
ACCEL = st.floats(-3.0, 3.0)
ROAD = RoadParams()
WHEELBASE = 2.405
STANCE = Stance(WHEELBASE, Car().cg_to_rear)
CHASSIS = ChassisParams()
PARAMS = SingleTrackParams()


def steady_force(slip: Slip, stiffness: float, largest: float) -> float:
    """Return the lateral force [N] of an axle in steady rolling; 0 at standstill, where slip has no meaning."""
    if slip.along <= 0.0:
        return 0.0
    return clamp(-stiffness * slip.across / slip.along, -largest, largest)


def steady_rates(
    motion: Motion,
    angle: float,
    force: float,
    accel: float,
    build: Build,
    p: SingleTrackParams,
) -> Wrench:
    """Return (v_x' - v_y r, v_y' + v_x r, r') [m/s2, m/s2, rad/s2] of steadily rolling tyres on a flat road.

    ``force`` [N] pushes along; ``accel`` [m/s2] moves load. beta' of ST is the second over v_x, minus r.
    """
    stance, chassis, _ = build
    loads = axle_loads(accel, GRAVITY_ACCELERATION, stance, p, chassis)
    stiffness = axle_stiffness(loads, stance, p, chassis)
    wheelbase, b = stance
    front = front_slip(motion, angle, wheelbase, b, p.small_angles)
    rear = rear_slip(motion, b)
    rolling = chassis.rolling_resistance * chassis.mass * GRAVITY_ACCELERATION * sign(motion.speed_x)
    forces = AxleForces(
        steady_force(front, stiffness.front, p.friction * loads.front),
        steady_force(rear, stiffness.rear, p.friction * loads.rear),
        force - rolling,
    )
    total = wrench(forces, angle, stance, p.small_angles)
    return accelerations(motion, total, Gravity(0.0, 0.0, GRAVITY_ACCELERATION), chassis)


def rates(car: Any, speed: float, beta: float, yaw_rate: float, angle: float, accel: float) -> tuple[float, ...]:
    """Return (v', yaw rate', beta') of our single track set as ST."""
    stance, chassis, params = single_track_car(car)
    motion = Motion(Pose(), speed, speed * beta, yaw_rate)
    found = steady_rates(motion, angle, car.m * accel, accel, Build(stance, chassis, ROAD), params)
    return found.x, found.yaw, found.y / speed - yaw_rate


def close(ours: float, theirs: float, tolerance: float) -> bool:
    return abs(ours - theirs) <= tolerance * (1.0 + abs(theirs))


@given(CAR, SPEED, BETA, CURVATURE, ANGLE, ACCEL)
def test_equals_st_forward(car: Any, v: float, beta: float, curvature: float, angle: float, accel: float) -> None:
    theirs = vehicle_dynamics_st([0.0, 0.0, angle, v, 0.3, curvature * v, beta], [0.0, accel], car)
    ours = rates(car, v, beta, curvature * v, angle, accel)
    assert close(ours[0], theirs[3], 1e-9)
    assert close(ours[1], theirs[5], 1e-9)
    assert close(ours[2], theirs[6], 1e-9)


@given(CAR, SPEED, BETA, CURVATURE, ANGLE, ACCEL)
def test_in_reverse_equals_st_driven_forward_with_axles_swapped(
    car: Any, v: float, beta: float, curvature: float, angle: float, accel: float
) -> None:
    swapped = copy.deepcopy(car)
    swapped.a, swapped.b = car.b, car.a
    theirs = vehicle_dynamics_st([0.0, 0.0, -angle, v, 0.3, curvature * v, beta - angle], [0.0, -accel], swapped)
    ours = rates(car, -v, beta, curvature * v, angle, accel)
    assert close(ours[0], -theirs[3], 1e-12)
    assert close(ours[1], theirs[5], 1e-12)
    assert close(ours[2], theirs[6], 1e-12)


def test_load_transfer_is_seen() -> None:
    braked = rates(CARS[0], 10.0, 0.01, 0.1, 0.02, -3.0)
    assert abs(braked[1] - rates(CARS[0], 10.0, 0.01, 0.1, 0.02, 0.0)[1]) > 0.01


def steady_yaw_rate(speed: float, angle: float, h: float = 0.004) -> float:
    chassis = ChassisParams(rolling_resistance=0.0, drag_x=0.0, drag_y=0.0)
    state = SingleTrackState(Motion(Pose(), speed, 0.0, 0.0))
    for _ in range(round((4.0 + 3.0 / abs(speed)) / h)):
        push = chassis.mass * 50.0 * (speed - state.motion.speed_x)
        state = step_single_track(state, angle, Effort(push, 0.0), Build(STANCE, chassis, ROAD), PARAMS, h)
    return state.motion.yaw_rate


@pytest.mark.parametrize("speed", [5.0, -5.0, 15.0])
def test_steady_turn_is_the_closed_form(speed: float) -> None:
    """r = v delta / (L + K v |v|), K = m (b / C_f - a / C_r) / L: what understeers forward oversteers in reverse."""
    angle = 0.01
    a = WHEELBASE - STANCE.cg_to_rear
    gradient = CHASSIS.mass / WHEELBASE * (STANCE.cg_to_rear / PARAMS.stiffness_front - a / PARAMS.stiffness_rear)
    expected = speed * angle / (WHEELBASE + gradient * speed * abs(speed))
    assert steady_yaw_rate(speed, angle) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("speed", [0.05, -0.05, 0.3, -0.3])
def test_tends_to_the_kinematic_car_as_speed_tends_to_zero(speed: float) -> None:
    kinematic = speed * math.tan(0.4) / WHEELBASE
    assert steady_yaw_rate(speed, 0.4) == pytest.approx(kinematic, rel=0.003 * abs(speed) + 1e-4)


def test_paper_3_dof_car_has_no_load_transfer() -> None:
    params = SingleTrackParams(32000.0, 32000.0)
    chassis = ChassisParams(560.0, 1040.0)
    motion = Motion(Pose(), 8.0, 0.1, 0.2)
    slow = steady_rates(motion, 0.05, 100.0, 0.0, Build(Stance(1.89, 0.76), chassis, ROAD), params)
    hard = steady_rates(motion, 0.05, 100.0, 3.0, Build(Stance(1.89, 0.76), chassis, ROAD), params)
    assert slow == hard
    front = -32000.0 * ((0.1 + 1.13 * 0.2) * math.cos(0.05) - 8.0 * math.sin(0.05))
    front = front / (8.0 * math.cos(0.05) + (0.1 + 1.13 * 0.2) * math.sin(0.05))
    rear = -32000.0 * (0.1 - 0.76 * 0.2) / 8.0
    moment = 1.13 * front * math.cos(0.05) - 0.76 * rear
    assert slow.yaw == pytest.approx(moment / 1040.0, rel=1e-12)
    along = 100.0 - 0.012 * 560.0 * 9.81 - front * math.sin(0.05) - 0.4 * 64.0
    assert slow.x == pytest.approx(along / 560.0, rel=1e-12)


def test_brake_holds_on_a_slope_and_rolling_resistance_alone_does_not() -> None:
    road = RoadParams(grade=0.1)
    for brake, moves in ((6000.0, False), (0.0, True)):
        state = SingleTrackState()
        for _ in range(4000):
            state = step_single_track(state, 0.2, Effort(0.0, brake), Build(STANCE, CHASSIS, road), PARAMS, 0.005)
        assert (abs(state.motion.pose.x) > 0.001) is moves


def test_mirrored_to_the_bit() -> None:
    left = right = SingleTrackState(Motion(Pose(), 3.0, 0.0, 0.0))
    for n in range(2000):
        angle = 0.5 * math.sin(0.003 * n)
        effort = Effort(3000.0 * math.sin(0.005 * n), 500.0)
        left = step_single_track(left, angle, effort, Build(STANCE, CHASSIS, ROAD), PARAMS, 0.001)
        right = step_single_track(right, -angle, effort, Build(STANCE, CHASSIS, ROAD), PARAMS, 0.001)
    assert left.motion.pose == Pose(right.motion.pose.x, -right.motion.pose.y, -right.motion.pose.heading)
    assert left.motion.yaw_rate == -right.motion.yaw_rate
    assert abs(left.motion.pose.heading) > 0.1
