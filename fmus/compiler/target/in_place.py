"""Which functions change a struct where it lies, instead of making another: ``state = step(state, inputs)``.

Those whose result is made of the argument of the same type, and those that are called in this way alone. A caller who
keeps the old value makes a copy first.
"""

import ast
from types import FunctionType
from typing import Any, NamedTuple

from fmus.compiler.source.bindings import variables_bound
from fmus.compiler.source.resolve import static
from fmus.compiler.source.types import Kind, Mixed, Struct
from fmus.compiler.target.program import Program
from fmus.compiler.target.signatures import signature
from fmus.compiler.target.values import is_result_by_value


class InPlace(NamedTuple):
    """An argument that is changed into a result."""

    parameter: int
    name: str
    result: int
    """Its place among the results."""


def in_place(program: Program, function: FunctionType) -> InPlace | None:
    """Return the argument of ``function`` that is changed into its result; None if there is none."""
    if function not in program.in_place:
        program.in_place[function] = None  # of a function that calls itself, which is refused
        program.in_place[function] = _find_in_place(program, function)
    found: InPlace | None = program.in_place[function]
    return found


def _find_in_place(program: Program, function: FunctionType) -> InPlace | None:
    known = signature(program, function)
    results = known.result.items if isinstance(known.result, Mixed) else (known.result,)
    node = program.library.function(function)
    for place, (name, kind) in enumerate(known.kinds.items()):
        alone = _is_large(kind) and results.count(kind) == 1 and list(known.kinds.values()).count(kind) == 1
        if alone:
            found = InPlace(place, name, results.index(kind))
            column = found.result if isinstance(known.result, Mixed) else None
            made_of_it = name in variables_bound(node.body) or _goes_on(program, function, node, name, column)
            if made_of_it or _only_updates(program, function, found, column):
                return found
    return None


def _is_large(kind: Kind) -> bool:
    return isinstance(kind, Struct) and not is_result_by_value(kind)


def _goes_on(program: Program, function: FunctionType, node: ast.FunctionDef, name: str, column: int | None) -> bool:
    """Return whether a result is made of the argument ``name`` on some way through the function."""
    values = [item.value for item in ast.walk(node) if isinstance(item, ast.Return) and item.value is not None]
    if column is not None:
        values = [value.elts[column] if isinstance(value, ast.Tuple) and column < len(value.elts) else value
                  for value in values]  # fmt: skip
    return any(_is_made_of(program, function, value, name) for value in values)


def _only_updates(program: Program, function: FunctionType, changed: InPlace, column: int | None) -> bool:
    """Return whether a function is called as ``x = function(x)`` or ``return function(x)``, x an argument, only."""
    if "." in function.__qualname__:
        return False  # a method: its calls are not found by name
    for caller in (caller for caller, used in program.found.uses.items() if function in used):
        node = program.library.function(caller)
        parents = {id(item.value): item for item in ast.walk(node) if isinstance(item, ast.Assign | ast.Return)}
        for call in ast.walk(node):
            if isinstance(call, ast.Call) and _callee(program, caller, call) is function:
                given = _argument(call, changed)
                if not isinstance(given, ast.Name) or not _replaces(parents.get(id(call)), given.id, node, column):
                    return False
    return True


def _replaces(parent: ast.stmt | None, name: str, node: ast.FunctionDef, column: int | None) -> bool:
    """Return whether a statement gives ``name`` to a function and gets it back, or passes the result on."""
    if isinstance(parent, ast.Return):
        return name in {item.arg for item in node.args.args}
    if not isinstance(parent, ast.Assign):
        return False
    target = parent.targets[0]
    if column is not None:
        if not isinstance(target, ast.Tuple) or column >= len(target.elts):
            return False
        target = target.elts[column]
    return isinstance(target, ast.Name) and target.id == name


def _is_made_of(program: Program, function: FunctionType, node: ast.expr, name: str) -> bool:
    """Return whether ``node`` is the variable ``name``, a changed copy of it, or what such a function makes of it."""
    if isinstance(node, ast.IfExp):
        return any(_is_made_of(program, function, part, name) for part in (node.body, node.orelse))
    if isinstance(node, ast.Name):
        return node.id == name
    if not isinstance(node, ast.Call):
        return False
    if isinstance(node.func, ast.Attribute) and node.func.attr == "_replace":
        return _is_made_of(program, function, node.func.value, name)
    called = _callee(program, function, node)
    changed = in_place(program, called) if called is not None else None
    given = changed and _argument(node, changed)
    return isinstance(given, ast.Name) and given.id == name


def _callee(program: Program, function: FunctionType, node: ast.Call) -> FunctionType | None:
    local = program.bindings_of(function).local
    found = static(node.func, function.__globals__, local, program.library)
    value: Any = found.value if found is not None else None
    known = isinstance(value, FunctionType) and value in program.functions
    return value if known else None


def _argument(node: ast.Call, changed: InPlace) -> ast.expr | None:
    if changed.parameter < len(node.args):
        return node.args[changed.parameter]
    return next((item.value for item in node.keywords if item.arg == changed.name), None)
