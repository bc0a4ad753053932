"""Every state of the chart against every set of guards."""

from typing import Any

import pytest

from controller_fmu.adaptive.chart import TRANSITIONS, Guard, transition
from controller_fmu.adaptive.phases import AdaptivePhase
from controller_fmu.common.chart import ANY_STATE

ENDS = {AdaptivePhase.PARKED, AdaptivePhase.FAILED, AdaptivePhase.TAKEOVER}
BUSY = [phase for phase in AdaptivePhase if phase not in ENDS]


@pytest.mark.parametrize("phase", BUSY)
def test_every_set_of_guards(phase: Any) -> None:
    rows = [row for row in TRANSITIONS if row[0] in (phase, ANY_STATE)]
    for guards in range(1 << len(Guard)):
        expected = next((row[2] for row in rows if guards >> row[1] & 1), phase)
        assert transition(phase, guards) == expected


@pytest.mark.parametrize("phase", ENDS)
def test_ends_are_ends(phase: Any) -> None:
    assert transition(phase, (1 << len(Guard)) - 1) == phase


@pytest.mark.parametrize("phase", BUSY)
def test_takeover_wins_then_fault(phase: Any) -> None:
    everything = (1 << len(Guard)) - 1
    assert transition(phase, everything) == AdaptivePhase.TAKEOVER
    assert transition(phase, everything & ~(1 << Guard.TAKEOVER)) == AdaptivePhase.FAILED


def test_no_dead_state() -> None:
    edges = {(row[0], row[2]) for row in TRANSITIONS if row[0] != ANY_STATE}
    reached: set[int] = set()
    new: set[int] = {AdaptivePhase.STANDBY}
    reached |= new
    while new:
        new = {t for s, t in edges if s in new} - reached
        reached |= new
    assert reached == set(BUSY) | {AdaptivePhase.PARKED}
