"""Functions of the language with a part put in place of another: refused, or of CPython's bits. Never anything else."""

import ast
import copy
import random
from pathlib import Path
from typing import Any

import pytest

from fmus.compiler import UnsupportedError
from tests.compiler.language import HEAD, SIGNATURE, Twins, results

TEXT = "# ---- types" + (Path(__file__).parent / "constructs.py").read_text().split("# ---- types", 1)[1]
TREE = ast.parse(HEAD + TEXT)
UNDER_TEST = {name for name, _ in results(TEXT)}
HELPERS = [node for node in TREE.body if not (isinstance(node, ast.FunctionDef) and node.name in UNDER_TEST)]
FUNCTIONS = [
    node
    for node in TREE.body
    if isinstance(node, ast.FunctionDef)
    and node.name in UNDER_TEST
    and node.name != "int_wide"  # its numbers are too large for the end of a loop
    and not any(isinstance(part, ast.While) for part in ast.walk(node))  # it may have no end when changed
]
ARGUMENTS = {name.split(":")[0] for name in SIGNATURE.split(", ")}
INPUTS = [
    (x, y, n, m, n % 2 == 0, m % 2 == 0)
    for x, y in ((0.5, -2.0), (3.0, 1.5), (-0.0, 0.0), (1e300, -7.0), (float("nan"), 2.0), (float("inf"), 1.0))
    for n, m in ((0, 1), (3, 2), (-2, 5), (7, -3))
]
PLAIN = (
    "1",
    "1.0",
    "True",
    "n",
    "x",
    "p",
    "-n",
    "(x, y)",
    "Point(x, y)",
    "START",
    "TABLE",
    "Mode.ON",
    "x > y",
    "x * n",
)


def expressions(function: Any) -> Any:
    nodes = (node for part in function.body for node in ast.walk(part) if isinstance(node, ast.expr))
    return [node for node in nodes if not isinstance(getattr(node, "ctx", None), ast.Store | ast.Del)]


def donors() -> Any:
    """Return expressions that need nothing but arguments and what the module has."""
    known = ARGUMENTS | {name for node in TREE.body for name in bound(node)} | set(dir(__builtins__))
    found = [node for function in FUNCTIONS for node in expressions(function)]
    names = ({part.id for part in ast.walk(node) if isinstance(part, ast.Name)} for node in found)
    plain = [ast.parse(text, mode="eval").body for text in PLAIN]
    return plain + [node for node, used in zip(found, names, strict=True) if used <= known]


def bound(node: Any) -> Any:
    if isinstance(node, ast.Assign):
        return [target.id for target in node.targets if isinstance(target, ast.Name)]
    return [alias.asname or alias.name for alias in node.names] if hasattr(node, "names") else [node.name]


class Swap(ast.NodeTransformer):
    def __init__(self, old: Any, new: Any) -> None:
        self.old, self.new = old, new

    def visit(self, node: Any) -> Any:
        return self.new if node is self.old else self.generic_visit(node)


def mutant(choose: Any, name: Any, parts: Any) -> Any:
    """Return a function with an expression replaced, and perhaps a statement gone or doubled."""
    while True:
        function = copy.deepcopy(choose.choice(FUNCTIONS))
        function.name = name
        old, new = choose.choice(expressions(function)), copy.deepcopy(choose.choice(parts))
        function = Swap(old, new).visit(function)
        if choose.random() < 0.3:
            place = choose.randrange(len(function.body))
            function.body[place : place + 1] = choose.choice(([], [function.body[place]] * 2))
        try:
            text = ast.unparse(ast.fix_missing_locations(function))
            compile(text, name, "exec")
        except (SyntaxError, ValueError, TypeError):
            continue
        return text


def translated(mutants: Any, head: Any, folder: Any, seed: Any) -> Any:
    """Return the mutants that are not refused, compiled; and the names of those that are."""
    refused: set[str] = set()
    while True:
        text = head + "\n\n\n" + "\n\n\n".join(body for name, body in mutants.items() if name not in refused)
        name = f"mutants_{seed}_{len(refused)}"
        try:
            return Twins(text, folder, name, warnings=("-w",)), refused
        except UnsupportedError as error:
            found = error.refusals
        lines = (folder / f"{name}.py").read_text().splitlines()
        assert not [item for item in found if "does not understand" in item.what]
        refused |= {name_at(lines, item.line) for item in found}
        assert refused <= set(mutants)


def name_at(lines: Any, number: Any) -> Any:
    """Return the name of the function at a line."""
    heads = [line for line in lines[:number] if line.startswith("def ")]
    return heads[-1].removeprefix("def ").partition("(")[0]


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_mutants_are_refused_or_equal(seed: int, tmp_path: Path) -> None:
    choose, parts = random.Random(seed), donors()
    mutants = {f"f{number}": mutant(choose, f"f{number}", parts) for number in range(40)}
    twins, refused = translated(mutants, "\n\n".join(ast.unparse(node) for node in HELPERS), tmp_path, seed)
    assert 0 < len(refused) < len(mutants)
    assert [line for inputs in INPUTS for line in twins.differing(inputs)] == []
