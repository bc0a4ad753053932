"""``xs = xs[:i] + (x,) + xs[i + 1 :]``: the tuple with another item, written where the item lies.

The same of a field: ``m = m._replace(xs=m.xs[:i] + (x,) + m.xs[i + 1 :])``.
"""

import ast

from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.types import INT, Array, describe
from fmus.compiler.target.access import is_at
from fmus.compiler.target.aggregates import coerce
from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.storage import put, put_whole
from fmus.compiler.target.values import UNKNOWN, Place, Value
from fmus.compiler.target.variables import LocalVariable, looks_at


def item_change(node: ast.expr, whole: ast.expr) -> tuple[ast.expr, ast.expr] | None:
    """Return (index, new item) if ``node`` is ``whole[:i] + (x,) + whole[i + 1 :]``, else None."""
    if not (isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add) and isinstance(node.left, ast.BinOp)):
        return None
    head, middle, tail = node.left.left, node.left.right, node.right
    before, after = _part(head, whole), _part(tail, whole)
    alone = isinstance(middle, ast.Tuple) and len(middle.elts) == 1
    if not isinstance(node.left.op, ast.Add) or before is None or after is None or not alone:
        return None
    index = before.upper
    if index is None or isinstance(index, ast.Constant) or before.lower or after.upper or before.step or after.step:
        return None
    next_one = ast.BinOp(index, ast.Add(), ast.Constant(1))
    if after.lower is None or ast.dump(after.lower) != ast.dump(next_one):
        return None
    assert isinstance(middle, ast.Tuple)
    return index, middle.elts[0]


def _part(node: ast.expr, whole: ast.expr) -> ast.Slice | None:
    """Return the slice if ``node`` is a part of the tuple ``whole``."""
    if isinstance(node, ast.Subscript) and _path(node.value) and _path(node.value) == _path(whole):
        return node.slice if isinstance(node.slice, ast.Slice) else None
    return None


def _path(node: ast.expr) -> str:
    """Return the names of a variable and its fields; empty: an expression of another form."""
    if isinstance(node, ast.Name):
        return node.id
    within = _path(node.value) if isinstance(node, ast.Attribute) else ""
    return f"{within}.{node.attr}" if within and isinstance(node, ast.Attribute) else ""


def with_item(body: FunctionBody, node: ast.BinOp) -> Value | None:
    """Return the tuple with another item as a value, which changes the tuple alone where it is put back."""
    if not (isinstance(node.left, ast.BinOp) and isinstance(node.left.left, ast.Subscript)):
        return None
    whole = node.left.left.value
    changed = item_change(node, whole)
    if changed is None:
        return None
    value = body.value(whole)
    if not isinstance(value.kind, Array):
        return None
    kind = value.kind
    index, item = _index(body, kind, changed[0]), _item(body, kind, changed[1])

    def fill(place: Place) -> None:
        target = place.element(index.text)
        if is_at(body, value, place):
            put_whole(body, target, item)
        else:
            put(body, place, value)
            put(body, target, item)

    return Value(kind, fill=fill, base=value if value.place else None)


def _index(body: FunctionBody, kind: Array, node: ast.expr) -> Value:
    """Return the index, which must be known to lie in the tuple, where Python would make it longer."""
    place = body.value(node)
    if place.kind != INT or place.const is not UNKNOWN or not place.lies_in(0, kind.length - 1):
        raise CannotError(
            node,
            f"an index that may lie outside of the {kind.length} items",
            "take it from range(len(xs)) or enumerate(xs)",
        )
    return place


def _item(body: FunctionBody, kind: Array, node: ast.expr) -> Value:
    return coerce(body, body.value(node), kind.item, node, f"an item is {describe(kind.item)}")


def change_item(body: FunctionBody, known: LocalVariable, name: str, index: ast.expr, item: ast.expr) -> None:
    """Write the new item."""
    if not isinstance(known.kind, Array):
        raise CannotError(item, f"another item in {describe(known.kind)}", "only tuples of one kind have items")  # type: ignore[arg-type]
    place = _index(body, known.kind, index)
    new = _item(body, known.kind, item)
    put(body, known.place.element(place.text), new, busy=looks_at(new, known.place.text, item, name))
