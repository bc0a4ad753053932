"""The command line: exit codes, JSON, plain text where nobody looks, and nothing but one line for a mistake."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from orchestrator.cli import main
from orchestrator.log.read_log import read_log

DEMO = str(Path(__file__).with_name("demo.yaml"))
PNG = b"\x89PNG\r\n"


def test_a_parked_run_writes_log_figure_and_summary(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "räum 1"
    assert main(["run", DEMO, "--fmus", "none", "--out", str(out), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert printed["outcome"] == "parked"
    assert printed["events"][-1]["to"] == "PARKED"
    assert (out / "overview.png").read_bytes().startswith(PNG)
    assert read_log(out / "run.mcap").t[-1] == printed["duration"]


def test_not_parked_is_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["run", DEMO, "--fmus", "none", "--out", str(tmp_path), "--no-figure"]
    assert main([*arguments, "--set", "stop_time=1"]) == 1
    printed = capsys.readouterr().out
    assert "not_parked: stop time reached in" in printed
    assert "\x1b" not in printed
    assert not (tmp_path / "overview.png").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "guo2015-case44"], "apa: guo2015-case44: no scenario of this name; did you mean"),
        (["run", DEMO, "--fmus", "none", "--set", "vehicle.wheelbas=3"], "apa: --set: vehicle.wheelbas: unknown"),
        (["run", DEMO, "--fmus", "none", "--set", "faults=[{signal: vehicle.spee, kind: freeze}]"], "no signal 'spee'"),
        (["recover", "nowhere.mcap.part"], "apa: nowhere.mcap.part: no such file"),
    ],
)
def test_bad_input_is_two_and_one_line(
    arguments: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = ["--out", str(tmp_path)] if arguments[0] == "run" else []
    assert main([*arguments, *more]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert message in captured.err
    assert captured.err.count("\n") == 1


def test_unknown_commands_and_kinds_are_two(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (["rum"], [], ["run", DEMO, "--fmus", "stone"]):
        with pytest.raises(SystemExit) as caught:
            main(arguments)
        assert caught.value.code == 2
    capsys.readouterr()


def test_help_shows_examples(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (["--help"], ["run", "--help"], ["recover", "--help"]):
        with pytest.raises(SystemExit) as caught:
            main(arguments)
        assert caught.value.code == 0
        assert "  apa " in capsys.readouterr().out


def test_list_names_every_scenario(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    names = {item["name"] for item in data["scenarios"]}
    assert {"guo2015-case4", "guo2015-case4-105"} <= names
    assert main(["list"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in names)


def test_no_colours_in_a_pipe(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "orchestrator", "run", DEMO, "--fmus", "none", "--out", str(tmp_path)]
    environment = {**os.environ, "TERM": "xterm-256color"}
    environment.pop("FORCE_COLOR", None)
    done = subprocess.run(
        [*command, "--no-figure", "--set", "stop_time=1"], capture_output=True, text=True, env=environment, check=False
    )
    assert done.returncode == 1, done.stderr
    assert "\x1b" not in done.stdout + done.stderr
    assert "final heading" in done.stdout


def test_a_slave_that_fails_aborts_and_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from orchestrator.cosim.model_slave import ModelSlave
    from orchestrator.text.errors import RunError

    def step(self: ModelSlave, t_ns: int, dt_ns: int) -> None:
        if t_ns >= 500_000_000:
            raise RunError(f"{self.name} failed at 0.5 s [mark]")

    monkeypatch.setattr(ModelSlave, "step", step)
    assert main(["run", DEMO, "--fmus", "none", "--out", str(tmp_path), "--no-figure"]) == 1
    assert "aborted: error: vehicle failed at 0.5 s [mark]" in capsys.readouterr().out
    found = read_log(tmp_path / "run.mcap")
    assert found.t[-1] == 0.5
    assert json.loads((tmp_path / "summary.json").read_text())["outcome"] == "aborted"


def test_a_slave_that_does_not_start_aborts_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from orchestrator.cosim.model_slave import ModelSlave
    from orchestrator.text.errors import RunError

    def initialize(self: ModelSlave, stop_ns: int) -> None:
        raise RunError(f"{self.name} refuses to initialize")

    monkeypatch.setattr(ModelSlave, "initialize", initialize)
    assert main(["run", DEMO, "--fmus", "none", "--out", str(tmp_path)]) == 1
    assert "aborted: error: vehicle refuses to initialize" in capsys.readouterr().out
    assert len(read_log(tmp_path / "run.mcap").t_ns) == 0
