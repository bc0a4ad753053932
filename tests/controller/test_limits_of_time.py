"""Each limit of time ends a drive with its reason just past it, not just before; so do the thresholds of a takeover."""

from typing import Any

import pytest

from controller_fmu.apa import watch as apa
from controller_fmu.apa.manoeuvre_chart import Step
from controller_fmu.common import monitor
from controller_fmu.common.monitor import Command
from controller_fmu.common.params import Longitudinal
from controller_fmu.common.phases import PhaseExpectation
from controller_fmu.common.steering_monitor import SteeringMonitorState
from controller_fmu.interface import Reason
from controller_fmu.registry import ControllerInput, ControllerParams
from modelkit.vocabulary import Gear

PARAMS = ControllerParams()
LIMIT, GUARD = PARAMS.limit, PARAMS.apa.guard
DRIVING = ControllerInput(gear=Gear.DRIVE)
MILLISECOND = 1_000_000
OFF = SteeringMonitorState(request=0.31, angle=0.0)
ASSIST = {
    "blind": (PARAMS.apa.sensors.blind_time, Reason.SENSOR_LOSS),
    "frozen": (LIMIT.pose_frozen, Reason.POSE_FROZEN),
    "fast": (GUARD.over_speed_time, Reason.OVER_SPEED),
    "stopping": (LIMIT.stopping, Reason.NOT_STOPPING),
    "blocked": (GUARD.blocked, Reason.BLOCKED),
    "waiting": (GUARD.driver_response_timeout, Reason.NOT_MOVING),
    "running": (GUARD.duration, Reason.TIMEOUT),
}
"""Clock of the assist -> its limit [s], and the reason."""
OTHERS = {
    "frozen": (LIMIT.pose_frozen, Reason.POSE_FROZEN),
    "wrong_direction_ns": (LIMIT.wrong_direction, Reason.WRONG_DIRECTION),
    "stopping": (LIMIT.stopping, Reason.NOT_STOPPING),
    "waiting": (LIMIT.driver_response_timeout, Reason.NOT_MOVING),
}


def around(seconds: float) -> tuple[int, int]:
    """Return a millisecond before and after a time [ns]."""
    return round(seconds * 1e9) - MILLISECOND, round(seconds * 1e9) + MILLISECOND


@pytest.mark.parametrize("clock", ASSIST)
def test_the_assist_fails_just_past_each_limit(clock: str) -> None:
    seconds, reason = ASSIST[clock]
    watches: list[Any] = [{clock: ns} for ns in around(seconds)]
    found = [apa.reason_to_fail(apa.Watch(**watch), DRIVING, True, PARAMS) for watch in watches]
    assert found == [Reason.NONE, reason]
    parked = apa.reason_to_fail(apa.Watch(**watches[1]), DRIVING, False, PARAMS)
    assert parked == (reason if clock in ("blind", "frozen") else Reason.NONE)


def test_a_wheel_that_is_off_is_what_the_assist_waits_for() -> None:
    late = apa.Watch(waiting=around(GUARD.driver_response_timeout)[1], wheel=OFF)
    assert apa.reason_to_fail(late, DRIVING, True, PARAMS) == Reason.STEERING_FAULT
    near = late._replace(wheel=OFF._replace(request=0.29))
    assert apa.reason_to_fail(near, DRIVING, True, PARAMS) == Reason.NOT_MOVING


@pytest.mark.parametrize("clock", OTHERS)
def test_the_other_systems_fail_just_past_each_limit(clock: str) -> None:
    seconds, reason = OTHERS[clock]
    expected = PhaseExpectation(begun=True, steering=False)
    clocks: list[Any] = [{clock: ns} for ns in around(seconds)]
    states = [monitor.MonitorState(**given) for given in clocks]
    found = [monitor.reason_to_fail(state, DRIVING, expected, 0, 0, PARAMS) for state in states]
    assert found == [Reason.NONE, reason]


@pytest.mark.parametrize("begun", [True, False])
def test_the_other_systems_end_in_time(begun: bool) -> None:
    expected = PhaseExpectation(begun=begun, steering=False)
    found = [
        monitor.reason_to_fail(monitor.MonitorState(), DRIVING, expected, ns, 0, PARAMS)
        for ns in around(LIMIT.duration)
    ]
    assert found == [Reason.NONE, Reason.TIMEOUT]
    manoeuvres = [monitor.reason_to_fail(monitor.MonitorState(), DRIVING, expected, 0, n, PARAMS) for n in (8, 9)]
    assert manoeuvres == [Reason.NONE, Reason.TOO_MANY_SHIFTS if begun else Reason.NONE]


def test_the_driver_takes_over_past_each_threshold() -> None:
    settled = apa.Watch(running=around(apa.SETTLING)[1])
    early = apa.Watch(running=around(apa.SETTLING)[0])
    pressed = DRIVING._replace(brake_pedal=GUARD.pedal + 0.01)
    rolling = DRIVING._replace(gear=Gear.NEUTRAL, measured_speed=0.21)
    pulled = OFF._replace(away_ns=around(apa.PULLED_FOR)[1])
    advised = PARAMS._replace(
        apa=PARAMS.apa._replace(drive=PARAMS.apa.drive._replace(longitudinal=Longitudinal.DRIVER))
    )
    cases = [
        (settled, DRIVING, PARAMS, False),
        (settled, DRIVING._replace(driver_takeover=True), PARAMS, True),
        (settled, pressed, PARAMS, True),
        (early, pressed, PARAMS, False),
        (settled, pressed, advised, False),
        (settled, DRIVING._replace(brake_pedal=GUARD.pedal - 0.01), PARAMS, False),
        (settled, rolling, PARAMS, True),
        (early, rolling, PARAMS, False),
        (settled, rolling._replace(gear=Gear.PARK, measured_speed=-0.21), PARAMS, True),
        (settled, rolling._replace(measured_speed=0.19), PARAMS, False),
        (settled._replace(wheel=pulled), DRIVING, PARAMS, True),
        (settled._replace(wheel=pulled._replace(away_ns=around(apa.PULLED_FOR)[0])), DRIVING, PARAMS, False),
        (settled._replace(wheel=pulled._replace(request=0.29)), DRIVING, PARAMS, False),
    ]
    for number, (state, inputs, params, taken) in enumerate(cases):
        assert apa.is_taken_over(state, inputs, params) == taken, number


@pytest.mark.parametrize(
    ("step", "speed", "blocked", "waits"),
    [
        (Step.DRIVE, 0.0, False, True),
        (Step.SET_WHEEL, 0.0, False, True),
        (Step.STRAIGHTEN, 0.0, False, True),
        (Step.PLAN, 0.0, False, False),
        (Step.HALT, 0.0, False, False),
        (Step.DRIVE, 0.3, False, False),
        (Step.DRIVE, 0.0, True, False),
    ],
)
def test_the_assist_waits_where_car_or_wheel_should_move_and_nothing_is_in_the_way(
    step: Step, speed: float, blocked: bool, waits: bool
) -> None:
    inputs = DRIVING._replace(measured_speed=speed)
    clocks = apa.watch(
        apa.Watch(waiting=5), Command(step, 0.0, blocked), inputs, apa.Duty(True, 0), PARAMS, MILLISECOND
    )
    assert clocks.waiting == (5 + MILLISECOND if waits else 0)
    assert clocks.stopping == (MILLISECOND if step == Step.HALT and speed > 0.0 else 0)
    assert clocks.running == MILLISECOND
