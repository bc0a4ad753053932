"""``xs = xs[:i] + (x,) + xs[i + 1 :]``: the tuple with another item, written where the item lies."""

import ast

from fmus.compiler.source.kinds import INT, Array, described
from fmus.compiler.source.refusals import CannotError
from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.making import coerced
from fmus.compiler.target.storage import put
from fmus.compiler.target.values import UNKNOWN
from fmus.compiler.target.variables import LocalVariable, looks_at


def changed_item(node: ast.expr, name: str) -> tuple[ast.expr, ast.expr] | None:
    """Return (index, new item) if ``node`` is ``name[:i] + (x,) + name[i + 1 :]``, else None."""
    if not (isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add) and isinstance(node.left, ast.BinOp)):
        return None
    head, middle, tail = node.left.left, node.left.right, node.right
    before, after = _part(head, name), _part(tail, name)
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


def _part(node: ast.expr, name: str) -> ast.Slice | None:
    """Return the slice if ``node`` is a part of the tuple ``name``."""
    if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name) and node.value.id == name:
        return node.slice if isinstance(node.slice, ast.Slice) else None
    return None


def change_item(body: FunctionBody, known: LocalVariable, name: str, index: ast.expr, item: ast.expr) -> None:
    """Write the new item; the index must be known to lie in the tuple, where Python would make it longer."""
    if not isinstance(known.kind, Array):
        raise CannotError(item, f"another item in {described(known.kind)}", "only tuples of one kind have items")  # type: ignore[arg-type]
    place = body.value(index)
    if place.kind != INT or place.const is not UNKNOWN or not place.lies_in(0, known.kind.length - 1):
        raise CannotError(
            index,
            f"an index that may lie outside of the {known.kind.length} items",
            "take it from range(len(xs)) or enumerate(xs)",
        )
    why = f"an item is {described(known.kind.item)}"
    new = coerced(body, body.value(item), known.kind.item, item, why)
    target = known.place.element(place.text)
    put(body, target, new, busy=looks_at(new, known.place.text, item, name))
