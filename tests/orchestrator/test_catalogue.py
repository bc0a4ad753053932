"""What standards ask, as data: entries that name what tests them, and verdicts that follow from the runs."""

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

from orchestrator.cli import main
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.files import LIBRARY
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.requirements import Requirement
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BAD_INPUT, BadInput
from orchestrator.session.foreign import ImportedFmus, load_bound_scenario
from orchestrator.session.session import Messages, make_instances, run_scenario
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_beside, fmu_files
from orchestrator.testing.catalogue.entries import (
    STEP_TESTS,
    Clause,
    is_catalogue,
    read_standard,
    select_standards,
)
from orchestrator.testing.catalogue.run import Catalogue, judge_standards
from orchestrator.testing.catalogue.show import markdown
from orchestrator.testing.catalogue.verdicts import ClauseRun, ClauseVerdict, counts, note, runs_of, suites, verdicts_of
from orchestrator.testing.suite import suite
from orchestrator.testing.suite.junit import Case
from orchestrator.testing.suite.suite import SuiteConfig
from tests.docs.scripts import DOCS, script

EVERYTHING = verdicts_of(select_standards(["catalogue"]))
compiled = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")


def page() -> str:
    return (DOCS / "tables" / "catalogue.md").read_text(encoding="utf-8")


def test_every_standard_asked_for_is_there() -> None:
    words = " ".join(item.standard.standard for item in EVERYTHING)
    for name in ("ISO 16787", "ISO 20900", "ISO 23374-1", "GB/T 41630", "GB/T 47031", "C-ICAP", "UN R79", "Euro NCAP"):
        assert name in words
    assert len(EVERYTHING) > 60
    assert sum(bool(item.entry.scenarios) for item in EVERYTHING) > 45


def test_every_step_test_and_every_scenario_made_for_it_is_used() -> None:
    scenarios, tests = runs_of(EVERYTHING)
    assert {path.stem for path in STEP_TESTS.glob("*.yaml")} == set(tests)
    assert {path.stem for path in (LIBRARY / "scenarios").glob("cicap-*.yaml")} <= set(scenarios)


@pytest.mark.parametrize("item", EVERYTHING, ids=lambda item: f"{item.standard.key}-{item.entry.id}")
def test_documentation_has_every_entry_as_it_is(item: ClauseVerdict) -> None:
    by = ", ".join(f"`{name}`" for name in (*item.entry.scenarios, *item.entry.step_tests)) or item.entry.not_tested
    start = f"| {item.entry.clause} | {item.entry.text} | {item.entry.sure} | "
    lines = [line for line in page().splitlines() if line.startswith(start) and line.endswith(f" | {by} |")]
    assert lines, start
    assert ("not tested" in lines[0]) == bool(item.entry.not_tested)


def test_limits_that_say_who_asks_say_it_of_the_standard_that_names_them() -> None:
    """A number belongs to the standard it is from, or to nobody: then it is ours."""
    for item in EVERYTHING:
        for limit in item.entry.limits_to_keep():
            source = limit.source.removesuffix(", unverified")
            own = source == "project" or item.standard.standard.startswith(source)
            assert own or item.standard.key.startswith("cicap"), (item.entry.id, limit.id, limit.source)


def entry(**given: object) -> Clause:
    return Clause.model_validate({"id": "it", "text": "Something.", "sure": "text", **given})


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({}, "either what tests it"),
        ({"scenarios": ["apa-parallel"], "not_tested": "no"}, "either what tests it"),
        ({"scenarios": ["apa-parallel"]}, "an outcome or limits"),
        ({"scenarios": ["apa-paralel"], "outcome": ["parked"]}, "did you mean apa-parallel"),
        ({"step_tests": ["ded-sensor"]}, "did you mean dead-sensor"),
        ({"scenarios": ["apa-parallel"], "requirements": {"gbt4163": "all"}}, "did you mean gbt41630"),
        ({"scenarios": ["apa-parallel"], "requirements": {"gbt41630": ["manoeuvre"]}}, "did you mean manoeuvres"),
        ({"scenarios": ["apa-parallel"], "outcome": ["lost"]}, "Input should be"),
    ],
)
def test_an_entry_that_cannot_be_is_refused(given: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        entry(**given)


def test_a_mistake_in_a_file_is_told_with_its_place(tmp_path: Path) -> None:
    one = {"id": "it", "text": "T", "sure": "text", "not_tested": "no"}
    content = {"standard": "S", "title": "T", "source": "s", "entries": [one]}
    file = tmp_path / "s.yaml"
    for change, said in (
        ({}, ""),
        ({"entries": [one, one]}, "two entries of this name"),
        ({"titel": "T"}, "did you mean title"),
        ({"entries": [{**one, "sure": "very"}]}, "s.yaml:"),
    ):
        file.write_text(yaml.safe_dump({**content, **change}))
        if not said:
            assert read_standard(file).key == "s"
            continue
        with pytest.raises(BadInput, match=said):
            read_standard(file)


OTHER = "apa-perpendicular"


def tried(*missed: str, name: str = "apa-parallel", unmeasured: tuple[str, ...] = (), error: str = "") -> ClauseRun:
    return ClauseRun(name, "parked", list(missed), list(unmeasured), error=error)


@pytest.mark.parametrize(
    ("runs", "word", "why"),
    [
        ([], "not tested", "not run"),
        ([tried()], "not tested", "not run"),
        ([tried(), tried(name=OTHER)], "met", "apa-parallel, apa-perpendicular"),
        ([tried("fast"), tried(name=OTHER)], "missed", "apa-parallel: fast"),
        ([tried(error="crashed"), tried(name=OTHER)], "missed", "apa-parallel: crashed"),
        (
            [tried(), tried(name=OTHER, unmeasured=("a",))],
            "not tested",
            "apa-perpendicular: not measured: a",
        ),
        ([tried("fast"), tried(name=OTHER, unmeasured=("a",))], "missed", "apa-parallel: fast"),
    ],
)
def test_verdicts(runs: list[ClauseRun], word: str, why: str) -> None:
    asked = entry(scenarios=["apa-parallel", "apa-perpendicular"], outcome=["parked"])
    found = ClauseVerdict(EVERYTHING[0].standard, asked, runs)
    assert (found.word, found.why) == (word, why)
    (of_standard,) = suites([found])
    (case,) = of_standard.cases
    assert (case.passed, case.skipped) == (word == "met", word == "not tested")


def test_what_a_step_test_cannot_ask_of_an_fmu_is_not_tested() -> None:
    asked = [ClauseVerdict(EVERYTHING[0].standard, entry(step_tests=["dead-sensor"]), []) for _ in range(3)]
    test = Scenario(name="dead-sensor")
    note(asked[:1], suite.SuiteResult(test, None, None, [], [], "no such input", code=BAD_INPUT))
    note(asked[1:2], suite.SuiteResult(test, None, None, [Case("a", False, "late")], []))
    note(asked[2:], suite.SuiteResult(test, None, None, [Case("a", True, "in time")], []))
    assert [item.word for item in asked] == ["not tested", "missed", "met"]


def test_a_state_that_a_controller_has_not_is_not_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    """The other limits of the entry, and contact, are judged."""
    scenario = load_scenario("guo2015-case4", ["stop_time=0.1"])
    ran = run_scenario(scenario)
    summary = summarize(ran.recording, scenario, 0.0)
    limits = [
        Requirement(id="taken over", signal="controller.phase", equals="NOWHERE", source="S"),
        Requirement(id="slow", signal="vehicle.speed", max_abs=3.0, source="S"),
    ]
    monkeypatch.setattr(Clause, "limits_to_keep", lambda self: limits)
    asked = [ClauseVerdict(EVERYTHING[0].standard, entry(scenarios=[scenario.name], outcome=["not_parked"]), [])]
    note(asked, suite.SuiteResult(scenario, summary, ran.recording, [], []))
    assert asked[0].word == "not tested", asked[0].why
    assert "'NOWHERE' is no state" in asked[0].why
    assert [check.id for check in asked[0].tried[0].checks] == ["slow", scenario.contact_rule.id]


def test_words_of_the_command() -> None:
    assert [is_catalogue(word) for word in ("catalogue", "catalogue/gbt*", "catalogue.yaml")] == [True, True, False]
    assert [item.key for item in select_standards(["catalogue/gbt*", "catalogue/gbt41630"])] == ["gbt41630", "gbt47031"]
    with pytest.raises(BadInput, match="did you mean unr79"):
        select_standards(["catalogue/unr97"])


@pytest.mark.parametrize("words", [["catalogue", "guo2015-case4"], ["catalogue", "--coverage"], ["catalogue/nothing"]])
def test_what_the_command_refuses(words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["test", *words, "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err


@compiled
def test_the_command_says_it_as_text_json_junit_and_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    words = ["test", "catalogue/gbt47031", "catalogue/euroncap", "--out", str(out)]
    assert main(words) == 1
    printed = capsys.readouterr().out
    assert "gear at the end" in printed
    assert "apa-parallel: gear P at the end: vehicle.gear: DRIVE" in " ".join(printed.split())
    root = ElementTree.parse(out / "junit.xml").getroot()
    assert [suite.get("name") for suite in root] == ["GB/T 47031-2026", "Euro NCAP"]
    assert root.find(".//testcase[@name='4.2.1: gear at the end']/failure") is not None
    assert root.find(".//testcase[@name='4.2.1: brake at the end']/system-out") is not None
    assert root.find(".//testcase[@name='4.1.1: class']/skipped") is not None
    text = (out / "index.html").read_text(encoding="utf-8")
    assert '<a href="apa-parallel/report.html">' in text
    assert (out / "apa-parallel" / "report.html").is_file()
    assert main(["test", "catalogue/cicap-b2", "--json", "--out", str(out)]) == 0
    found = json.loads(capsys.readouterr().out)
    rows = {row["id"]: row for row in found["entries"]}
    assert rows["pedestrian crosses"]["verdict"] == "met"
    assert rows["pedestrian crosses"]["runs"][0]["name"] == "valet-pedestrian"
    assert rows["cruising"]["verdict"] == "not tested"
    assert sum(found["counts"].values()) == len(found["entries"])


@compiled
@pytest.mark.release  # drives three catalogues; tests/golden drives all scenarios
def test_nothing_missed_is_exit_code_0_and_documentation_says_the_same(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["test", "catalogue/iso20900", "--out", str(tmp_path / "out")]) == 0
    assert "0 missed" in capsys.readouterr().out
    bench = SuiteConfig(fmu_files("native", lambda text: None), "native", ImportedFmus(), [], Interrupt())
    for name in ("iso16787", "cicap-b1"):
        assert markdown(judge_standards([f"catalogue/{name}"], bench, tmp_path / name)) in page()


@compiled
def test_a_third_party_controller_shows_what_the_controller_of_the_scenario_shows() -> None:
    """Its local variables too, which requirements name."""
    parking = load_scenario("apa-parallel-tight").models["controller"]
    own = fmu_beside(fmu_files("native", lambda text: None)["controller"], parking)
    foreign = ImportedFmus({"controller": own}, is_in_process=True)
    scenario = load_bound_scenario("apa-parallel-tight", [], foreign).scenario
    instances = make_instances(scenario, None, Messages(), foreign)
    try:
        shown = next(item for item in instances if item.name == "controller").outputs.names
        assert {"phase", "apa.parking_time", "apa.slot.type"} <= set(shown)
    finally:
        for instance in instances:
            instance.close()


@pytest.mark.release
@compiled
def test_a_third_party_controller_is_judged_by_what_it_puts_out(tmp_path: Path) -> None:
    """Our own as a foreign FMU meets what it meets otherwise; one that crashes misses what it is run for."""
    catalogue = Catalogue(["catalogue/iso16787"])
    parking = load_scenario("apa-parallel-tight").models["controller"]
    own = fmu_beside(fmu_files("native", lambda text: None)["controller"], parking)
    foreign = ImportedFmus({"controller": own})
    bench = SuiteConfig(fmu_files("native", lambda text: None), "native", foreign, [], Interrupt())
    catalogue.run([], bench, tmp_path, 1, lambda code: None)
    assert counts(catalogue.verdicts) == {"met": 4, "missed": 0, "not tested": 2}  # a step test chooses the system
    assert catalogue.code() == 0


def test_documentation_is_written_by_the_file_that_it_names() -> None:
    assert page().count("<!-- catalogue -->") == page().count("<!-- /catalogue -->") == 1
    assert callable(script("catalogue").tables)


def test_scenarios_of_the_catalogue_are_what_they_say() -> None:
    for name in ("apa-not-confirmed", "apa-switched-off", "apa-search-too-fast"):
        assert load_scenario(name).expected_outcome != "parked"
