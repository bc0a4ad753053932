"""The source of every model file keeps to what CPython, compiled batches and native FMUs do alike.

The rules are those of docs/architecture.md, read from the syntax tree.
"""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ROOMS = ("modelkit", "vehicle_fmu", "controller_fmu")
NO_MODEL_CODE = ("modelkit/model.py", "modelkit/variables.py", "modelkit/connections.py", "modelkit/terminals.py")
STANDARD = {"math", "typing", "enum"}
KIT = {"modelkit.signal", "modelkit.maths", "modelkit.random", "modelkit.vocabulary", "modelkit.geometry"}
INEXACT = {"hypot", "fmod", "pow", "dist", "remainder", "fsum", "prod", "sumprod"}
CALLS = {"min", "max", "pow", "divmod", "sum", "sorted", "isinstance", "print", "dict", "set", "list", "str", "round"}
BANNED = {
    ast.Try: "try",
    ast.Raise: "raise",
    ast.Assert: "assert",
    ast.Dict: "a dict",
    ast.DictComp: "a dict comprehension",
    ast.Set: "a set",
    ast.SetComp: "a set comprehension",
    ast.With: "with",
    ast.Lambda: "lambda",
    ast.Global: "global",
    ast.Nonlocal: "nonlocal",
    ast.AsyncFunctionDef: "async",
    ast.Yield: "yield",
    ast.Match: "match",
}
IN_FUNCTIONS = {ast.List: "a list", ast.ListComp: "a list comprehension", ast.JoinedStr: "a string"}


def model_files():
    files = (path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py")))
    names = (path.relative_to(ROOT).as_posix() for path in files if path.name != "__init__.py")
    return [name for name in names if name not in NO_MODEL_CODE]


def faults(source, room):
    """Return 'line: what' of everything in ``source`` that breaks a rule; ``room`` is its top-level package."""
    tree = ast.parse(source)
    inside = {id(node) for function in functions(tree) for part in function.body for node in ast.walk(part)}
    harmless = {id(node) for part in annotations_and_docstrings(tree) for node in ast.walk(part)}
    harmless |= integer_remainders(tree)
    found = []
    for node in ast.walk(tree):
        if id(node) not in harmless:
            found += [f"{getattr(node, 'lineno', 0)}: {what}" for what in node_faults(node, id(node) in inside, room)]
    return found


def node_faults(node, in_function, room):
    if type(node) in BANNED:
        yield BANNED[type(node)]
    if in_function and type(node) in IN_FUNCTIONS:
        yield IN_FUNCTIONS[type(node)]
    if in_function and isinstance(node, ast.Constant) and isinstance(node.value, str | bytes):
        yield f"the string {node.value!r}"
    if isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.Pow | ast.Mod | ast.MatMult):
        yield {ast.Pow: "**", ast.Mod: "%", ast.MatMult: "@"}[type(node.op)]
    if isinstance(node, ast.Attribute) and (node.attr in INEXACT or node.attr == "_replace"):
        yield node.attr
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in CALLS and in_function:
        yield f"{node.func.id}()"
    yield from import_faults(node, in_function, room)


def import_faults(node, in_function, room):
    if isinstance(node, ast.Import | ast.ImportFrom) and in_function:
        yield "an import inside a function"
    if isinstance(node, ast.Import):
        yield from (f"import {alias.name}" for alias in node.names if alias.name not in STANDARD)
    if isinstance(node, ast.ImportFrom):
        module = node.module or ""
        own = module.split(".")[0] == room and room != "modelkit"
        if node.level or not (own or module in STANDARD | KIT):
            yield f"from {'.' * node.level}{module} import"
        yield from (f"from {module} import {alias.name}" for alias in node.names if alias.name in INEXACT | {"*"})


def integer_remainders(tree):
    """Return the ids of all ``a % b`` of integers: there CPython and compiled code agree."""
    constants = integer_names(tree.body, set(), [])
    found = set()
    for scope in functions(tree):
        arguments = scope.args.posonlyargs + scope.args.args + scope.args.kwonlyargs
        body = [node for part in scope.body for node in ast.walk(part)]
        known = integer_names(body, constants, arguments)
        found |= {id(node) for node in ast.walk(scope) if is_remainder(node) and is_integer(node, known)}
    return found


def integer_names(nodes, known, arguments):
    """Return ``known`` and all names that ``arguments`` and ``nodes`` bind to integers alone."""
    bound = {item.arg: [ast.Constant(0) if is_name(item.annotation, "int") else None] for item in arguments}
    for node in nodes:
        if isinstance(node, ast.Assign | ast.AnnAssign):
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                parts = target.elts if isinstance(target, ast.Tuple) else [target]
                for part in parts:
                    if isinstance(part, ast.Name):
                        bound.setdefault(part.id, []).append(node.value if part is target else None)
        elif isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
            bound.setdefault(node.target.id, []).append(node.value if not isinstance(node.op, ast.Div) else None)
        elif isinstance(node, ast.For) and isinstance(node.target, ast.Name):
            in_range = isinstance(node.iter, ast.Call) and is_name(node.iter.func, "range")
            bound.setdefault(node.target.id, []).append(ast.Constant(0) if in_range else None)
    known = known | set(bound)
    for _ in bound:
        known = known - {name for name, values in bound.items() if not all(is_integer(item, known) for item in values)}
    return known


def is_integer(node, known):
    if isinstance(node, ast.Constant):
        return type(node.value) is int
    if isinstance(node, ast.BinOp):
        whole = isinstance(node.op, ast.Add | ast.Sub | ast.Mult | ast.FloorDiv | ast.Mod)
        return whole and is_integer(node.left, known) and is_integer(node.right, known)
    if isinstance(node, ast.IfExp):
        return is_integer(node.body, known) and is_integer(node.orelse, known)
    if isinstance(node, ast.UnaryOp):
        return is_integer(node.operand, known)
    if isinstance(node, ast.Call):
        return is_name(node.func, "int") or is_name(node.func, "len")
    return isinstance(node, ast.Name) and node.id in known


def is_remainder(node):
    return isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mod)


def is_name(node, name):
    return isinstance(node, ast.Name) and node.id == name


def functions(tree):
    return [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]


def annotations_and_docstrings(tree):
    for node in ast.walk(tree):
        if isinstance(node, ast.AnnAssign | ast.arg) and node.annotation is not None:
            yield node.annotation
        if isinstance(node, ast.FunctionDef) and node.returns is not None:
            yield node.returns
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            yield node.value


@pytest.mark.parametrize("name", model_files())
def test_model_file_keeps_the_rules(name):
    assert faults((ROOT / name).read_text(), name.split("/")[0]) == []


@pytest.mark.parametrize("name", model_files())
def test_model_function_arguments_are_annotated(name):
    """Compiled code takes its types from the annotations of the interface."""
    bare = [
        f"{node.lineno}: {node.name}({argument.arg})"
        for node in functions(ast.parse((ROOT / name).read_text()))
        for argument in node.args.posonlyargs + node.args.args + node.args.kwonlyargs
        if argument.annotation is None and argument.arg != "self"
    ]
    assert bare == []


@pytest.mark.parametrize(
    ("body", "what"),
    [
        ("return x ** 2", "**"),
        ("return x % 2", "%"),
        ("x **= 2", "**"),
        ("return math.hypot(x, x)", "hypot"),
        ("return math.fmod(x, x)", "fmod"),
        ("return x._replace(a=1)", "_replace"),
        ("return {1: x}", "a dict"),
        ("return 'a'", "the string 'a'"),
        ("return f'{x}'", "a string"),
        ("return [y for y in x]", "a list comprehension"),
        ("return max(x, 1.0)", "max()"),
        ("raise ValueError", "raise"),
        ("try:\n        pass\n    except ValueError:\n        pass", "try"),
        ("import numpy", "import numpy"),
        ("from vehicle_fmu.body import slip", "from vehicle_fmu import"),
        ("from modelkit.variables import flatten", "from modelkit.variables import"),
        ("from math import hypot", "from math import hypot"),
    ],
)
def test_the_rules_find_what_they_should(body, what):
    found = faults(f"def f(x: float) -> float:\n    {body}\n", "controller_fmu")
    assert any(what.split(" import")[0] in fault for fault in found)


def test_remainders_of_integers_alone_are_allowed():
    head = "N = 3\nM = 2.5\ndef f(x: float, n: int, m: int) -> float:\n    k = n // 2\n    k = k // N\n    m = x + m\n"
    source = head + "    return {}\n"
    for fine in ("n % 2", "k % N", "(n + 1) % 4", "int(x) % N"):
        assert faults(source.format(fine), "vehicle_fmu") == []
    for wrong in ("x % 2", "n % M", "n % 2.0", "(n / 2) % 2", "m % 2", "g % 2"):
        assert faults(source.format(wrong), "vehicle_fmu") == ["7: %"]


def test_docstrings_annotations_and_module_constants_are_allowed():
    source = '''"""Module."""
import math
from controller_fmu.path import length

SOURCE = "a paper"


def f(x: "float") -> "float":
    """Docstring with x ** 2 and {a: dict}."""
    return math.sqrt(x) * length
'''
    assert faults(source, "controller_fmu") == []
