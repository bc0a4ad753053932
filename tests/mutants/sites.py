"""Where a mistake can be made in model code, and what it then says: numbers, signs, comparisons, guards, rows."""

import ast
import hashlib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

CONTROLLERS = Path("controller_fmu")
SYSTEMS = ("guo2015", "zhang2022", "hsic", "preview")
"""Packages of ``controller_fmu`` that are systems of papers."""
NOT_LAWS = ("__init__.py", "outputs.py", "signals.py")
FACTOR = 1.5
COMPARED: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE,
    ast.GtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.LtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
COMPUTED: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
}
EXTREMES = {"min": "max", "max": "min"}
ROW = "_row"
"""What makes a row of a chart."""


class Mutant(NamedTuple):
    """One mistake: a piece of one file, and what stands there instead."""

    file: str
    """Relative to the checkout."""
    line: int
    begin: int
    end: int
    """Offsets into the file [bytes]."""
    before: str
    after: str
    kind: str
    """number, sign, operator, comparison, guard, extreme or row."""
    count: int = 1  # type: ignore[assignment]  # tuples have a method count
    """It is the so many-th of the file that says the same."""

    @property
    def name(self) -> str:
        """What it is called in tables, wherever in the file it moves to, and its file in the system."""
        again = f" [{self.count}]" if self.count > 1 else ""
        words = " ".join(f"{self.before} -> {self.after or 'nothing'}".split())
        return f"{self.system}/{Path(self.file).name}: {words}{again}"

    @property
    def system(self) -> str:
        """The system of the controller it is in, or the package."""
        file = Path(self.file)
        return file.relative_to(CONTROLLERS).parts[0] if file.is_relative_to(CONTROLLERS) else file.parent.as_posix()

    def put_into(self, text: str) -> str:
        """Return the file's text with the mistake."""
        raw = text.encode()
        assert raw[self.begin : self.end].decode() == self.before, self
        return (raw[: self.begin] + self.after.encode() + raw[self.end :]).decode()


def files_of(root: Path, system: str) -> list[Path]:
    """Return the files with laws of a system, in its rooms too."""
    found = [item for item in (root / CONTROLLERS / system).rglob("*.py") if item.name not in NOT_LAWS]
    return sorted(found, key=lambda item: item.name)


def mutants_of(root: Path, file: Path) -> list[Mutant]:
    """Return every mistake of these kinds that one file can have, in its order."""
    text = file.read_text(encoding="utf-8")
    lines = [0]
    for line in text.encode().splitlines(keepends=True):
        lines.append(lines[-1] + len(line))
    found = []
    for node, after, kind in _changes(ast.parse(text)):
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        begin, end = lines[node.lineno - 1] + node.col_offset, lines[node.end_lineno - 1] + node.end_col_offset
        before = text.encode()[begin:end].decode()
        if kind == "row" and text.encode()[end : end + 1] == b",":
            end, before = end + 1, before + ","
        found.append(Mutant(file.relative_to(root).as_posix(), node.lineno, begin, end, before, after, kind))
    seen: Counter[tuple[str, str]] = Counter()
    counted = []
    for item in sorted(found, key=lambda item: (item.begin, item.end)):
        seen[item.before, item.after] += 1
        counted.append(item._replace(count=seen[item.before, item.after]))
    return counted


def drawn(root: Path, count: int, seed: int) -> list[Mutant]:
    """Return ``count`` mutants of the systems of all papers, drawn without looking; a change of one file draws others
    of this file only.
    """
    every = [mutant for system in SYSTEMS for file in files_of(root, system) for mutant in mutants_of(root, file)]
    return sorted(every, key=lambda item: hashlib.sha256(f"{seed} {item.name}".encode()).digest())[:count]


def _changes(tree: ast.Module) -> Iterator[tuple[ast.expr, str, str]]:
    """Yield node, what is to stand there, kind; annotations are left out."""
    for node in _code(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, float) and node.value != 0.0:
            yield node, repr(FACTOR * node.value), "number"
        elif isinstance(node, ast.BinOp) and type(node.op) in COMPUTED:
            yield node, _said(ast.BinOp(node.left, COMPUTED[type(node.op)](), node.right)), "operator"
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            yield node, _said(node.operand), "sign"
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            yield node, _said(node.operand), "guard"
        elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in COMPARED:
            yield node, _said(ast.Compare(node.left, [COMPARED[type(node.ops[0])]()], node.comparators)), "comparison"
        elif isinstance(node, ast.BoolOp):
            other = ast.Or() if isinstance(node.op, ast.And) else ast.And()
            yield node, _said(ast.BoolOp(other, node.values)), "guard"
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            if node.func.id in EXTREMES:
                yield node, _said(ast.Call(ast.Name(EXTREMES[node.func.id]), node.args, [])), "extreme"
            if node.func.id == ROW:
                yield node, "", "row"
        if isinstance(node, ast.IfExp) and isinstance(node.test, ast.Name | ast.Attribute | ast.Call):
            yield node.test, f"(not {ast.unparse(node.test)})", "guard"
    for node in ast.walk(tree):
        if isinstance(node, ast.If | ast.While) and isinstance(node.test, ast.Name | ast.Attribute | ast.Call):
            yield node.test, f"(not {ast.unparse(node.test)})", "guard"


def _code(node: ast.AST) -> Iterator[ast.AST]:
    """Yield all nodes but those of annotations."""
    yield node
    for field, value in ast.iter_fields(node):
        if field in ("annotation", "returns"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _code(child)


def _said(node: ast.expr) -> str:
    return f"({ast.unparse(ast.fix_missing_locations(node))})"
