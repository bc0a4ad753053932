"""The manoeuvre chart, exhaustively: every state against every combination of conditions that it looks at."""

from itertools import product

import pytest

from controller_fmu.parking.chart import TRANSITIONS, Condition, ParkingState, next_parking_state
from controller_fmu.parking.outputs import PHASE_OF_STATE

DRIVING = (
    ParkingState.PLANNING,
    ParkingState.STEERING,
    ParkingState.DRIVING,
    ParkingState.STOPPING,
    ParkingState.STRAIGHTENING,
)
"""In these the vehicle is the system's."""


def combinations(state: int) -> list[int]:
    """Return the bits of every combination of the conditions that end a state."""
    looked_at = [condition for source, condition, _ in TRANSITIONS if source == state]
    return [
        sum(1 << condition for condition, holds in zip(looked_at, chosen, strict=True) if holds)
        for chosen in product((False, True), repeat=len(looked_at))
    ]


@pytest.mark.parametrize("state", list(ParkingState))
def test_every_combination_follows_the_first_row_that_holds(state: ParkingState) -> None:
    for bits in combinations(state):
        rows = [target for source, condition, target in TRANSITIONS if source == state and bits >> condition & 1]
        assert next_parking_state(state, bits) == (rows[0] if rows else state)
    everything = (1 << len(Condition)) - 1
    looked_at = sum(1 << condition for source, condition, _ in TRANSITIONS if source == state)
    assert next_parking_state(state, everything & ~looked_at) == state


@pytest.mark.parametrize("state", DRIVING)
def test_takeover_and_faults_win_over_everything_while_driving(state: ParkingState) -> None:
    taken = 1 << Condition.TAKEN_OVER | 1 << Condition.SWITCHED_OFF
    for bits in combinations(state):
        if bits & taken:
            assert next_parking_state(state, bits) == ParkingState.TAKEOVER
        elif bits & 1 << Condition.FAULT:
            assert next_parking_state(state, bits) == ParkingState.FAILED


def test_the_vehicle_drives_only_after_confirmation_or_to_a_known_goal() -> None:
    starts = {(source, condition) for source, condition, target in TRANSITIONS if target in DRIVING}
    starts = {(source, condition) for source, condition in starts if source not in DRIVING}
    assert starts == {
        (ParkingState.CONFIRMING, Condition.CONFIRMED),
        (ParkingState.STANDBY, Condition.GOAL_KNOWN),
    }


def reachable(start: int) -> set[int]:
    found = {start}
    while True:
        more = {target for source, _, target in TRANSITIONS if source in found} - found
        if not more:
            return found
        found |= more


def test_no_state_is_dead_and_every_state_leads_to_standby() -> None:
    assert reachable(ParkingState.STANDBY) == set(ParkingState)
    for state in ParkingState:
        assert ParkingState.STANDBY in reachable(state)
    assert len(PHASE_OF_STATE) == len(ParkingState)


def test_the_wheel_is_turned_before_every_drive_and_a_drive_ends_in_a_stop() -> None:
    assert {source for source, _, target in TRANSITIONS if target == ParkingState.DRIVING} == {ParkingState.STEERING}
    ends = {ParkingState.STOPPING, ParkingState.TAKEOVER, ParkingState.FAILED}
    assert {target for source, _, target in TRANSITIONS if source == ParkingState.DRIVING} == ends
