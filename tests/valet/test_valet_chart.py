"""The valet's chart: every step against every combination of guards."""

import itertools

import pytest

from controller_fmu.valet.chart import TRANSITIONS, Guard, Step, step_transition

FINAL = (Step.PARKED, Step.FAILED, Step.TAKEN_OVER)


def bits(*guards):
    return sum(1 << guard for guard in guards)


@pytest.mark.parametrize("step", [step for step in Step if step not in FINAL])
def test_a_takeover_and_then_a_fault_win_everywhere(step):
    for others in itertools.chain.from_iterable(itertools.combinations(Guard, count) for count in range(3)):
        assert step_transition(step, bits(*{*others, Guard.TAKEN_OVER})) == Step.TAKEN_OVER
        if Guard.TAKEN_OVER not in others:
            assert step_transition(step, bits(*{*others, Guard.FAULT})) == Step.FAILED


@pytest.mark.parametrize("step", FINAL)
def test_what_is_over_stays(step):
    assert step_transition(step, bits(*Guard)) == step


def test_no_step_is_dead_and_each_row_matters():
    reached = {Step.PLAN} | {target for _, _, target in TRANSITIONS}
    assert reached == set(Step)
    for source, guard, target in TRANSITIONS:
        assert step_transition(source, bits(guard)) == target


def test_nothing_happens_without_a_reason():
    for step in Step:
        assert step_transition(step, 0) == step
