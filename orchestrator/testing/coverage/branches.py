"""Which branches of model code a run takes: each decision, and each condition of one, seen true and seen false.

A decision is what ``if``, ``while``, ``x if c else y`` or a filter of a comprehension decides on; a condition is an
operand of ``and`` or ``or``. While they are watched, functions run code that counts both outcomes of each; the
functions themselves stay the same objects, whoever has imported them.
"""

import ast
import inspect
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any, NamedTuple

SEEN = "__seen__"
"""What the counting code calls; no name of model code."""


class Branch(NamedTuple):
    """One decision or condition."""

    file: Path
    line: int
    text: str
    was_true: int
    was_false: int

    @property
    def outcomes(self) -> int:
        """Of its two outcomes those seen."""
        return (self.was_true > 0) + (self.was_false > 0)

    @property
    def missing(self) -> str:
        """What was not seen, in words; "" if both were."""
        if self.was_true and self.was_false:
            return ""
        return "never decided" if not self.outcomes else "never true" if not self.was_true else "never false"


class Branches:
    """The branches of some packages, and how often each had which result."""

    def __init__(self) -> None:
        self._places: list[tuple[Path, int, str]] = []
        self._counts: list[int] = []

    def add(self, file: Path, line: int, text: str) -> int:
        """Return the number of a new branch."""
        self._places.append((file, line, text))
        self._counts += [0, 0]
        return len(self._places) - 1

    def count_outcome(self, number: int, value: Any) -> Any:
        """Count an outcome and hand it on."""
        self._counts[2 * number + bool(value)] += 1
        return value

    def list_branches(self) -> list[Branch]:
        """Return all branches with their counts, by file and line; of folders that did not run, none."""
        counts = self._counts
        every = [Branch(*place, counts[2 * n + 1], counts[2 * n]) for n, place in enumerate(self._places)]
        ran = {item.file.parent for item in every if item.outcomes}
        return sorted((item for item in every if item.file.parent in ran), key=lambda item: (item.file, item.line))


@contextmanager
def watching(packages: Iterable[ModuleType]) -> Iterator[Branches]:
    """Yield the branches of all functions of some packages, counted while models run in this process."""
    branches = Branches()
    changed: list[tuple[FunctionType, CodeType]] = []
    modules = list(_modules({package.__name__ for package in packages}))
    try:
        for module in modules:
            codes = _counting(module, branches)
            vars(module)[SEEN] = branches.count_outcome
            for function in _functions(module):
                changed.append((function, function.__code__))
                function.__code__ = codes[function.__qualname__]
        yield branches
    finally:
        for function, code in changed:
            function.__code__ = code
        for module in modules:
            vars(module).pop(SEEN, None)


def branch_share(branches: Iterable[Branch]) -> float:
    """Return the share of the outcomes that were seen; 1 without any branch."""
    outcomes = [branch.outcomes for branch in branches]
    return sum(outcomes) / (2 * len(outcomes)) if outcomes else 1.0


def _modules(packages: set[str]) -> Iterator[ModuleType]:
    for name, module in list(sys.modules.items()):
        if name.split(".")[0] in packages and getattr(module, "__file__", None):
            yield module


def _functions(module: ModuleType) -> Iterator[FunctionType]:
    """Yield the functions and methods that are written in a module."""
    for item in list(vars(module).values()):
        if inspect.isclass(item) and item.__module__ == module.__name__:
            members = [value.fget if isinstance(value, property) else value for value in vars(item).values()]
        else:
            members = [item]
        for member in members:
            if isinstance(member, FunctionType) and member.__module__ == module.__name__:
                if member.__code__.co_filename == module.__file__:
                    yield member


def _counting(module: ModuleType, branches: Branches) -> dict[str, CodeType]:
    """Return the code of each function of a module, by qualified name, that counts."""
    file = Path(str(module.__file__))
    text = file.read_text(encoding="utf-8")
    tree = ast.fix_missing_locations(_Counting(file, branches).visit(ast.parse(text)))
    codes: dict[str, CodeType] = {}
    waiting = [compile(tree, str(file), "exec", dont_inherit=True)]
    while waiting:
        code = waiting.pop()
        codes.setdefault(code.co_qualname, code)
        waiting += [item for item in code.co_consts if isinstance(item, CodeType)]
    return codes


class _Counting(ast.NodeTransformer):
    """Puts a count around each decision and each condition."""

    def __init__(self, file: Path, branches: Branches) -> None:
        self._file = file
        self._branches = branches

    def visit_If(self, node: ast.If) -> ast.AST:
        return self._decision(node)

    def visit_While(self, node: ast.While) -> ast.AST:
        return self._decision(node)

    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        return self._decision(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.AST:
        node.values = [self._count(value) for value in node.values]
        return node

    def visit_comprehension(self, node: ast.comprehension) -> ast.AST:
        node.ifs = [self._count(value) for value in node.ifs]
        self.generic_visit(node)
        return node

    def _decision(self, node: ast.If | ast.While | ast.IfExp) -> ast.AST:
        text = ast.unparse(node.test)
        self.generic_visit(node)
        node.test = self._call(node.test, text)
        return node

    def _count(self, node: ast.expr) -> ast.expr:
        text = ast.unparse(node)
        return self._call(self.visit(node), text)

    def _call(self, node: ast.expr, text: str) -> ast.expr:
        number = self._branches.add(self._file, node.lineno, text)
        name = ast.copy_location(ast.Name(SEEN, ast.Load()), node)
        call = ast.Call(name, [ast.copy_location(ast.Constant(number), node), node], [])
        return ast.copy_location(call, node)
