"""Studies of systems with a third-party FMU: its parameters varied, its outputs kept, the same bits again."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from apa_cosim import load_scenario, read_table, run
from orchestrator.cli import main
from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.sweep.batch import run_recorded
from orchestrator.studies.sweep.columns import fill_columns
from orchestrator.studies.sweep.job import Chunk, make_job
from orchestrator.studies.sweep.study.read_study import read_study
from orchestrator.studies.sweep.table import Table
from tests.orchestrator import c_fmus

STUDY = """scenario: their.yaml
set: {stop_time: 6, expected_outcome: not_parked}
runs:
  grid:
    controller.TurnTime: [1.5, 2 s]
    vehicle.start.y: [0, 1 cm]
measures:
  moves: {greatest: controller.Moves}
  state: {last: controller.State}
"""


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Somebody's FMU, the scenario that connects it, and a study of both."""
    folder = tmp_path_factory.mktemp("desk")
    c_fmus.two_arcs(folder)
    shutil.copy(c_fmus.THEIR / "two_arcs.yaml", folder / "their.yaml")
    (folder / "study.yaml").write_text(STUDY, encoding="utf-8")
    return folder


def test_a_study_varies_and_keeps_what_is_theirs(
    desk: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(desk)
    words = ["sweep", "study.yaml", "--fmus", "none", "--jobs", "1", "--out", str(tmp_path), "--replays", "0"]
    assert main([*words, "--no-page"]) == 0
    table = read_table(tmp_path / "study.parquet")
    assert table["controller.TurnTime"].tolist() == [1.5, 1.5, 2.0, 2.0]
    assert table["moves"].tolist() == [1.0] * 4
    x = table["final.x"]
    assert x[0] < x[2] - 0.1  # who waits half a second less is further
    assert table["final.y"][1] - table["final.y"][0] == pytest.approx(0.01, abs=1e-3)
    assert set(Table(tmp_path / "study.parquet").about["fmus"]) == {"controller"}
    again = main(["replay", str(tmp_path / "study.parquet"), "--row", "3", "--no-page", "--out", str(tmp_path / "3")])
    assert again == 1  # not parked yet
    assert "same bits as in the table" in capsys.readouterr().out
    assert np.array_equal(table.replay(0)["vehicle.pose.x"][-1], x[0])


def test_modes_of_their_own_decide_in_a_table_too(desk: Path) -> None:
    text = (desk / "their.yaml").read_text(encoding="utf-8")
    own = (
        text[: text.index("    mode:")]
        + "    mode: {from: controller.State, states: {idle: 1, first: 2, next: 3, there: 4}}\n"
    )
    (desk / "own.yaml").write_text(f"{own}stop_condition: {{succeeded: [there], failed: [next]}}\n", encoding="utf-8")
    (desk / "own-study.yaml").write_text(STUDY.replace("their.yaml", "own.yaml"), encoding="utf-8")
    study = read_study(str(desk / "own-study.yaml"), {"stop_time": "3"})
    job = make_job(study)
    chunk = Chunk(0, 0, study.design.values[:1], study.design.seeds[:1])
    columns = fill_columns(study, job, chunk, run_recorded(job, chunk, "none"))
    assert (columns["outcome"][0], columns["reason"][0]) == ("not_parked", "stop time reached in first")


def test_a_hunt_says_that_it_takes_no_system(
    desk: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(desk)
    assert main(["falsify", "study.yaml", "--budget", "50", "--out", str(tmp_path)]) == 2
    assert "system: a falsification runs our models" in capsys.readouterr().err


def test_names_that_theirs_has_not_are_answered(desk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(desk)
    for old, new, says in (
        ("controller.TurnTime", "controller.TurnTimes", "did you mean controller.TurnTime"),
        ("{last: controller.State}", "{last: controller.Stat}", "did you mean controller.State"),
    ):
        (desk / "wrong.yaml").write_text(STUDY.replace(old, new), encoding="utf-8")
        with pytest.raises(BadInput, match=says):
            make_job(read_study(str(desk / "wrong.yaml"), {}))


def test_a_scenario_in_hand_knows_its_own_system(desk: Path) -> None:
    scenario = load_scenario(desk / "their.yaml", {"stop_time": 1.0})
    assert run(scenario, fmus="none")["controller.State"][-1] == 1.0
