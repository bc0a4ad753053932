"""A run that could not take place is no row, margin, clause or verdict: exit code 2, how many and why, and again."""

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from apa_cosim import sweep as sweep_table
from orchestrator.cli import main
from orchestrator.inputs.text.errors import NotRunError, RunError
from orchestrator.inputs.text.failures import exit_code_and_message
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.studies.parking.world import ends
from orchestrator.studies.sweep import batch
from orchestrator.studies.sweep.engine import all_rows, rows_or_reason

STUDY = """
name: few
scenario: guo2015-case4
set: {stop_time: 2}
runs:
  grid:
    vehicle.start.x: {from: -0.05, to: 0.05, steps: 4}
"""


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "few.yaml"
    path.write_text(STUDY)
    return path


class Failing:
    """A run that cannot take place at some of its calls."""

    def __init__(self, run: Any, error: BaseException, calls: set[int]) -> None:
        self._run, self._error, self._calls, self.count = run, error, calls, 0

    def __call__(self, *given: Any, **named: Any) -> Any:
        self.count += 1
        if self.count in self._calls:
            raise self._error
        return self._run(*given, **named)


CAUSES = [OSError(24, "Too many open files"), MemoryError(), NotRunError("x.fmu cannot be loaded here")]


@pytest.mark.parametrize("cause", CAUSES, ids=["EMFILE", "memory", "FMU"])
def test_a_chunk_with_a_run_that_could_not_take_place_has_no_rows(cause: Exception) -> None:
    def row(number: int) -> Any:
        if number in (1, 3):
            raise cause
        return np.zeros(2)

    with pytest.raises(NotRunError) as error:
        batch.rows_by(row, 5)
    assert len(error.value.args) == 2
    assert str(error.value).startswith("2 runs could not take place: ")
    assert exit_code_and_message(error.value, [])[0] == 2
    again = pickle.loads(pickle.dumps(error.value))
    assert (type(again), again.args) == (NotRunError, error.value.args)


def test_what_a_model_refuses_is_another_outcome() -> None:
    def row(number: int) -> Any:
        raise RunError("the model refuses")

    with pytest.raises(RunError):
        batch.rows_by(row, 1)


def test_all_rows_says_how_many_have_none() -> None:
    found = rows_or_reason(lambda: (_ for _ in ()).throw(MemoryError()), 3)
    assert isinstance(found, NotRunError)
    chunks: Any = iter([("a", np.zeros(1)), ("b", found), ("c", np.zeros(1))])
    rows = all_rows(chunks)
    assert [next(rows)[0], next(rows)[0]] == ["a", "c"]
    with pytest.raises(NotRunError, match="3 runs could not take place"):
        next(rows)


def test_a_sweep_says_so_and_resume_makes_these_runs(
    study: Path, tmp_path: Path, monkeypatch: Any, capsys: Any
) -> None:
    words = ["sweep", str(study), "--no-page", "--chunk", "1", "--jobs", "1"]
    assert main([*words, "--fmus", "native", "--out", str(tmp_path / "whole")]) == 0
    in_threads(monkeypatch, Failing(run_scenario, CAUSES[0], {2, 3}))
    capsys.readouterr()
    out = ["--fmus", "native", "--out", str(tmp_path / "part")]
    assert main([*words, *out]) == 2
    said = capsys.readouterr().err
    assert "few: 2 runs could not take place: " in said
    assert "2 of 4 runs are kept, --resume makes the others" in said
    assert not list((tmp_path / "part").glob("*.parquet"))
    monkeypatch.undo()
    assert main([*words, *out, "--resume"]) == 0
    tables = [(tmp_path / name / "few.parquet").read_bytes() for name in ("whole", "part")]
    assert tables[0] == tables[1]


def in_threads(monkeypatch: Any, run: Any) -> None:
    """Have the chunks of a study made in this process, by another ``run_scenario``."""
    from orchestrator.studies.sweep import engines

    monkeypatch.setattr(batch, "run_scenario", run)
    choose = engines.choose_task
    monkeypatch.setattr(
        "orchestrator.studies.sweep.sweep.choose_task", lambda *given: choose(*given)._replace(threads=True)
    )


def test_the_table_of_a_notebook_raises_it(study: Path, tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setattr(
        "orchestrator.studies.sweep.batch.compile_models", lambda *given: Failing(None, MemoryError(), {1, 2, 3, 4})
    )
    with pytest.raises(NotRunError, match="4 runs could not take place"):
        sweep_table(study, folder=tmp_path / "s")


def test_a_hunt_has_no_result(tmp_path: Path, monkeypatch: Any, capsys: Any) -> None:
    monkeypatch.setattr(
        "orchestrator.studies.sweep.batch.compile_models", lambda *given: Failing(None, OSError(28, "full"), {1, 2})
    )
    assert main(["falsify", "apa-world", "--budget", "50", "--jobs", "1", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr()
    assert "no result" in said.err
    assert "could not take place: " in said.err
    assert "break" not in said.out
    assert not list(tmp_path.glob("journal/*.npz"))


@pytest.mark.parametrize("name", ["guo2015-case4", "catalogue/iso20900"])
def test_a_test_calls_it_not_run(tmp_path: Path, monkeypatch: Any, capsys: Any, name: str) -> None:
    monkeypatch.setattr("orchestrator.testing.suite.suite.run_scenario", Failing(None, MemoryError(), set(range(99))))
    assert main(["test", name, "--fmus", "none", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().out
    assert "could not take place" in said
    assert "FAIL" not in said
    assert "missed" not in said.replace("0 missed", "")
    assert "<failure" not in (tmp_path / "junit.xml").read_text()


def test_a_run_leaves_no_log_if_nothing_has_run(tmp_path: Path, monkeypatch: Any, capsys: Any) -> None:
    monkeypatch.setattr(
        "orchestrator.simulation.cosim.model_instance.ModelInstance.initialize", Failing(None, MemoryError(), {1})
    )
    assert main(["run", "guo2015-case4", "--fmus", "none", "--no-page", "--out", str(tmp_path)]) == 2
    assert "more memory" in capsys.readouterr().err
    assert not list(tmp_path.glob("*.mcap"))
    assert not list(tmp_path.glob("summary.json"))


@pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")
def test_an_fmu_that_cannot_be_unpacked_is_not_run(tmp_path: Path, monkeypatch: Any, capsys: Any) -> None:
    monkeypatch.setattr(
        "orchestrator.simulation.cosim.local_instance.extract", Failing(None, ValueError("no zip"), {1})
    )
    assert main(["run", "guo2015-case4", "--fmus", "native", "--no-page", "--json", "--out", str(tmp_path)]) == 2
    assert "cannot be loaded here: no zip" in capsys.readouterr().err


def test_what_was_not_measured_is_no_good_margin() -> None:
    nan, zero = np.array([np.nan]), np.array([0.0])
    columns = {
        "assist.clearance": nan,
        "min_clearance": nan,
        "state": nan,
        "end": np.array([ends.ENDLESS], dtype=object),
        "touched.speed": nan,
        **dict.fromkeys(("final.heading_error", "final.lateral_error", "final.outline_margin"), zero),
    }
    for goal in ends.GOALS:
        assert goal.margins is not None
        assert goal.margins(columns)[0] < 0.0
    never = {**columns, "min_clearance": np.array([0.3]), "state": zero}
    assert all(goal.margins(never)[0] > 0.0 for goal in ends.GOALS if goal.margins)


def test_a_part_that_cannot_be_read_for_lack_of_memory_is_kept(study: Path, tmp_path: Path, monkeypatch: Any) -> None:
    """It was called damaged, and removed."""
    words = ["sweep", str(study), "--no-page", "--out", str(tmp_path / "s"), "--chunk", "1"]
    monkeypatch.setattr("orchestrator.studies.sweep.store.pq.read_table", Failing(None, MemoryError(), {1}))
    assert main(words) == 2
    assert len(list((tmp_path / "s" / "parts").glob("*.parquet"))) == 4
    monkeypatch.undo()
    assert main([*words, "--resume"]) == 0
