"""The MPC's prediction, its fall-back, and the PID."""

import math

import pytest

from controller_fmu.interface import ParkingInput, Reason
from controller_fmu.zhang2022.mpc import FrontAxle, FrontWheels, prediction, steer, turn_wheels
from controller_fmu.zhang2022.params import MpcParams, PidParams, ZhangSystemParams
from controller_fmu.zhang2022.path import nearest, plan
from controller_fmu.zhang2022.phases import ZhangPhase
from controller_fmu.zhang2022.pid import PidState, pid
from controller_fmu.zhang2022.qp import Status
from controller_fmu.zhang2022.system import ZhangState, zhang_sample
from modelkit.vocabulary import Pose

CAR = FrontAxle(2.62, 0.57, 0.5)
PATH = plan(Pose(8.5, 2.8, 0.0), 5.0, 0.235)
P = MpcParams()


def test_prediction_is_the_kinematic_car_to_first_order() -> None:
    pose = Pose(6.0, 0.0, 0.0)
    reference = nearest(PATH, pose._replace(y=2.2))
    stage = prediction(PATH, reference, -1.0, CAR, P)[0]
    small = 1e-4
    gained = -1.0 * P.step_time * (math.tan(stage.r + small) - math.tan(stage.r)) / CAR.wheelbase
    assert stage.a == pytest.approx(-P.step_time)
    assert stage.g * small == pytest.approx(gained, rel=1e-3)
    assert stage.c == pytest.approx(0.5 * stage.a * stage.g)


def test_on_a_straight_path_with_a_straight_wheel_nothing_is_asked() -> None:
    found = steer(FrontWheels(), PATH, nearest(PATH, Pose(-0.5, 0.0, 0.0)), -1.0, CAR, P)
    assert found.status == Status.SOLVED
    assert found.rate == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_off_the_path_the_car_is_steered_back(side: float) -> None:
    reference = nearest(PATH, Pose(0.0, 0.0, 0.0))._replace(lateral_error=0.2 * side)
    found = steer(FrontWheels(), PATH, reference, -1.0, CAR, P)
    assert found.rate * side < -0.1, "in reverse, too far left: steer right, so that the tail comes in"
    assert abs(found.rate) <= CAR.rate_limit


def test_fall_back_keeps_the_last_rate_within_its_limit() -> None:
    reference = nearest(PATH, Pose(3.0, 0.5, 0.3))
    capped = steer(FrontWheels(0.1, 0.2, 0, 0), PATH, reference, -1.0, CAR, P._replace(max_iterations=1))
    assert (capped.status, capped.rate) == (Status.ITERATION_CAP, 0.2)
    bad = steer(FrontWheels(0.1, 0.9, 0, 0), PATH, reference._replace(lateral_error=math.nan), -1.0, CAR, P)
    assert bad.status in (Status.FAILED, Status.ITERATION_CAP)
    assert bad.rate == CAR.rate_limit


def test_turned_stays_within_the_lock() -> None:
    steering = FrontWheels(0.5, 0.5, 0, 0)
    for _ in range(100):
        steering = turn_wheels(steering, CAR, 0.01)
    assert steering.angle == CAR.angle_limit


def test_horizon_drops_the_weights_beyond_it() -> None:
    stages = prediction(PATH, nearest(PATH, Pose(6.0, 2.2, 0.2)), -1.0, CAR, P._replace(horizon=5))
    assert [stage.on for stage in stages] == [1.0] * 5 + [0.0] * 7


def test_pid_is_equation_eight() -> None:
    p, dt, state, integral, last = PidParams(100.0, 50.0, 10.0, 1e9), 0.01, PidState(), 0.0, None
    for k in range(50):
        error = math.sin(0.1 * k)
        integral += error * dt
        rate = 0.0 if last is None else (error - last) / dt
        state, last = pid(state, error, p, dt), error
        assert state.force == pytest.approx(100.0 * error + 50.0 * integral + 10.0 * rate)


def test_pid_does_not_wind_up() -> None:
    p, state = PidParams(100.0, 1000.0, 0.0, 50.0), PidState()
    for _ in range(1000):
        state = pid(state, 1.0, p, 0.01)
    assert state.force == 50.0
    assert state.integral <= 0.01
    assert pid(state, -0.2, p, 0.01).force < 0.0


@pytest.mark.parametrize(
    ("pose", "speed", "wheel", "expected"),
    [
        (Pose(), 0.0, 0.0, (ZhangPhase.PARKED, Reason.NONE)),
        (Pose(), 0.02, 0.0, (ZhangPhase.STRAIGHTEN, Reason.NONE)),
        (Pose(), 0.0, 1.0, (ZhangPhase.STRAIGHTEN, Reason.NONE)),
        (Pose(0.0, 0.5, 0.0), 0.0, 0.0, (ZhangPhase.FAILED, Reason.MISSED_TARGET)),
        (Pose(0.0, 0.0, 0.2), 0.0, 0.0, (ZhangPhase.FAILED, Reason.MISSED_TARGET)),
    ],
)
def test_parked_is_said_of_a_standing_car_with_its_wheels_straight_in_its_place(
    pose: Pose, speed: float, wheel: float, expected: tuple[ZhangPhase, Reason]
) -> None:
    state = ZhangState(phase=ZhangPhase.STRAIGHTEN, path=PATH)
    inputs = ParkingInput(odometry=pose, measured_speed=speed, steering_wheel_angle=wheel)
    after = zhang_sample(state, inputs, ZhangSystemParams(), 10_000_000)
    assert (after.phase, after.reason) == expected
