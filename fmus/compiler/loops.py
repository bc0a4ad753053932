"""For loops over ranges and tuples, and the generators inside tuple(), any(), all(), sum(), min() and max()."""

import ast
from dataclasses import dataclass

from fmus.compiler.bindings import block, stored_in
from fmus.compiler.body import STATEMENTS, Body
from fmus.compiler.kinds import INT, Array, described
from fmus.compiler.refusals import CannotError
from fmus.compiler.statements import unpack
from fmus.compiler.values import UNKNOWN, Value, as_int, element, literal


@dataclass
class Range:
    """The numbers of a range."""

    start: Value
    stop: Value
    step: int

    def bounds(self) -> tuple[int, int] | None:
        """Return the least and the greatest number, if known."""
        first, last = self.start.bounds(), self.stop.bounds()
        if first is None or last is None:
            return None
        if self.step > 0:
            return first[0], max(last[1] - 1, first[0])
        return min(last[0] + 1, first[1]), first[1]


def for_loop(body: Body, node: ast.For) -> None:
    """Write a for loop."""
    if node.orelse:
        raise CannotError(node.orelse[0], "else after a loop", "set a bool in the loop and test it after")
    inside = block(body.frames[-1].path, node, "body")
    if _is_call(node.iter, "range"):
        _over_range(body, node, range_of(body, node.iter), inside)
        return
    index = body.names.add("i")
    length, item = items_at(body, node.iter, index, stored_in(node.body))
    body.emit(f"for (int {index} = 0; {index} < {length}; ++{index}) {{")
    with body.frame(inside):
        body.begin_statement()
        unpack(body, node.target, item, node.target)
        body.more_statements(node.body)
    body.emit("}")
    body.names.taken.discard(index)


def range_of(body: Body, node: ast.expr) -> Range:
    """Return the start, stop and step of ``range(...)``."""
    assert isinstance(node, ast.Call)
    if node.keywords or not 1 <= len(node.args) <= 3:
        raise CannotError(node, "range() with these arguments", "write range(stop), range(start, stop) or with a step")
    values = [body.value(item) for item in node.args]
    for value, item in zip(values, node.args, strict=True):
        if value.kind != INT:
            raise CannotError(item, f"range() of {described(value.kind)}", "write an int: math.floor(x), int(x)")
    values = [as_int(value) for value in values]
    start, stop = (literal(0), values[0]) if len(values) == 1 else (values[0], values[1])
    step = values[2].const if len(values) == 3 else 1
    if step is UNKNOWN or step == 0:
        raise CannotError(node, "range() with a step that varies or is 0", "write the step as a number")
    return Range(start, stop, int(step))


def _over_range(body: Body, node: ast.For, numbers: Range, inside: tuple[tuple[int, str], ...]) -> None:
    if not isinstance(node.target, ast.Name):
        raise CannotError(node.target, "several names for a number of a range", "write one name")
    name = node.target.id
    changed = stored_in(node.body)
    stop = (
        numbers.stop if numbers.stop.const is not UNKNOWN or _stays(numbers.stop) else body.hoist(numbers.stop, "stop")
    )
    counts = body.bindings.homes[name] == inside and name not in changed and body.bindings.loads[name] > 0
    counts = counts and name not in body.bindings.parameters and body.bindings.stores[name] >= 1
    limits = numbers.bounds()
    low, high = limits if limits else (None, None)
    known = body.variable(name)
    if counts and (known.kind is None or known.kind == INT):
        counter = known.c
        known.kind, known.fixed, known.low, known.high, known.line = INT, True, low, high, node.lineno
    else:
        counts = False
        counter = body.names.add("i")
    body.emit(_range_head(counter, numbers, stop.text))
    with body.frame(inside):
        body.begin_statement()
        if not counts and body.bindings.loads[name]:
            body.bind(name, Value(INT, counter, place=True, low=low, high=high), node)
        body.more_statements(node.body)
    body.emit("}")
    if not counts:
        body.names.taken.discard(counter)


def _stays(value: Value) -> bool:
    return value.place and value.fixed


def _range_head(counter: str, numbers: Range, stop: str) -> str:
    sign, step = ("<", numbers.step) if numbers.step > 0 else (">", -numbers.step)
    count = f"{'++' if numbers.step > 0 else '--'}{counter}"
    if step != 1:
        count = f"{counter} {'+' if numbers.step > 0 else '-'}= {step}"
    return f"for (int64_t {counter} = {numbers.start.text}; {counter} {sign} {stop}; {count}) {{"


def items_at(body: Body, node: ast.expr, index: str, changed: set[str]) -> tuple[int, Value]:
    """Return how many items ``node`` has, and the one at ``index``; ``changed`` names what the loop binds."""
    if _is_call(node, "enumerate"):
        return _enumerated(body, node, index, changed)
    if _is_call(node, "zip"):
        return _zipped(body, node, index, changed)
    value = body.value(node)
    if not isinstance(value.kind, Array):
        raise CannotError(node, f"a loop over {described(value.kind)}", "loop over a tuple or range(...)")
    kind = value.kind
    stays = value.place and not any(name in changed for name in _names(node))
    if not stays:
        value = body.hoist(value, "items")
    fixed = value.fixed or stays
    return kind.length, Value(kind.item, element(value, index), place=True, fixed=fixed)


def _names(node: ast.AST) -> set[str]:
    return {item.id for item in ast.walk(node) if isinstance(item, ast.Name)}


def _enumerated(body: Body, node: ast.expr, index: str, changed: set[str]) -> tuple[int, Value]:
    from fmus.compiler.body import tuple_of

    assert isinstance(node, ast.Call)
    starts = [*node.args[1:], *(item.value for item in node.keywords if item.arg == "start")]
    if not node.args or len(starts) > 1 or len(node.keywords) > len(starts):
        raise CannotError(node, "enumerate() with these arguments", "write enumerate(xs) or enumerate(xs, start)")
    length, item = items_at(body, node.args[0], index, changed)
    start = body.value(starts[0]) if starts else literal(0)
    if start.kind != INT or start.const is UNKNOWN:
        raise CannotError(node, "enumerate() with a start that varies", "write the start as a number")
    text = index if start.const == 0 else f"{index} + {start.text}"
    level = literal(0).level if start.const == 0 else literal(0).level - 3
    number = Value(INT, text, level, narrow=True, low=start.const, high=start.const + length - 1)
    return length, tuple_of(body, (number, item))


def _zipped(body: Body, node: ast.expr, index: str, changed: set[str]) -> tuple[int, Value]:
    from fmus.compiler.body import tuple_of

    assert isinstance(node, ast.Call)
    if any(item.arg != "strict" for item in node.keywords) or not node.args:
        raise CannotError(node, "zip() with these arguments", "write zip(xs, ys, strict=True)")
    found = [items_at(body, item, index, changed) for item in node.args]
    lengths = {length for length, _ in found}
    if len(lengths) > 1:
        what = f"zip() of tuples of {', '.join(str(length) for length in sorted(lengths))} items"
        raise CannotError(node, what, "make them equally long, or write xs[:n]")
    return found[0][0], tuple_of(body, tuple(item for _, item in found))


def _is_call(node: ast.expr, name: str) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == name


STATEMENTS[ast.For] = for_loop
