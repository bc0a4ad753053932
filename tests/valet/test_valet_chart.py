"""The valet's chart: every step against every combination of guards."""

import itertools
from typing import Any

import pytest

from controller_fmu.valet.chart import TRANSITIONS, Guard, Step, step_transition

FINAL = (Step.PARKED, Step.FAILED, Step.TAKEN_OVER)
BEFORE = (Step.OFF, Step.SEARCH, Step.SHOWN)
"""The driver still drives."""


def bits(*guards: Any) -> Any:
    return sum(1 << guard for guard in guards)


@pytest.mark.parametrize("step", [step for step in Step if step not in (*FINAL, *BEFORE)])
def test_a_takeover_and_then_a_fault_win_everywhere(step: Any) -> None:
    for others in itertools.chain.from_iterable(itertools.combinations(Guard, count) for count in range(3)):
        assert step_transition(step, bits(*{*others, Guard.TAKEN_OVER})) == Step.TAKEN_OVER
        if Guard.TAKEN_OVER not in others:
            assert step_transition(step, bits(*{*others, Guard.FAULT})) == Step.FAILED


@pytest.mark.parametrize("step", FINAL)
def test_what_is_over_stays_until_it_is_switched_off(step: Any) -> None:
    assert step_transition(step, bits(*(guard for guard in Guard if guard != Guard.SWITCHED_OFF))) == step
    assert step_transition(step, bits(*Guard)) == Step.OFF


@pytest.mark.parametrize("step", [Step.SEARCH, Step.SHOWN])
def test_while_the_driver_drives_the_switch_and_then_a_fault_win(step: Any) -> None:
    for others in itertools.chain.from_iterable(itertools.combinations(Guard, count) for count in range(3)):
        assert step_transition(step, bits(*{*others, Guard.SWITCHED_OFF})) == Step.OFF
        if Guard.SWITCHED_OFF not in others:
            assert step_transition(step, bits(*{*others, Guard.FAULT})) == Step.FAILED


def test_only_who_has_confirmed_is_driven() -> None:
    for others in itertools.chain.from_iterable(itertools.combinations(Guard, count) for count in range(4)):
        for step in BEFORE:
            after = step_transition(step, bits(*others))
            assert after in (*BEFORE, Step.FAILED) or (Guard.CONFIRMED in others and after == Step.SET_WHEEL)


def test_no_step_is_dead_and_each_row_matters() -> None:
    reached = {Step.PLAN, Step.OFF} | {target for _, _, target in TRANSITIONS}
    assert reached == set(Step)
    for source, guard, target in TRANSITIONS:
        assert step_transition(source, bits(guard)) == target


def test_nothing_happens_without_a_reason() -> None:
    for step in Step:
        assert step_transition(step, 0) == step
