"""How values get into places: initializers, assignments, temporaries, addresses."""

import re
from dataclasses import dataclass
from typing import Any

from fmus.compiler.source.types import Array, Scalar, Struct
from fmus.compiler.target.access import Access, access_to, accesses, is_at, overlap
from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.layout import flat
from fmus.compiler.target.values import (
    MAX_BY_VALUE_SCALARS,
    UNKNOWN,
    Place,
    Value,
    is_scalar,
    place_of,
    rvalue,
    scalars_in,
)

NUMBER = re.compile(r"-?\d[\d.]*(?:e[+-]?\d+)?|true|false")
ONE_BY_ONE = 4
"""Arrays of no more items are written item by item."""


def put(body: FunctionBody, place: Place, value: Value, busy: bool = False) -> None:
    """Write the statements that make ``place`` equal to ``value``; ``busy``: which is made of what the place holds."""
    if value.fill is None:
        if is_at(body, value, place):
            return
        if isinstance(value.kind, Array):
            _copy(body, place, value, value.kind)
        else:
            body.emit(f"{place.whole} = {rvalue(value)};")
    elif value.base is not None and is_at(body, value.base, place):
        value.fill(place)
    elif value.braces and isinstance(value.kind, Struct) and scalars_in(value.kind) <= MAX_BY_VALUE_SCALARS:
        body.emit(f"{place.whole} = ({body.program.type_name(value.kind)}){value.braces};")
    elif busy and value.members is not None:
        put_members(body, place, value.members)
    elif busy:
        put(body, place, hoist(body, value, "next"))
    else:
        value.fill(place)


def put_whole(body: FunctionBody, place: Place, value: Value) -> None:
    """Write a new value of what lies at ``place``, which it may be made of."""
    body.lines += _part(body, place, value).lines


def put_members(body: FunctionBody, place: Place, members: dict[str, Value]) -> None:
    """Write members of a struct, whose new values may be made of what it holds: each after all that reads it."""
    waiting = [_part(body, place.member(name), value) for name, value in members.items()]
    while waiting:
        free = [part for part in waiting if not any(other.reads(part) for other in waiting)]
        if free:
            body.lines += free[0].lines
            waiting.remove(free[0])
            continue
        looking = [part for part in waiting if any(part.reads(other) for other in waiting)]
        first = next((part for part in looking if is_scalar(part.value.kind)), looking[0])
        kept = hoist(body, first.value, re.split(r"\W+", first.place.text)[-1])
        waiting[waiting.index(first)] = _part(body, first.place, kept)


@dataclass
class Assignment:
    """The statements that give a place a new value, and what they look at."""

    place: Place
    value: Value
    own: Access
    lines: list[Any]
    seen: list[Access]

    def reads(self, other: "Assignment") -> bool:
        """Return whether the new value is made of what ``other`` overwrites."""
        return other is not self and any(overlap(other.own, access) for access in self.seen)


def _part(body: FunctionBody, place: Place, value: Value) -> Assignment:
    own = access_to(body, place)
    lines, seen = _assignment(body, place, value, False)
    changed = value.base is not None and is_at(body, value.base, place)
    at_once = len(lines) == 1 and _is_store(lines[0], place)
    if not changed and not at_once and any(overlap(own, access) for access in seen):
        lines, seen = _assignment(body, place, value, True)
    return Assignment(place, value, own, lines, seen)


def _assignment(body: FunctionBody, place: Place, value: Value, busy: bool) -> tuple[list[Any], list[Access]]:
    """Return the statements of an assignment, and what they look at."""
    with body.capture() as lines:
        put(body, place, value, busy)
    lines = list(flat(lines))
    return lines, [access for line in lines for access in _accesses(body, line, place)]


def _accesses(body: FunctionBody, line: str, place: Place) -> list[Access]:
    """Return what a statement looks at; not the place that it writes to, nor the one that is given to a function."""
    if _is_store(line, place):
        left, _, right = line.partition(" = ")
        return accesses(body, right) + [access for index in re.findall(r"\[(.*)\]", left)
                                        for access in accesses(body, index)]  # fmt: skip
    for own in (place.address, place.text):
        if line.endswith((f"({own});", f", {own});")):
            line = line.removesuffix(f"{own});")
            break
    return accesses(body, line)


def _is_store(line: str, place: Place) -> bool:
    """Return whether a statement assigns to a place or a part of it."""
    return re.match(rf"{re.escape(place.whole)}(?:(?:\.|->|\[)[^=]*)? = ", line) is not None


def _copy(body: FunctionBody, place: Place, value: Value, kind: Array) -> None:
    index = body.names.add("i")
    body.emit(f"for (int {index} = 0; {index} < {kind.length}; ++{index}) {{")
    put(body, place.element(index), item_of(value, index))
    body.emit("}")
    body.names.taken.discard(index)


def item_of(value: Value, index: object, known: bool = False) -> Value:
    """Return an element of an array that is a place; ``known`` if the index is a number."""
    assert isinstance(value.kind, Array)
    const = value.const[int(str(index))] if known and value.const is not UNKNOWN else UNKNOWN
    text = place_of(value).element(index).text
    return Value(value.kind.item, text, place=True, fixed=value.fixed, const=const)


def initial(value: Value) -> str | None:
    """Return the text of ``value`` inside an initializer; None if it takes statements."""
    if value.fill is not None:
        return value.braces or None
    if isinstance(value.kind, Array):
        if value.kind.length > ONE_BY_ONE or not isinstance(value.kind.item, Scalar | Struct):
            return None
        items = (item_of(value, at) for at in range(value.kind.length))
        return "{" + ", ".join(rvalue(item) for item in items) + "}"
    return rvalue(value)


def start_of(value: Value) -> str | None:
    """Return what a declaration can begin with; None if it takes statements."""
    if value.fill is not None:
        return value.braces or None
    return None if isinstance(value.kind, Array) else rvalue(value)


def declare(body: FunctionBody, c: str, value: Value, const: bool) -> None:
    """Write the declaration of a variable with its value."""
    declared = body.program.declaration(value.kind, c)
    start = start_of(value)
    if start is None:
        body.emit(f"{declared};")
        put(body, Place(c), value)
    else:
        head = "static const " if const and _is_table(value) else "const " if const else ""
        body.emit(f"{head}{declared} = {start};")


def _is_table(value: Value) -> bool:
    """Return whether a tuple is made of numbers written out and enum members, so that it need not be made anew."""
    if not isinstance(value.kind, Array) or value.items is None or value.const is UNKNOWN:
        return False
    return all(NUMBER.fullmatch(item.text) or (item.narrow and item.text.isidentifier()) for item in value.items)


def hoist(body: FunctionBody, value: Value, name: str) -> Value:
    """Return ``value`` as a constant of its own, declared here."""
    c = body.names.add(name)
    declare(body, c, value, const=True)
    known = (value.const, value.low, value.high) if is_scalar(value.kind) else (value.const, None, None)
    return Value(value.kind, c, place=True, fixed=True, const=known[0], low=known[1], high=known[2])


def materialise(body: FunctionBody, value: Value, name: str) -> Value:
    """Return ``value`` as something that may be mentioned often and pointed at."""
    if value.place or (is_scalar(value.kind) and value.const is not UNKNOWN):
        return value
    return hoist(body, value, name)


def address(body: FunctionBody, value: Value, name: str) -> str:
    """Return a pointer to a struct, or to the first item of an array."""
    if value.place:
        return value.text if isinstance(value.kind, Array) else place_of(value).address
    if value.braces and isinstance(value.kind, Struct):
        return f"&({body.program.type_name(value.kind)}){value.braces}"
    if value.braces and isinstance(value.kind, Array) and isinstance(value.kind.item, Scalar | Struct):
        item = body.program.type_name(value.kind.item)
        return f"(const {item}[{value.kind.length}]){value.braces}"
    return address(body, hoist(body, value, name), name)


def text_of(body: FunctionBody, value: Value, name: str) -> str:
    """Return a value as an expression: a scalar or a struct."""
    if value.fill is None:
        return rvalue(value)
    if value.braces and isinstance(value.kind, Struct):
        return f"({body.program.type_name(value.kind)}){value.braces}"
    return rvalue(hoist(body, value, name))
