"""Variables that stand for a field of a struct itself, while the struct is changed into the next one.

``car = state.car`` may be changed within ``state``, without a copy, if nothing looks at the old field afterwards, and
``car`` is put back before anything sees the whole: ``state = State(car, ...)``.
"""

import ast

from fmus.compiler.source.bindings import variables_bound


def aliases_of(node: ast.FunctionDef, whole: str, cls: type) -> set[str]:
    """Return the variables of a function that may stand for a field of its argument ``whole``, a ``cls``."""
    found = set()
    for place, statement in enumerate(node.body):
        name, field = _bound(statement, whole)
        if name and _is_put_back(node.body[place + 1 :], name, _ArgumentField(whole, field, cls)):
            found.add(name)
    return found


class _ArgumentField:
    """A field of an argument."""

    def __init__(self, whole: str, name: str, cls: type) -> None:
        self.whole, self.name, self.cls = whole, name, cls
        self.fields: tuple[str, ...] = cls._fields  # type: ignore[attr-defined]

    def is_seen(self, nodes: list[ast.stmt] | list[ast.expr]) -> bool:
        """Return whether ``nodes`` look at the argument otherwise than at one of its other fields."""
        parts = [part for node in nodes for part in ast.walk(node)]
        others = {
            id(part.value)
            for part in parts
            if isinstance(part, ast.Attribute) and part.attr in self.fields and part.attr != self.name
        }
        names = [part for part in parts if isinstance(part, ast.Name) and part.id == self.whole]
        return any(id(part) not in others for part in names)

    def value_in(self, node: ast.expr) -> ast.expr | None:
        """Return what ``node``, which makes a new argument, has in the field."""
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name) or node.func.id != self.cls.__name__:
            return None
        named = dict(zip(self.fields, node.args, strict=False)) | {str(item.arg): item.value for item in node.keywords}
        return None if self.is_seen([*node.args, *(item.value for item in node.keywords)]) else named.get(self.name)


def _bound(node: ast.stmt, whole: str) -> tuple[str, str]:
    """Return x and f of ``x = whole.f``."""
    if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
        value = node.value
        if isinstance(value, ast.Attribute) and isinstance(value.value, ast.Name) and value.value.id == whole:
            return node.targets[0].id, value.attr
    return "", ""


def _is_put_back(after: list[ast.stmt], name: str, field: _ArgumentField) -> bool:
    """Return whether the statements put ``name`` back before they look at its field, and leave it alone then."""
    at = next((place for place, one in enumerate(after) if field.whole in variables_bound([one])), None)
    if at is None or name in variables_bound(after[at:]) or field.whole in variables_bound(after[at + 1 :]):
        return False
    back = after[at]
    if field.is_seen(after[:at]) or not isinstance(back, ast.Assign) or not isinstance(back.targets[0], ast.Name):
        return False
    given = field.value_in(back.value)
    return isinstance(given, ast.Name) and given.id == name
