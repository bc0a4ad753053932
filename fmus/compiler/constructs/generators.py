"""``tuple(f(x) for x in xs)``, and any(), all(), sum(), min() and max() of the same."""

import ast
from collections.abc import Callable
from typing import Any, NamedTuple

from fmus.compiler.constructs.conditions import condition
from fmus.compiler.constructs.loops import is_call, items_at, range_head, range_of, steady
from fmus.compiler.constructs.unpacking import items_of
from fmus.compiler.source.bindings import Home
from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.types import BOOL, FLOAT, INT, Array, Scalar, describe
from fmus.compiler.target.aggregates import coerce
from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.storage import put
from fmus.compiler.target.values import Place, Value, as_int
from fmus.compiler.target.variables import LocalVariable


class Loop(NamedTuple):
    """The C loop that a generator is."""

    head: str
    counter: str
    length: int | None
    lines: list[Any]
    """What is worked out in each round before the item."""
    item: Value
    tests: list[Value]


def _loop(body: FunctionBody, node: ast.GeneratorExp, truth: bool = False) -> Loop:
    """Return the loop of a generator, whose variables are seen inside it alone."""
    if len(node.generators) > 1:
        raise CannotError(node, "a generator with two loops", "write for loops")
    (part,) = node.generators
    counter = body.names.add("i")
    scope: dict[str, LocalVariable] = {}
    if is_call(body, part.iter, range):
        numbers = range_of(body, part.iter)
        low, high = numbers.bounds()
        head, length = range_head(counter, numbers, steady(body, numbers.stop)), numbers.length()
        value = Value(INT, counter, place=True, fixed=True, low=low, high=high)
    else:
        length, value = items_at(body, part.iter, counter, set())
        head = f"for (int {counter} = 0; {counter} < {length}; ++{counter}) {{"
    _name_items(body, scope, part.target, value)
    body.scopes.append(scope)
    with body.capture() as lines:
        tests = [condition(body, test) for test in part.ifs]
        item = condition(body, node.elt) if truth else body.value(node.elt)
    body.scopes.pop()
    return Loop(head, counter, length, lines, item, tests)


def _name_items(body: FunctionBody, scope: dict[str, LocalVariable], target: ast.expr, value: Value) -> None:
    """Let the names of ``target`` mean the items of ``value`` where they are."""
    if isinstance(target, ast.Name):
        known = LocalVariable(value.text, Home(()), kind=value.kind, pointer=value.pointer, fixed=True)
        known.low, known.high, known.level, known.narrow = value.low, value.high, value.level, value.narrow
        scope[target.id] = known
    elif isinstance(target, ast.Tuple):
        items = items_of(body, value, target)
        if len(items) != len(target.elts):
            raise CannotError(target, f"{len(target.elts)} names for {len(items)} items", "write one name for each")
        for part, item in zip(target.elts, items, strict=True):
            _name_items(body, scope, part, item)
    else:
        raise CannotError(target, f"{ast.unparse(target)} in a generator", "write names")


def lower_tuple(body: FunctionBody, node: ast.Call, generator: ast.GeneratorExp) -> Value:
    """Return ``tuple(f(x) for x in xs)``."""
    loop = _loop(body, generator)
    if loop.tests:
        raise CannotError(generator, "a tuple whose length a condition decides", "keep all items, and a bool for each")
    if not loop.length:
        raise CannotError(generator, "a tuple of unknown length", "loop over a tuple, or a range of constants")
    kind = Array(loop.item.kind, loop.length)

    def fill(place: Place) -> None:
        at = loop.counter
        starts_at_0 = (
            loop.head.startswith((f"for (int {at} = 0;", f"for (int64_t {at} = 0;")) and f"++{at}" in loop.head
        )
        index = at if starts_at_0 else body.names.add("place")
        if not starts_at_0:
            body.emit(f"int {index} = 0;")
        body.emit(loop.head)
        body.lines += loop.lines
        put(body, place.element(index), loop.item)
        if not starts_at_0:
            body.emit(f"++{index};")
        body.emit("}")

    return Value(kind, fill=fill)


def _run(body: FunctionBody, loop: Loop, inside: list[str]) -> None:
    """Write a loop; ``inside`` is done in each round that the conditions let in."""
    body.emit(loop.head)
    body.lines += loop.lines
    if loop.tests:
        tests = " && ".join(f"({test.text})" if len(loop.tests) > 1 else test.text for test in loop.tests)
        body.emit(f"if ({tests}) {{")
    body.lines += inside
    body.lines += ["}"] * (2 if loop.tests else 1)


def any_or_all(word: str) -> Callable[[FunctionBody, ast.Call, ast.GeneratorExp], Value]:
    """Return the translation of any or all."""

    def lower(body: FunctionBody, node: ast.Call, generator: ast.GeneratorExp) -> Value:
        loop = _loop(body, generator, truth=True)
        result = body.names.add(f"{word}_of")
        test = loop.item.text if word == "any" else f"!({loop.item.text})"
        body.emit(f"bool {result} = {'false' if word == 'any' else 'true'};")
        found = "true" if word == "any" else "false"
        _run(body, loop, [f"if ({test}) {{", f"{result} = {found};", "break;", "}"])
        return Value(BOOL, result)

    return lower


def total(body: FunctionBody, node: ast.Call, generator: ast.GeneratorExp) -> Value:
    """Return ``sum(f(x) for x in xs)`` of integers."""
    loop = _loop(body, generator)
    if loop.item.kind == FLOAT:
        raise CannotError(node, "sum() of floats, which from Python 3.12 on adds otherwise", "write a loop that adds")
    item = coerce(body, loop.item, INT, generator.elt, "sum() of integers is meant")
    result = body.names.add("sum")
    body.emit(f"int64_t {result} = 0;")
    _run(body, loop, [f"{result} += {item.text};"])
    return Value(INT, result)


def extreme(word: str) -> Callable[[FunctionBody, ast.Call, ast.GeneratorExp], Value]:
    """Return the translation of min or max: the first item stays unless a later one is less (or greater)."""

    def lower(body: FunctionBody, node: ast.Call, generator: ast.GeneratorExp) -> Value:
        if node.keywords:
            raise CannotError(node, f"{word}() with {node.keywords[0].arg}", "write a loop")
        loop = _loop(body, generator)
        if loop.tests or not loop.length:
            raise CannotError(generator, f"{word}() of what may be empty", "write a loop that begins with a value")
        if not isinstance(loop.item.kind, Scalar):
            raise CannotError(node, f"{word}() of {describe(loop.item.kind)}", "give it numbers")
        item = as_int(loop.item)
        result, first, new = body.names.add(f"{word}_of"), body.names.add("first"), body.names.add("new")
        kind = item.kind
        assert isinstance(kind, Scalar)
        body.lines += [f"{kind.c} {result} = 0;", f"bool {first} = true;"]
        test = f"if ({first} || {new} {'<' if word == 'min' else '>'} {result}) {{"
        _run(body, loop, [f"const {kind.c} {new} = {item.text};", test, f"{result} = {new};", "}", f"{first} = false;"])
        return Value(kind, result)

    return lower


GENERATORS: dict[Any, Callable[[FunctionBody, ast.Call, ast.GeneratorExp], Value]] = {
    tuple: lower_tuple,
    any: any_or_all("any"),
    all: any_or_all("all"),
    sum: total,
    min: extreme("min"),
    max: extreme("max"),
}
