"""Tuples, NamedTuples and constants made from their parts, and values taken as another kind where Python does so."""

import ast
from dataclasses import replace
from typing import Any

from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.types import BOOL, FLOAT, INT, Array, Kind, Mixed, Open, Scalar, Struct, describe
from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.names import member_name
from fmus.compiler.target.storage import ONE_BY_ONE, initial, item_of, materialise, put
from fmus.compiler.target.values import UNKNOWN, Place, Value, as_int, literal


def tuple_of(body: FunctionBody, items: tuple[Value, ...], kind: Kind | None = None) -> Value:
    """Return a tuple of ``items``."""
    kinds = tuple(item.kind for item in items)
    if kind is None:
        kind = Array(kinds[0], len(kinds)) if len(set(kinds)) == 1 else Mixed(kinds)
    const = tuple(item.const for item in items)
    mixed = isinstance(kind, Mixed)

    def fill(place: Place) -> None:
        for number, item in enumerate(items):
            put(body, place.member(f"item{number}") if mixed else place.element(number), item)

    known = UNKNOWN if any(item is UNKNOWN for item in const) else const
    return Value(kind, fill=fill, braces=_braces([initial(item) for item in items]), items=items, const=known)


def repeat_items(body: FunctionBody, items: tuple[Value, ...], count: int) -> Value:
    """Return a tuple of ``items``, ``count`` times over; a single one is written by a loop where there are many."""
    items = tuple(item if item.const is not UNKNOWN else materialise(body, item, "item") for item in items)
    whole = tuple_of(body, items * count)
    if len(items) > 1 or count <= ONE_BY_ONE:
        return whole

    def fill(place: Place) -> None:
        index = body.names.add("i")
        body.emit(f"for (int {index} = 0; {index} < {count}; ++{index}) {{")
        put(body, place.element(index), items[0])
        body.emit("}")
        body.names.taken.discard(index)

    return replace(whole, fill=fill)


def struct_of(body: FunctionBody, kind: Struct, fields: dict[str, Value]) -> Value:
    """Return a NamedTuple of ``fields``."""

    members = {member_name(name): value for name, value in fields.items()}

    def fill(place: Place) -> None:
        for name, value in members.items():
            put(body, place.member(name), value)

    texts = [initial(value) for value in members.values()]
    named = [None if text is None else f".{name} = {text}" for name, text in zip(members, texts, strict=True)]
    return Value(kind, fill=fill, braces=_braces(named), members=members)


def zero(body: FunctionBody, kind: Kind) -> Value:
    """Return the zero of ``kind``: what stands where a slice of the program needs no value."""
    if isinstance(kind, Scalar):
        return literal(False if kind == BOOL else 0 if kind == INT else 0.0)
    body.program.need(kind)
    if isinstance(kind, Array):
        return repeat_items(body, (zero(body, kind.item),), kind.length)
    assert isinstance(kind, Struct | Mixed)

    def fill(place: Place) -> None:
        body.emit(f"{place.whole} = ({body.program.type_name(kind)}){{0}};")

    return Value(kind, fill=fill, braces="{0}")


def _braces(texts: list[str | None]) -> str:
    return "" if None in texts else "{" + ", ".join(str(text) for text in texts) + "}"


def spell_out(body: FunctionBody, constant: Any, kind: Kind) -> Value:
    """Return a constant that has no name of its own."""
    if isinstance(kind, Scalar):
        value = body.program.number(constant)
        return as_int(value) if kind == INT else value
    if isinstance(kind, Struct):
        cls = kind.cls
        body.program.need(kind)
        if len(cls._field_defaults) == len(cls._fields) and repr(constant) == repr(cls()):
            return Value(kind, body.program.default(cls), place=True, fixed=True, const=constant)
        kinds = body.program.fields(cls, None)
        fields = {name: spell_out(body, getattr(constant, name), part) for name, part in kinds.items()}
        return struct_of(body, kind, fields)
    parts = kind.items if isinstance(kind, Mixed) else (kind.item,) * len(constant)
    return tuple_of(body, tuple(spell_out(body, item, one) for item, one in zip(constant, parts, strict=True)))


def elements(body: FunctionBody, value: Value) -> tuple[Value, ...]:
    """Return the items of a tuple of equal kinds one by one."""
    if value.items is not None:
        return value.items
    assert isinstance(value.kind, Array)
    whole = materialise(body, value, "items")
    return tuple(item_of(whole, at, known=True) for at in range(value.kind.length))


def coerce(body: FunctionBody, value: Value, kind: Kind, node: ast.AST, why: str) -> Value:
    """Return ``value`` as ``kind``; refuse what Python would not keep apart but C would."""
    if value.kind == kind:
        return value
    if kind == INT and value.kind == BOOL:
        return as_int(value)
    if value.items is not None and isinstance(kind, Array | Mixed):
        kinds = (kind.item,) * kind.length if isinstance(kind, Array) else kind.items
        if len(kinds) == len(value.items):
            pairs = zip(value.items, kinds, strict=True)
            return tuple_of(body, tuple(coerce(body, item, one, node, why) for item, one in pairs), kind)
    raise CannotError(node, f"{describe(value.kind)} where {why}", _advice(value, kind))


def _advice(value: Value, kind: Kind) -> str:
    if kind == FLOAT and value.kind in (INT, BOOL):
        return f"write {float(value.const)!r}" if value.const is not UNKNOWN else "write float(...) around it"
    if kind == INT and value.kind == FLOAT:
        return "write int(...) or math.floor(...) around it"
    if kind == BOOL and isinstance(value.kind, Scalar):
        return "write a comparison, such as x != 0"
    if isinstance(kind, Array | Open) and isinstance(value.kind, Array) and kind.item == value.kind.item:
        return f"make it as long as {describe(kind)}"
    return f"make it {describe(kind)}"
