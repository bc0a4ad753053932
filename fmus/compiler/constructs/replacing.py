"""``x._replace(a=...)``: a copy with other fields, or the fields alone where x itself is bound to it."""

import ast

from fmus.compiler.source.kinds import Kind, Struct, described
from fmus.compiler.source.refusals import CannotError
from fmus.compiler.target.body import Body
from fmus.compiler.target.making import coerced
from fmus.compiler.target.names import member_name
from fmus.compiler.target.storage import hoist, put
from fmus.compiler.target.values import Place, Value, place_of
from fmus.compiler.target.variables import looks_at


def replaced(body: Body, node: ast.Call, value: Value) -> Value:
    """Return a copy of ``value`` with other fields."""
    changes = _changes(body, node, value)
    made = {name: _new(body, kind, item) for name, (kind, item) in changes.items()}

    def fill(place: Place) -> None:
        put(body, place, value)
        for name, item in made.items():
            put(body, place.member(member_name(name)), item)

    return Value(value.kind, fill=fill)


def _new(body: Body, kind: Kind, node: ast.expr) -> Value:
    return coerced(body, body.value(node), kind, node, f"the field is {described(kind)}")


def _changes(body: Body, node: ast.Call, value: Value) -> dict[str, tuple[Kind, ast.expr]]:
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


def replace_in_place(body: Body, place: Place, node: ast.Call, value: Value, name: str) -> None:
    """Write ``x = x._replace(...)`` without a copy; fields whose new values need old ones are worked out first."""
    changes = _changes(body, node, value)
    early = _early(changes, name)
    ready = {
        word: hoist(body, _new(body, kind, item), f"new_{word}")
        for word, (kind, item) in changes.items()
        if word in early
    }
    for word, (kind, item) in changes.items():
        target = place.member(member_name(word))
        inner = None if word in ready else _inner_replace(body, item, target)
        if inner is not None:
            assert isinstance(item, ast.Call)
            replace_in_place(body, target, item, inner, name)
        else:
            new = ready.get(word) or _new(body, kind, item)
            put(body, target, new, busy=word not in ready and looks_at(new, place.text, item, name))


def _inner_replace(body: Body, node: ast.expr, target: Place) -> Value | None:
    """Return what ``node`` replaces fields of, if that is the place it is stored to."""
    if isinstance(node, ast.Call) and is_replace(node) and isinstance(node.func, ast.Attribute):
        base = node.func.value
        if isinstance(base, ast.Name | ast.Attribute) and body.static(base) is None:
            value = body.value(base)
            if isinstance(value.kind, Struct) and value.place and place_of(value) == target:
                return value
    return None


def is_replace(node: ast.AST, name: str = "") -> bool:
    """Return whether an expression is ``x._replace(...)``, of the variable ``name`` if one is given."""
    if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute) or node.func.attr != "_replace":
        return False
    return not name or (isinstance(node.func.value, ast.Name) and node.func.value.id == name)


def _early(changes: dict[str, tuple[Kind, ast.expr]], name: str) -> set[str]:
    """Return the fields whose new values read what an assignment before theirs has changed."""
    done: list[str] = []
    found = set()
    for word, (_, item) in changes.items():
        seen = _fields_read(item, name)
        if any(other in seen or "*" in seen for other in done):
            found.add(word)
        done.append(word)
    return found


def _fields_read(node: ast.AST, name: str) -> set[str]:
    """Return the fields of ``name`` that an expression reads; '*' if it reads all."""
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == name:
        return {"*"} if node.attr == "_replace" else {node.attr}
    if isinstance(node, ast.Name) and node.id == name:
        return {"*"}
    return {word for child in ast.iter_child_nodes(node) for word in _fields_read(child, name)}
