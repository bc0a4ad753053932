"""``store.column[i] = x``: the only change in place that model code knows.

A function that writes to a store, itself or by a function it calls, is a *writer*. Within a statement the order in
which C works out its parts is free, so a writer may be called only where nothing else happens: as a statement by
itself, or as all that names are bound to or that is returned.
"""

import ast
from types import FunctionType

from fmus.compiler.constructs.tuples import COLUMN_RANGES, index_text
from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.types import Cells, describe
from fmus.compiler.target.aggregates import coerce
from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.values import UNARY, Value, as_int, place_of, within


def write(body: FunctionBody, target: ast.Subscript, source: ast.expr, node: ast.AST) -> None:
    """Write ``store.column[index] = source``."""
    column = _column(body, target.value)
    if column is None or not isinstance(column.kind, Cells):
        what = f"a change of {ast.unparse(target)}"
        raise CannotError(node, what, "bind a new value: x = x._replace(field=...), or a new tuple")
    why = f"{ast.unparse(target.value)} is {describe(column.kind)}"
    value = coerce(body, body.value(source), column.kind.item, node, why)
    place = place_of(column).element(index_text(body, target, column)).text
    body.emit(f"{place} = {_as_column_item(body, value, column.kind)};")


def _column(body: FunctionBody, node: ast.expr) -> Value | None:
    """Return what is changed, if it is the field of something."""
    return body.value(node) if isinstance(node, ast.Attribute) else None


def _as_column_item(body: FunctionBody, value: Value, kind: Cells) -> str:
    """Return ``value`` as a column keeps it; of an integer that does not fit the nearest, where Python raises."""
    if kind.c == "double":
        return value.text
    if kind.c == "float":
        return f"(float){within(value, UNARY)}"
    least, most, bound = COLUMN_RANGES[kind.c]
    value = as_int(value)
    if value.lies_in(-bound, bound - 1):
        return f"({kind.c}){within(value, UNARY)}"
    return f"({kind.c}){body.program.helper('int_within')}({value.text}, {least}, {most})"


def may_write(body: FunctionBody, node: ast.expr, name: str = "") -> None:
    """Note that ``node`` is all there is to its statement; what a writer gives to ``name`` must be read."""
    body.may_write = node
    if name and isinstance(node, ast.Call) and not body.bindings.home(name, body.frames[-1].path).loads:
        if body.program.writers.is_one(body.static(node.func)):
            raise CannotError(node, f"{name} is never read", "use it, or let the function return None")


def check_place(body: FunctionBody, node: ast.Call, function: FunctionType) -> None:
    """Refuse a call of a writer inside an expression."""
    if function in body.program.writers and body.may_write is not node:
        what = f"{function.__name__}() writes to a store inside an expression"
        raise CannotError(node, what, "bind its result to a name in a line of its own")
