"""A third-party controller: connected as FMI 2.0 allows, judged by what was measured, unable to stop a test."""

import html
import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import pytest

from orchestrator.cli import main
from orchestrator.simulation.cosim.fmu_files import fmu_files
from tests.orchestrator import foreign_fmus

KINDS = ["python", "native"]


@pytest.fixture(scope="module")
def theirs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    for kind in KINDS:
        fmu_files(kind)
    return foreign_fmus.controller(tmp_path_factory.mktemp("theirs"))


def test_units_and_variability_that_are_not_said_are_no_mistake(
    theirs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["run", "guo2015-case4", "--controller", str(theirs), "--out", str(tmp_path), "--no-page"]
    assert main([*arguments, "--json", "--set", "controller.wheel=4"]) == 1
    captured = capsys.readouterr()
    summary = json.loads(captured.out)
    assert summary["final"]["x"] < -5.0
    assert summary["final"]["steering_wheel_angle"] == pytest.approx(4.0, abs=0.01)
    assert "controller says no unit of measured_speed, steering_wheel_request" in captured.err
    assert "parameters that the FMU does not have are left out: 43 of controller.car, " in captured.err
    assert "controller.system" not in captured.err


def test_its_own_parameters_are_told_from_those_nobody_has(
    theirs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["run", "guo2015-case4", "--controller", str(theirs), "--out", str(tmp_path)]
    assert main([*arguments, "--set", "controller.weel=4"]) == 2
    assert "controller.weel: unknown; did you mean controller.wheel" in capsys.readouterr().err


def test_where_it_came_from_is_in_the_summary(theirs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    main(["run", "guo2015-case4", "--controller", str(theirs), "--out", str(out), "--no-page", "--json"])
    used = {item["name"]: item for item in json.loads(capsys.readouterr().out)["fmus"]}
    assert used["controller"]["kind"] == "foreign"
    assert used["controller"]["path"] == str(theirs)
    assert len(used["controller"]["sha256"]) == 64
    assert used["vehicle"]["kind"] != "foreign"


def test_a_misspelled_output_is_said_before_the_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wrong = foreign_fmus.controller(tmp_path, request="steering_request")
    main(["run", "guo2015-case4", "--controller", str(wrong), "--out", str(tmp_path / "out"), "--no-page"])
    error = capsys.readouterr().err
    assert "unconnected inputs of vehicle (start values are used): " in error
    assert "steering_wheel_request (did you mean steering_request" in error
    assert "advised_speed, speed_control_active, " in error


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "step", ["if t > 1.0: raise ValueError('their mistake')", "return t < 1.0", "self.prompt = None if t > 1.0 else 3"]
)
def test_one_that_fails_is_a_verdict_and_the_others_go_on(
    kind: str, step: str, theirs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bad = foreign_fmus.controller(tmp_path, step=step)
    out = tmp_path / "out"
    names = ["guo2015-case4", "guo2015-case3"]
    assert main(["test", *names, "--controller", str(bad), "--fmus", kind, "--out", str(out)]) == 1
    assert "0 of 2 scenarios passed" in capsys.readouterr().out
    root: Any = ElementTree.parse(out / "junit.xml").getroot()
    assert [suite.get("name") for suite in root] == names
    assert root.get("errors") == "2"
    assert "controller " in root[0].find("testcase/error").get("message")
    assert (out / "index.html").is_file()


def test_an_fmu_that_cannot_be_run_is_one_line_and_the_others_go_on(
    theirs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, (path, text) in foreign_fmus.broken(theirs, tmp_path).items():
        out = tmp_path / path.stem
        code = main(["test", "guo2015-case4", "guo2015-case3", "--controller", str(path), "--out", str(out)])
        captured = capsys.readouterr()
        assert code in (1, 2), name
        assert captured.out.count(text) == 2, (name, captured.out)
        assert "Traceback" not in captured.err
        assert ElementTree.parse(out / "junit.xml").getroot().get("errors") == "2", name


def test_a_scenario_that_cannot_be_read_fails_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad, same = tmp_path / "bad one.yaml", tmp_path / "same.yaml"
    bad.write_text("extends: nothing-of-this-name")
    same.write_text("{name: fault-pose-nan, extends: fault-pose-frozen}")
    names = ["fault-pose-nan", str(bad), str(same)]
    assert main(["test", *names, "--fmus", "none", "--out", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr().out
    assert "pass  fault-pose-nan  (1 of 3)" in printed
    assert "no scenario of this name" in printed
    assert "another scenario of this test is called fault-pose-nan" in printed
    root: Any = ElementTree.parse(tmp_path / "out" / "junit.xml").getroot()
    assert root.get("errors") == "2"


def test_what_is_not_measured_is_never_passed(theirs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["test", "guo2015-case4", "apa-parallel", "--controller", str(theirs), "--out", str(out)]) == 1
    summary = json.loads((out / "guo2015-case4" / "summary.json").read_text())
    assert summary["manoeuvres"] is None
    check = next(item for item in summary["checks"] if item["signal"] == "manoeuvres")
    assert (check["passed"], check["evaluated"], check["value"], check["note"]) == (False, False, None, "not measured")
    assert "not measured: manoeuvres" in summary["reason"]
    parallel = json.loads((out / "apa-parallel" / "summary.json").read_text())
    assert "time to park" in parallel["reason"].partition("not measured")[2]
    root: Any = ElementTree.parse(out / "junit.xml").getroot()
    skipped = root.find("testsuite/testcase[@name='manoeuvres (GB/T 41630)']/skipped")
    assert skipped.get("message") == "manoeuvres: not measured, not evaluated"
    capsys.readouterr()
    assert main(["check", str(out / "guo2015-case4" / "run.mcap"), "gbt41630"]) == 1
    assert "1 not evaluated" in capsys.readouterr().out


def test_without_a_phase_nothing_says_parked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mute = foreign_fmus.controller(tmp_path, phase=False)
    arguments = ["--controller", str(mute), "--out", str(tmp_path / "out"), "--set", "stop_time=7", "--no-page"]
    assert main(["run", "apa-parallel", *arguments]) == 1
    captured = capsys.readouterr()
    assert "controller has no output phase: PARKED (9) of it says" in captured.err
    assert "not_parked: the controller has no output phase" in captured.out
    assert "manoeuvres not counted" in captured.out
    assert "clearance" in captured.out
    assert "not evaluated" in captured.out


def test_what_was_tested_when_and_how_is_told(theirs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out put"
    words = ["test", "guo2015-case4", "--controller", str(theirs), "--out", str(out), "--json"]
    main(words)
    about = json.loads(capsys.readouterr().out)["about"]
    assert about["controller"].startswith(f"{theirs}, SHA-256 ")
    assert "Vehicle.fmu, SHA-256 " in about["vehicle"]
    assert about["command"] == f"apa test guo2015-case4 --controller {theirs} --out '{out}' --json"
    assert about["warning"].count("controller has no output manoeuvres") == 1
    page = (out / "index.html").read_text(encoding="utf-8")
    suite = ElementTree.parse(out / "junit.xml").getroot()[0]
    assert suite.get("timestamp") == about["when"]
    reported: Any = {item.get("name"): item.get("value") for item in suite.iter("property")}
    assert {key: reported[key] for key in about} == about
    assert reported["left out"].startswith("controller.car.wheelbase, ")
    assert all(html.escape(text) in page for text in about.values())
