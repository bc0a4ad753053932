"""How a command ends: its code, its line, and what it leaves behind when it is asked to end or killed."""

import inspect
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, cast

import pytest

from fmus import files
from fmus.native.compilers import CompilerError, find_compiler
from orchestrator.cli import main
from orchestrator.inputs.text.failures import exit_code_and_message

ROOT = Path(__file__).parents[2]
posix = pytest.mark.skipif(os.name != "posix", reason="signals are those of POSIX")
HANGS = """
import time
from fmus.files import new_folder
from orchestrator.inputs.text.ends import interrupt_within_limit
with interrupt_within_limit():
    print(new_folder("x"), flush=True)
    {hang}
"""


DEAF = "exec('while True:\\n try: print(0, flush=True); time.sleep(60)\\n except KeyboardInterrupt: pass')"
"""As an FMU that hangs: nothing that Python does ends it."""


KILLED = """
import os
from pathlib import Path
from orchestrator.cli import main
def moved(move):
    return lambda path, target: move(path, target) if ".apa-" in Path(target).name else os.kill(os.getpid(), 9)
Path.rename, Path.replace = moved(Path.rename), moved(Path.replace)
main({words})
"""
"""Killed as the first file, or folder, is moved to its place."""


def started(code: str, **more: str) -> "subprocess.Popen[str]":
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **more}
    pipe = subprocess.PIPE
    return subprocess.Popen([sys.executable, "-c", code], stdout=pipe, stderr=pipe, text=True, env=environment)


def test_an_unexpected_error_is_one_line_with_code_3_and_its_traceback_in_a_file(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def broken(_arguments: object) -> int:
        raise KeyError("some\nthing")

    monkeypatch.setattr("orchestrator.commands.list.run", broken)
    monkeypatch.setattr("platformdirs.user_log_path", lambda *_, **__: tmp_path)
    assert main(["list"]) == 3
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "internal error, no verdict: KeyError" in said
    (file,) = tmp_path.iterdir()
    assert str(file) in said
    assert "Traceback" in file.read_text()
    assert "apa list" in file.read_text()


@pytest.mark.parametrize(
    ("module", "code", "text"),
    [
        ("distributed.client", 2, "[sweep]"),
        ("rerun", 2, "[export]"),
        ("rich.markup", 2, "the package rich is not installed: the installation of apa-cosim is incomplete"),
        ("orchestrator.no_such_module", 3, "internal error"),
    ],
)
def test_a_package_that_is_not_installed_is_named(module: str, code: int, text: str) -> None:
    found, line = exit_code_and_message(ModuleNotFoundError(f"No module named {module!r}", name=module), [])
    assert found == code
    assert text in line


def test_a_compiler_that_is_missing_or_fails_is_no_internal_error() -> None:
    """Studies in compiled code met it outside of the places that expected it."""
    with pytest.raises(CompilerError) as raised:
        find_compiler("/nonexistent/cc")
    for error in (raised.value, CompilerError("cc -o x: error\nbad")):
        code, line = exit_code_and_message(error, [])
        assert code == 2
        assert "\n" not in line


def test_without_memory_it_is_no_internal_error(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def hungry(_arguments: object) -> int:
        raise MemoryError

    monkeypatch.setattr("orchestrator.commands.list.run", hungry)
    assert main(["list"]) == 2
    assert "memory" in capsys.readouterr().err


@posix
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("hang", [DEAF, "time.sleep(60)"])
def test_a_signal_ends_what_hangs_within_two_seconds_and_takes_its_folders_away(number: Any, hang: Any) -> None:
    child = started(HANGS.format(hang=hang))
    assert child.stdout is not None
    folder = Path(child.stdout.readline().strip())
    assert folder.is_dir()
    begun = time.monotonic()
    child.send_signal(number)
    child.communicate(timeout=120)
    assert time.monotonic() - begun < 3.0
    assert child.returncode != 0
    assert not folder.parent.exists()


@posix
def test_an_interrupt_that_a_library_makes_another_error_of_is_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def told_otherwise(_arguments: object) -> int:
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(1.0)
        except KeyboardInterrupt as error:
            raise ValueError("no schema") from error
        return 0

    monkeypatch.setattr("orchestrator.commands.list.run", told_otherwise)
    assert main(["list"]) == 130
    assert capsys.readouterr().err == "apa: interrupted\n"


LEAVES_EXEC = """
import os, signal, sys, time
import orchestrator.commands.list as command, orchestrator.inputs.text.failures
from orchestrator.cli import _complain, main
_complain("all is imported, nothing more is made by exec")
command.run = lambda _: exec("os.kill(os.getpid(), signal.SIGINT); time.sleep(5)")
sys.exit(main(["list"]))
"""


@posix
def test_an_interrupt_while_a_library_makes_code_ends_with_the_code_of_interrupts(tmp_path: Path) -> None:
    (tmp_path / "leaves_exec.py").write_text(LEAVES_EXEC)
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{tmp_path}"}
    done = subprocess.run([sys.executable, "-m", "leaves_exec"], env=environment, capture_output=True, text=True)
    assert done.returncode == 130, done.stderr


@posix
def test_a_second_signal_ends_at_once() -> None:
    child = started(HANGS.format(hang=DEAF))
    assert child.stdout is not None
    child.stdout.readline()
    child.stdout.readline()
    time.sleep(0.1)
    begun = time.monotonic()
    child.send_signal(signal.SIGTERM)
    time.sleep(0.1)
    child.send_signal(signal.SIGTERM)
    assert "interrupted" in child.communicate(timeout=120)[1]
    assert child.returncode == 130
    assert time.monotonic() - begun < 1.4


@posix
def test_the_next_process_takes_away_what_a_killed_one_left(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    child = started(HANGS.format(hang="time.sleep(60)"), TMPDIR=str(tmp_path))
    assert child.stdout is not None
    left = Path(child.stdout.readline().strip()).parent
    files._remove_forsaken(tmp_path)
    assert left.is_dir(), "its process lives"
    child.kill()
    child.communicate()
    files._remove_forsaken(tmp_path)
    assert not left.exists()


@posix
def test_a_folder_too_deep_or_closed_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """``shutil.rmtree`` ended in a RecursionError where an FMU had left so deep a folder."""
    kept = tmp_path / "kept"
    kept.write_text("kept")
    monkeypatch.chdir(tmp_path)
    for _ in range(1200):
        os.mkdir("deep")
        os.chdir("deep")
        os.symlink(tmp_path, "link")
        os.mkdir("closed", 0)
    os.chdir(tmp_path)
    files.remove_folder(tmp_path / "deep")
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]


@posix
@pytest.mark.parametrize(
    "words", [["export", "ros2", "RUN"], ["new", "controller", "mine"]], ids=["export ros2", "new controller"]
)
def test_a_folder_is_complete_or_absent_and_its_scratch_goes(words: list[str], tmp_path: Path) -> None:
    """Killed while it writes; the same command then does it, and leaves nothing beside."""
    if "ros2" in words:
        pytest.importorskip("rosbags.highlevel", reason="the package rosbags is not installed")
    short = ["guo2015-case4", "--set", "stop_time=0.3", "--fmus", "none", "--no-page"]
    assert "ros2" not in words or main(["run", *short, "--out", str(tmp_path)]) == 1
    words = [word.replace("RUN", str(tmp_path / "run.mcap")) for word in words]
    words += ["--out", str(tmp_path / "out" / "bag")] if "ros2" in words else ["--out", str(tmp_path / "out")]
    child = started(KILLED.format(words=words))
    child.communicate()
    assert child.returncode == -signal.SIGKILL
    assert [path.name[:9] for path in (tmp_path / "out").iterdir()] == [".apa-tmp-"]
    assert main(words) == 0
    assert [path.name for path in (tmp_path / "out").iterdir()] == [{"export": "bag", "new": "mine"}[words[0]]]


def test_a_folder_that_cannot_be_made_leaves_the_one_there(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "old").write_text("kept")
    with pytest.raises(FileExistsError), files.whole_folder(tmp_path / "out"):
        (tmp_path / "out").mkdir()
    with pytest.raises(FileNotFoundError), files.whole_folder(tmp_path / "out"):
        pass
    assert (tmp_path / "out" / "old").read_text() == "kept"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    with files.whole_folder(tmp_path / "out") as made:
        made.mkdir()
    assert list((tmp_path / "out").iterdir()) == []


def test_a_file_is_whole_or_as_it_was(tmp_path: Path) -> None:
    path, number = tmp_path / "new" / "file.txt", cast("str", 2)
    files.write_whole(path, "one", sync=True)
    with pytest.raises(TypeError):
        files.write_whole(path, number)
    assert path.read_text() == "one"
    assert [item.name for item in path.parent.iterdir()] == ["file.txt"]


@posix
def test_who_may_read_a_file_is_kept_when_it_is_written_again(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    for text in ("one", "two"):
        files.write_whole(path, text)
        path.chmod(0o600)
    files.write_whole(path, "three")
    assert (path.read_text(), path.stat().st_mode & 0o777) == ("three", 0o600)


def test_what_is_in_the_way_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(IsADirectoryError) as found:
        files.write_whole(tmp_path, "x")
    assert found.value.filename == str(tmp_path)
    with pytest.raises(OSError, match="file"):
        files.write_whole(tmp_path / "file" / "below", "x")


@posix
def test_standard_output_that_is_full_is_said(tmp_path: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("there is no /dev/full")
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "orchestrator", "list"], stdout=full, stderr=subprocess.PIPE, env=environment
        )
    assert done.returncode == 2
    assert done.stderr == b"apa: output: the disk is full\n"


def test_letters_that_a_terminal_has_not_cost_no_run(tmp_path: Path) -> None:
    scenario = tmp_path / "own.yaml"
    scenario.write_text("extends: guo2015-case4\ntitle: '→ 車庫'\nstop_time: 0.1\n", encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "cp1252"}
    command = [sys.executable, "-m", "orchestrator", "run", str(scenario), "--fmus", "none", "--no-page"]
    done = subprocess.run([*command, "--out", str(tmp_path / "o")], capture_output=True, env=environment)
    assert done.returncode == 1
    assert b"Traceback" not in done.stderr


def test_folders_nested_deeper_than_the_recursion_limit_are_removed(tmp_path: Path) -> None:
    """As an archive of a hostile FMU leaves them when its test is killed."""
    top = tmp_path / "left"
    top.mkdir()
    inner = os.open(top, os.O_RDONLY)
    for _ in range(300):
        os.mkdir("a", dir_fd=inner)
        deeper = os.open("a", os.O_RDONLY, dir_fd=inner)
        os.close(inner)
        inner = deeper
    os.close(inner)
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(len(inspect.stack(0)) + 200)
    try:
        files.remove_folder(top)
    finally:
        sys.setrecursionlimit(limit)
    assert not top.exists()


def test_code_that_leaves_within_a_command_is_no_success(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def leave(_: object) -> int:
        raise SystemExit(0)

    monkeypatch.setattr("orchestrator.commands.list.run", leave)
    assert main(["list"]) == 2
    assert capsys.readouterr().err == "apa: code of a model, or of a study, ended the program (SystemExit: 0)\n"
