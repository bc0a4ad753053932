"""Tuples and NamedTuples: written out, their fields, their items, their parts."""

import ast

from fmus.compiler.arithmetic import elements
from fmus.compiler.body import EXPRESSIONS, Body, tuple_of
from fmus.compiler.kinds import INT, Array, Mixed, Struct, described
from fmus.compiler.names import member_name
from fmus.compiler.refusals import CannotError
from fmus.compiler.resolve import attribute as static_attribute
from fmus.compiler.values import UNARY, UNKNOWN, Value, element, is_scalar, member, within


def display(body: Body, node: ast.Tuple) -> Value:
    """Return ``(a, b, c)``."""
    if not node.elts:
        raise CannotError(node, "an empty tuple", "leave it out, or give it the items it needs")
    return tuple_of(body, tuple(body.value(item) for item in node.elts))


def attribute(body: Body, node: ast.Attribute) -> Value:
    """Return a field of a NamedTuple, an enum member, a constant of another module."""
    found = body.static(node)
    if found is not None:
        if callable(found.value) and not isinstance(found.value, int):
            raise CannotError(node, f"the function or class {node.attr} as a value", "call it here")
        return body.program.constant(found, node)
    base = body.static(node.value)
    if base is not None and static_attribute(base, node.attr, body.program.library) is None:
        if not isinstance(base.value, tuple):
            raise CannotError(node, f"{ast.unparse(node)} is not known", f"{base.name} has no {node.attr}")
    value = body.value(node.value)
    if not isinstance(value.kind, Struct):
        if node.attr in ("value", "name") and value.kind == INT:
            advice = "leave .value out" if node.attr == "value" else "text is made outside of the model"
            raise CannotError(node, f".{node.attr} of an integer variable", advice)
        raise CannotError(node, f".{node.attr} of {described(value.kind)}", "only NamedTuples have fields")
    return field(body, value, node.attr, node)


def field(body: Body, value: Value, name: str, node: ast.AST) -> Value:
    """Return the field ``name`` of a struct; a property is called."""
    assert isinstance(value.kind, Struct)
    cls = value.kind.cls
    kinds = body.program.fields(cls, node)
    if name not in kinds:
        from fmus.compiler.calls import call_property

        return call_property(body, value, name, node)
    if value.fill is not None or value.braces or (not value.place and isinstance(kinds[name], Array)):
        value = body.settled(value, cls.__name__.lower())
    const = UNKNOWN if value.const is UNKNOWN else getattr(value.const, name)
    text = member(value, member_name(name))
    return Value(kinds[name], text, place=value.place, fixed=value.fixed and value.place, const=const)


def subscript(body: Body, node: ast.Subscript) -> Value:
    """Return ``xs[i]`` or ``xs[1:]``."""
    value = body.value(node.value)
    if isinstance(value.kind, Struct):
        return _field_at(body, node, value)
    if not isinstance(value.kind, Array | Mixed):
        raise CannotError(node, f"an index into {described(value.kind)}", "only tuples have items")
    if isinstance(node.slice, ast.Slice):
        return _part(body, node, value, node.slice)
    index = body.value(node.slice)
    if index.kind != INT:
        raise CannotError(node.slice, f"an index that is {described(index.kind)}", "write an int: int(...)")
    length = value.kind.length if isinstance(value.kind, Array) else len(value.kind.items)
    if index.const is not UNKNOWN:
        return _item(body, value, _place(node, int(index.const), length), index)
    if isinstance(value.kind, Mixed):
        raise CannotError(node, "an index that varies into a tuple of different kinds", "write the number")
    value = body.settled(value, "items")
    assert isinstance(value.kind, Array)
    text = _index_text(body, node, index, length)
    return Value(value.kind.item, element(value, text), place=True, fixed=value.fixed and _is_steady(body, node.slice))


def _field_at(body: Body, node: ast.Subscript, value: Value) -> Value:
    """Return the field of a NamedTuple at an index; one that varies chooses among numbers of one kind."""
    assert isinstance(value.kind, Struct)
    kinds = body.program.fields(value.kind.cls, node)
    index = None if isinstance(node.slice, ast.Slice) else body.value(node.slice)
    if index is None or index.kind != INT:
        raise CannotError(node.slice, f"an index into {described(value.kind)} that is no int", "name the field")
    if index.const is not UNKNOWN:
        return field(body, value, list(kinds)[_place(node, int(index.const), len(kinds))], node)
    if len(set(kinds.values())) > 1 or not is_scalar(next(iter(kinds.values()))):
        what = f"an index that varies into {described(value.kind)}, whose fields differ"
        raise CannotError(node, what, "name the field, or make the fields a tuple")
    text = _index_text(body, node, index, len(kinds))
    name = body.program.item_function(value.kind.cls)
    kind = next(iter(kinds.values()))
    return Value(kind, f"{name}({body.address(value, 'items')}, {text})")


def _index_text(body: Body, node: ast.AST, index: Value, length: int) -> str:
    """Return an index as C takes it: as it is if it is surely in range, else made so."""
    bounds = index.bounds()
    if bounds is not None and (bounds[0] >= length or bounds[1] < -length):
        raise CannotError(node, f"an index out of range: there are {length} items", "correct the bounds")
    if bounds is None or bounds[0] < 0 or bounds[1] >= length:
        return f"{body.program.helper('index_in')}({index.text}, {length})"
    return index.text


def _is_steady(body: Body, node: ast.expr) -> bool:
    """Return whether an index is made of variables that are bound once, so that a pointer to its item stays right."""
    return all(
        body.is_once(item.id) or (item.id in body.bindings.parameters and not body.bindings.rebound(item.id))
        for item in ast.walk(node)
        if isinstance(item, ast.Name) and item.id in body.bindings.local
    )


def _place(node: ast.AST, index: int, length: int) -> int:
    if not -length <= index < length:
        raise CannotError(node, f"index {index} of {length} items", f"write an index from 0 to {length - 1}")
    return index + length if index < 0 else index


def _item(body: Body, value: Value, place: int, index: Value) -> Value:
    """Return the item at a known place."""
    if value.items is not None:
        return value.items[place]
    value = body.settled(value, "items")
    const = UNKNOWN if value.const is UNKNOWN else value.const[place]
    if isinstance(value.kind, Mixed):
        text = member(value, f"item{place}")
        return Value(value.kind.items[place], text, place=True, fixed=value.fixed, const=const)
    assert isinstance(value.kind, Array)
    named = index.text if index.const == place and not index.text.lstrip("-").isdigit() else str(place)
    return Value(value.kind.item, element(value, named), place=True, fixed=value.fixed, const=const)


def _part(body: Body, node: ast.Subscript, value: Value, part: ast.Slice) -> Value:
    """Return ``xs[a:b]`` between known places."""
    ends = [None if end is None else body.value(end) for end in (part.lower, part.upper, part.step)]
    if any(end is not None and (end.kind != INT or end.const is UNKNOWN) for end in ends):
        raise CannotError(node, "a slice with ends that vary", "write whole numbers or constants: xs[1:4]")
    if not isinstance(value.kind, Array):
        raise CannotError(node, f"a slice of {described(value.kind)}", "name the items that are meant")
    places = range(value.kind.length)[slice(*(None if end is None else end.const for end in ends))]
    if not places:
        raise CannotError(node, "an empty tuple", f"the tuple has {value.kind.length} items")
    if places.step == 1 and value.place and value.items is None:
        kind = Array(value.kind.item, len(places))
        text = value.text if places.start == 0 else f"&{within(value, UNARY)}[{places.start}]"
        const = UNKNOWN if value.const is UNKNOWN else value.const[places.start : places.stop]
        return Value(kind, text, UNARY, place=True, fixed=value.fixed, const=const)
    items = elements(body, value)
    return tuple_of(body, tuple(items[place] for place in places))


EXPRESSIONS |= {ast.Tuple: display, ast.Attribute: attribute, ast.Subscript: subscript}
