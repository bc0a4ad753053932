"""``x._replace(a=...)``: a copy with other fields, or the fields alone where x itself is bound to it."""

import ast

from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.types import Kind, Struct, describe
from fmus.compiler.target.access import is_at
from fmus.compiler.target.aggregates import coerce
from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.names import member_name
from fmus.compiler.target.storage import hoist, put, put_members
from fmus.compiler.target.values import Place, Value


def lower_replace(body: FunctionBody, node: ast.Call, value: Value) -> Value:
    """Return a copy of ``value`` with other fields."""
    changes = _changes(body, node, value)
    members = {member_name(name): _new(body, kind, item) for name, (kind, item) in changes.items()}

    def fill(place: Place) -> None:
        if is_at(body, value, place):
            put_members(body, place, members)
            return
        # what the copy is written over is read first: a member that lies there already would need no statement
        there = {name: item for name, item in members.items() if is_at(body, item, place.member(name))}
        kept = members | {name: hoist(body, item, name) for name, item in there.items()}
        put(body, place, value)
        for name, item in kept.items():
            put(body, place.member(name), item)

    return Value(value.kind, fill=fill, base=value if value.place else None)


def _new(body: FunctionBody, kind: Kind, node: ast.expr) -> Value:
    return coerce(body, body.value(node), kind, node, f"the field is {describe(kind)}")


def _changes(body: FunctionBody, node: ast.Call, value: Value) -> dict[str, tuple[Kind, ast.expr]]:
    """Return kind and new value of each field that is replaced."""
    assert isinstance(value.kind, Struct)
    if node.args:
        raise CannotError(node, "_replace() with a value that has no name", "write _replace(field=value)")
    kinds = body.program.fields(value.kind.cls, node)
    found = {}
    for keyword in node.keywords:
        if keyword.arg not in kinds:
            what = f"{value.kind.cls.__name__} has no field {keyword.arg}"
            raise CannotError(keyword.value, what, f"it has {', '.join(kinds)}")
        found[str(keyword.arg)] = (kinds[str(keyword.arg)], keyword.value)
    return found


def is_replace(node: ast.AST, name: str = "") -> bool:
    """Return whether an expression is ``x._replace(...)``, of the variable ``name`` if one is given."""
    if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute) or node.func.attr != "_replace":
        return False
    return not name or (isinstance(node.func.value, ast.Name) and node.func.value.id == name)
