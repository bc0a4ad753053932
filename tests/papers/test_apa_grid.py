"""The grid study at a reduced size: no contact in any run, every run ends parked or failed with a reason."""

import random
from pathlib import Path

import pytest

from orchestrator.cli import main
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.studies.parking.cases import CARS, SEED_STRIDE, cases, parameters
from orchestrator.studies.parking.imperfect import imperfect
from orchestrator.studies.parking.parkings import GridRun, parkings
from orchestrator.studies.parking.study import study, study_of, totals
from orchestrator.studies.sweep.engines import choose_task
from orchestrator.studies.sweep.in_memory import columns_in_memory
from orchestrator.studies.sweep.job import Chunk, chunk_scenario, make_job
from orchestrator.studies.sweep.rows import row_of

needs_compiler = pytest.mark.skipif(not can_compile(), reason="needs a C compiler")
EVERY = 25
"""Each so many-th run: every car, kind, side, slot, distance, heading, body and speed are among them."""
EVERY_OF_RELEASE = 5
MILD = (62, 93, 186, 310, 658)
"""Runs without a miss of any kind."""
PLAIN = (62, 658)
"""Driven in plain Python as well: one parallel, one perpendicular."""


def driven(numbers: tuple[int, ...]) -> list[GridRun]:
    return parkings(columns_in_memory(study_of([cases()[number] for number in numbers])))


@pytest.fixture(scope="module", params=[EVERY, pytest.param(EVERY_OF_RELEASE, marks=pytest.mark.release)])
def results(request: pytest.FixtureRequest) -> list[GridRun]:
    whole = study()
    return parkings(columns_in_memory(whole._replace(design=whole.design.part(0, request.param))))


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
    assert parameters(grid[5]) == parameters(cases(0)[5])
    assert parameters(grid[5]) != parameters(cases(1)[5])


def test_any_lot_gives_seeds_that_the_sensors_take() -> None:
    lot = 900_022
    for vehicle in (parameters(cases(lot)[5])[0], imperfect(5 + SEED_STRIDE * lot, random.Random(1))):
        assert 0 <= vehicle["ultrasonic.seed"] < 2**31


@needs_compiler
def test_no_run_touches_anything(results: list[GridRun]) -> None:
    assert min(item.nearest for item in results) > 0.01
    assert totals(results)["with contact"] == 0


@needs_compiler
def test_every_run_ends_parked_or_failed_with_its_reason(results: list[GridRun]) -> None:
    assert [item.case.number for item in results if not item.is_ended] == []


@needs_compiler
def test_all_but_two_in_a_hundred_are_parked_within_gbt(results: list[GridRun]) -> None:
    """Of the few runs of each change all but one."""
    assert sum(not item.is_gbt for item in results) <= max(1.0, 0.02 * len(results))


@needs_compiler
def test_project_limits_are_met_where_no_kerb_decides_the_lateral_position(results: list[GridRun]) -> None:
    group = [item for item in results if item.case.kind == 2]
    assert sum(item.is_within_limits for item in group) >= 0.5 * len(group)
    assert all(item.is_within_limits_but_manoeuvres for item in results if item.is_within_limits)


@needs_compiler
def test_corners_are_found_and_no_slot_where_there_is_none(results: list[GridRun]) -> None:
    assert [item.case.number for item in results if item.kind == 0 or item.is_ghost] == []
    errors = {item.case.number: max(item.corner_a, item.corner_b) for item in results}
    slow = [item.case.number for item in results if item.case.speed < 5.0]
    assert sum(errors[number] > 0.12 for number in slow) <= max(1.0, 0.01 * len(slow))
    assert sum(error > 0.2 for error in errors.values()) <= max(1.0, 0.01 * len(errors))


@needs_compiler
def test_these_runs_are_parked_within_gbt_with_all_corners_found() -> None:
    mild = driven(MILD)
    assert [item.case.number for item in mild if not item.is_gbt] == []
    assert max(max(item.corner_a, item.corner_b) for item in mild) < 0.1


@needs_compiler
@pytest.mark.release
@pytest.mark.parametrize("number", [62, 658])
def test_a_run_is_the_same_in_plain_python(number: int) -> None:
    """``test_apa_world.py`` has one on each change."""
    chosen = study_of([cases()[number], cases()[0]])
    job = make_job(chosen)
    chunk = Chunk(0, 0, chosen.design.values[:1], chosen.design.seeds[:1])
    scenario = chunk_scenario(job, chunk, 0)
    recorded = row_of(run_scenario(scenario).recording, scenario, job.measures)
    assert choose_task(chosen.scenario, None).work(job, chunk)[0].tolist() == recorded.tolist()


@pytest.mark.skipif(can_compile(), reason="where nothing can be compiled")
def test_some_runs_in_plain_python_are_parked_within_gbt() -> None:
    assert all(item.is_gbt for item in driven(PLAIN))


@needs_compiler
def test_the_command_prints_the_tables_and_rows_come_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["sweep", "apa-grid", "--set", "lot=1", "--stride", "400", "--out", str(tmp_path), "--no-page"]
    assert main(asked) == 0
    printed = capsys.readouterr().out
    assert "with contact" in printed
    assert "slot found" in printed
    assert main(["replay", str(tmp_path / "apa-grid.parquet"), "--row", "1", "--no-page", "--fmus", "native"]) == 0
    assert "same bits as in the table" in capsys.readouterr().out


def test_what_the_grid_cannot_be_asked(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", "apa-grid", "--set", "lots=1"]) == 2
    assert "did you mean lot?" in capsys.readouterr().err
    assert main(["sweep", "apa-grid", "--set", "lot=two"]) == 2
    assert "is not a whole number" in capsys.readouterr().err
