"""Variables: where they are declared, whether const, whether a copy or a pointer to what does not change."""

import ast
import re
from dataclasses import dataclass
from typing import Any

from fmus.compiler.source.bindings import Home, Path
from fmus.compiler.source.diagnostics import AlreadySaidError
from fmus.compiler.source.types import Array, Kind, Open, Struct, describe
from fmus.compiler.target.access import accesses, is_at
from fmus.compiler.target.aggregates import coerce
from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.storage import declare, put
from fmus.compiler.target.values import PRIMARY, UNKNOWN, Place, Value, is_scalar, place_of


@dataclass
class LocalVariable:
    """A variable of the function."""

    c: str
    home: Home
    parameter: bool = False
    kind: Kind | None = None
    """None: not bound yet."""
    pointer: bool = False
    fixed: bool = False
    const: Any = UNKNOWN
    low: int | None = None
    high: int | None = None
    level: int = PRIMARY
    narrow: bool = False

    @property
    def once(self) -> bool:
        """Whether it is bound at one place only."""
        return self.home.stores == 1 and not self.parameter

    @property
    def place(self) -> Place:
        """Where it lives."""
        return Place(self.c, self.pointer)

    def value(self) -> Value:
        """Return the variable as an expression."""
        assert self.kind is not None
        return Value(
            self.kind,
            self.c,
            self.level,
            place=True,
            fixed=self.fixed,
            pointer=self.pointer,
            const=self.const,
            low=self.low,
            high=self.high,
            narrow=self.narrow,
        )


def variable(body: FunctionBody, name: str) -> LocalVariable:
    """Return the variable that ``name`` stands for here."""
    for scope in reversed(body.scopes):
        if name in scope:
            return scope[name]  # type: ignore[no-any-return]
    home = body.bindings.home(name, body.frames[-1].path)
    key = (name, home.path)
    if key not in body.variables:
        if name not in body.c_names:
            body.c_names[name] = body.names.add(name)
        body.variables[key] = LocalVariable(body.c_names[name], home)
    return body.variables[key]  # type: ignore[no-any-return]


def bind(body: FunctionBody, name: str, value: Value, node: ast.AST, source: ast.AST | None = None) -> None:
    """Write that ``name`` gets ``value``; ``source`` is the expression it comes from."""
    if isinstance(value.kind, Open):
        raise AlreadySaidError
    known = variable(body, name)
    if known.kind is not None and known.parameter and _begins_anew(body, known, name):
        slot = _result_slot(body, known, name, value.kind)
        known = LocalVariable(slot.text if slot else body.names.add(f"next_{name}"), known.home)
        body.variables[name, ()] = known
    if known.kind is not None:
        value = coerce(body, value, known.kind, node, f"{name} is {describe(known.kind)} before")
        _store(body, known, value, name, source)
    elif known.home.loads:
        _first(body, known, name, value)
    known.kind = value.kind if known.kind is None else known.kind


def _begins_anew(body: FunctionBody, known: LocalVariable, name: str) -> bool:
    """Return whether a parameter that is a struct or tuple is bound to something new for all the rest of the function.

    Then the rest gets a variable of its own, and the parameter stays a pointer to const.
    """
    return not is_scalar(known.kind) and name in body.anew and body.frames[-1].path == ()  # type: ignore[arg-type]


def _store(body: FunctionBody, known: LocalVariable, value: Value, name: str, source: ast.AST | None) -> None:
    """Write the assignment of ``value``; through a temporary if it is made while the variable is still read."""
    if known.home.loads:
        put(body, known.place, value, busy=source is not None and looks_at(value, known.c, source, name))


def looks_at(value: Value, c: str, source: ast.AST, name: str) -> bool:
    """Return whether the statements that make ``value`` look at a variable, called ``c`` in C, while they write."""
    if value.held is None:
        return mentions(source, name)
    return re.split(r"\W", c)[0] in value.held


def mentions(node: ast.AST, name: str) -> bool:
    """Return whether ``name`` is read anywhere in ``node``."""
    return any(isinstance(item, ast.Name) and item.id == name for item in ast.walk(node))


def _first(body: FunctionBody, known: LocalVariable, name: str, value: Value) -> None:
    """Write the first binding of a variable."""
    kind = value.kind
    slot = _result_slot(body, known, name, kind)
    if slot is not None:
        known.c, known.pointer, known.fixed = slot.text, slot.pointer, known.once
        put(body, known.place, value)
    elif name in body.borrowed and isinstance(kind, Struct) and value.place:
        _borrow(body, known, value)
    elif body.frames[-1].path != known.home.path:
        frame = _frame(body, known.home.path)
        frame.slot.append(f"{body.program.declaration(kind, known.c)};")
        put(body, known.place, value)
    elif known.once and value.place and value.fixed and not is_scalar(kind):
        _point(body, known, value)
    else:
        declare(body, known.c, value, const=known.once)
        known.fixed = known.once
        if known.once and is_scalar(kind):
            known.const, known.low, known.high = value.const, value.low, value.high


def _result_slot(body: FunctionBody, known: LocalVariable, name: str, kind: Kind) -> Place | None:
    """Return where the result goes, if the variable is the result."""
    place, wanted = body.result_of.get(name, (None, None))
    if known.home.path != () or place is None:
        return None
    open_one = isinstance(wanted, Open) and isinstance(kind, Array) and wanted.item == kind.item
    return place if wanted == kind or open_one else None


def _frame(body: FunctionBody, path: Path) -> Any:
    return next(frame for frame in body.frames if frame.path == path)


def _point(body: FunctionBody, known: LocalVariable, value: Value) -> None:
    """Write a variable as a pointer to what does not change."""
    text = value.text if isinstance(value.kind, Array) else place_of(value).address
    body.emit(f"{body.program.pointer_declaration(value.kind, known.c)} = {text};")
    body.aliases[known.c] = tuple(accesses(body, text))
    known.pointer, known.fixed, known.const = not isinstance(value.kind, Array), True, value.const


def _borrow(body: FunctionBody, known: LocalVariable, value: Value) -> None:
    """Write a variable as a pointer to what it is at first, and will be put back into."""
    place = place_of(value)
    body.emit(f"{body.program.declaration(value.kind, f'*{known.c}')} = {place.address};")
    known.pointer = True
    body.aliases[known.c] = tuple(accesses(body, place.text))


def open_place(
    body: FunctionBody, name: str, kind: Kind, value: Value, source: ast.AST, own: Value | None = None
) -> Place | None:
    """Return where a function may write what ``name`` gets, declared if it is new; None if it must not yet.

    ``own`` is the argument that the function changes into it.
    """
    known = variable(body, name)
    if not known.home.loads:
        return None
    if known.kind is not None:
        if own is not None and is_at(body, own, known.place):
            return known.place
        if known.kind != kind or (known.parameter and not is_scalar(kind)):
            return None
        return None if looks_at(value, known.c, source, name) else known.place
    known.kind, known.fixed = kind, known.once
    slot = _result_slot(body, known, name, kind)
    if slot is not None:
        known.c, known.pointer = slot.text, slot.pointer
    else:
        declared = f"{body.program.declaration(kind, known.c)};"
        here = body.frames[-1].path == known.home.path
        (body.lines if here else _frame(body, known.home.path).slot).append(declared)
    return known.place
