"""Outcomes of decisions and conditions are counted while functions run, and what they return stays what it was."""

import html
import importlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import controller_fmu
from orchestrator.cli import main
from orchestrator.testing.coverage.branches import branch_share, watching

TEXT = """
from typing import NamedTuple


class Point(NamedTuple):
    x: float = 0.0

    @property
    def is_right(self) -> bool:
        return True if self.x > 0.0 else False


def sign(x: float, wide: bool) -> int:
    if x > 0.0 and not wide:
        return 1
    return -1 if x < 0.0 else 0


def halved(count: int) -> int:
    steps = 0
    while count > 1:
        count = count // 2
        steps += 1
    return steps


def even(numbers: tuple[int, ...]) -> list[int]:
    return [n for n in numbers if n % 2 == 0]


def first(x: int, y: int) -> int:
    return x or y


def never(x: int) -> int:
    return 1 if x else 2
"""


@pytest.fixture
def law(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """A package with a law of some branches, and a module that has imported one of its functions before."""
    folder = tmp_path / "branchy"
    folder.mkdir()
    (folder / "__init__.py").write_text("from branchy.law import sign\n")
    (folder / "law.py").write_text(TEXT)
    monkeypatch.syspath_prepend(tmp_path)
    yield importlib.import_module("branchy")
    for name in ("branchy", "branchy.law"):
        del sys.modules[name]


def missing(branches: Any) -> Any:
    return {branch.text: branch.missing for branch in branches.list_branches() if branch.missing}


def test_both_outcomes_of_each_decision_and_condition_are_counted(law: Any) -> None:
    module = sys.modules["branchy.law"]
    with watching([law]) as branches:
        assert [law.sign(x, wide) for x, wide in ((1.0, False), (1.0, True), (0.0, False))] == [1, 0, 0]
        assert module.halved(9) == 3
        assert module.even((2, 4)) == [2, 4]
        assert (module.first(3, 0), module.first(3, 4)) == (3, 3)
        assert module.Point(1.0).is_right is True
        found = {branch.text: (branch.was_true, branch.was_false) for branch in branches.list_branches()}
    assert found["x > 0.0"] == (2, 1)
    assert found["not wide"] == (1, 1)
    assert found["x > 0.0 and (not wide)"] == (1, 2)
    assert found["count > 1"] == (3, 1)
    assert missing(branches) == {
        "x < 0.0": "never true",
        "n % 2 == 0": "never false",
        "x": "never decided",
        "y": "never decided",
        "self.x > 0.0": "never false",
    }
    assert 0.0 < branch_share(branches.list_branches()) < 1.0


def test_functions_are_what_they_were_afterwards(law: Any) -> None:
    module = sys.modules["branchy.law"]
    functions = {name: vars(module)[name] for name in ("sign", "halved", "even")}
    codes = {name: function.__code__ for name, function in functions.items()}
    with watching([law]) as branches:
        assert law.sign is functions["sign"]
        assert law.sign.__code__ is not codes["sign"]
    law.sign(-1.0, False)
    assert {name: function.__code__ for name, function in functions.items()} == codes
    assert "__seen__" not in vars(module)
    assert branches.list_branches() == []


def test_what_did_not_run_is_not_counted() -> None:
    with watching([controller_fmu]) as branches:
        assert branches.list_branches() == []
        assert branch_share(branches.list_branches()) == 1.0


def test_a_run_says_how_far_it_went_into_the_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["test", "guo2015-case1", "--min-branch-coverage", "90", "--out", str(tmp_path)]
    assert main(words) == 1
    said = capsys.readouterr()
    assert "of the branches are covered, required 90 %" in said.err
    assert "controller_fmu/guo2015" in said.out
    data = json.loads((tmp_path / "coverage.json").read_text(encoding="utf-8"))
    folders = {branch["file"].rpartition("/")[0] for branch in data["branches"]}
    assert {"vehicle_fmu", "controller_fmu/guo2015"} <= folders
    assert "controller_fmu/hsic" not in folders
    page = (tmp_path / "coverage.html").read_text(encoding="utf-8")
    assert "never true" in page
    missing = [branch for branch in data["branches"] if not branch["was_true"] and branch["was_false"]]
    assert all(f"<code>{html.escape(branch['text'])}</code>" in page for branch in missing)


def test_the_numbers_of_a_run_are_the_same_while_it_is_watched(tmp_path: Path) -> None:
    """Those of native FMUs, where they can be built, are CPython's (tests/twin)."""
    for name, words in {"plain": [], "watched": ["--coverage"]}.items():
        main(["test", "guo2015-case4", *words, "--out", str(tmp_path / name), "--quiet"])
    plain, watched = (
        json.loads((tmp_path / name / "guo2015-case4" / "summary.json").read_text())["final"]
        for name in ("plain", "watched")
    )
    assert plain == watched
