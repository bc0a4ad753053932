"""``apa build``: kinds, versions, platforms, compilers, and what is said when it cannot be done."""

import json
import shutil
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any

import pytest

from fmus.installation import install_command
from fmus.native import fmu as native_fmu
from fmus.native.platforms import host
from orchestrator.cli import main


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> Any:
    """What is asked of the FMU maker; nothing is built."""
    calls = []

    def build(model: Any, out_dir: Any, platforms: Any, compiler: Any, fmi: Any) -> Any:
        calls.append((model.name, out_dir.name, sorted(platforms), compiler.is_zig, fmi))
        out_dir.mkdir(parents=True, exist_ok=True)
        path = out_dir / f"{model.name}.fmu"
        path.write_bytes(b"")
        return path

    monkeypatch.setattr(native_fmu, "build", build)
    monkeypatch.delenv("CC", raising=False)
    return calls


def test_platforms_are_named_with_commas_or_again(asked: Any, tmp_path: Path) -> None:
    base = ["build", "--fmus", "native", "--out", str(tmp_path)]
    assert main([*base, "--platform", "win64,linux64", "--platform", "aarch64-linux"]) == 0
    assert asked[0] == ("Controller", "native", ["aarch64-linux", "linux64", "win64"], True, 2)
    assert main([*base, "--platform", "all"]) == 0
    assert asked[-1][2] == ["aarch64-linux", "darwin64", "linux64", "win64"]


def test_fmi_3(asked: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", "--fmi", "3", "--out", str(tmp_path), "--json"]) == 0
    assert asked[-1] == ("Vehicle", "fmi3", [host()], True, 3)
    assert [row["kind"] for row in json.loads(capsys.readouterr().out)] == ["fmi3", "fmi3"]
    assert main(["build", "--fmi", "3", "--fmus", "python"]) == 2
    assert "PythonFMUs are FMI 2.0" in capsys.readouterr().err


def test_a_compiler_by_name_or_by_the_variable_cc(
    asked: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    base = ["build", "--fmus", "native", "--out", str(tmp_path)]
    assert main([*base, "--cc", "no-such-cc"]) == 2
    assert "there is no C compiler called no-such-cc" in capsys.readouterr().err
    monkeypatch.setattr(shutil, "which", lambda name: name)
    monkeypatch.setenv("CC", "true")
    assert main(base) == 0
    assert asked[-1][3] is False
    assert main([*base, "--cc", "zig"]) == 0
    assert asked[-1][3] is True


def test_without_a_compiler_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def absent(name: Any) -> None:
        raise PackageNotFoundError(name)

    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr("importlib.metadata.version", absent)
    assert main(["build", "--fmus", "native", "--out", str(tmp_path)]) == 2
    assert install_command("native") in capsys.readouterr().err


def test_what_the_compiler_says_is_passed_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CC", "false")
    assert main(["build", "--fmus", "native", "--out", str(tmp_path)]) == 2
    assert "false -std=c99" in capsys.readouterr().err
