"""The documentation does not rot: commands parse, YAML is valid, links lead somewhere, every signal is listed."""

import importlib
import re
import shlex
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
import yaml

from modelkit.variables import variables
from orchestrator.cli import EPILOG, parser
from orchestrator.commands import COMMANDS
from orchestrator.commands.export import FORMATS
from orchestrator.evaluation.verdict.judge import Check
from orchestrator.evaluation.verdict.summary import Event, Final, FmuUsed, Summary, summarize
from orchestrator.inputs.scenario.catalogue import split_index
from orchestrator.inputs.scenario.end_condition import EndCondition
from orchestrator.inputs.scenario.fault import Fault
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import MODELS, models_for
from orchestrator.inputs.scenario.plausible import implausible
from orchestrator.inputs.scenario.requirements import Occasion, Requirement, Window, read_requirements
from orchestrator.inputs.scenario.scenario import Scenario, Slot, Target
from orchestrator.inputs.scenario.slot_layout import LayoutKerb, LayoutOrigin, Neighbours, SlotLayout
from orchestrator.session.session import run_scenario
from orchestrator.studies.sweep.study.study_file import load_study
from tests.docs.scripts import script

ROOT = Path(__file__).parents[2]
RECIPES = ("extend.md", "extend-tools.md")
"""Their commands are of what they add; ``test_extend`` runs them."""
READMES = sorted((ROOT / "controller_fmu").glob("*/README.md"))
PAGES = sorted([ROOT / "README.md", *READMES, *(ROOT / "docs").glob("*.md")], key=lambda path: str(path))


@pytest.fixture(scope="module")
def generate() -> Any:
    return script("generate")


@pytest.fixture(scope="module")
def reference(generate: Any) -> set[str]:
    """The pages that are made, as the others link to them."""
    return {f"reference/{name}" for name in generate.pages()}


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.S | re.M)


def commands() -> list[str]:
    """Return the commands in sentences of the documentation, and those in the help of every command."""
    pages = [page for page in PAGES if page.name not in RECIPES]
    texts = [text for page in pages for text in re.findall(r"`(apa [^`]+)`", page.read_text(encoding="utf-8"))]
    modules = [f"orchestrator.commands.{name}" for name in COMMANDS] + [
        f"orchestrator.presentation.export.{name}" for name in FORMATS
    ]
    examples = [line for name in modules for line in importlib.import_module(name).EXAMPLES.splitlines()]
    found = [*(" ".join(text.split()) for text in texts), *(line.strip() for line in [*examples, *EPILOG.splitlines()])]
    chosen = [re.split(r"\s{2,}|\s+[#>]", line)[0] for line in found if line.startswith("apa ")]
    return list(dict.fromkeys(chosen))


def test_there_are_commands_to_check() -> None:
    assert len(commands()) > 60


@pytest.mark.parametrize("line", commands())
def test_commands_in_the_documentation_parse(line: Any, capsys: pytest.CaptureFixture[str]) -> None:
    words = [{"N": "3"}.get(word, word) for word in shlex.split(line)[1:]]
    with suppress(SystemExit):
        parser().parse_args(words)
    error = capsys.readouterr().err
    is_only_named = "the following arguments are required" in error or "expected one argument" in error
    assert not error or is_only_named, error


def named(study: bool) -> list[str]:
    """Return the YAML blocks that begin with a name: studies have ``runs``, scenarios do not."""
    found = [block for page in PAGES for block in blocks(page, "yaml") if block.startswith("name:")]
    return [block for block in found if ("\nruns:" in block) == study]


@pytest.mark.parametrize("text", named(study=True))
def test_studies_in_the_documentation_are_valid(text: Any, tmp_path: Path) -> None:
    file = tmp_path / "study.yaml"
    file.write_text(text)
    assert load_study(str(file))[0].name == yaml.safe_load(text)["name"]


@pytest.mark.parametrize("text", named(study=False))
def test_scenarios_in_the_documentation_are_valid(text: Any, tmp_path: Path) -> None:
    file = tmp_path / "scenario.yaml"
    file.write_text(text)
    scenario = load_scenario(str(file))
    assert scenario.name == yaml.safe_load(text)["name"]
    if "expected_outcome" in text:
        summary = summarize(run_scenario(scenario).recording, scenario, 0.0)
        assert (summary.outcome, list(implausible(scenario))) == (scenario.expected_outcome, [])


def rules() -> list[str]:
    return [block for page in PAGES for block in blocks(page, "yaml") if re.match(r"- (id:|\{id:)", block)]


@pytest.mark.parametrize("text", rules())
def test_requirements_in_the_documentation_are_valid(text: Any, tmp_path: Path) -> None:
    file = tmp_path / "rules.yaml"
    file.write_text(text)
    assert read_requirements(file)


def test_both_kinds_were_found() -> None:
    assert len(named(study=False)) >= 1
    assert len(named(study=True)) >= 1
    assert len(rules()) >= 2


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_to_files(page: Any) -> None:
    """To files that are in the repository: the reference is made by ``make docs``, a link to it would be dead there."""
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
        if "://" in target:
            continue
        assert (page.parent / target).exists(), target
        assert "docs/reference" not in str((page.parent / target).resolve()), target


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS.keys())
def test_every_variable_is_in_its_reference(generate: Any, model: Any) -> None:
    text = generate.model_page(model)
    for cls in (model.inputs, model.outputs, model.params):
        for item in variables(cls):
            key, number = split_index(item.name)
            first = key.replace("[]", "[1]", 1) if number > 1 else item.name
            assert f"`{first}`" in text, item.name


def test_every_row_of_every_chart_is_drawn(generate: Any) -> None:
    modules = generate.chart_modules()
    assert "controller_fmu.guo2015.chart" in [module.__name__ for module in modules]
    page = generate.charts_page()
    rows = sum(len(module.TRANSITIONS) for module in modules)
    assert page.count(" --> ") == rows
    assert page.count("<text") - page.count("<rect") == rows


def test_every_command_is_in_the_reference(generate: Any) -> None:
    page = generate.commands_page()
    for name in ("run", "report", "compare", "check", "test", "export csv", "export mf4", "export rerun"):
        assert f"## apa {name}\n" in page


def test_every_option_is_in_a_page_of_its_own_words(generate: Any) -> None:
    """The reference lists all; a page says what one is for."""
    top = parser()
    commands = [top, *(sub for _, sub in generate.subcommands(top))]
    options = {option for command in commands for option in re.findall(r"--[a-z][\w-]+", command.format_usage())}
    pages = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    assert len(options) > 60
    assert sorted(options - set(re.findall(r"--[a-z][\w-]+", pages))) == []


def test_scenarios_and_files_pages(generate: Any) -> None:
    text = generate.scenarios_page()
    assert "`guo2015-case4`" in text
    assert "Limits: gbt41630" in text
    assert "`window`" in generate.files_page()
    assert "GB/T 41630" in text


def test_every_key_of_a_file_has_a_meaning(generate: Any) -> None:
    for model in (
        Scenario,
        Target,
        Slot,
        SlotLayout,
        LayoutOrigin,
        Neighbours,
        LayoutKerb,
        EndCondition,
        Fault,
        Requirement,
        Window,
        Occasion,
        Summary,
        Final,
        Event,
        Check,
        FmuUsed,
    ):
        rows = generate.key_rows(model)
        assert [row[0] for row in rows if not row[3]] == [], model
    keys = {row[0]: row for row in generate.key_rows(Scenario)}
    assert {"`target`", "`scene`", "`task`", "`stop_condition`"} <= keys.keys()
    assert not {"`file`", "`overrides`", "`texts`", "`unsupported_parameters`"} & keys.keys()
    assert keys["`step`"][2] == "`0.01`"


def test_charts_are_drawn_by_us(generate: Any) -> None:
    charts = script("charts")
    pages = [page for page in PAGES if "<!-- chart: " in page.read_text(encoding="utf-8")]
    assert len(pages) >= 3
    for page in pages:
        text = page.read_text(encoding="utf-8")
        drawn = charts.on_page_markdown(text)
        marks = text.count("<!-- chart: ")
        assert drawn.count('<svg class="chart"') == marks
        assert "<!-- chart" not in drawn
    site = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert "name: mermaid" not in site
    assert "use_directory_urls: false" in site


def test_pages_that_are_driven_stand_where_a_law_is_explained(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    frames = script("frames")
    monkeypatch.setattr(frames, "REFERENCE", tmp_path)
    marks = {
        mark[0]: mark.groups() for page in PAGES for mark in frames.MARK.finditer(page.read_text(encoding="utf-8"))
    }
    assert len(marks) == len(READMES) + 2, "each system of a paper, apa and parking"
    for text, (system, scenario, names) in marks.items():
        made = tmp_path / (f"live-{system}.html" if system else "live.html")
        models = load_scenario(scenario).models
        assert models == models_for({"system": system})
        known = {f"{owner}.{item.name}" for owner, model in models.items() for item in variables(model.params)}
        known |= {item.replace("vehicle.car.", "car.") for item in known}
        assert set(names.split()) <= known
        assert "<iframe" not in frames.on_page_markdown(text)
        made.touch()
        assert f"#s={scenario}&amp;only={names.split()[0]}," in frames.on_page_markdown(text)
        made.unlink()


def test_search_finds_the_parts_of_a_name() -> None:
    (separator,) = re.findall(r"separator: '(.*)'", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    assert re.split(separator, "vehicle.car.steering.rate_limit") == ["vehicle", "car", "steering", "rate_limit"]
    assert re.split(separator, "ultrasonic[3]")[:2] == ["ultrasonic", "3"]


def test_pages_not_named_in_the_site_get_a_place() -> None:
    nav = script("nav")
    config = {"docs_dir": str(ROOT / "docs"), "nav": [{"Start": "index.md"}, {nav.SECTION: ["results.md"]}]}
    pages = nav.on_config(config)["nav"][1][nav.SECTION]
    assert pages[0] == "results.md"
    assert "guo2015.md" in pages
    assert "index.md" not in pages


def test_equations_name_their_files() -> None:
    found = {(item.paper, item.number): item.where for item in script("equations").equations(ROOT)}
    assert found["Guo 2015", 14] == "`controller_fmu/guo2015/point_tracking.py`"
    assert found["Zhang 2022", 4] == "`controller_fmu/zhang2022/quintic.py`"
    assert all(paper for paper, _ in found)


def test_a_table_is_put_between_its_marks_and_nowhere_else(tmp_path: Path) -> None:
    page, put = tmp_path / "page.md", script("marked").put
    page.write_text("a\n<!-- one -->\nold\n<!-- /one -->\nb\n<!-- two -->\n<!-- /two -->\n")
    put(page, "one", ["| 1 |", "| 2 |"])
    put(page, "two", ["x\\1"])
    first, second = "<!-- one -->\n\n| 1 |\n| 2 |\n\n<!-- /one -->", "<!-- two -->\n\nx\\1\n\n<!-- /two -->"
    assert page.read_text() == f"a\n{first}\nb\n{second}\n"
    with pytest.raises(ValueError, match="0 blocks"):
        put(page, "three", [])


def test_every_decision_is_listed() -> None:
    listed = (ROOT / "docs" / "adr" / "index.md").read_text(encoding="utf-8")
    assert [page.name for page in (ROOT / "docs" / "adr").glob("0*.md") if f"({page.name})" not in listed] == []


LONGEST = {"README.md": 1000, "CHANGELOG.md": 500}
"""Largest number of words of a page that is not 1,800."""


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CHANGELOG.md"], ids=lambda path: str(path.relative_to(ROOT)))
def test_a_page_is_short(page: Path) -> None:
    assert len(page.read_text(encoding="utf-8").split()) <= LONGEST.get(str(page.relative_to(ROOT)), 1800)


def test_all_pages_together_are_short() -> None:
    pages = [*(ROOT / "docs").glob("*.md"), *READMES]
    assert sum(len(page.read_text(encoding="utf-8").split()) for page in pages) <= 31_000


def test_links_of_readmes_lead_to_pages_of_the_site() -> None:
    readmes = script("readmes")
    assert list(readmes.readmes().values()) == READMES
    page = "[a](../../docs/vehicle.md#x) [b](../hsic/README.md) [c](../controller_fmu/guo2015/README.md#chart)"
    assert readmes.on_page_markdown(page) == "[a](vehicle.md#x) [b](hsic.md) [c](guo2015.md#chart)"


def test_factors_of_the_disturbed_studies_are_in_the_reference(generate: Any) -> None:
    page = generate.scenarios_page()
    for factor in (*generate.APA_WORLD, *generate.PARKING_WORLD):
        assert "| " + " | ".join(generate.factor_row(factor)) + " |" in page, factor.name


def test_every_figure_of_a_paper_is_in_the_reference(generate: Any) -> None:
    page = generate.figures_page()
    for item in generate.FIGURES:
        assert f"### {item.number}: {item.title}\n" in page
        assert item.draw is None or (ROOT / "docs" / "images" / "papers" / f"{item.name}.png").exists()


def test_pages_that_the_code_names_exist() -> None:
    """Help, messages and templates name pages of the documentation."""
    named = re.compile(r"\bdocs/[\w/-]+\.(?:md|py)|page [\w-]+ of the documentation")
    folders = ("orchestrator", "controller_fmu", "fmus/contents", "fmus/native", "apa_cosim")
    files = [file for folder in folders for suffix in ("py", "txt") for file in (ROOT / folder).rglob(f"*.{suffix}")]
    found = {(page, file) for file in files for page in named.findall(file.read_text(encoding="utf-8"))}
    places = {page: page if "/" in page else f"docs/{page.split()[1]}.md" for page, _ in found}
    assert len(places) > 3
    assert [(page, file) for page, file in found if not (ROOT / places[page]).exists()] == []
