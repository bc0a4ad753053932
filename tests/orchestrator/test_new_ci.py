"""``apa new ci``: the pipelines it writes are what the servers read, and their lines do what they say."""

import os
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml
from packaging.requirements import Requirement

from orchestrator.cli import main
from tests.orchestrator import foreign_fmus

ROOT = Path(__file__).parents[2]
NAME = "my_controller"
INSTALL = 'python -m pip install pytest "$APA_COSIM"'
PIPELINES = ["github", "gitlab"]


@pytest.fixture
def pushed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with a user's controller and both pipelines."""
    monkeypatch.chdir(tmp_path)
    assert main(["new", "controller", NAME]) == 0
    assert main(["new", "ci", NAME]) == 0
    return tmp_path


def read(server: str) -> tuple[list[str], dict[str, str], list[str]]:
    """Return the lines that a server runs, its variables, and the paths it keeps whatever happens."""
    if server == "github":
        job = yaml.safe_load(Path(f".github/workflows/{NAME}.yml").read_text())["jobs"]["test"]
        lines = [step["run"] for step in job["steps"] if "run" in step]
        kept = [step["with"]["path"] for step in job["steps"] if step.get("if") == "always()"]
        return lines, job["env"], kept
    job = yaml.safe_load(Path(".gitlab-ci.yml").read_text())["test"]
    artifacts = job["artifacts"]
    assert artifacts["when"] == "always"
    kept = [*artifacts["paths"], *artifacts["reports"]["junit"]]
    return job["before_script"] + job["script"], job["variables"], kept


def shell(lines: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run lines as the servers do, in one shell that ends at the first that fails; what is installed is there."""
    tools = folder / "tools"
    tools.mkdir(exist_ok=True)
    for tool, module in {"apa": "orchestrator", "pytest": "pytest -p no:cacheprovider"}.items():
        file = tools / tool
        file.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m {module} "$@"\n')
        file.chmod(0o755)
    path = {"PATH": f"{tools}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
    words = ["bash", "-eo", "pipefail", "-c", "\n".join(lines)]
    return subprocess.run(words, cwd=folder, env={**os.environ, **path}, capture_output=True, text=True, check=False)


@pytest.mark.release
@pytest.mark.parametrize("server", PIPELINES)
def test_its_lines_pass_and_leave_what_is_kept(server: str, pushed: Path) -> None:
    lines, variables, kept = read(server)
    assert lines[0] == INSTALL
    done = shell(lines[1:], pushed)
    assert done.returncode == 0, done.stdout + done.stderr
    assert all((pushed / path).exists() for path in kept)
    for file in ("results/pytest.xml", "results/apa.xml"):
        suites = ElementTree.parse(pushed / file).getroot()
        assert sum(1 for _ in suites.iter("testcase")) >= 3
        assert not list(suites.iter("failure"))
    assert (pushed / "build/native/MyController.fmu").is_file()
    assert Requirement(variables["APA_COSIM"]).name == "apa-cosim"


@pytest.mark.release
@pytest.mark.parametrize("server", PIPELINES)
def test_a_law_that_is_wrong_ends_them_and_the_results_are_there(server: str, pushed: Path) -> None:
    law = pushed / NAME / "law.py"
    text = law.read_text()
    assert "-params.wheel" in text
    law.write_text(text.replace("-params.wheel", "params.wheel"))
    lines, _, _ = read(server)
    test, ship = lines[2:]
    done = shell([test, ship], pushed)
    assert done.returncode == 1
    assert list(ElementTree.parse(pushed / "results/apa.xml").getroot().iter("failure"))
    assert not (pushed / "build").exists()


def test_what_they_install_is_what_this_is(pushed: Path) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    for server in PIPELINES:
        asked = Requirement(read(server)[1]["APA_COSIM"])
        assert asked.name == project["name"]
        assert asked.extras <= set(project["optional-dependencies"])


def test_what_is_there_stays(pushed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "ci", NAME]) == 2
    assert "is there already" in capsys.readouterr().err


@pytest.mark.parametrize("server", PIPELINES)
def test_the_pipelines_of_an_fmu_check_it_and_run_its_scenario(
    server: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    foreign_fmus.controller(tmp_path).rename(f"{NAME}.fmu")
    assert main(["new", "ci", "--fmu", f"{NAME}.fmu"]) == 0
    assert f"{NAME}.yaml" in capsys.readouterr().out
    lines, variables, kept = read(server)
    assert lines[0] == 'python -m pip install "$APA_COSIM"'
    assert lines[1:] == [
        f"apa fmu check {NAME}.fmu --scenario {NAME}.yaml",
        f"apa test {NAME}.yaml --junit results/apa.xml --out results --trust",
    ]
    assert Requirement(variables["APA_COSIM"]).name == "apa-cosim"
    for line in lines[1:]:
        assert main(shlex.split(line)[1:]) in (0, 1)
    assert all(Path(path).exists() for path in kept)
    assert main(["new", "ci", "--fmu", f"{NAME}.fmu"]) == 2
