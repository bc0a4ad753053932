"""The recipes of docs/extend*.md, followed literally: in a copy of the repository, blocks as edits, commands run."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.vocabulary.findings import findings

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "docs" / "extend.md", ROOT / "docs" / "extend-tools.md"]
PACKAGES = ("modelkit", "vehicle_fmu", "controller_fmu", "fmus", "orchestrator")
LEFT_OUT = shutil.ignore_patterns("dist", "*-pytest-*.pyc")
"""Bytecode is copied: it is of the same sources, and half of the time of a first command."""
OWN_TESTS = (
    "tests/test_rooms.py",
    "tests/test_model_code_rules.py",
    "tests/controller/test_phases.py",
    "tests/controller/test_systems.py",
    "tests/vehicle/test_vehicle.py::test_parameters_without_meaning_give_a_status",
    "tests/orchestrator/test_requirements.py",
    "tests/orchestrator/test_viewer_layouts.py",
)
"""Those that a recipe could break: the structure, the language of models, systems, bad parameters, limits, layouts."""
HANGS = 1800.0
"""A command that takes longer hangs [s]; building FMUs beside much other work takes minutes."""
BLOCK = re.compile(r"^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```", re.S | re.M)


class Recipe(NamedTuple):
    title: str
    blocks: list[tuple[str, str, str]]
    """Language, file, text."""

    @property
    def edits(self) -> list[tuple[str, str, str]]:
        return [block for block in self.blocks if block[1]]

    @property
    def commands(self) -> list[str]:
        texts = [text for language, file, text in self.blocks if language == "sh" and not file]
        return [line for text in texts for line in text.splitlines() if line.startswith(("apa ", "python -m "))]


def recipes() -> list[Recipe]:
    parts = [part for page in PAGES for part in re.split(r"^## ", page.read_text(encoding="utf-8"), flags=re.M)[1:]]
    found = [Recipe(part.splitlines()[0], BLOCK.findall(part)) for part in parts]
    return [recipe for recipe in found if recipe.commands]


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """The packages, without what was built, in a folder of their own."""
    for package in PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package, ignore=LEFT_OUT)
    return tmp_path


@pytest.mark.release
@pytest.mark.parametrize("recipe", recipes(), ids=lambda recipe: recipe.title)
def test_a_recipe_does_what_it_says(recipe: Recipe, copy: Path) -> None:
    for language, file, text in recipe.edits:
        edit(copy, language, copy / file, text)
    for command in recipe.commands:
        words, _, comment = command.partition("#")
        as_said(comment, *run_line(copy, words.split()))


def as_said(comment: str, code: int, output: str) -> None:
    """Assert that a command did what the page says behind it."""
    asked, _, wanted = comment.strip().partition(": ")
    assert code == int(asked.removeprefix("exit ") or 0) if asked.startswith("exit") else code == 0, output
    assert all(word in output for word in wanted.split(", ")), output


IN_ONE_PROCESS = """
import contextlib, io, json, shutil, sys
from fmus.native import web
from orchestrator.cli import main
web.can_build = lambda: False
answers = []
for lines in json.load(sys.stdin):
    for words in lines:
        with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(out):
            try:
                code = main(words)
            except SystemExit as end:
                code = end.code
        answers.append([code or 0, out.getvalue()])
    for folder in ("run", "runs", "build"):
        shutil.rmtree(folder, ignore_errors=True)
json.dump(answers, sys.stdout)
"""
"""Runs the commands of one recipe after the other in a process that has the models of all.

It writes no page that is driven, which would take as long as all of them: `make release` compiles it.
"""


def test_what_adds_something_does_so_together(copy: Path) -> None:
    """In CPython; ``make release`` compiles, and runs the project's own tests."""
    asked: list[list[list[str]]] = []
    comments = []
    for recipe in recipes():
        if not recipe.title.startswith("Add "):
            continue
        for language, file, text in recipe.edits:
            edit(copy, language, copy / file, text)
        asked.append([])
        for command in recipe.commands:
            words, _, comment = command.partition("#")
            if command.startswith("python"):
                as_said(comment, *run_line(copy, words.split()))
                continue
            is_run = words.startswith("apa run") and "--fmus" not in words
            asked[-1].append([*words.split()[1:], *(["--fmus", "none"] if is_run else [])])
            comments.append(comment)
    call = [sys.executable, "-c", IN_ONE_PROCESS]
    done = subprocess.run(
        call, cwd=copy, env=environment(copy), input=json.dumps(asked), capture_output=True, text=True, timeout=HANGS
    )
    assert done.returncode == 0, done.stderr
    for comment, answer in zip(comments, json.loads(done.stdout), strict=True):
        as_said(comment, *answer)


def test_the_code_of_the_recipes_passes_lint(copy: Path) -> None:
    """What `make lint` checks: ruff, and the vocabulary of the files that a recipe changes."""
    shutil.copy(ROOT / "pyproject.toml", copy)
    changed = sorted({file for recipe in recipes() for _, file, _ in recipe.edits})
    before = len(list(findings(ROOT, [file for file in changed if (ROOT / file).is_file()])))
    for recipe in recipes():
        for language, file, text in recipe.edits:
            edit(copy, language, copy / file, text)
    python = [file for file in changed if file.endswith(".py")]
    for words in (["check"], ["format", "--check"]):
        call = [sys.executable, "-m", "ruff", *words, "--no-cache", *python]
        done = subprocess.run(call, cwd=copy, capture_output=True, text=True, timeout=HANGS)
        assert done.returncode == 0, done.stdout + done.stderr
    found = list(findings(copy, changed))
    assert len(found) <= before, found


@pytest.mark.release
def test_all_recipes_together_pass_the_projects_own_tests(copy: Path) -> None:
    for folder in ("tests", "apa_cosim", "benchmarks"):
        shutil.copytree(ROOT / folder, copy / folder, ignore=LEFT_OUT)
    shutil.copy(ROOT / "pyproject.toml", copy)
    for recipe in recipes():
        for language, file, text in recipe.edits:
            edit(copy, language, copy / file, text)
        for command in recipe.commands:
            if command.startswith("python"):  # writes files that are checked in
                run_line(copy, command.partition("#")[0].split())
    code, output = run(copy, ["-n", "0", "-q", "-p", "no:cacheprovider", *OWN_TESTS], "pytest")
    assert code == 0, output
    code, output = run(copy, ["controller_fmu", "vehicle_fmu", "orchestrator"], "mypy")
    assert code == 0, output


CLASH = """\
Phase: controller_fmu.straight.phases.StraightPhase.BACK = 4 is TO_Q2 = 4 of \
controller_fmu.guo2015.phases.GuoPhase; free numbers:"""


def test_the_number_of_another_systems_phase_is_bad_input_in_one_line(copy: Path) -> None:
    recipe = next(item for item in recipes() if item.title == "Add a controller")
    for language, file, text in recipe.edits:
        edit(copy, language, copy / file, text.replace("BACK = 12", "BACK = 4"))
    code, output = run(copy, ["list", "controllers"])
    assert code == 2, output
    assert CLASH in output
    assert "internal error" not in output
    assert "Traceback" not in output


def test_a_recipe_touches_two_files_at_most() -> None:
    touched = {recipe.title: {file for kind, file, _ in recipe.edits if kind == "diff"} for recipe in recipes()}
    assert {title: files for title, files in touched.items() if len(files) > 2} == {}


def edit(copy: Path, language: str, file: Path, text: str) -> None:
    if language == "diff":
        done = subprocess.run(["patch", "-p1", "--fuzz=0"], cwd=copy, input=text, text=True, capture_output=True)
        assert done.returncode == 0, done.stdout + done.stderr
    else:
        assert not file.exists(), f"{file} is there already"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")


def run_line(copy: Path, words: list[str]) -> tuple[int, str]:
    return run(copy, words[1:]) if words[0] == "apa" else run(copy, words[3:], words[2])


def environment(copy: Path) -> dict[str, str]:
    return {"PATH": "/usr/bin:/bin", "PYTHONPATH": str(copy), "COLUMNS": "200"}


def run(copy: Path, words: list[str], module: str = "orchestrator") -> tuple[int, str]:
    call = [sys.executable, "-m", module, *words]
    done = subprocess.run(call, cwd=copy, env=environment(copy), capture_output=True, text=True, timeout=HANGS)
    return done.returncode, done.stdout + done.stderr


def test_the_newcomers_count_is_of_the_recipes() -> None:
    """Lines to add to what is there already, and the files they are in."""
    counted = {}
    for recipe in recipes():
        diffs = [(file, text) for language, file, text in recipe.edits if language == "diff"]
        added = [line for _, text in diffs for line in text.splitlines() if re.match(r"\+(?!\+\+ )", line)]
        counted[recipe.title] = (len(added), len({file for file, _ in diffs}))
    assert counted["Add a controller"] == (2, 1)
    assert counted["Add a sensor"] == (11, 2)
    assert counted["Add a slot type"] == (4, 1)
    assert [counted[f"Add {thing}"][0] for thing in ("an export", "a command", "a paper")] == [1, 1, 0]
    table = PAGES[0].read_text(encoding="utf-8").split("## ")[0]
    assert "2 lines in 1 file: an import and a row" in table
    assert "| add a slot type | 4 lines in 1 file |" in table
    assert "11 lines in 2 files, six of them the record" in table


def test_every_recipe_is_tried() -> None:
    asked: tuple[str, ...] = (
        "gain",
        "law",
        "controller",
        "sensor",
        "check",
        "export",
        "command",
        "paper",
        "planner",
        "FMI variable",
        "plot panel",
        "slot type",
    )
    titles = " ".join(recipe.title for recipe in recipes())
    assert [word for word in asked if word not in titles] == []
