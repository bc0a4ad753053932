"""Which equation of which paper stands in which file, read from their docstrings."""

import ast
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

PACKAGES = ("controller_fmu", "vehicle_fmu", "modelkit")
PAPERS = {"guo2015": "Guo 2015", "zhang2022": "Zhang 2022", "preview": "Preview", "hsic": "HSIC", "apa": "APA"}
"""Package -> the paper that its docstrings mean where they name none."""
NUMBERS = r"\(\d+\)(?:(?:, | and |, and )\(\d+\))*"
MENTION = re.compile(rf"\b(?:eq\.|[Ee]quations?) ({NUMBERS})(?: of ([A-Z]\w+ \d{{4}}))?")
NAMED = re.compile(r"\b([A-Z][a-z]+ \d{4})\b")


class Equation(NamedTuple):
    """One equation, where it is written and what the docstring there says first."""

    paper: str
    number: int
    where: str
    line: int
    text: str


def equations(root: Path) -> list[Equation]:
    """Return all equations that docstrings name, in the order of papers and numbers."""
    files = [file for package in PACKAGES for file in sorted((root / package).rglob("*.py"))]
    return sorted({item for file in files for item in _in_file(file, file.relative_to(root))})


def _in_file(file: Path, name: Path) -> Iterator[Equation]:
    for where, line, text in _docstrings(ast.parse(file.read_text(encoding="utf-8"))):
        first = text.strip().split("\n\n")[0].replace("\n", " ")
        for numbers, paper in MENTION.findall(text):
            named = NAMED.search(text)
            paper = paper or (named[1] if named else PAPERS.get(name.parts[1], ""))
            place = f"`{name}`" + (f", `{where}`" if where else "")
            yield from (Equation(paper, int(n), place, line, first) for n in re.findall(r"\d+", numbers))


def _docstrings(tree: ast.Module) -> Iterator[tuple[str, int, str]]:
    """Yield name, line and text of what documents a module, class, function or field."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            text = ast.get_docstring(node)
            if text:
                yield getattr(node, "name", ""), getattr(node, "lineno", 1), text
            yield from _fields(node.body)


def _fields(body: list[ast.stmt]) -> Iterator[tuple[str, int, str]]:
    for before, node in pairwise(body):
        if not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)):
            continue
        if isinstance(before, ast.AnnAssign | ast.Assign):
            target = before.target if isinstance(before, ast.AnnAssign) else before.targets[0]
            yield ast.unparse(target), before.lineno, str(node.value.value)
