"""The commands that give CI a verdict: exit codes, JUnit, the page over many runs, a foreign controller."""

import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import pytest

from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.session.foreign import ImportedFmus
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.testing.suite.junit import Case, Suite, write_junit
from orchestrator.testing.suite.suite import SuiteConfig, run_test, select_scenarios

RULES = """
- {id: parked at the end, signal: controller.phase, equals: PARKED, window: {at: end}, source: us}
- {id: slow into the slot, signal: vehicle.speed, max_abs: 1.0 m/s, window: {from: 6}, source: us}
- {id: never fast, signal: vehicle.speed, max_abs: 1.0 m/s, source: us, required: false}
"""


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Any:
    out = tmp_path_factory.mktemp("case4")
    main(["run", "guo2015-case4", "--fmus", "native", "--no-page", "--out", str(out)])
    return out / "run.mcap"


@pytest.fixture
def rules(tmp_path: Path) -> Any:
    file = tmp_path / "rules.yaml"
    file.write_text(RULES)
    return file


def test_check_passes_and_writes_junit(
    log: Any, rules: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    junit = tmp_path / "out" / "junit.xml"
    assert main(["check", str(log), str(rules), "gbt41630", "--junit", str(junit)]) == 0
    root: Any = ElementTree.parse(junit).getroot()
    assert (root.get("tests"), root.get("failures"), root.get("skipped")) == ("9", "0", "1")
    skipped = root.find(".//testcase[@name='never fast (us)']/skipped")
    assert "-1.500 m/s at " in skipped.get("message")
    assert "8 of 9 met" in capsys.readouterr().out


def test_check_fails_with_a_margin(log: Any, rules: Any, capsys: pytest.CaptureFixture[str]) -> None:
    rules.write_text("- {id: quick, signal: duration, max: 10 s, source: us}")
    assert main(["check", str(log), str(rules), "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["passed"] is False
    assert found["checks"][0]["margin"] == pytest.approx(10.0 - found["checks"][0]["value"])


def test_check_gives_the_verdicts_of_the_run_itself(log: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(log), "guo2015", "gbt41630", "--json"]) == 0
    checks = json.loads(capsys.readouterr().out)["checks"]
    assert checks == json.loads((log.parent / "summary.json").read_text())["checks"]


@pytest.mark.parametrize("arguments", [["nothing.mcap", "project"], ["LOG", "nothing.yaml"], ["LOG", "projekt"]])
def test_check_refuses_bad_input(log: Any, arguments: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", *(str(log) if item == "LOG" else item for item in arguments)]) == 2
    assert capsys.readouterr().err


def test_junit_holds_any_text(tmp_path: Path) -> None:
    file = tmp_path / "j.xml"
    write_junit(file, [Suite("<&\x00\x1b>", [Case('a"b', False, "\x07]]>")], 1.0), Suite("b", [], 0.0, "broken")])
    root: Any = ElementTree.parse(file).getroot()
    assert (root.get("tests"), root.get("failures"), root.get("errors")) == ("2", "1", "1")
    assert root[0].get("name") == "<&??>"


def test_patterns_choose_shipped_scenarios() -> None:
    names = select_scenarios(["guo2015-case4*", "guo2015-case4", "my.yaml"])
    assert names[0] == "guo2015-case4"
    assert names[-1] == "my.yaml"
    assert len(names) == len(set(names)) >= 5


def test_test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    names = ["guo2015-case4", "guo2015-case2", "fault-pose-nan"]
    assert main(["test", *names, "--fmus", "native", "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "pass  guo2015-case2  (2 of 3)" in printed
    assert "3 of 3 scenarios passed" in printed
    for name in names:
        assert (out / name / "report.html").is_file()
        assert (out / name / "run.mcap").is_file()
    page = (out / "index.html").read_text()
    assert page.count("<svg") == 3
    assert "3 of 3 passed" in page
    assert page.count("failed as expected, ") == 2
    root: Any = ElementTree.parse(out / "junit.xml").getroot()
    assert [suite.get("name") for suite in root] == names
    assert root.get("failures") == "0"


def test_test_command_fails_when_a_requirement_or_the_outcome_is_missed(
    tmp_path: Path, rules: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    arguments = ["test", "guo2015-case4", "--fmus", "native", "--out", str(out), "--json"]
    rules.write_text("- {id: quick, signal: duration, max: 10 s, source: us}")
    assert main([*arguments, "--requirements", str(rules)]) == 1
    found = json.loads(capsys.readouterr().out)
    assert [case["name"] for case in found["scenarios"][0]["cases"] if not case["passed"]] == ["quick (us)"]
    assert main([*arguments, "--set", "expected_outcome=failed"]) == 1
    assert "parked (expected: failed), " in (out / "index.html").read_text()
    root: Any = ElementTree.parse(out / "junit.xml").getroot()
    assert root.find(".//testcase[@name='outcome']/failure").get("message").startswith("parked")


def test_titles_of_scenarios_are_escaped_on_the_page(tmp_path: Path) -> None:
    out = tmp_path / "out"
    title = "title=<script>alert(1)</script>"
    assert main(["test", "guo2015-case4", "--fmus", "native", "--out", str(out), "--set", title]) == 0
    assert "<script" not in (out / "index.html").read_text()


def test_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["test", "guo2016-*", "--fmus", "none", "--out", str(tmp_path)]) == 2
    assert main(["test", "guo2015-case4", "--controller", "nothing.fmu", "--out", str(tmp_path)]) == 2
    assert "nothing.fmu" in capsys.readouterr().err


def test_a_foreign_controller_is_run_without_the_parameters_it_does_not_have(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = fmu_files("python")
    theirs = tmp_path / "their controller.fmu"
    theirs.write_bytes(files["controller"].read_bytes())
    monkeypatch.setattr("orchestrator.session.foreign.load_scenario", lambda name, sets, more: foreign_scenario(name))
    bench = SuiteConfig(files, "python", ImportedFmus({"controller": theirs}), [], Interrupt())
    tested = run_test("guo2015-case4", [], bench, tmp_path / "out")
    assert tested.ignored == ["controller.no_such_gain"]
    assert tested.passed


def foreign_scenario(name: Any) -> Any:
    scenario = load_scenario(name)
    return scenario.model_copy(update={"controller": {**scenario.controller, "no_such_gain": 1.0}})


def test_names_of_cases_are_unique_and_tell_the_source(tmp_path: Path, rules: Any) -> None:
    rules.write_text(
        "- {id: quick, signal: duration, max: 50 s, source: us}\n- {id: quick, signal: duration, max: 60 s, source: us}"
    )
    out = tmp_path / "out"
    arguments = ["--fmus", "native", "--out", str(out), "--requirements", str(rules), "--requirements", "gbt41630"]
    assert main(["test", "guo2015-case4", *arguments]) == 0
    names = [case.get("name") for case in ElementTree.parse(out / "junit.xml").iter("testcase")]
    assert len(names) == len(set(names)) == 19
    assert {
        "final heading (GB/T 41630)",
        "final heading (reproduction of Guo 2015)",
        "quick (us)",
        "quick (us) #2",
        "speed (GB/T 41630) #2",
    } < set(names)


def test_a_window_that_never_comes_is_said_in_words(
    tmp_path: Path, rules: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    rules.write_text("- {id: crawl, signal: vehicle.speed, max_abs: 2 km/h, window: {phase: TO_Q4}, source: us}")
    arguments = ["--fmus", "native", "--out", str(tmp_path / "out"), "--requirements", str(rules)]
    assert main(["test", "guo2015-case4", *arguments]) == 1
    printed = capsys.readouterr().out
    assert "vehicle.speed: the window never comes, required" in printed
    assert "with if_never: pass it would be met" in printed
    assert "nan" not in printed
