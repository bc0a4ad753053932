"""What is known of functions whatever is live: the kinds of their parameters, results, variables and expressions."""

import ast
import typing
from collections.abc import Iterable, Iterator
from types import FunctionType
from typing import Any, TypeAlias

from fmus.compiler.source.reading import Library
from fmus.compiler.source.resolve import Static, owner_of, static
from fmus.compiler.source.types import (
    FLOAT,
    INT,
    Array,
    Cells,
    Kind,
    Mixed,
    NoKindError,
    Open,
    Scalar,
    Struct,
    fields_of,
    is_named_tuple,
    kind_of,
    kind_of_value,
    parts,
    whole_of,
)

Scope: TypeAlias = dict[str, Kind | None]
"""Kinds of the variables that generators around an expression bind."""


class FunctionFacts:
    """What is known of a function whatever is live: parameters, result, kinds of its variables."""

    def __init__(self, library: Library, function: FunctionType, kinds: "CodeKinds") -> None:
        self.node = library.function(function)
        self.globals = function.__globals__
        arguments = self.node.args
        self.names = [item.arg for item in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
        hints = typing.get_type_hints(function, include_extras=True)
        self.kinds: Scope = {name: _kind_or_none(hints.get(name)) for name in self.names}
        if self.names and self.names[0] == "self" and "." in function.__qualname__:
            self.kinds["self"] = Struct(whole_of(owner_of(function)))
        self.result = _kind_or_none(hints.get("return"))
        self.local = {*self.names, *(item.id for item in ast.walk(self.node)
                                     if isinstance(item, ast.Name) and isinstance(item.ctx, ast.Store))}  # fmt: skip
        for _ in range(2):  # a variable may be read, in a loop, above the line that binds it
            for item in ast.walk(self.node):
                kinds.note_kinds(self, item)


def fields_along(cls: Any, name: str) -> Iterator[tuple[Any, str]]:
    """Yield the (class, field) that lead from a NamedTuple to its variable ``name``: ``pose.x``, ``ultrasonic[3]``."""
    for word in name.split("."):
        field = word.partition("[")[0]
        yield cls, field
        kind = fields_of(cls)[field]
        while isinstance(kind, Array):
            kind = kind.item
        cls = kind.cls if isinstance(kind, Struct) else None


def _kind_or_none(hint: Any) -> Kind | None:
    if hint is None:
        return None
    try:
        return kind_of(hint)
    except NoKindError:
        return None


class CodeKinds:
    """The kinds of the code read so far."""

    def __init__(self, library: Library) -> None:
        self.library = library
        self._known: dict[FunctionType, FunctionFacts] = {}

    def function(self, function: FunctionType) -> FunctionFacts:
        """Return what is known of ``function``."""
        if function not in self._known:
            self._known[function] = FunctionFacts(self.library, function, self)
        return self._known[function]

    def static(self, known: FunctionFacts, node: ast.expr, scope: Iterable[str] = ()) -> Static | None:
        """Return the Python object that ``node`` names, unless it is a variable."""
        return static(node, known.globals, known.local.union(scope), self.library)

    def method(self, known: FunctionFacts, node: ast.Attribute, scope: Scope) -> FunctionType | None:
        """Return the method or the property's function that ``node`` names."""
        kind = self.kind(known, node.value, scope)
        if not isinstance(kind, Struct):
            return None
        found = vars(kind.cls).get(node.attr)
        found = found.fget if isinstance(found, property) else found
        return found if isinstance(found, FunctionType) and not node.attr.startswith("_") else None

    def kind(self, known: FunctionFacts, node: ast.expr, scope: Scope) -> Kind | None:
        """Return the kind of an expression; None if it is not known."""
        if isinstance(node, ast.Name):
            if node.id in scope:
                return scope[node.id]
            if node.id in known.local:
                return known.kinds.get(node.id)
        if isinstance(node, ast.Name | ast.Attribute):
            found = self.static(known, node, scope)
            if found is not None:
                return _kind_of_constant(found.value)
        if isinstance(node, ast.Attribute):
            return self._kind_of_attribute(known, node, scope)
        if isinstance(node, ast.Call):
            return self._kind_of_call(known, node, scope)
        if isinstance(node, ast.IfExp):
            return self.kind(known, node.body, scope) or self.kind(known, node.orelse, scope)
        if isinstance(node, ast.Tuple):
            kinds = [self.kind(known, item, scope) for item in node.elts]
            if not kinds or any(kind is None for kind in kinds):
                return None
            same = len(set(kinds)) == 1
            return Array(kinds[0], len(kinds)) if same else Mixed(tuple(kinds))  # type: ignore[arg-type]
        if isinstance(node, ast.Subscript):
            return self._kind_of_item(known, node, scope)
        if isinstance(node, ast.BinOp):
            left = self.kind(known, node.left, scope)
            return Open(left.item) if isinstance(left, Array | Open) else FLOAT if isinstance(left, Scalar) else left
        return FLOAT if isinstance(node, ast.Constant | ast.Compare | ast.UnaryOp | ast.BoolOp) else None

    def _kind_of_attribute(self, known: FunctionFacts, node: ast.Attribute, scope: Scope) -> Kind | None:
        base = self.kind(known, node.value, scope)
        if not isinstance(base, Struct):
            return None
        if node.attr in fields_of(base.cls):
            return fields_of(base.cls)[node.attr]
        method = self.method(known, node, scope)
        return self.function(method).result if method is not None else None

    def _kind_of_item(self, known: FunctionFacts, node: ast.Subscript, scope: Scope) -> Kind | None:
        base = self.kind(known, node.value, scope)
        if isinstance(base, Array | Open):
            return Open(base.item) if isinstance(node.slice, ast.Slice) else base.item
        if isinstance(base, Cells):
            return base.item
        if isinstance(base, Mixed) and isinstance(node.slice, ast.Constant) and isinstance(node.slice.value, int):
            return base.items[node.slice.value]
        return None

    def _kind_of_call(self, known: FunctionFacts, node: ast.Call, scope: Scope) -> Kind | None:
        found = self.static(known, node.func, scope)
        if found is None:
            if not isinstance(node.func, ast.Attribute):
                return None
            if node.func.attr == "_replace":
                return self.kind(known, node.func.value, scope)
            method = self.method(known, node.func, scope)
            return self.function(method).result if method is not None else None
        if is_named_tuple(found.value):
            return Struct(whole_of(found.value))
        if isinstance(found.value, FunctionType):
            return self.function(found.value).result
        if found.value in (tuple, min, max, sum) and node.args:
            first = node.args[0]
            if isinstance(first, ast.GeneratorExp):
                item = self.kind(known, first.elt, scope | self.bound(known, first, scope))
                return None if item is None else Open(item) if found.value is tuple else item
            kind = self.kind(known, first, scope)
            return kind if found.value is tuple or not isinstance(kind, Array | Open) else kind.item
        return FLOAT

    def bound(self, known: FunctionFacts, node: Any, scope: Scope) -> Scope:
        """Return the kinds of the variables that a generator binds."""
        found: Scope = {}
        for part in node.generators:
            items = self.item_kind(known, part.iter, scope | found)
            found |= dict(targets_of(part.target, items))
        return found

    def item_kind(self, known: FunctionFacts, node: ast.expr, scope: Scope) -> Kind | None:
        """Return the kind of the items that a loop runs over."""
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id not in known.local:
            word = node.func.id
            if word == "range":
                return INT
            inner = [self.item_kind(known, item, scope) for item in node.args]
            if word == "reversed" and inner:
                return inner[0]
            if word in ("enumerate", "zip"):
                kinds = [INT, *inner[:1]] if word == "enumerate" else inner
                return None if any(kind is None for kind in kinds) else Mixed(tuple(kinds))  # type: ignore[arg-type]
        kind = self.kind(known, node, scope)
        if isinstance(kind, Array | Open | Cells):
            return kind.item
        if isinstance(kind, Mixed) and len(set(kind.items)) == 1:
            return kind.items[0]
        return None

    def note_kinds(self, known: FunctionFacts, node: ast.AST) -> None:
        """Note the kinds of the variables that a statement binds."""
        pairs: Iterable[tuple[str, Kind | None]] = ()
        if isinstance(node, ast.Assign):
            pairs = targets_of(node.targets[0], self.kind(known, node.value, {}))
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            pairs = targets_of(node.target, self.kind(known, node.value, {}))
        elif isinstance(node, ast.For):
            pairs = targets_of(node.target, self.item_kind(known, node.iter, {}))
        for name, kind in pairs:
            if known.kinds.get(name) is None:
                known.kinds[name] = kind


def targets_of(target: ast.expr, kind: Kind | None) -> Iterator[tuple[str, Kind | None]]:
    """Yield name and kind of each variable that gets a part of a value of ``kind``."""
    if isinstance(target, ast.Name):
        yield target.id, kind
    elif isinstance(target, ast.Tuple):
        count = len(target.elts)
        kinds: list[Kind | None] = [None] * count
        if isinstance(kind, Mixed) and len(kind.items) == count:
            kinds = list(kind.items)
        elif isinstance(kind, Array | Open):
            kinds = [kind.item] * count
        elif isinstance(kind, Struct) and len(fields_of(kind.cls)) == count:
            kinds = list(fields_of(kind.cls).values())
        for part, own in zip(target.elts, kinds, strict=True):
            yield from targets_of(part, own)


def _kind_of_constant(value: Any) -> Kind | None:
    try:
        return kind_of_value(value)
    except NoKindError:
        return None


def has_open(kind: Kind) -> bool:
    """Return whether a kind is, or has, a tuple of unknown length."""
    return isinstance(kind, Open) or any(has_open(part) for part in parts(kind))
