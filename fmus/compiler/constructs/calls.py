"""Calls: functions of the model, NamedTuples and their methods, what is let in of Python's own and of math."""

import ast
import math
import re
from dataclasses import replace
from enum import IntEnum
from types import FunctionType
from typing import Any, NamedTuple

from fmus.compiler.constructs.builtin import BUILTINS, math_call
from fmus.compiler.constructs.columns import check_place
from fmus.compiler.constructs.generators import GENERATORS
from fmus.compiler.constructs.replacing import lower_replace
from fmus.compiler.source.advice import CALL_ADVICE
from fmus.compiler.source.diagnostics import AlreadySaidError, CannotError
from fmus.compiler.source.types import Array, Kind, Mixed, Open, Struct, describe, is_named_tuple, whole_of
from fmus.compiler.target.access import is_at, looks_at_place
from fmus.compiler.target.aggregates import coerce, spell_out, struct_of
from fmus.compiler.target.body import EXPRESSIONS, METHODS, FunctionBody
from fmus.compiler.target.functions import Instance, Parameter, instance_of
from fmus.compiler.target.in_place import InPlace
from fmus.compiler.target.signatures import signature
from fmus.compiler.target.storage import address, hoist, put, text_of
from fmus.compiler.target.values import Place, Value, place_of


def call(body: FunctionBody, node: ast.Call) -> Value:
    """Return the result of a call."""
    if any(isinstance(item, ast.Starred) for item in node.args) or any(item.arg is None for item in node.keywords):
        raise CannotError(node, "a call with * or **", "write the arguments out")
    found = body.static(node.func)
    if found is None:
        return _method(body, node)
    target = found.value
    word = str(getattr(target, "__name__", ""))
    if getattr(math, word, None) is target:
        return math_call(body, node, word)
    if found.module == "builtins" or target in BUILTINS:
        if target in GENERATORS and len(node.args) == 1 and isinstance(node.args[0], ast.GeneratorExp):
            return GENERATORS[target](body, node, node.args[0])
        handler = BUILTINS.get(target)
        if handler is None:
            raise CannotError(node, f"{found.name}()", CALL_ADVICE.get(found.name, "it has no place in model code"))
        return handler(body, node)
    if is_named_tuple(target):
        return construct(body, node, target)
    if isinstance(target, FunctionType):
        return invoke(body, node, target, node.args)
    name = ast.unparse(node.func)
    if isinstance(target, type):
        advice = "use the int itself" if issubclass(target, IntEnum) else "only NamedTuples are made in model code"
        raise CannotError(node, f"a call of {name}", advice)
    module = found.module.split(".")[0]
    raise CannotError(node, f"{name}() of {module}", f"use math and functions of the model: {module} has no C")


def invoke(
    body: FunctionBody, node: ast.Call, function: FunctionType, nodes: list[ast.expr], own: Value | None = None
) -> Value:
    """Return the result of a function of the model; ``own`` is what a method belongs to."""
    check_place(body, node, function)
    known = signature(body.program, function)
    name = function.__name__
    given = _arguments(node, name, list(known.kinds), nodes, own is not None)
    values: list[Value] = []
    for place, (word, kind) in enumerate(known.kinds.items()):
        if place == 0 and own is not None:
            value = own
        elif word in given:
            value = body.value(given[word])
        elif word in known.defaults:
            value = spell_out(body, known.defaults[word], kind)
        else:
            raise CannotError(node, f"{name}() without its argument {word}", f"it takes {', '.join(known.kinds)}")
        values.append(_argument(body, value, kind, given.get(word, node), f"{name}() takes {describe(kind)}"))
    made = instance_of(body.program, function, tuple(value.kind for value in values), node)
    if made.result is None:
        raise AlreadySaidError
    return _result(body, made, made.result, [_pass_argument(body, made, *pair) for pair in enumerate(values)])


class Argument(NamedTuple):
    """An argument of a call."""

    parameter: Parameter
    value: Value
    text: str


def _pass_argument(body: FunctionBody, made: Instance, number: int, value: Value) -> Argument:
    parameter = made.parameters[number]
    if made.changed is not None and number == made.changed.parameter:
        return Argument(parameter, value, place_of(value).text if value.place else "")
    text = address(body, value, parameter.name) if parameter.by_pointer else text_of(body, value, parameter.name)
    return Argument(parameter, value, text)


def _result(body: FunctionBody, made: Instance, kind: Kind, given: list[Argument]) -> Value:
    """Return what a function gives: an expression, or what it writes to pointers."""
    if not made.outs and made.changed is None:
        return Value(kind, f"{made.name}({', '.join(item.text for item in given)})")
    pointers = [item.text for item in given if item.parameter.by_pointer]
    words = frozenset(word for text in pointers for word in re.findall(r"[A-Za-z_]\w*", text))
    held = words if all(pointers) else None
    kinds = kind.items if isinstance(kind, Mixed) else (kind,)

    def fill_items(places: list[Place]) -> None:
        texts = [item.text for item in given]
        ends = [
            place.text if isinstance(one, Array) else place.address for place, one in zip(places, kinds, strict=True)
        ]
        if made.changed is not None:
            place = places[made.changed.result]
            texts = _changing(body, made.changed, given, place)
            del ends[made.changed.result]
        body.emit(f"{made.name}({', '.join([*texts, *ends])});")

    base = given[made.changed.parameter].value if made.changed is not None else None
    common = Value(kind, held=held, base=base if base is not None and base.place else None)
    if not isinstance(kind, Mixed):
        return replace(common, fill=lambda place: fill_items([place]))

    def fill(place: Place) -> None:
        fill_items([place.member(f"item{number}") for number in range(len(kinds))])

    changes = made.changed.result if made.changed is not None else 0
    return replace(common, fill=fill, fill_items=fill_items, changes=changes)


def _changing(body: FunctionBody, changed: InPlace, given: list[Argument], place: Place) -> list[str]:
    """Return the arguments of a call that changes what lies at ``place``; what else points there is copied before."""
    own = given[changed.parameter].value
    there = is_at(body, own, place)
    if not there:
        put(body, place, own)
    texts = []
    for number, item in enumerate(given):
        if number == changed.parameter:
            texts.append(place.address)
        elif there and item.parameter.by_pointer and item.value.place and looks_at_place(body, item.text, place):
            texts.append(address(body, hoist(body, item.value, item.parameter.name), item.parameter.name))
        else:
            texts.append(item.text)
    return texts


def _argument(body: FunctionBody, value: Value, kind: Kind, node: ast.AST, why: str) -> Value:
    """Return an argument as the kind that is expected; a tuple of any length for ``tuple[X, ...]``."""
    if isinstance(kind, Open):
        if isinstance(value.kind, Array) and value.kind.item == kind.item:
            return value
        raise CannotError(node, f"{describe(value.kind)} where {why}", f"make it {describe(kind)}")
    return coerce(body, value, kind, node, why)


def _arguments(
    node: ast.Call, name: str, names: list[str], nodes: list[ast.expr], has_own: bool = False
) -> dict[str, ast.expr]:
    """Return the argument of each name."""
    places = names[1:] if has_own else names
    if len(nodes) > len(places):
        raise CannotError(node, f"{name}() with {len(nodes)} arguments", f"it takes {', '.join(places) or 'none'}")
    found = dict(zip(places, nodes, strict=False))
    for keyword in node.keywords:
        word = str(keyword.arg)
        if word not in places:
            raise CannotError(node, f"{name}() has no {word}", f"it takes {', '.join(places) or 'nothing'}")
        if word in found:
            raise CannotError(node, f"{name}() with two values for {word}", "write one")
        found[word] = keyword.value
    return found


def construct(body: FunctionBody, node: ast.Call, cls: Any) -> Value:
    """Return ``Cls(...)``; fields left out have their defaults."""
    whole = whole_of(cls)
    if whole is not cls and node.args:
        raise CannotError(node, f"{cls.__name__}() with arguments without a name", "name each, as in reason=...")
    cls = whole
    kinds = body.program.fields(cls, node)
    given = _arguments(node, cls.__name__, list(kinds), node.args)
    kind = Struct(cls)
    body.program.need(kind)
    if not given and len(cls._field_defaults) == len(kinds):
        return Value(kind, body.program.default(cls), place=True, fixed=True, const=cls())
    fields: dict[str, Value] = {}
    for name, wanted in kinds.items():
        if name in given:
            why = f"{cls.__name__}.{name} is {describe(wanted)}"
            fields[name] = coerce(body, body.value(given[name]), wanted, given[name], why)
        elif name in cls._field_defaults:
            fields[name] = spell_out(body, cls._field_defaults[name], wanted)
        else:
            raise CannotError(node, f"{cls.__name__}() without its field {name}", f"it has {', '.join(kinds)}")
    return struct_of(body, kind, fields)


def _method(body: FunctionBody, node: ast.Call) -> Value:
    """Return ``x._replace(...)`` or a method of a NamedTuple."""
    if not isinstance(node.func, ast.Attribute):
        raise CannotError(node, f"a call of {ast.unparse(node.func)}", "call a function of the model by its name")
    word = node.func.attr
    base = body.static(node.func.value)
    if base is not None and not isinstance(base.value, tuple):
        name = ast.unparse(node.func)
        raise CannotError(node, f"{name}() is not known", f"{base.name} has no {word} that has a C")
    value = body.value(node.func.value)
    if not isinstance(value.kind, Struct):
        advice = "write a function of the value, or a loop over the items"
        raise CannotError(node, f".{word}() of {describe(value.kind)}", advice)
    if word == "_replace":
        return lower_replace(body, node, value)
    function = vars(value.kind.cls).get(word)
    if not isinstance(function, FunctionType) or word.startswith("_"):
        what = f"{value.kind.cls.__name__} has no method {word}"
        raise CannotError(node, what, f"it has the fields {', '.join(value.kind.cls._fields)}")
    return invoke(body, node, function, node.args, value)


def _property(body: FunctionBody, value: Value, name: str, node: ast.AST) -> Value:
    """Return a property of a NamedTuple."""
    assert isinstance(value.kind, Struct)
    found = vars(value.kind.cls).get(name)
    if not isinstance(found, property) or not isinstance(found.fget, FunctionType):
        what = f"{value.kind.cls.__name__} has no field {name}"
        raise CannotError(node, what, f"it has {', '.join(value.kind.cls._fields)}")
    empty = ast.copy_location(ast.Call(ast.Name(name, ast.Load()), [], []), node)
    return invoke(body, empty, found.fget, [], value)


EXPRESSIONS[ast.Call] = call
METHODS[property] = _property
