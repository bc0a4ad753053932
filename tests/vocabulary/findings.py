"""What the check finds: places with private words, and names that say nothing, counted by package."""

import ast
import re
import subprocess
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from tests.vocabulary.terms import NAMES, NOUNS, PARTICIPLES, PROSE, RIDDLES

OLD_NAMES = ("renamed_names.py", "test_migrate.py")
SKIPPED = ("CHANGELOG", "third_party", ".svg", "tests/golden/", "tests/vocabulary/", "docs/adr/", *OLD_NAMES)
CODE = ("controller_fmu", "vehicle_fmu", "modelkit", "fmus", "orchestrator", "apa_cosim")
"""Packages whose names are checked."""
SUBJECT = re.compile(r"[a-z][\w, ./-]*: (?P<first>[a-z][\w-]*)\b")
MAX_SUBJECT_LETTERS = 72


class Finding(NamedTuple):
    """One place that should be said otherwise."""

    file: str
    line: int
    word: str
    term: str


def tracked(root: Path) -> list[str]:
    """Return the files that are checked, relative to ``root``."""
    done = subprocess.run(["git", "ls-files"], cwd=root, capture_output=True, text=True, check=True)
    kinds = (".md", ".py", ".yaml", ".html", ".js")
    return [
        name
        for name in done.stdout.splitlines()
        if name.endswith(kinds) and not any(part in name for part in SKIPPED) and (root / name).is_file()
    ]


def findings(root: Path, files: Iterable[str]) -> Iterator[Finding]:
    """Yield every place of ``files``, relative to ``root``, that should be said otherwise."""
    for name in files:
        text = (root / name).read_text(encoding="utf-8")
        yield from _words(name, text, PROSE)
        if name.endswith(".py") and not name.startswith("tests/"):
            yield from _words(name, text, NAMES)
        if name.endswith(".py") and name.split("/")[0] in CODE:
            yield from _names(name, ast.parse(text))


def _words(name: str, text: str, rules: dict[str, str]) -> Iterator[Finding]:
    for pattern, term in rules.items():
        for match in re.finditer(pattern, text):
            yield Finding(name, text.count("\n", 0, match.start()) + 1, match[0], term)


def _names(name: str, tree: ast.Module) -> Iterator[Finding]:
    """Yield constants of one word, which do not say what they limit, and functions called by a participle."""
    for node in tree.body:
        if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
            constant = node.targets[0].id
            if constant.isupper() and constant.isalpha() and _is_number(node.value):
                yield Finding(name, node.lineno, constant, "a constant's name says what it limits")
    for item in ast.walk(tree):
        if isinstance(item, ast.FunctionDef) and _is_participle(item.name) and not _is_attribute(item):
            yield Finding(name, item.lineno, item.name, "a function is a verb, or the noun that it returns")


def _is_number(value: ast.expr) -> bool:
    value = value.operand if isinstance(value, ast.UnaryOp) else value
    if isinstance(value, ast.BinOp):
        return _is_number(value.left) or _is_number(value.right)
    return isinstance(value, ast.Constant) and type(value.value) in (int, float)


def _is_attribute(function: ast.FunctionDef) -> bool:
    """Return whether a function is read as an attribute, whose name states a property."""
    return any(isinstance(item, ast.Name) and item.id == "property" for item in function.decorator_list)


def _is_participle(name: str) -> bool:
    word = name.strip("_").removeprefix("closed_loop").split("_")[0]
    return word in PARTICIPLES or (word.endswith("ed") and word not in NOUNS)


def package(file: str) -> str:
    """Return the package that a file is counted in: two folders, or one where there is no second."""
    return "/".join(file.split("/")[:-1][:2]) or "."


def counts(found: Iterable[Finding]) -> Counter[str]:
    """Return package -> number of findings."""
    return Counter(package(item.file) for item in found)


def unclear(subject: str) -> str:
    """Return what is wrong with the subject of a commit, empty if nothing is: ``area: imperative summary``."""
    match = SUBJECT.match(subject)
    if len(subject) > MAX_SUBJECT_LETTERS:
        return f"{len(subject)} letters, expected at most {MAX_SUBJECT_LETTERS}"
    if match is None:
        return "expected `area: summary`"
    first = match["first"]
    if first in RIDDLES or first.endswith("ing") or (first.endswith("ed") and first not in NOUNS):
        return f"{first!r}: expected an imperative"
    return ""
