"""For loops over ranges and tuples of fixed length."""

import ast
from dataclasses import dataclass
from types import FunctionType

from fmus.compiler.constructs.unpacking import unpack
from fmus.compiler.source.bindings import Path, block, variables_bound
from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.types import INT, Array, describe
from fmus.compiler.target.aggregates import tuple_of
from fmus.compiler.target.body import STATEMENTS, FunctionBody
from fmus.compiler.target.storage import hoist, item_of
from fmus.compiler.target.values import SUM, UNKNOWN, Value, as_int, literal
from fmus.compiler.target.variables import LocalVariable, bind, variable


@dataclass
class LoopRange:
    """The numbers of a range."""

    start: Value
    stop: Value
    step: int

    def bounds(self) -> tuple[int | None, int | None]:
        """Return the least and the greatest number as far as they are known."""
        if self.step > 0:
            most = self.stop.most()
            return self.start.least(), None if most is None else most - 1
        least = self.stop.least()
        return None if least is None else least + 1, self.start.most()

    def length(self) -> int | None:
        """Return how many numbers there are, if known."""
        if UNKNOWN in (self.start.const, self.stop.const):
            return None
        return len(range(self.start.const, self.stop.const, self.step))


def for_loop(body: FunctionBody, node: ast.For) -> None:
    """Write a for loop."""
    if node.orelse:
        raise CannotError(node.orelse[0], "else after a loop", "set a bool in the loop and test it after")
    inside = block(body.frames[-1].path, node, "body")
    if is_call(body, node.iter, range):
        _over_range(body, node, range_of(body, node.iter), inside)
        return
    source, target = node.iter, node.target
    number = _plain_number(body, node)
    known = number and _counter(body, number, inside)
    if known:
        assert isinstance(source, ast.Call)
        assert isinstance(target, ast.Tuple)
        source, target = source.args[0], target.elts[1]
    index = known.c if known else body.names.add("i")
    length, item = items_at(body, source, index, variables_bound(node.body))
    body.emit(f"for ({'int64_t' if known else 'int'} {index} = 0; {index} < {length}; ++{index}) {{")
    if known:
        known.low, known.high = 0, length - 1
    with body.frame(inside):
        body.begin_statement()
        unpack(body, target, item, target)
        body.more_statements(node.body)
    body.emit("}")
    if not known:
        body.names.taken.discard(index)


def _plain_number(body: FunctionBody, node: ast.For) -> str:
    """Return the name that counts in ``for i, x in enumerate(xs)``, else an empty string."""
    if not is_call(body, node.iter, enumerate) or not isinstance(node.target, ast.Tuple):
        return ""
    assert isinstance(node.iter, ast.Call)
    first = node.target.elts[0]
    plain = len(node.iter.args) == 1 and not node.iter.keywords and len(node.target.elts) == 2
    return first.id if plain and isinstance(first, ast.Name) else ""


def _counter(body: FunctionBody, name: str, inside: Path) -> LocalVariable | None:
    """Return the variable ``name`` if C can count with it: it is bound by the loop alone and read inside alone."""
    home = body.bindings.home(name, inside)
    if home.path != inside or home.stores != 1 or not home.loads or name in body.bindings.parameters:
        return None
    with body.frame(inside):
        known = variable(body, name)
    known.kind, known.fixed = INT, True
    return known


def range_of(body: FunctionBody, node: ast.expr) -> LoopRange:
    """Return the start, stop and step of ``range(...)``."""
    assert isinstance(node, ast.Call)
    if node.keywords or not 1 <= len(node.args) <= 3:
        raise CannotError(node, "range() with these arguments", "write range(stop), range(start, stop) or with a step")
    values = [body.value(item) for item in node.args]
    for value, item in zip(values, node.args, strict=True):
        if value.kind != INT:
            raise CannotError(item, f"range() of {describe(value.kind)}", "write an int: math.floor(x), int(x)")
    values = [as_int(value) for value in values]
    start, stop = (literal(0), values[0]) if len(values) == 1 else (values[0], values[1])
    step = values[2].const if len(values) == 3 else 1
    if step is UNKNOWN or step == 0:
        raise CannotError(node, "range() with a step that varies or is 0", "write the step as a number")
    return LoopRange(start, stop, int(step))


def _over_range(body: FunctionBody, node: ast.For, numbers: LoopRange, inside: Path) -> None:
    if not isinstance(node.target, ast.Name):
        raise CannotError(node.target, "several names for a number of a range", "write one name")
    name = node.target.id
    low, high = numbers.bounds()
    stop = steady(body, numbers.stop)
    known = _counter(body, name, inside)
    if known:
        known.low, known.high = low, high
    counter = known.c if known else body.names.add("i")
    body.emit(range_head(counter, numbers, stop))
    with body.frame(inside):
        body.begin_statement()
        if known is None and body.bindings.home(name, inside).loads:
            bind(body, name, Value(INT, counter, place=True, low=low, high=high), node)
        body.more_statements(node.body)
    body.emit("}")
    if known is None:
        body.names.taken.discard(counter)


def steady(body: FunctionBody, value: Value) -> str:
    """Return the text of the end of a range, which is worked out once."""
    if value.const is not UNKNOWN or (value.place and value.fixed):
        return value.text
    return hoist(body, value, "stop").text


def range_head(counter: str, numbers: LoopRange, stop: str) -> str:
    """Return the head of a loop over a range."""
    sign, step = ("<", numbers.step) if numbers.step > 0 else (">", -numbers.step)
    count = f"{'++' if numbers.step > 0 else '--'}{counter}"
    if step != 1:
        count = f"{counter} {'+' if numbers.step > 0 else '-'}= {step}"
    return f"for (int64_t {counter} = {numbers.start.text}; {counter} {sign} {stop}; {count}) {{"


def items_at(body: FunctionBody, node: ast.expr, index: str, changed: set[str]) -> tuple[int, Value]:
    """Return how many items ``node`` has, and the one at ``index``; ``changed`` names what the loop binds."""
    if is_call(body, node, enumerate):
        return _lower_enumerate(body, node, index, changed)
    if is_call(body, node, zip):
        return _lower_zip(body, node, index, changed)
    if is_call(body, node, reversed):
        raise CannotError(node, "reversed()", "write range(n - 1, -1, -1) and xs[i], or xs[::-1]")
    value = body.value(node)
    if not isinstance(value.kind, Array):
        raise CannotError(node, f"a loop over {describe(value.kind)}", "loop over a tuple or range(...)")
    names = {item.id for item in ast.walk(node) if isinstance(item, ast.Name)}
    stays = value.place and not names & changed
    if not stays:
        value = hoist(body, value, "items")
    item = item_of(value, index)
    return value.kind.length, Value(item.kind, item.text, place=True, fixed=value.fixed or stays)  # type: ignore[union-attr]


def _lower_enumerate(body: FunctionBody, node: ast.expr, index: str, changed: set[str]) -> tuple[int, Value]:
    assert isinstance(node, ast.Call)
    starts = [*node.args[1:], *(item.value for item in node.keywords if item.arg == "start")]
    if not node.args or len(starts) > 1 or len(node.keywords) > len(starts):
        raise CannotError(node, "enumerate() with these arguments", "write enumerate(xs) or enumerate(xs, start)")
    length, item = items_at(body, node.args[0], index, changed)
    start = body.value(starts[0]) if starts else literal(0)
    if start.kind != INT or start.const is UNKNOWN or not start.narrow:
        raise CannotError(node, "enumerate() with a start that varies", "write the start as a number")
    number = Value(INT, index, narrow=True, low=0, high=length - 1)
    if start.const != 0:
        text = f"{index} + {start.text}" if start.const > 0 else f"{index} - {-start.const}"
        number = Value(INT, text, SUM, narrow=True, low=start.const, high=start.const + length - 1)
    return length, tuple_of(body, (number, item))


def _lower_zip(body: FunctionBody, node: ast.expr, index: str, changed: set[str]) -> tuple[int, Value]:
    assert isinstance(node, ast.Call)
    if any(item.arg != "strict" for item in node.keywords) or not node.args:
        raise CannotError(node, "zip() with these arguments", "write zip(xs, ys, strict=True)")
    found = [items_at(body, item, index, changed) for item in node.args]
    lengths = sorted({length for length, _ in found})
    if len(lengths) > 1:
        what = f"zip() of tuples of {' and '.join(str(length) for length in lengths)} items"
        raise CannotError(node, what, "make them equally long, or write xs[:n]")
    return lengths[0], tuple_of(body, tuple(item for _, item in found))


def is_call(body: FunctionBody, node: ast.expr, builtin: type | FunctionType) -> bool:
    """Return whether an expression calls a function of Python's own."""
    if not isinstance(node, ast.Call):
        return False
    found = body.static(node.func)
    return found is not None and found.value is builtin


STATEMENTS[ast.For] = for_loop
