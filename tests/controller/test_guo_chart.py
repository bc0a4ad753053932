"""Every state of the manoeuvre chart against every set of guards that its rows can tell apart."""

import itertools

import pytest

from controller_fmu.common.chart import ANY_STATE
from controller_fmu.guo2015.chart import SAME_LEG, TRANSITIONS, Guard, transition
from controller_fmu.guo2015.phases import DIRECTION_OF_PHASE, GuoPhase
from controller_fmu.guo2015.prompts import PROMPT_OF_PHASE

ENDS = {GuoPhase.PARKED, GuoPhase.FAILED, GuoPhase.TAKEOVER}
BUSY = [phase for phase in GuoPhase if phase not in ENDS]


def _bits(guards: tuple[Guard, ...]) -> int:
    return sum(1 << guard for guard in guards)


@pytest.mark.parametrize("phase", GuoPhase)
def test_every_combination_of_guards(phase: GuoPhase) -> None:
    """All 2^20 sets fall into those of the guards that the state's rows read; others never matter."""
    rows = [row for row in TRANSITIONS if row[0] in (phase, ANY_STATE)]
    read = [Guard(row[1]) for row in rows]
    for size in range(len(read) + 1):
        for held in itertools.combinations(read, size):
            expected = next((GuoPhase(row[2]) for row in rows if Guard(row[1]) in held), phase)
            if phase in ENDS:
                expected = phase
            for noise in (0, ~_bits(tuple(read)) & 0xFFFFF):
                target, _ = transition(phase, GuoPhase.TO_Q2, _bits(held) | noise)
                assert target == expected


@pytest.mark.parametrize("phase", BUSY)
def test_takeover_wins_then_fault(phase: GuoPhase) -> None:
    everything = (1 << len(Guard)) - 1
    assert transition(phase, 0, everything)[0] == GuoPhase.TAKEOVER
    assert transition(phase, 0, everything & ~(1 << Guard.TAKEOVER))[0] == GuoPhase.FAILED


@pytest.mark.parametrize("phase", ENDS)
def test_ends_are_ends(phase: GuoPhase) -> None:
    assert transition(phase, 0, (1 << len(Guard)) - 1) == (phase, 0)


def test_no_dead_state() -> None:
    """Every state can be reached from standby, and from every state an end can be reached other than by failing."""
    edges = {(GuoPhase(s), GuoPhase(t)) for s, g, t, _ in TRANSITIONS if s != ANY_STATE}
    reached, new = {GuoPhase.STANDBY}, {GuoPhase.STANDBY}
    while new:
        new = {t for s, t in edges if s in new} - reached
        reached |= new
    assert reached | {GuoPhase.FAILED, GuoPhase.TAKEOVER} == set(GuoPhase)
    parks, new = {GuoPhase.PARKED}, {GuoPhase.PARKED}
    while new:
        new = {s for s, t in edges if t in new} - parks
        parks |= new
    assert parks == set(BUSY) | {GuoPhase.PARKED}


def test_every_guard_is_used_and_every_row_can_fire() -> None:
    assert {row[1] for row in TRANSITIONS} == {int(guard) for guard in Guard}
    assert len({row[:2] for row in TRANSITIONS}) == len(TRANSITIONS)


def test_legs_are_states_that_drive() -> None:
    driving = {phase for phase in GuoPhase if DIRECTION_OF_PHASE[phase] != 0}
    for _, _, target, leg in TRANSITIONS:
        if leg != SAME_LEG:
            assert GuoPhase(leg) in driving | {GuoPhase.STRAIGHTEN}
            assert GuoPhase(target) in {GuoPhase.STOP, GuoPhase.PRE_STEER}


def test_tables_have_one_entry_for_each_state() -> None:
    assert len(PROMPT_OF_PHASE) == len(DIRECTION_OF_PHASE) == len(GuoPhase)
