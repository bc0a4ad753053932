"""Each clock of the fault monitor ends a drive with its reason just past its limit, not just before."""

from typing import Any

import pytest

from controller_fmu.common.monitor import MonitorState, watch
from controller_fmu.common.phases import PhaseExpectation
from controller_fmu.interface import Reason
from controller_fmu.parking.monitor.fault_monitor import (
    FaultClocks,
    advance_clocks,
    fault_reason,
)
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.signals import ParkingSystemInput

PARAMS = ParkingParams()
LIMIT = PARAMS.limit
DRIVING = PhaseExpectation(direction=1)
STEERING = PhaseExpectation(steering=True)
MILLISECOND = 1_000_000
CLOCKS = {
    "frozen": (LIMIT.pose_frozen, Reason.POSE_FROZEN),
    "fast": (PARAMS.monitor.over_speed_time, Reason.OVER_SPEED),
    "wrong_direction_ns": (LIMIT.wrong_direction, Reason.WRONG_DIRECTION),
    "stopping": (LIMIT.stopping, Reason.NOT_STOPPING),
    "waiting": (LIMIT.driver_response_timeout, Reason.NOT_MOVING),
    "running": (LIMIT.duration, Reason.TIMEOUT),
}
"""Clock -> its limit [s], and the reason."""


def clocks_with(**own: Any) -> FaultClocks:
    """Return the clocks with these at a time [ns], be they common to all systems or not."""
    common = {name: value for name, value in own.items() if name in MonitorState._fields}
    return FaultClocks(MonitorState(**common), **{name: own[name] for name in own if name not in common})


def reason_of(clocks: FaultClocks, phase: PhaseExpectation, manoeuvres: int = 0) -> int:
    return fault_reason(clocks, ParkingSystemInput(), phase, manoeuvres, PARAMS.monitor.over_speed_time, PARAMS)


@pytest.mark.parametrize("clock", CLOCKS)
def test_a_drive_fails_just_past_each_limit(clock: str) -> None:
    seconds, reason = CLOCKS[clock]
    around: list[dict[str, Any]] = [{clock: round(seconds * 1e9) + sign * MILLISECOND} for sign in (-1, 1)]
    found = [reason_of(clocks_with(**own), DRIVING) for own in around]
    assert found == [Reason.NONE, reason]


def test_a_wheel_that_does_not_turn_is_a_steering_fault() -> None:
    late = clocks_with(waiting=round(LIMIT.driver_response_timeout * 1e9) + MILLISECOND)
    assert reason_of(late, STEERING) == Reason.STEERING_FAULT


def test_more_manoeuvres_than_allowed_end_the_drive() -> None:
    most = LIMIT.manoeuvres
    found = [reason_of(FaultClocks(), DRIVING, count) for count in (most, most + 1)]
    assert found == [Reason.NONE, Reason.TOO_MANY_SHIFTS]


@pytest.mark.parametrize(
    ("moves", "speed", "blocked", "waits"),
    [(True, 0.0, False, True), (False, 0.0, False, False), (True, 0.3, False, False), (True, 0.0, True, False)],
)
def test_the_vehicle_is_waited_for_where_it_should_move_and_nothing_is_in_the_way(
    moves: bool, speed: float, blocked: bool, waits: bool
) -> None:
    before = clocks_with(waiting=5)
    phase = DRIVING if moves else PhaseExpectation()
    common = watch(before.common, ParkingSystemInput(measured_speed=speed), phase, 0.0, MILLISECOND, PARAMS)
    clocks = advance_clocks(before, common, speed == 0.0, blocked, False, MILLISECOND)
    assert clocks.common.waiting == (5 + MILLISECOND if waits else 0)
    assert clocks.common.stopping == (MILLISECOND if not moves and speed > 0.0 else 0)
    assert clocks.running == MILLISECOND
