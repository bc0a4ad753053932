"""Every state of the manoeuvre chart against every set of guards that its rows can tell apart."""

import itertools

import pytest

from controller_fmu.common.monitor import DIRECTION_OF_PHASE
from controller_fmu.guo2015.chart import ANY, KEEP, TRANSITIONS, Guard, transition
from controller_fmu.guo2015.prompts import PROMPT_OF_PHASE
from controller_fmu.interface import Phase

ENDS = {Phase.PARKED, Phase.FAILED, Phase.TAKEOVER}
BUSY = [phase for phase in Phase if phase not in ENDS]


def _bits(guards: tuple[Guard, ...]) -> int:
    return sum(1 << guard for guard in guards)


@pytest.mark.parametrize("phase", Phase)
def test_every_combination_of_guards(phase: Phase) -> None:
    """All 2^20 sets fall into those of the guards that the state's rows read; others never matter."""
    rows = [row for row in TRANSITIONS if row[0] in (phase, ANY)]
    read = [Guard(row[1]) for row in rows]
    for size in range(len(read) + 1):
        for held in itertools.combinations(read, size):
            expected = next((Phase(row[2]) for row in rows if Guard(row[1]) in held), phase)
            if phase in ENDS:
                expected = phase
            for noise in (0, ~_bits(tuple(read)) & 0xFFFFF):
                target, _ = transition(phase, Phase.TO_Q2, _bits(held) | noise)
                assert target == expected


@pytest.mark.parametrize("phase", BUSY)
def test_takeover_wins_then_fault(phase: Phase) -> None:
    everything = (1 << len(Guard)) - 1
    assert transition(phase, 0, everything)[0] == Phase.TAKEOVER
    assert transition(phase, 0, everything & ~(1 << Guard.TAKEOVER))[0] == Phase.FAILED


@pytest.mark.parametrize("phase", ENDS)
def test_ends_are_ends(phase: Phase) -> None:
    assert transition(phase, 0, (1 << len(Guard)) - 1) == (phase, 0)


def test_no_dead_state() -> None:
    """Every state can be reached from standby, and from every state an end can be reached other than by failing."""
    edges = {(Phase(s), Phase(t)) for s, g, t, _ in TRANSITIONS if s != ANY}
    reached, new = {Phase.STANDBY}, {Phase.STANDBY}
    while new:
        new = {t for s, t in edges if s in new} - reached
        reached |= new
    assert reached | {Phase.FAILED, Phase.TAKEOVER} == set(Phase)
    parks, new = {Phase.PARKED}, {Phase.PARKED}
    while new:
        new = {s for s, t in edges if t in new} - parks
        parks |= new
    assert parks == set(BUSY) | {Phase.PARKED}


def test_every_guard_is_used_and_every_row_can_fire() -> None:
    assert {row[1] for row in TRANSITIONS} == {int(guard) for guard in Guard}
    assert len({row[:2] for row in TRANSITIONS}) == len(TRANSITIONS)


def test_legs_are_states_that_drive() -> None:
    driving = {phase for phase in Phase if DIRECTION_OF_PHASE[phase] != 0}
    for _, _, target, leg in TRANSITIONS:
        if leg != KEEP:
            assert Phase(leg) in driving | {Phase.STRAIGHTEN}
            assert Phase(target) in {Phase.STOP, Phase.PRE_STEER}


def test_tables_have_one_entry_for_each_state() -> None:
    assert len(PROMPT_OF_PHASE) == len(DIRECTION_OF_PHASE) == len(Phase)
