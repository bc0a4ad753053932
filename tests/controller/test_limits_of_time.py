"""Each limit of time ends a drive with its reason just past it, not just before."""

from typing import Any

import pytest

from controller_fmu.common import monitor
from controller_fmu.common.phases import PhaseExpectation
from controller_fmu.interface import Reason
from controller_fmu.registry import ControllerInput, ControllerParams

PARAMS = ControllerParams()
LIMIT = PARAMS.limit
DRIVING = ControllerInput()
MILLISECOND = 1_000_000
CLOCKS = {
    "frozen": (LIMIT.pose_frozen, Reason.POSE_FROZEN),
    "wrong_direction_ns": (LIMIT.wrong_direction, Reason.WRONG_DIRECTION),
    "stopping": (LIMIT.stopping, Reason.NOT_STOPPING),
    "waiting": (LIMIT.driver_response_timeout, Reason.NOT_MOVING),
}


def around(seconds: float) -> tuple[int, int]:
    """Return a millisecond before and after a time [ns]."""
    return round(seconds * 1e9) - MILLISECOND, round(seconds * 1e9) + MILLISECOND


@pytest.mark.parametrize("clock", CLOCKS)
def test_systems_fail_just_past_each_limit(clock: str) -> None:
    seconds, reason = CLOCKS[clock]
    expected = PhaseExpectation(begun=True, steering=False)
    clocks: list[Any] = [{clock: ns} for ns in around(seconds)]
    states = [monitor.MonitorState(**given) for given in clocks]
    found = [monitor.reason_to_fail(state, DRIVING, expected, 0, 0, PARAMS) for state in states]
    assert found == [Reason.NONE, reason]


@pytest.mark.parametrize("begun", [True, False])
def test_systems_end_in_time(begun: bool) -> None:
    expected = PhaseExpectation(begun=begun, steering=False)
    found = [
        monitor.reason_to_fail(monitor.MonitorState(), DRIVING, expected, ns, 0, PARAMS)
        for ns in around(LIMIT.duration)
    ]
    assert found == [Reason.NONE, Reason.TIMEOUT]
    manoeuvres = [monitor.reason_to_fail(monitor.MonitorState(), DRIVING, expected, 0, n, PARAMS) for n in (8, 9)]
    assert manoeuvres == [Reason.NONE, Reason.TOO_MANY_SHIFTS if begun else Reason.NONE]
