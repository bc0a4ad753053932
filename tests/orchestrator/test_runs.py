"""Runs on disk: never replaced silently, with what it takes to repeat them, listed, and run again from their log."""

import hashlib
import json
import shlex
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from orchestrator.cli import main
from orchestrator.evaluation.verdict.logged_scenario import read_logged_scenario
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.presentation.log.read_log import read_log
from orchestrator.session.provenance import git_commit
from orchestrator.simulation.cosim import fmu_files
from orchestrator.simulation.cosim.fmu_files import can_compile, sources_hash
from orchestrator.studies.live.layout import layout_data

DEMO = str(Path(__file__).with_name("demo.yaml"))
SHORT = ["run", DEMO, "--fmus", "none", "--no-page", "--set", "stop_time=0.2"]


def test_a_run_is_replaced_only_if_that_is_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["run", DEMO, "--fmus", "native", "--no-page", "--out", str(tmp_path / "run")]
    assert main(arguments) == 0
    first = (tmp_path / "run" / "run.mcap").read_bytes()
    assert main(["export", "csv", str(tmp_path / "run")]) == 0
    capsys.readouterr()
    assert main([*arguments, "--set", "stop_time=1"]) == 2
    assert f"{tmp_path / 'run'}: has a run already; choose another --out, or replace it with --force" in (
        capsys.readouterr().err
    )
    assert (tmp_path / "run" / "run.mcap").read_bytes() == first
    assert main([*arguments, "--set", "stop_time=1", "--force"]) == 1
    assert "removed run.csv of the run before" in capsys.readouterr().err
    assert (tmp_path / "run" / "run.mcap").read_bytes() != first
    assert {path.name for path in (tmp_path / "run").iterdir()} == {"run.mcap", "summary.json"}


def test_runs_without_a_folder_are_numbered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    arguments = ["run", DEMO, "--fmus", "none", "--no-page", "--set", "stop_time=0.2"]
    assert [main(arguments) for _ in range(3)] == [1, 1, 1]
    names = ["demo", "demo-2", "demo-3"]
    assert sorted(path.name for path in Path("runs").iterdir()) == names
    assert all((Path("runs") / name / "run.mcap").is_file() for name in names)
    assert main([*arguments, "--force"]) == 1
    assert sorted(path.name for path in Path("runs").iterdir()) == names


def test_a_run_says_when_how_and_from_what_it_was_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    words = ["run", DEMO, "--fmus", "python", "--no-page", "--set", "stop_time=0.2", "--out", str(tmp_path / "run")]
    assert main(words) == 1
    for made in (json.loads((tmp_path / "run/summary.json").read_text()), read_log(tmp_path / "run/run.mcap").info):
        assert made["started"]["time"] == "2023-11-14T22:13:20Z"
        assert made["started"]["command"] == shlex.join(["apa", *words])
        assert made["started"]["folder"] == str(Path.cwd())
        assert {item["name"] for item in made["fmus"]} == {"vehicle", "controller"}
        for item in made["fmus"]:
            assert item["sha256"] == hashlib.sha256(Path(item["path"]).read_bytes()).hexdigest()


def test_a_run_of_models_in_process_names_the_hash_of_their_sources(tmp_path: Path) -> None:
    assert main(["run", DEMO, "--fmus", "none", "--no-page", "--set", "stop_time=0.2", "--out", str(tmp_path)]) == 1
    used = json.loads((tmp_path / "summary.json").read_text())["fmus"]
    assert {item["sha256"] for item in used} == {sources_hash()}


def test_the_git_commit_of_the_folder_is_named(tmp_path: Path) -> None:
    assert git_commit(tmp_path) == ""
    git = ["git", "-C", str(tmp_path), "-c", "user.name=n", "-c", "user.email=e@example.org"]
    (tmp_path / "file").write_text("a")
    for words in (["init", "-q"], ["add", "file"], ["commit", "-q", "-m", "m"]):
        subprocess.run([*git, *words], check=True)
    commit = git_commit(tmp_path)
    assert len(commit) == 40
    (tmp_path / "file").write_text("b")
    assert git_commit(tmp_path) == f"{commit}-modified"


def test_a_run_is_repeated_from_its_log_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sets = ["--set", "vehicle.driver.reaction_delay=300 ms"]
    assert main([*SHORT, *sets, "--out", str(tmp_path / "run")]) == 1
    log = (tmp_path / "run" / "run.mcap").rename(tmp_path / "alone.mcap")
    capsys.readouterr()
    assert main(["rerun", str(log), "--no-page", "--out", str(tmp_path / "again")]) == 1
    assert capsys.readouterr().out.endswith("identical to the log\n")
    first, again = read_log(log), read_log(tmp_path / "again" / "run.mcap")
    assert again.parameters == first.parameters
    assert again.info["scenario"] == first.info["scenario"]


def test_the_page_of_a_repeated_run_has_the_slot_layout_of_the_log(tmp_path: Path) -> None:
    layout = ["--set", "slot_layout.length=6.4", "--set", "stop_time=0.1"]
    short = ["--fmus", "none", "--no-page", "-q"]
    assert main(["run", "apa-parallel", *layout, *short, "--out", str(tmp_path / "run")]) == 1
    assert main(["rerun", str(tmp_path / "run"), "--no-page", "-q"]) == 1
    first, again = (
        layout_data(read_logged_scenario(read_log(tmp_path / name / "run.mcap"))) for name in ("run", "run-rerun")
    )
    assert first == again
    assert first is not None
    assert first["start"][0] == 6.4


def test_a_run_that_differs_from_its_log_is_code_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert main([*SHORT, "--out", str(tmp_path / "run")]) == 1
    real = read_log(tmp_path / "run" / "run.mcap")
    changed = real.signals["vehicle.pose.x"].copy()
    changed[-1] += 1e-12
    altered = replace(real, signals={**real.signals, "vehicle.pose.x": changed})
    monkeypatch.setattr("orchestrator.commands.rerun.read_log", lambda _: altered)
    assert main(["rerun", str(tmp_path / "run"), "--no-page"]) == 2
    assert "differs from the log in vehicle.pose.x\n" in capsys.readouterr().out
    assert (tmp_path / "run-rerun" / "run.mcap").is_file()


def test_runs_are_listed_with_time_change_outcome_and_path(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for epoch, more in (("1700000000", []), ("1700000100", ["--set", "vehicle.driver.reaction_delay=0.5"])):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
        assert main([*SHORT, *more]) == 1
    Path("runs/broken").mkdir()
    Path("runs/broken/summary.json").write_text("{")
    capsys.readouterr()
    assert main(["list", "runs", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["path"] for row in rows] == ["runs/demo-2", "runs/demo"]
    assert rows[0]["time"] == "2023-11-14T22:15:00Z"
    assert rows[0]["overrides"] == "stop_time = 0.2, vehicle.driver.reaction_delay = 0.5"
    assert {row["outcome"] for row in rows} == {"not_parked"}
    assert main(["list", "runs", "elsewhere"]) == 2
    assert "elsewhere: no such folder" in capsys.readouterr().err
    assert main(["list", "runs", "runs", "--page"]) == 0
    page = Path("runs/index.html").read_text(encoding="utf-8")
    assert page.count('<tr data-text="') == 2
    assert 'href="demo-2/"' in page


def test_a_page_of_runs_shows_pictures_and_escapes_titles(tmp_path: Path) -> None:
    words = ["run", DEMO, "--fmus", "none", "--set", "stop_time=0.2", "--set", "title=<script>x</script>"]
    assert main([*words, "--out", str(tmp_path / "one")]) == 1
    assert main(["list", "runs", str(tmp_path), "--page"]) == 0
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert 'src="one/overview.png"' in page
    assert 'href="one/report.html"' in page
    assert 'alt="demo: not parked"' in page
    assert "not_parked</b>" not in page
    assert "<script>x" not in page


@pytest.mark.skipif(not can_compile(), reason="no C compiler")
def test_an_fmu_beside_another_is_built_once_for_all_processes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And again if it is damaged."""
    place = tmp_path / "native" / "Controller.fmu"
    made = fmu_files.fmu_beside(place, MODELS["vehicle"])
    whole = made.read_bytes()

    def refuse(*_: Any, **__: Any) -> Any:
        raise AssertionError("built again")

    with monkeypatch.context() as other:
        other.setattr(fmu_files, "_BESIDE", {})
        other.setattr(fmu_files, "build_into", refuse)
        assert fmu_files.fmu_beside(place, MODELS["vehicle"]) == made
    made.write_bytes(whole[:1000] + b"?" + whole[1001:])
    monkeypatch.setattr(fmu_files, "_BESIDE", {})
    assert fmu_files.fmu_beside(place, MODELS["vehicle"]).read_bytes() == whole
