"""Every state of the chart against every set of guards."""

import pytest

from controller_fmu.adaptive.chart import ANY, TRANSITIONS, Guard, transition
from controller_fmu.interface import Phase

ENDS = {Phase.PARKED, Phase.FAILED, Phase.TAKEOVER}
NOT_HERE = {Phase.TO_Q1, Phase.TO_Q2, Phase.TO_Q3}
BUSY = [phase for phase in Phase if phase not in ENDS | NOT_HERE]


@pytest.mark.parametrize("phase", BUSY)
def test_every_set_of_guards(phase):
    rows = [row for row in TRANSITIONS if row[0] in (phase, ANY)]
    for guards in range(1 << len(Guard)):
        expected = next((row[2] for row in rows if guards >> row[1] & 1), phase)
        assert transition(phase, guards) == expected


@pytest.mark.parametrize("phase", ENDS)
def test_ends_are_ends(phase):
    assert transition(phase, (1 << len(Guard)) - 1) == phase


@pytest.mark.parametrize("phase", BUSY)
def test_takeover_wins_then_fault(phase):
    everything = (1 << len(Guard)) - 1
    assert transition(phase, everything) == Phase.TAKEOVER
    assert transition(phase, everything & ~(1 << Guard.TAKEOVER)) == Phase.FAILED


def test_no_dead_state():
    edges = {(row[0], row[2]) for row in TRANSITIONS if row[0] != ANY}
    reached, new = {Phase.STANDBY}, {Phase.STANDBY}
    while new:
        new = {t for s, t in edges if s in new} - reached
        reached |= new
    assert reached == set(BUSY) | {Phase.PARKED}
