"""Tuples and NamedTuples: written out, their fields, their items, their parts."""

import ast

from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.resolve import attribute as static_attribute
from fmus.compiler.source.types import FLOAT, INT, Array, Cells, Mixed, Struct, describe
from fmus.compiler.target.aggregates import elements, tuple_of
from fmus.compiler.target.body import EXPRESSIONS, METHODS, FunctionBody
from fmus.compiler.target.names import member_name
from fmus.compiler.target.storage import address, item_of, materialise
from fmus.compiler.target.values import UNARY, UNKNOWN, Value, is_scalar, place_of, within

COLUMN_RANGES = {"int32_t": ("INT32_MIN", "INT32_MAX", 2**31), "int16_t": ("INT16_MIN", "INT16_MAX", 2**15)}
"""Least and greatest integer that a column keeps, and the first that is too great."""


def display(body: FunctionBody, node: ast.Tuple) -> Value:
    """Return ``(a, b, c)``."""
    if not node.elts:
        raise CannotError(node, "an empty tuple", "leave it out, or give it the items it needs")
    return tuple_of(body, tuple(body.value(item) for item in node.elts))


def attribute(body: FunctionBody, node: ast.Attribute) -> Value:
    """Return a field of a NamedTuple, an enum member, a constant of another module."""
    found = body.static(node)
    if found is not None:
        if callable(found.value) and not isinstance(found.value, int):
            raise CannotError(node, f"the function or class {node.attr} as a value", "call it here")
        return body.program.constant(found, node)
    base = body.static(node.value)
    if base is not None and not isinstance(base.value, tuple):
        if static_attribute(base, node.attr, body.program.library) is None:
            raise CannotError(node, f"{ast.unparse(node)} is not known", f"{base.name} has no {node.attr}")
    value = body.value(node.value)
    if isinstance(value.kind, Struct):
        return field(body, value, node.attr, node)
    if node.attr in ("value", "name") and value.kind == INT:
        advice = "leave .value out" if node.attr == "value" else "text is made outside of the model"
        raise CannotError(node, f".{node.attr} of an integer variable", advice)
    raise CannotError(node, f".{node.attr} of {describe(value.kind)}", "only NamedTuples have fields")


def field(body: FunctionBody, value: Value, name: str, node: ast.AST) -> Value:
    """Return the field ``name`` of a NamedTuple; a property is called."""
    assert isinstance(value.kind, Struct)
    cls = value.kind.cls
    kinds = body.program.fields(cls, node)
    if name not in kinds:
        return METHODS[property](body, value, name, node)
    if value.fill is not None or (not value.place and isinstance(kinds[name], Array)):
        value = materialise(body, value, cls.__name__.lower())
    const = UNKNOWN if value.const is UNKNOWN else getattr(value.const, name)
    text = place_of(value).member(member_name(name)).text
    return Value(kinds[name], text, place=value.place, fixed=value.fixed and value.place, const=const)


def subscript(body: FunctionBody, node: ast.Subscript) -> Value:
    """Return ``xs[i]`` or ``xs[1:]``."""
    value = body.value(node.value)
    if isinstance(value.kind, Struct):
        return _field_at(body, node, value)
    if isinstance(value.kind, Cells):
        return _cell(value, index_text(body, node, value))
    if not isinstance(value.kind, Array | Mixed):
        raise CannotError(node, f"an index into {describe(value.kind)}", "only tuples have items")
    if isinstance(node.slice, ast.Slice):
        return _part(body, node, value, node.slice)
    index = _index(body, node.slice, value)
    length = value.kind.length if isinstance(value.kind, Array) else len(value.kind.items)
    if index.const is not UNKNOWN:
        return _item(body, value, _place(node, int(index.const), length), index)
    if isinstance(value.kind, Mixed):
        raise CannotError(node, "an index that varies into a tuple of different kinds", "write the number")
    value = materialise(body, value, "items")
    item = item_of(value, _in_range(body, node, index, length))
    return Value(item.kind, item.text, place=True, fixed=value.fixed)


def _index(body: FunctionBody, node: ast.expr, value: Value) -> Value:
    index = body.value(node)
    if index.kind != INT:
        what = f"an index into {describe(value.kind)} that is {describe(index.kind)}"
        raise CannotError(node, what, "write an int: int(...), or 1 if c else 0")
    return index


def _field_at(body: FunctionBody, node: ast.Subscript, value: Value) -> Value:
    """Return the field of a NamedTuple at an index; one that varies chooses among numbers of one kind."""
    assert isinstance(value.kind, Struct)
    kinds = body.program.fields(value.kind.cls, node)
    if isinstance(node.slice, ast.Slice):
        raise CannotError(node.slice, f"a part of {describe(value.kind)}", "name the fields")
    index = _index(body, node.slice, value)
    if index.const is not UNKNOWN:
        return field(body, value, list(kinds)[_place(node, int(index.const), len(kinds))], node)
    kind = next(iter(kinds.values()))
    if len(set(kinds.values())) > 1 or not is_scalar(kind):
        what = f"an index that varies into {describe(value.kind)}, whose fields differ"
        raise CannotError(node, what, "name the field, or make the fields a tuple")
    text = _in_range(body, node, index, len(kinds))
    name = body.program.item_function(value.kind.cls)
    return Value(kind, f"{name}({address(body, value, 'items')}, {text})")


def _cell(column: Value, index: str) -> Value:
    """Return the item of a column at ``index``."""
    kind = column.kind
    assert isinstance(kind, Cells)
    text = place_of(column).element(index).text
    if kind.item == FLOAT:
        return Value(FLOAT, text) if kind.c == "double" else Value(FLOAT, f"(double){text}", UNARY)
    bound = COLUMN_RANGES[kind.c][2]
    return Value(kind.item, f"(int64_t){text}", UNARY, low=-bound, high=bound - 1)


def index_text(body: FunctionBody, node: ast.Subscript, column: Value) -> str:
    """Return the index into a column as C takes it."""
    assert isinstance(column.kind, Cells)
    if isinstance(node.slice, ast.Slice):
        raise CannotError(node.slice, "a part of a column", "read or write one item at a time")
    return _in_range(body, node, _index(body, node.slice, column), column.kind.length)


def _in_range(body: FunctionBody, node: ast.AST, index: Value, length: int) -> str:
    """Return an index as C takes it: as it is if it is surely in range, else made so."""
    if index.lies_in(0, length - 1):
        return index.text
    least, most = index.least(), index.most()
    if (least is not None and least >= length) or (most is not None and most < -length):
        raise CannotError(node, f"an index out of range: there are {length} items", "correct the bounds")
    return f"{body.program.helper('index_in')}({index.text}, {length})"


def _place(node: ast.AST, index: int, length: int) -> int:
    if not -length <= index < length:
        raise CannotError(node, f"index {index} of {length} items", f"write an index from 0 to {length - 1}")
    return index + length if index < 0 else index


def _item(body: FunctionBody, value: Value, place: int, index: Value) -> Value:
    """Return the item at a known place."""
    if value.items is not None:
        return value.items[place]
    value = materialise(body, value, "items")
    if isinstance(value.kind, Mixed):
        const = UNKNOWN if value.const is UNKNOWN else value.const[place]
        text = place_of(value).member(f"item{place}").text
        return Value(value.kind.items[place], text, place=True, fixed=value.fixed, const=const)
    item = item_of(value, place, known=True)
    if index.const == place and index.text.isidentifier():
        named = place_of(value).element(index.text).text
        return Value(item.kind, named, place=True, fixed=item.fixed, const=item.const)
    return item


def _part(body: FunctionBody, node: ast.Subscript, value: Value, part: ast.Slice) -> Value:
    """Return ``xs[a:b]`` between known places."""
    ends = [None if end is None else body.value(end) for end in (part.lower, part.upper, part.step)]
    if any(end is not None and (end.kind != INT or end.const is UNKNOWN) for end in ends):
        raise CannotError(node, "a slice with ends that vary", "write whole numbers or constants: xs[1:4]")
    if not isinstance(value.kind, Array):
        raise CannotError(node, f"a slice of {describe(value.kind)}", "name the items that are meant")
    if ends[2] is not None and ends[2].const == 0:
        raise CannotError(node, "a slice with step 0", "write another step")
    places = range(value.kind.length)[slice(*(None if end is None else end.const for end in ends))]
    if not places:
        raise CannotError(node, "an empty tuple", f"the tuple has {value.kind.length} items")
    if places.step == 1 and value.place:
        kind = Array(value.kind.item, len(places))
        text = value.text if places.start == 0 else f"&{within(value, UNARY)}[{places.start}]"
        const = UNKNOWN if value.const is UNKNOWN else value.const[places.start : places.stop]
        items = tuple(item_of(value, place, known=True) for place in places)
        return Value(kind, text, UNARY, place=True, fixed=value.fixed, const=const, items=items)
    whole = elements(body, value)
    return tuple_of(body, tuple(whole[place] for place in places))


EXPRESSIONS |= {ast.Tuple: display, ast.Attribute: attribute, ast.Subscript: subscript}
