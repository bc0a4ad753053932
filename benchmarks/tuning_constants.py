"""The tuning constants of a package, and their numbers as a variable array in the C of a model.

A constant is a number in a module constant, a number in a function but for 0, 1, 2, 3, 4, 0.5, 12 and their negatives,
or a parameter's default. Most real numbers can be changed while the compiled model runs: the model is translated from a
copy of the packages in which each has a number of its own (``marked``), and in its C that number is an item of an array
(``with_array``). The others, whole numbers and tables, need a translation each (``scaled``).
"""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Literal, NamedTuple

ROOT = Path(__file__).parents[1]
TRIVIAL = {0, 1, 2, 3, 4, 0.5, 12, 1e9, 1e300}
ARRAY = "tuning_values"
FIRST_MARK = 1_000_000.25
"""The number of the first constant in the marked copy; that of the next is larger by 1."""
STATIC_TABLE = re.compile(r"static const [^;=]*=[^;]*;")

Kind = Literal["named", "unnamed", "parameter"]


class TuningConstant(NamedTuple):
    """One number of the code."""

    file: str
    name: str
    """``LIMIT``, ``LIMITS[2]``, ``Params.gain``, or the function with the number: ``predict 0.35``."""
    kind: Kind
    line: int
    column: int
    end: int
    value: float
    is_whole_value: bool = True
    """Whether a module constant is this number alone."""


def constants_of(folder: Path, root: Path = ROOT) -> list[TuningConstant]:
    """Return the tuning constants below ``folder``."""
    return [item for file in sorted(folder.rglob("*.py")) for item in _constants_in(file, root)]


def _constants_in(file: Path, root: Path) -> Iterator[TuningConstant]:
    place, seen = str(file.resolve().relative_to(root)), Counter[str]()
    for owner, kind, node, alone in _numbers(ast.parse(file.read_text()).body, ""):
        number = node.value
        assert isinstance(number, int | float)
        assert node.end_col_offset is not None
        name = f"{owner} {number:g}" if kind == "unnamed" else owner
        seen[name] += 1
        if seen[name] > 1 or (kind == "named" and not alone):
            name = f"{name}[{seen[name]}]"
        yield TuningConstant(place, name, kind, node.lineno, node.col_offset, node.end_col_offset, number, alone)


def _numbers(body: list[ast.stmt], owner: str) -> Iterator[tuple[str, Kind, ast.Constant, bool]]:
    """Yield owner, kind and node of each number of statements, and whether it is all that its constant is."""
    for statement in body:
        if isinstance(statement, ast.ClassDef):
            yield from _numbers_in_class(statement)
        elif isinstance(statement, ast.FunctionDef):
            for node in _number_nodes(statement):
                if abs(_value(node)) not in TRIVIAL:
                    yield statement.name, "unnamed", node, False
        elif isinstance(statement, ast.Assign | ast.AnnAssign) and statement.value is not None:
            target = statement.targets[0] if isinstance(statement, ast.Assign) else statement.target
            for node in _number_nodes(statement.value):
                if _value(node) != 0.0:
                    yield ast.unparse(target), "named", node, node is statement.value


def _numbers_in_class(class_: ast.ClassDef) -> Iterator[tuple[str, Kind, ast.Constant, bool]]:
    for statement in class_.body:
        if isinstance(statement, ast.AnnAssign) and statement.value is not None and class_.name.endswith("Params"):
            nodes = list(_number_nodes(statement.value))
            if nodes:
                yield f"{class_.name}.{ast.unparse(statement.target)}", "parameter", nodes[0], False


def _number_nodes(tree: ast.AST) -> Iterator[ast.Constant]:
    """Yield the numbers in a tree; those in indices are no constants of the method."""
    if isinstance(tree, ast.Constant) and type(tree.value) in (int, float):
        yield tree
    skipped = "slice" if isinstance(tree, ast.Subscript) else "annotation"
    for name, value in ast.iter_fields(tree):
        if name not in (skipped, "returns", "decorator_list"):
            for item in value if isinstance(value, list) else [value]:
                if isinstance(item, ast.AST):
                    yield from _number_nodes(item)


def _value(node: ast.Constant) -> float:
    assert isinstance(node.value, int | float)
    return node.value


def scaled_value(value: float, scale: float) -> float:
    """Return a number times ``scale``; a whole number stays whole and changes by at least 1."""
    if not isinstance(value, int):
        return value * scale
    found = round(value * scale)
    return found if found != value else value + (1 if scale > 1.0 else -1)


def scaled(text: str, constant: TuningConstant, scale: float) -> str:
    """Return a file's text with this constant scaled."""
    return _replaced(text, [(constant, repr(scaled_value(constant.value, scale)))])


def marked(text: str, constants: list[tuple[int, TuningConstant]]) -> str:
    """Return a file's text with the mark of its number in place of each of these constants."""
    return _replaced(text, [(item, repr(FIRST_MARK + number)) for number, item in constants])


def _replaced(text: str, numbers: list[tuple[TuningConstant, str]]) -> str:
    lines = [line.encode() for line in text.splitlines(keepends=True)]
    for item, number in sorted(numbers, key=lambda pair: pair[0].column, reverse=True):
        line = lines[item.line - 1]
        lines[item.line - 1] = line[: item.column] + number.encode() + line[item.end :]
    return b"".join(lines).decode()


def can_vary(constant: TuningConstant) -> bool:
    """Return whether a number may become an item of the array: a real one, and no part of a table."""
    return isinstance(constant.value, float) and (constant.kind == "unnamed" or constant.is_whole_value)


def with_array(code: str, constants: list[TuningConstant]) -> tuple[str, list[int]]:
    """Return C with the array of the marked numbers in it, and the places of the constants that it reads there."""
    found: set[int] = set()
    number = re.compile(r"\b1\d{6}\.25\b")

    def place(match: re.Match[str]) -> int:
        return round(float(match[0]) - FIRST_MARK)

    def restored(match: re.Match[str]) -> str:
        return number.sub(lambda mark: repr(float(constants[place(mark)].value)), match[0])

    def item(match: re.Match[str]) -> str:
        found.add(place(match))
        return f"({ARRAY}[{place(match)}])"

    code = re.sub(r"^static const double (\w+) = (1\d{6}\.25);$", r"#define \1 \2", code, flags=re.M)
    code = number.sub(item, STATIC_TABLE.sub(restored, code))
    values = ", ".join(repr(float(constant.value)) for constant in constants)
    head = f'__attribute__((visibility("default"))) double {ARRAY}[{len(constants)}] = {{{values}}};\n'
    return head + code, sorted(found)
