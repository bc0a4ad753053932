"""The grid study at a reduced size: no contact in any run, every run ends parked or failed with a reason."""

import argparse

import pytest

from orchestrator.commands.study import run
from orchestrator.cosim.fmu_files import can_compile
from orchestrator.grid.apa_grid import (
    CARS,
    KEPT,
    Result,
    cases,
    drive,
    is_ended,
    is_ghost,
    is_within_gbt,
    is_within_house,
    parameters,
    totals,
)
from orchestrator.grid.apa_loop import Loop

needs_compiler = pytest.mark.skipif(not can_compile(), reason="needs a C compiler")
EVERY = 5
"""Each so many-th run: every car, kind, side, slot, distance, heading, body and speed are among them."""
MILD = (62, 93, 186, 310, 658)
"""Runs without a miss of any kind."""
PLAIN = (62, 658)
"""Driven in plain Python as well: one parallel, one perpendicular."""


@pytest.fixture(scope="module")
def results() -> list[Result]:
    loop = Loop(KEPT, compiled=True)
    return [drive(case, loop) for case in cases()[::EVERY]]


def test_the_grid_covers_what_it_says() -> None:
    grid = cases()
    assert [case.number for case in grid] == list(range(756))
    assert {(case.car, case.kind, case.side, case.body) for case in grid} == {
        (car, kind, side, body)
        for car in CARS
        for kind in (1, 2)
        for side in (1, -1)
        for body in ("kinematic", "double_track")
    }
    part = grid[::EVERY]
    for field in ("car", "kind", "side", "extra", "beside", "heading", "body", "speed"):
        assert {getattr(case, field) for case in part} == {getattr(case, field) for case in grid}
    assert parameters(grid[5]) == parameters(cases()[5])
    assert parameters(grid[5]) != parameters(cases(1)[5])


@needs_compiler
def test_no_run_touches_anything(results: list[Result]) -> None:
    assert min(result.nearest for result in results) > 0.05
    assert totals(results)["touched something"] == 0


@needs_compiler
def test_every_run_ends_parked_or_failed_with_its_reason(results: list[Result]) -> None:
    assert [result.case.number for result in results if not is_ended(result)] == []


@needs_compiler
def test_all_but_one_in_a_hundred_are_parked_within_gbt(results: list[Result]) -> None:
    inside = [result for result in results if result.inside]
    assert len(inside) > 30
    for group in (results, inside):
        assert sum(is_within_gbt(result) for result in group) >= 0.99 * len(group)


@needs_compiler
def test_house_limits_are_met_where_the_slot_allows_three_shifts(results: list[Result]) -> None:
    group = [result for result in results if result.case.kind == 2 or result.case.extra > 0.0]
    assert sum(is_within_house(result) for result in group) >= 0.93 * len(group)


@needs_compiler
def test_corners_are_found_and_no_slot_where_there_is_none(results: list[Result]) -> None:
    assert [result.case.number for result in results if result.kind == 0 or is_ghost(result)] == []
    slow = [result for result in results if result.case.speed < 5.0]
    assert max(max(result.corner_a, result.corner_b) for result in slow) < 0.1
    assert max(max(result.corner_a, result.corner_b) for result in results) < 0.2


@needs_compiler
def test_these_runs_are_parked_within_gbt_with_all_corners_found() -> None:
    loop = Loop(KEPT, compiled=True)
    mild = [drive(cases()[number], loop) for number in MILD]
    assert [result.case.number for result in mild if not is_within_gbt(result)] == []
    assert max(max(result.corner_a, result.corner_b) for result in mild) < 0.1


@needs_compiler
def test_a_run_is_repeated_by_its_number_in_plain_python_too(results: list[Result]) -> None:
    compiled, plain = Loop(KEPT, compiled=True), Loop(KEPT, compiled=False)
    for number in PLAIN:
        case = cases()[number]
        assert drive(case, compiled) == drive(case, plain)


@pytest.mark.skipif(can_compile(), reason="where nothing can be compiled")
def test_some_runs_in_plain_python_are_parked_within_gbt() -> None:
    loop = Loop(KEPT, compiled=False)
    assert all(is_within_gbt(drive(cases()[number], loop)) for number in PLAIN)


@needs_compiler
def test_the_command_prints_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    asked = argparse.Namespace(first=0, every=400, lot=0, number=None, all=True, plain=False, json=False)
    assert run(asked) == 0
    printed = capsys.readouterr().out
    assert "touched something" in printed
    assert "from inside the start range" in printed
    assert " 400 " in printed
