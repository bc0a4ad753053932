"""The grid study at a reduced size: no contact in any run, every run parked or failed with a reason."""

import math

import pytest

from orchestrator.apa_grid import KEPT, Result, cases, drive, is_within_gbt, parameters, totals
from orchestrator.apa_loop import Loop

RUNS = (62, 93, 186, 310, 658)


@pytest.fixture(scope="module")
def results() -> list[Result]:
    loop = Loop(KEPT, compiled=False)
    return [drive(case, loop) for case in cases() if case.number in RUNS]


def test_the_grid_covers_what_it_says() -> None:
    grid = cases()
    assert [case.number for case in grid] == list(range(len(grid)))
    assert {(case.car, case.kind, case.side, case.body) for case in grid} == {
        (car, kind, side, body)
        for car in ("guo2015", "zhang2022", "commonroad1")
        for kind in (1, 2)
        for side in (1, -1)
        for body in ("kinematic", "double_track")
    }
    assert parameters(grid[5]) == parameters(cases()[5])


def test_no_run_touches_anything(results: list[Result]) -> None:
    assert min(result.nearest for result in results) > 0.0
    assert totals(results)["touched something"] == 0


def test_these_runs_are_parked_within_gbt(results: list[Result]) -> None:
    assert [result.case.number for result in results if not is_within_gbt(result)] == []


def test_corners_are_found(results: list[Result]) -> None:
    assert all(not math.isnan(result.corner_a) for result in results)
    assert max(max(result.corner_a, result.corner_b) for result in results) < 0.1
