"""``apa new``: what it makes runs at once, is tested, and can be shipped."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from orchestrator.cli import main

KINDS = ["controller", "vehicle"]
ONE_ON_EACH_CHANGE = ["controller", pytest.param("vehicle", marks=pytest.mark.release)]


@pytest.fixture
def made(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A package of the kind asked for, in the current folder."""
    monkeypatch.chdir(tmp_path)
    name = f"my_{request.param}"
    assert main(["new", request.param, name]) == 0
    return name


@pytest.mark.parametrize("made", KINDS, indirect=True)
def test_what_it_makes_runs_at_once_and_takes_its_parameters(made: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", f"{made}/scenario.yaml", "--json", "--no-page"]) == 0
    printed = capsys.readouterr()
    assert "warning" not in printed.err
    summary = json.loads(printed.out)
    used = {item["name"]: item for item in summary["fmus"]}[made.removeprefix("my_")]
    assert used["kind"] == "foreign"
    assert Path(used["path"]).name == f"{made.title().replace('_', '')}.fmu"
    changed = {"my_controller": "controller.turn=40deg", "my_vehicle": "vehicle.driver_speed=0.3"}[made]
    before, before_speed = summary["final"]["x"], summary["max_speed"]
    main(["run", f"{made}/scenario.yaml", "--json", "--no-page", "--set", changed])
    summary = json.loads(capsys.readouterr().out)
    assert (summary["final"]["x"], summary["max_speed"]) != (before, before_speed)


@pytest.mark.release
@pytest.mark.parametrize("made", KINDS, indirect=True)
def test_its_tests_pass_and_its_readme_is_true(made: str) -> None:
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-n0", made]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    lines = [line.split("  ")[0].split() for line in Path(made, "README.md").read_text().splitlines() if "apa " in line]
    lines = [words for words in lines if words[:1] == ["apa"]]
    assert len(lines) == 6
    for words in lines:
        assert main(words[1:]) in (0, 1), words
    assert Path("build/native").is_dir()


@pytest.mark.parametrize("made", ONE_ON_EACH_CHANGE, indirect=True)
def test_a_model_may_stand_in_the_place_of_ours(made: str) -> None:
    kind = made.removeprefix("my_")
    words = ["test", "guo2015-case4", f"--{kind}", f"{made}:MODEL", "--quiet"]
    assert main(words) in (0, 1)
    assert json.loads(Path("runs/test/guo2015-case4/summary.json").read_text())["fmus"][0]["name"] == "vehicle"


@pytest.mark.parametrize("made", ["controller"], indirect=True)
def test_a_mistake_in_the_model_is_told_with_its_line(made: str, capsys: pytest.CaptureFixture[str]) -> None:
    law = Path(made, "law.py")
    law.write_text(law.read_text().replace("    waited = ", "    print(state)\n    waited = "))
    assert main(["run", f"{made}/scenario.yaml", "--fmus", "none"]) == 2
    assert "law.py:" in capsys.readouterr().err


@pytest.mark.parametrize("made", ["controller"], indirect=True)
def test_a_name_that_is_taken_is_refused(made: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "controller", made]) == 2
    assert "is there already" in capsys.readouterr().err
    for name in ("my-law", "json", "modelkit", "1st", "class"):
        assert main(["new", "vehicle", name]) == 2
        assert f"{name}: is no name for a package" in capsys.readouterr().err


def test_the_templates_say_what_they_lack_together(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for kind in ("controller", "vehicle"):
        assert main(["new", kind, f"my_{kind}"]) == 0
    capsys.readouterr()
    pair = ["--controller", "my_controller:MODEL", "--vehicle", "my_vehicle:MODEL"]
    assert main(["run", "guo2015-case4", *pair, "--no-page", "--set", "stop_time=1"]) == 1
    lines = capsys.readouterr().err.splitlines()
    assert "apa: note: unconnected inputs of vehicle (start values are used): prompt" in lines
    assert "apa: warning: outputs of controller that no input takes: speed_control_active, speed_request" in lines


def test_a_scenario_and_a_study_run_without_warnings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", "scenario", "my-slot"]) == 0
    assert main(["new", "study", "my-study", "--scenario", "my-slot.yaml", "--out", "studies"]) == 0
    assert main(["new", "study", "case4"]) == 0
    capsys.readouterr()
    short = ["--fmus", "none", "--no-page", "--set", "stop_time=0.5"]
    assert main(["run", "my-slot.yaml", *short]) == 1
    for study in ("studies/my-study.yaml", "case4.yaml"):
        assert main(["sweep", study, "--stride", "12", *short]) == 0
    assert main(["replay", "runs/my-study/my-study.parquet", "--row", "0", "--no-page"]) == 1
    assert "warning" not in capsys.readouterr().err
    assert main(["new", "scenario", "my-slot.yaml"]) == 2
    assert "my-slot.yaml: is there already" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["scenario"], "NAME: is missing"),
        (["controller"], "NAME: is missing"),
        (["study", "a/b"], "a/b: is no name for a file"),
        (["scenario", "x", "--scenario", "guo2015-case4"], "--scenario: needs --controller, --vehicle or --fmu"),
        (["study", "x", "--controller", "their.fmu"], "--controller: is not for apa new study"),
        (["ci", "x", "--scenario", "x.yaml"], "--scenario: needs --fmu"),
        (["scenario", "--controller", "their.fmu"], "their.fmu: no such file"),
        (["study", "x", "--scenario", "guo2015-cse4"], "guo2015-case4"),
    ],
)
def test_options_that_do_not_fit_are_bad_input(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", *words]) == 2
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
