"""``apa fmu check``: what is to be known of an FMU before any run."""

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from fmus.python.fmu import build
from orchestrator.cli import main
from orchestrator.inputs.scenario.models import MODELS
from tests.orchestrator import bad_fmus, c_fmus, foreign_fmus


def report(capsys: pytest.CaptureFixture[str], *words: str, code: int) -> dict[str, Any]:
    assert main(["fmu", "check", *words, "--json"]) == code
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert found["ready"] is (code == 0)
    return found


def test_our_own_is_ready_as_what_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, model in MODELS.items():
        found = report(capsys, str(build(model, tmp_path)), code=0)
        assert found["place"] == name
        assert found["no_unit"] == found["missing"] == found["problems"] == found["not_understood"] == []
    assert "steering_wheel_angle <- vehicle.steering_wheel_angle" in found["connected"]
    assert "prompt -> vehicle.prompt" in found["connected"]


def test_one_with_names_of_its_own(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fmu = c_fmus.two_arcs(tmp_path)
    found = report(capsys, str(fmu), code=1)
    assert (found["place"], found["connected"]) == ("controller", [])
    assert found["not_fed"][0] == "Yaw"
    assert "vehicle.steering_wheel_request" in found["not_fed"]
    assert found["not_understood"] == ["StrWhlAngReq", "VehSpdReq", "State", "Moves"]
    assert found["no_unit"] == ["Yaw"]
    assert found["missing"][0].startswith("phase: PARKED (9) of it says that the task is done")
    assert found["about"]["FMI"] == "2.0"
    shutil.copy(c_fmus.THEIR / "two_arcs.yaml", tmp_path)
    found = report(capsys, str(fmu), "--scenario", str(tmp_path / "two_arcs.yaml"), code=0)
    assert "Yaw <- vehicle.odometry.heading (converted)" in found["connected"]
    assert found["not_fed"] == found["no_unit"] == []


def test_a_misspelled_name_and_a_unit_that_does_not_fit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wrong = foreign_fmus.controller(tmp_path, request="steering_request")
    found = report(capsys, str(wrong), "--as", "controller", code=1)
    assert found["missing"] == ["manoeuvres: limits on the number of manoeuvres are not evaluated"]
    assert "vehicle.steering_wheel_request; did you mean steering_request?" in found["not_fed"]
    assert found["no_unit"] == ["measured_speed", "steering_request"]
    metres = foreign_fmus.changed(
        wrong, tmp_path / "metres.fmu", lambda text: text.replace('name="steering_request"', 'name="speed_request"')
    )
    text = '<Real unit="deg" '
    metres = foreign_fmus.changed(metres, tmp_path / "deg.fmu", lambda found: found.replace("<Real ", text))
    (said,) = report(capsys, str(metres), "--as", "controller", "--no-load", code=1)["problems"]
    assert "in deg" in said
    assert "units are converted" in said


@pytest.mark.parametrize(
    ("guid", "said"),
    [
        ("load-crash", "controller crashed while loading"),
        ("step-crash", ""),
        ("initialize-error", "the tank is empty"),
        ("start-hang", "took more than 0.5 s in initialization"),
    ],
)
def test_what_does_not_load_is_said(guid: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    timeout = "500 ms" if guid == "start-hang" else "30 s"
    words = str(bad_fmus.behaving(tmp_path, guid)), "--as", "controller", "--timeout", timeout
    problems = report(capsys, *words, code=1)["problems"]
    assert (said in problems[0]) if said else problems == []
    assert report(capsys, *words, "--no-load", code=1)["problems"] == []


def test_what_is_no_fmu_is_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good = foreign_fmus.controller(tmp_path)
    for name, (path, said) in foreign_fmus.broken(good, tmp_path).items():
        code = main(["fmu", "check", str(path)])
        printed = capsys.readouterr()
        assert code == (1 if name in ("no binary", "other type") else 2), name
        assert said in " ".join((printed.err, *printed.out.split())) or said.split("(")[0] in printed.out, name
    assert main(["fmu", "check", str(good), "--as", "gps"]) == 2
    assert "--as: gps is neither vehicle nor controller" in capsys.readouterr().err
    with pytest.raises(SystemExit, match="2"):
        main(["fmu", "check", str(good), "--timeout", "never"])


def test_one_that_nothing_connects_is_sent_to_the_command_that_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    c_fmus.two_arcs(tmp_path)
    c_fmus.plant(tmp_path)
    advice = "apa new scenario --controller two_arcs.fmu writes its connections"
    assert main(["fmu", "check", "two_arcs.fmu"]) == 1
    assert f"next: {advice}" in capsys.readouterr().out
    words = ["run", "guo2015-case4", "--fmus", "none", "--no-page", "--set", "stop_time=0.1"]
    assert main([*words, "--controller", "two_arcs.fmu"]) == 1
    assert f"no output of controller is connected to vehicle, so nothing drives it; {advice}" in capsys.readouterr().err
    assert main([*words, "--vehicle", "plant.fmu"]) in (1, 2)
    assert "apa new scenario --vehicle plant.fmu writes its connections" in capsys.readouterr().err
    assert main(["fmu", "check", "plant.fmu", "--no-load", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["place"] == "vehicle"
