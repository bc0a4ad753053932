"""Both charts of the parking assist, exhaustively: every state, every combination of guards."""

import pytest

from controller_fmu.apa.chart import TRANSITIONS, Guard, Mode, transition
from controller_fmu.apa.manoeuvre_chart import TRANSITIONS as STEPS
from controller_fmu.apa.manoeuvre_chart import Guard as StepGuard
from controller_fmu.apa.manoeuvre_chart import Step, step_transition
from controller_fmu.apa.outputs import PHASE_OF_STEP

DRIVING = (Mode.AUTO_PARKING_ASSIST, Mode.POSITION_TUNING)


def expected(mode: int, guards: int) -> int:
    rows = [row for row in TRANSITIONS if row[0] == mode and guards & (1 << row[1])]
    return rows[0][2] if rows else mode


@pytest.mark.parametrize("mode", list(Mode))
def test_every_combination_of_guards_follows_the_first_row_that_holds(mode: Mode) -> None:
    for guards in range(1 << len(Guard)):
        assert transition(mode, guards) == expected(mode, guards)


@pytest.mark.parametrize("mode", DRIVING)
def test_takeover_and_faults_win_over_everything_while_driving(mode: Mode) -> None:
    for guards in range(1 << len(Guard)):
        if guards & (1 << Guard.TAKEN_OVER | 1 << Guard.FAULT):
            assert transition(mode, guards) == Mode.FAIL


def test_a_fault_fails_every_active_state_unless_it_is_switched_off() -> None:
    for mode in (Mode.STANDBY, Mode.PARKING_SPACE_SEARCH, Mode.PARKING_SPACE_APPEARS):
        for guards in range(1 << len(Guard)):
            if guards & 1 << Guard.FAULT:
                off = guards & 1 << Guard.SWITCHED_OFF
                assert transition(mode, guards) == (Mode.OFF if off else Mode.FAIL)


def test_the_assist_drives_only_after_confirmation() -> None:
    for mode in Mode:
        for guards in range(1 << len(Guard)):
            if transition(mode, guards) in DRIVING and mode not in DRIVING:
                assert mode == Mode.PARKING_SPACE_APPEARS
                assert guards & 1 << Guard.CONFIRMED


def reachable(rows: tuple[tuple[int, int, int], ...], start: int) -> set[int]:
    found = {start}
    while True:
        more = {target for source, _, target in rows if source in found} - found
        if not more:
            return found
        found |= more


def test_no_state_is_dead_and_every_state_leads_to_off() -> None:
    assert reachable(TRANSITIONS, Mode.OFF) == set(Mode)
    for mode in Mode:
        assert Mode.OFF in reachable(TRANSITIONS, mode)


@pytest.mark.parametrize("step", list(Step))
def test_every_combination_of_step_guards(step: Step) -> None:
    for guards in range(1 << len(StepGuard)):
        rows = [row for row in STEPS if row[0] == step and guards & (1 << row[1])]
        assert step_transition(step, guards) == (rows[0][2] if rows else step)


def test_every_step_is_reached_and_leads_to_done() -> None:
    assert reachable(STEPS, Step.IDLE) == set(Step)
    for step in Step:
        assert Step.DONE in reachable(STEPS, step)
    assert len(PHASE_OF_STEP) == len(Step)


def test_the_wheel_is_set_at_standstill_before_every_drive() -> None:
    assert {source for source, _, target in STEPS if target == Step.DRIVE} == {Step.SET_WHEEL}
    assert {target for source, _, target in STEPS if source == Step.DRIVE} == {Step.HALT}


def test_together_the_charts_finish_only_when_the_manoeuvre_is_done() -> None:
    """Walk the product: the outer chart sees ENDED only in DONE, and the inner one moves only while driving."""
    seen = set()
    front = {(int(Mode.PARKING_SPACE_APPEARS), int(Step.PLAN))}
    while front:
        seen |= front
        after = set()
        for mode, step in front:
            driving = mode in DRIVING
            for inner in range(1 << len(StepGuard)):
                held = inner if driving else inner & ~(1 << StepGuard.PLANNED) & ~(1 << StepGuard.IN_PLACE)
                next_step = step_transition(step, held)
                for bit in (Guard.CONFIRMED, Guard.NEARLY, Guard.FAULT, Guard.TAKEN_OVER):
                    outer = 1 << bit | (1 << Guard.ENDED if next_step == Step.DONE else 0)
                    if bit == Guard.NEARLY and next_step != Step.PLAN:
                        outer &= ~(1 << Guard.NEARLY)
                    next_mode = transition(mode, outer)
                    if next_mode == Mode.PARKING_FINISH:
                        assert next_step == Step.DONE
                    if next_mode in (Mode.PARKING_SPACE_APPEARS, *DRIVING):
                        after.add((next_mode, next_step))
        front = after - seen
    assert (int(Mode.POSITION_TUNING), int(Step.DRIVE)) in seen
    assert {mode for mode, _ in seen} == {Mode.PARKING_SPACE_APPEARS, *DRIVING}
