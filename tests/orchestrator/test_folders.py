"""Results of two commands are never mixed: a folder belongs to one at a time, and older results go with their log."""

import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import pytest

from fmus.native.compilers import can_compile, find_compiler
from orchestrator.cli import main
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.locked_folder import lock_folder

ROOT = Path(__file__).parents[2]
SHORT = ["guo2015-case4", "--set", "stop_time=0.3", "--fmus", "none"]
STUDY = "name: trial\nscenario: guo2015-case4\nruns: {grid: {vehicle.start.x: [X, 2.1, 2.2, 2.3]}}\n"
posix = pytest.mark.skipif(os.name != "posix", reason="folders are locked on POSIX only")


@posix
@pytest.mark.parametrize(
    "words", [["run", *SHORT, "--no-page"], ["test", *SHORT], ["replay", "TABLE", "--row", "0", "--no-page"]]
)
def test_a_folder_in_use_is_refused(words: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str], study: Any) -> None:
    words = [str(study("2.0", tmp_path / "study", "--no-page")) if word == "TABLE" else word for word in words]
    with lock_folder(tmp_path / "out"):
        assert main([*words, "--out", str(tmp_path / "out")]) == 2
    assert "out: another command is writing there" in capsys.readouterr().err
    assert list((tmp_path / "out").iterdir()) == []
    assert main([*words, "--out", str(tmp_path / "out")]) in (0, 1)


@posix
def test_the_lock_dies_with_its_process(tmp_path: Path) -> None:
    code = "import sys, os; from pathlib import Path; from orchestrator.inputs.text.locked_folder import lock_folder\n"
    code += "with lock_folder(Path(sys.argv[1])):\n print('has it', flush=True)\n os.kill(os.getpid(), 9)"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", code, str(tmp_path)], capture_output=True, env=environment)
    assert done.stdout == b"has it\n"
    with lock_folder(tmp_path), pytest.raises(BadInput), lock_folder(tmp_path):
        pass


def test_an_older_report_goes_as_the_new_log_comes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", *SHORT, "--out", str(tmp_path)]) == 1
    assert main(["export", "csv", str(tmp_path)]) == 0
    (tmp_path / "mine.txt").write_text("kept")
    assert main(["run", *SHORT, "--no-page", "--force", "--out", str(tmp_path)]) == 1
    assert "removed run.csv of the run before" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.txt", "run.mcap", "summary.json"]


def test_two_scenarios_of_one_name_are_refused_and_junit_holds_all(tmp_path: Path) -> None:
    for number in (1, 2):
        (tmp_path / str(number)).mkdir()
        (tmp_path / str(number) / "one.yaml").write_text("extends: guo2015-case4\nstop_time: 0.1\n")
    files = [str(tmp_path / "1" / "one.yaml"), str(tmp_path / "2" / "one.yaml"), str(tmp_path / "none.yaml")]
    assert main(["test", *files, "--fmus", "none", "--out", str(tmp_path / "out")]) == 2
    root = ElementTree.parse(tmp_path / "out" / "junit.xml").getroot()
    assert [suite.get("name") for suite in root] == ["one", "one", "none"]
    assert [suite.get("errors") for suite in root] == ["0", "1", "1"]
    assert (tmp_path / "out" / "index.html").is_file()


def test_a_mistake_of_ours_is_3_with_junit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("platformdirs.user_log_path", lambda *_, **__: tmp_path / "log")
    monkeypatch.setattr("orchestrator.testing.suite.suite.summarize", lambda *_: 1 / 0)
    assert main(["test", *SHORT, "--out", str(tmp_path / "out")]) == 3
    (case,) = ElementTree.parse(tmp_path / "out" / "junit.xml").getroot().iter("error")
    assert "internal error, no verdict: ZeroDivisionError" in case.get("message", "")
    assert len(list((tmp_path / "log").iterdir())) == 1
    assert "Traceback" not in capsys.readouterr().err


def test_a_test_that_ends_too_soon_is_no_success(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def leaves(*_: object) -> None:
        raise SystemExit(0)

    monkeypatch.setattr("orchestrator.testing.suite.suite.run_test", leaves)
    (tmp_path / "index.html").write_text("all passed")
    assert main(["test", *SHORT, "--out", str(tmp_path)]) == 2
    root = ElementTree.parse(tmp_path / "junit.xml").getroot()
    assert root.get("errors") == "1"
    assert not (tmp_path / "index.html").exists()


@pytest.fixture
def study() -> Any:
    def swept(first: str, out: Path, *more: str) -> Path:
        file = out.parent / f"{first}.yaml"
        file.write_text(STUDY.replace("X", first))
        assert main(["sweep", str(file), "--out", str(out), "--chunk", "2", *more]) == 0
        return out / "trial.parquet"

    return swept


def parts_of(table: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the parts of a study stay."""
    monkeypatch.setattr("orchestrator.studies.sweep.store.Store._forget", lambda self: None)


def test_parts_of_another_study_are_refused(
    study: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with monkeypatch.context() as patched:
        parts_of(tmp_path, patched)
        study("1.9", tmp_path / "a", "--no-page")
        study("2.0", tmp_path / "b", "--no-page")
    part, other = (tmp_path / name / "parts" / "00000001.parquet" for name in "ab")
    file = str(tmp_path / "1.9.yaml")
    words = ["sweep", file, "--out", str(tmp_path / "a"), "--chunk", "2", "--no-page", "--resume"]
    whole = (tmp_path / "a" / "trial.parquet").read_bytes()
    part.write_bytes(other.read_bytes())
    assert main(words) == 2
    assert "is of another study" in capsys.readouterr().err
    part.unlink()
    (tmp_path / "a" / "trial.parquet").unlink()
    (tmp_path / "a" / "parts" / "about.json").unlink()
    assert main(words) == 2
    assert "has runs of a study that is not known" in capsys.readouterr().err
    assert main([*words[:-1], "--restart"]) == 0
    assert (tmp_path / "a" / "trial.parquet").read_bytes() == whole


def test_a_damaged_part_is_made_again(
    study: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with monkeypatch.context() as patched:
        parts_of(tmp_path, patched)
        whole = study("1.9", tmp_path / "a", "--no-page").read_bytes()
    part = tmp_path / "a" / "parts" / "00000001.parquet"
    data = bytearray(part.read_bytes())
    data[60] ^= 1
    part.write_bytes(data)
    words = ["sweep", str(tmp_path / "1.9.yaml"), "--out", str(tmp_path / "a"), "--chunk", "2", "--no-page", "--resume"]
    assert main(words) == 2
    assert "00000001.parquet: was damaged and is removed" in capsys.readouterr().err
    assert main(words) == 0
    assert (tmp_path / "a" / "trial.parquet").read_bytes() == whole


def test_a_finished_study_is_not_run_again_and_another_takes_its_page_away(
    study: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = study("2.0", tmp_path / "out", "--replays", "1")
    (row,) = (tmp_path / "out").glob("row-*")
    capsys.readouterr()
    study("2.0", tmp_path / "out", "--no-page", "--resume", "--json")
    assert json.loads(capsys.readouterr().out)["made"] == 0
    assert table.with_suffix(".html").is_file()
    study("1.8", tmp_path / "out", "--no-page")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [f"{row.name}.older", "trial.parquet"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ["run", *SHORT, "--no-page"],
        pytest.param(["sweep", "STUDY", "--jobs", "1", "--no-page"], marks=pytest.mark.release),
        pytest.param(["sweep", "STUDY", "--jobs", "1", "--no-page", "--fmus", "none"], marks=pytest.mark.release),
    ],
)
def test_no_module_of_the_current_folder_is_run(words: Any, tmp_path: Path) -> None:
    (tmp_path / "trial.yaml").write_text(STUDY.replace("X", "2.0"))
    for name in ("struct", "math", "random", "pickle", "multiprocessing", "ziglang", "numpy", "orchestrator"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'a').write({name!r})\n")
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "APA_DIST": str(tmp_path / "dist")}
    environment.pop("PYTHONSAFEPATH", None)
    apa = "import sys; from orchestrator.cli import main; sys.exit(main(sys.argv[1:]))"
    words = ["trial.yaml" if word == "STUDY" else word for word in words]
    command = [sys.executable, "-P", "-c", apa, *words, "--out", "out"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == (words[0] == "run"), done.stderr  # a run that is cut off has not parked
    if can_compile():
        find_compiler().run(["--version"], tmp_path)
    assert not (tmp_path / "ran").exists(), (tmp_path / "ran").read_text()


@posix
def test_a_relative_entry_of_path_names_the_interpreter_from_any_folder() -> None:
    code = "import os, sys; from fmus.children import PYTHON; print(os.path.isabs(sys.executable), PYTHON)"
    python = Path(sys.executable)
    environment = {**os.environ, "PATH": python.parent.name, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [python.name, "-c", code], cwd=python.parents[1], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["False", str(python)]


def test_a_library_that_is_damaged_is_made_again(tmp_path: Path) -> None:
    from fmus.locks import cache_file

    made = []

    def make() -> bytes:
        made.append(1)
        return b"library"

    path = cache_file(tmp_path, "x", "1", ".so", make)
    assert cache_file(tmp_path, "x", "1", ".so", make) == path
    assert len(made) == 1
    path.write_bytes(b"another")
    assert cache_file(tmp_path, "x", "1", ".so", make).read_bytes() == b"library"
    assert len(made) == 2
