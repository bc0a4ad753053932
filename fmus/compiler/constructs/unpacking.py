"""``a, b = ...``: all of the right side is worked out before any name is bound."""

import ast
from dataclasses import replace

from fmus.compiler.constructs.tuples import field
from fmus.compiler.source.bindings import reads
from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.types import Array, Mixed, Struct, describe
from fmus.compiler.target.aggregates import elements
from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.storage import hoist, materialise
from fmus.compiler.target.values import Place, Value, place_of
from fmus.compiler.target.variables import bind, open_place


def unpack_assignment(body: FunctionBody, target: ast.Tuple, source: ast.expr, node: ast.AST) -> None:
    """Write ``a, b = ...``."""
    value = body.value(source)
    names = [item.id for item in ast.walk(target) if isinstance(item, ast.Name)]
    if value.fill_items is not None and isinstance(value.kind, Mixed):
        _from_call(body, target, value, source)
        return
    if value.items is not None and any(reads(source, name) for name in names):
        value = _apart(body, value, target, source)
    elif value.items is None:
        value = materialise(body, value, "items")
    unpack(body, target, value, node)


def _from_call(body: FunctionBody, target: ast.Tuple, value: Value, source: ast.expr) -> None:
    """Write a call of a function that writes each item to where its name lives."""
    assert isinstance(value.kind, Mixed)
    assert value.fill_items is not None
    kinds = value.kind.items
    if len(kinds) != len(target.elts):
        what = f"{len(target.elts)} names for {len(kinds)} items"
        raise CannotError(target, what, "write one name for each item")
    places = []
    later = []
    for number, (part, kind) in enumerate(zip(target.elts, kinds, strict=True)):
        own = value.base if number == value.changes else None
        place = open_place(body, part.id, kind, value, source, own) if isinstance(part, ast.Name) else None
        if place is None:
            word = f"next_{part.id}" if isinstance(part, ast.Name) and part.id != "_" else "unused"
            place = Place(body.names.add(word))
            body.emit(f"{body.program.declaration(kind, place.text)};")
            later.append((part, Value(kind, place.text, place=True, fixed=True)))
        places.append(place)
    value.fill_items(places)
    for part, item in later:
        unpack(body, part, item, part)


def _apart(body: FunctionBody, value: Value, target: ast.Tuple, source: ast.expr) -> Value:
    """Return items of which those are worked out first that read a name bound before them."""
    assert value.items is not None
    nodes = source.elts if isinstance(source, ast.Tuple) else [source] * len(value.items)
    done: list[str] = []
    items = []
    for item, from_node, to in zip(value.items, nodes, target.elts, strict=False):
        if any(reads(from_node, name) for name in done):
            item = hoist(body, item, f"next_{to.id}" if isinstance(to, ast.Name) else "next")
        items.append(item)
        done += [name.id for name in ast.walk(to) if isinstance(name, ast.Name)]
    return replace(value, items=(*items, *value.items[len(items) :]))


def unpack(body: FunctionBody, target: ast.expr, value: Value, node: ast.AST) -> None:
    """Write that the names of ``target`` get the items of ``value``."""
    if isinstance(target, ast.Name):
        if target.id != "_" or body.bindings.home("_", body.frames[-1].path).loads:
            bind(body, target.id, value, node)
        return
    if not isinstance(target, ast.Tuple | ast.List):
        raise CannotError(target, f"a change of {ast.unparse(target)}", "bind a new value to a name")
    for part in target.elts:
        if isinstance(part, ast.Starred):
            raise CannotError(part, "a star on the left side", "name each item")
    items = items_of(body, value, target)
    if len(items) != len(target.elts):
        raise CannotError(target, f"{len(target.elts)} names for {len(items)} items", "write one name for each item")
    for part, item in zip(target.elts, items, strict=True):
        unpack(body, part, item, node)


def items_of(body: FunctionBody, value: Value, node: ast.AST) -> tuple[Value, ...]:
    """Return the items of a tuple or the fields of a NamedTuple."""
    if value.items is not None:
        return value.items
    if isinstance(value.kind, Array):
        return elements(body, value)
    if isinstance(value.kind, Mixed):
        whole = materialise(body, value, "items")
        places = [place_of(whole).member(f"item{at}").text for at in range(len(value.kind.items))]
        pairs = zip(value.kind.items, places, strict=True)
        return tuple(Value(kind, text, place=True, fixed=whole.fixed) for kind, text in pairs)
    if isinstance(value.kind, Struct):
        whole = materialise(body, value, "items")
        return tuple(field(body, whole, name, node) for name in body.program.fields(value.kind.cls, node))
    raise CannotError(node, f"the items of {describe(value.kind)}", "only tuples have items")
