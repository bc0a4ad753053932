"""The documentation does not rot: commands parse, YAML is valid, links lead somewhere, every signal is listed."""

import importlib.util
import re
import shlex
from pathlib import Path

import pytest
import yaml

from modelkit.variables import variables
from orchestrator.cli import parser
from orchestrator.scenario.catalogue import split_index
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.requirements import read_requirements
from orchestrator.sweep.study import load_study

ROOT = Path(__file__).parents[2]
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").glob("*.md")], key=lambda path: path.name)


def load(name: str):
    spec = importlib.util.spec_from_file_location(f"docs_{name}", ROOT / "docs" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def generate():
    return load("generate")


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.S | re.M)


def commands() -> list[str]:
    lines = [line for page in PAGES for block in blocks(page, "sh") for line in block.splitlines()]
    return [line for line in lines if line.startswith("apa ")]


def test_there_are_commands_to_check():
    assert len(commands()) > 15


@pytest.mark.parametrize("line", commands())
def test_commands_in_the_documentation_parse(line):
    parser().parse_args(shlex.split(line, comments=True)[1:])


def named(study: bool) -> list[str]:
    """Return the YAML blocks that begin with a name: studies have ``runs``, scenarios do not."""
    found = [block for page in PAGES for block in blocks(page, "yaml") if block.startswith("name:")]
    return [block for block in found if ("\nruns:" in block) == study]


@pytest.mark.parametrize("text", named(study=True))
def test_studies_in_the_documentation_are_valid(text, tmp_path):
    file = tmp_path / "study.yaml"
    file.write_text(text)
    assert load_study(str(file)).name == yaml.safe_load(text)["name"]


@pytest.mark.parametrize("text", named(study=False))
def test_scenarios_in_the_documentation_are_valid(text, tmp_path):
    file = tmp_path / "scenario.yaml"
    file.write_text(text)
    assert load_scenario(str(file)).name == yaml.safe_load(text)["name"]


def rules() -> list[str]:
    return [block for page in PAGES for block in blocks(page, "yaml") if re.match(r"- (id:|\{id:)", block)]


@pytest.mark.parametrize("text", rules())
def test_requirements_in_the_documentation_are_valid(text, tmp_path):
    file = tmp_path / "rules.yaml"
    file.write_text(text)
    assert read_requirements(file)


def test_both_kinds_were_found():
    assert len(named(study=False)) >= 1
    assert len(named(study=True)) >= 1
    assert len(rules()) >= 2


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_links_lead_to_files(page):
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
        if "://" in target or target.startswith("reference/"):
            continue
        assert (page.parent / target).exists(), target


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS.keys())
def test_every_variable_is_in_its_reference(generate, model):
    text = generate.model_page(model)
    for cls in (model.inputs, model.outputs, model.params):
        for item in variables(cls):
            key, number = split_index(item.name)
            first = key.replace("[]", "[1]", 1) if number > 1 else item.name
            assert f"`{first}`" in text, item.name


def test_every_row_of_every_chart_is_drawn(generate):
    modules = generate.chart_modules()
    assert "controller_fmu.guo2015.chart" in [module.__name__ for module in modules]
    page = generate.charts_page()
    rows = sum(len(module.TRANSITIONS) for module in modules)
    assert page.count(" --> ") == rows
    assert page.count("<text") - page.count("<rect") == rows


def test_every_command_is_in_the_reference(generate):
    page = generate.commands_page()
    for name in ("run", "report", "compare", "check", "test", "export csv", "export mf4", "export rerun"):
        assert f"## apa {name}\n" in page


def test_scenarios_and_files_pages(generate):
    text = generate.scenarios_page()
    assert "`guo2015-case4`" in text
    assert "Limits: gbt41630" in text
    assert "`window`" in generate.files_page()
    assert "GB/T 41630" in text


def test_pages_not_named_in_the_site_get_a_place():
    nav = load("nav")
    config = {"docs_dir": str(ROOT / "docs"), "nav": [{"Start": "index.md"}, {nav.SECTION: ["architecture.md"]}]}
    pages = nav.on_config(config)["nav"][1][nav.SECTION]
    assert pages[0] == "architecture.md"
    assert "guo2015.md" in pages
    assert "index.md" not in pages
