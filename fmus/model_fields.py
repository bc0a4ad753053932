"""What is wrong with the fields of a model's types, each with its line and what to write instead."""

import ast
import math
import typing
from typing import Any, NamedTuple

from fmus.compiler import Diagnostic
from fmus.compiler.source.reading import Library
from fmus.compiler.source.types import NoKindError, hints_of, is_named_tuple, kind_of
from fmus.contents.units import unit
from modelkit.model import Model
from modelkit.signal import Signal
from modelkit.store import columns_of

EXAMPLE = 'Annotated[{kind}, Signal("m/s", "what it is, in which direction")]'
NUMBERS = (float, int, bool)


class _Field(NamedTuple):
    cls: Any
    name: str
    hint: Any
    default: Any
    """``...`` if there is none."""
    signal: Signal | None
    """Of the tuple or field around."""


class _Wrong(Exception):  # noqa: N818
    """What is wrong with a field, and what to write."""


def field_refusals(model: Model) -> list[Diagnostic]:
    """Return what is wrong with the fields of parameters, inputs, outputs and state."""
    library, found, done = Library(), list[Diagnostic](), set[Any]()
    public: list[Any] = [model.params, model.inputs, model.outputs]
    todo: list[tuple[Any, bool]] = [*((cls, True) for cls in public), (model.state, False)]
    while todo:
        cls, needs_signal = todo.pop(0)
        if (cls, needs_signal) in done or not is_named_tuple(cls):
            continue
        done.add((cls, needs_signal))
        node = library.class_node(cls)
        file = library.module(cls.__module__).file
        lines = _lines(node)
        found += [
            Diagnostic(file, line, f"{cls.__name__}.{name} has no type", f"write {name}: float = {text}")
            for name, (line, text) in _fields_without_type(node).items()
        ]
        for name, hint in hints_of(cls).items():
            default = cls._field_defaults.get(name, ...)
            field = _Field(cls, name, hint, default, None)
            try:
                todo += [(inner, needs_signal) for inner in _check_field(field, needs_signal)]
            except NoKindError as error:
                what = f"{cls.__name__}.{name} is {error.what}"
                found.append(Diagnostic(file, lines.get(name, 1), what, error.advice))
            except _Wrong as error:
                what, advice = error.args
                found.append(Diagnostic(file, lines.get(name, 1), f"{cls.__name__}.{name} {what}", advice))
    return sorted({*found, *_store_refusals(model, library)})


def _store_refusals(model: Model, library: Library) -> list[Diagnostic]:
    """Return what is wrong with the columns of a model's store."""
    if model.store is None:
        return []
    lines = _lines(library.class_node(model.store)) if is_named_tuple(model.store) else {}
    file = library.module(model.store.__module__).file
    try:
        columns_of(model.store)
    except TypeError as error:
        name, _, advice = str(error).partition(": ")
        return [Diagnostic(file, lines.get(name.rpartition(".")[2], 1), f"{name} is no column of a store", advice)]
    return []


def _check_field(field: _Field, needs_signal: bool) -> list[Any]:
    """Return the NamedTuples inside a field. Raises if something is wrong."""
    hint, signal = field.hint, field.signal
    while typing.get_origin(hint) is typing.Annotated:
        signal = next((mark for mark in hint.__metadata__ if isinstance(mark, Signal)), signal)
        hint = hint.__origin__
    kind_of(hint, () if field.default is ... and typing.get_origin(hint) is tuple else field.default)
    if field.default is ...:
        value = "0.0" if hint is float else "0" if hint is int else "False" if hint is bool else "..."
        raise _Wrong("has no default", f"write {field.name}: ... = {value}")
    if hint in NUMBERS:
        _check_number(field, hint, signal, needs_signal)
    if typing.get_origin(hint) is tuple:
        return _items(field, typing.get_args(hint), signal, needs_signal)
    return [hint] if is_named_tuple(hint) else []


def _items(field: _Field, items: tuple[Any, ...], signal: Signal | None, needs_signal: bool) -> list[Any]:
    if not isinstance(field.default, tuple):
        raise _Wrong(f"is a tuple, its default {field.default!r}", f"write ({field.default!r},) with all items")
    hints = [items[0]] * len(field.default) if items[-1] is Ellipsis else items
    if len(hints) != len(field.default):
        raise _Wrong(f"has {len(hints)} items, its default {len(field.default)}", "give each item a default")
    pairs = zip(hints, field.default, strict=True)
    return [
        inner
        for hint, value in pairs
        for inner in _check_field(field._replace(hint=hint, default=value, signal=signal), needs_signal)
    ]


def _check_number(field: _Field, hint: Any, signal: Signal | None, needs_signal: bool) -> None:
    default = field.default
    if hint is float and type(default) is int:
        raise _Wrong(f"is float, its default the int {default}", f"write {float(default)!r}: a float stays a float")
    if type(default) not in NUMBERS or (type(default) is not hint and not (hint is int and isinstance(default, int))):
        raise _Wrong(f"is {hint.__name__}, its default {default!r}", f"write a default that is {hint.__name__}")
    if not needs_signal:
        return
    if signal is None:
        advice = f"write {field.name}: {EXAMPLE.format(kind=hint.__name__)} = {default!r}"
        raise _Wrong("has no unit and no meaning", advice)
    if not signal.text or not signal.unit:
        raise _Wrong(f"has no {'unit' if signal.text else 'meaning'}", 'write Signal("m/s", "what it is")')
    try:
        unit(signal.unit)
    except ValueError as error:
        raise _Wrong(f"has the unit {signal.unit!r}", str(error)) from error
    if not signal.low <= default <= signal.high or not math.isfinite(default):
        raise _Wrong(f"starts at {default!r}", f"write a default in [{signal.low:g}, {signal.high:g}], or widen it")


def _lines(node: ast.ClassDef | None) -> dict[str, int]:
    found = {}
    for item in node.body if node else []:
        if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name):
            found[item.target.id] = item.lineno
    return found


def _fields_without_type(node: ast.ClassDef | None) -> dict[str, tuple[int, str]]:
    """Return name -> (line, value) of what a class assigns without a type: no field at all."""
    body = node.body if node else []
    assigned = [item for item in body if isinstance(item, ast.Assign)]
    return {
        target.id: (item.lineno, ast.unparse(item.value))
        for item in assigned
        for target in item.targets
        if isinstance(target, ast.Name)
    }
