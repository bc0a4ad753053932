"""Verdict and files do not depend on the output: closed pipes, notebook backends, failing pages."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from fmus.installation import install_command
from orchestrator.cli import main

ROOT = Path(__file__).parents[2]
posix = pytest.mark.skipif(os.name != "posix", reason="pipes are those of POSIX")
SHORT_RUN = ("run", "fault-pose-frozen", "--fmus", "none", "--set", "stop_time=0.5")


@posix
def test_a_run_into_a_closed_pipe_with_a_notebook_backend_is_complete(tmp_path: Path) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "MPLBACKEND": "module://absent_package.backend"}
    command = [sys.executable, "-m", "orchestrator", *SHORT_RUN, "--out", str(tmp_path)]
    done = subprocess.run(command, env=environment, stdout=writer, stderr=subprocess.PIPE, text=True)
    os.close(writer)
    assert done.stderr == ""
    assert done.returncode == 1  # the verdict: not parked after half a second
    assert json.loads((tmp_path / "summary.json").read_text())["outcome"]
    assert (tmp_path / "overview.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "report.html").is_file()


def test_a_page_that_fails_leaves_verdict_and_exit_code(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def broken(*_: object) -> None:
        raise KeyError("page")

    monkeypatch.setattr("orchestrator.presentation.report.replay.write_replay", broken)
    monkeypatch.setattr("platformdirs.user_log_path", lambda *_, **__: tmp_path / "errors")
    assert main([*SHORT_RUN, "--out", str(tmp_path)]) == 1
    text = capsys.readouterr()
    assert f"{tmp_path / 'report.html'} was not made, the verdict stands: KeyError" in text.err
    assert f"results in {tmp_path}" in text.out
    assert len(list((tmp_path / "errors").iterdir())) == 1


@pytest.mark.parametrize(
    ("receipt", "start"), [("pipx_metadata.json", "pipx install --force"), ("uv-receipt.toml", "uv tool install")]
)
def test_tools_in_environments_of_their_own_get_their_own_command(
    receipt: str, start: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / receipt).touch()
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    assert install_command("native").startswith(start)
    assert "[native]" in install_command("native")


def test_pip_is_called_by_the_interpreter_that_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fmus.installation.distribution", _distribution(None))
    assert install_command("native,sweep").endswith("-m pip install 'apa-cosim[native,sweep]'")
    editable = '{"url": "file:///home/someone/apa%20cosim", "dir_info": {"editable": true}}'
    monkeypatch.setattr("fmus.installation.distribution", _distribution(editable))
    assert install_command("sweep").endswith("-m pip install -e '/home/someone/apa cosim[sweep]'")


def _distribution(text: str | None) -> Any:
    class Installed:
        def read_text(self, _name: str) -> str | None:
            return text

    return lambda _name: Installed()
