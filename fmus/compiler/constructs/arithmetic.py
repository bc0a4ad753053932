"""Numbers: names, constants, + - * / // % << >> & | ^ ~, as Python defines them."""

import ast
import operator
from collections.abc import Callable
from typing import Any

from fmus.compiler.constructs.items import with_item
from fmus.compiler.slicing import DeadValue
from fmus.compiler.source.diagnostics import AlreadySaidError, CannotError
from fmus.compiler.source.types import BOOL, FLOAT, INT, Array, describe
from fmus.compiler.target.aggregates import elements, repeat_items, tuple_of, zero
from fmus.compiler.target.body import EXPRESSIONS, FunctionBody
from fmus.compiler.target.values import (
    BIT_AND,
    BIT_OR,
    BIT_XOR,
    INT32,
    INT64,
    MAX_EXACT_INTEGER,
    PRIMARY,
    PRODUCT,
    SUM,
    UNARY,
    UNKNOWN,
    Value,
    as_float,
    as_int,
    as_wide,
    literal,
    within,
)
from fmus.compiler.target.variables import variable

SIGNS: dict[type[ast.operator], tuple[str, int]] = {
    ast.Add: ("+", SUM),
    ast.Sub: ("-", SUM),
    ast.Mult: ("*", PRODUCT),
    ast.Div: ("/", PRODUCT),
    ast.BitAnd: ("&", BIT_AND),
    ast.BitOr: ("|", BIT_OR),
    ast.BitXor: ("^", BIT_XOR),
}
HELPED = {ast.FloorDiv: "floor_div", ast.Mod: "floor_mod", ast.LShift: "shift_left", ast.RShift: "shift_right"}
WORDS = {ast.FloorDiv: "//", ast.Mod: "%", ast.LShift: "<<", ast.RShift: ">>", ast.Pow: "**", ast.MatMult: "@"}
PYTHON: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.LShift: operator.lshift,
    ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
}
MOST_ITEMS = 10_000
FLOAT_ADVICE = {ast.FloorDiv: "write math.floor(a / b)", ast.Mod: "write a - b * math.floor(a / b)"}


def constant(body: FunctionBody, node: ast.Constant) -> Value:
    """Return a number or truth value written in the source."""
    if type(node.value) in (float, bool):
        return literal(node.value)
    if isinstance(node.value, DeadValue):
        return zero(body, node.value.kind)
    if type(node.value) is int:
        return in_64_bits(literal(node.value), node)
    if isinstance(node.value, str | bytes):
        raise CannotError(node, "a string", "name what is meant by an IntEnum; text is made outside of the model")
    if node.value is None:
        advice = "return a value on every path; for 'no value' keep a bool beside it"
        raise CannotError(node, "None", advice)
    raise CannotError(node, f"the constant {node.value!r}", "write a float, an int, True or False")


def name(body: FunctionBody, node: ast.Name) -> Value:
    """Return a variable, or a constant of the module."""
    if any(node.id in scope for scope in body.scopes) or node.id in body.bindings.local:
        known = variable(body, node.id)
        if known.kind is None:
            raise AlreadySaidError
        return known.value()
    found = body.static(node)
    if found is None:
        raise CannotError(node, f"{node.id} is not known", "define it in the module, or import it from one that does")
    if callable(found.value) or isinstance(found.value, type):
        raise CannotError(node, f"the function or class {node.id} as a value", "call it here")
    return body.program.constant(found, node)


def binary(body: FunctionBody, node: ast.BinOp) -> Value:
    """Return ``a + b`` and the like."""
    changed = with_item(body, node)
    if changed is not None:
        return changed
    left, right = body.value(node.left), body.value(node.right)
    kind = type(node.op)
    if isinstance(left.kind, Array) or isinstance(right.kind, Array):
        return _of_tuples(body, node, left, right)
    for side, value in ((node.left, left), (node.right, right)):
        if value.kind not in (FLOAT, INT, BOOL):
            raise CannotError(side, f"arithmetic with {describe(value.kind)}", "name the field that is meant")
    if kind in (ast.Pow, ast.MatMult):
        raise CannotError(node, WORDS[kind], "write x * x, math.sqrt(x) or math.exp(y * math.log(x))")
    if FLOAT in (left.kind, right.kind):
        return _of_floats(node, as_float(left), as_float(right))
    if kind is ast.Div:
        return _quotient(body, node, as_int(left), as_int(right))
    if left.kind == right.kind == BOOL and kind in (ast.BitAnd, ast.BitOr, ast.BitXor):
        sign, level = SIGNS[kind]
        return Value(BOOL, f"{within(left, PRIMARY)} {sign} {within(right, PRIMARY)}", level)
    return _of_ints(body, node, as_int(left), as_int(right))


def _of_floats(node: ast.BinOp, left: Value, right: Value) -> Value:
    kind = type(node.op)
    if kind not in (ast.Add, ast.Sub, ast.Mult, ast.Div):
        advice = FLOAT_ADVICE.get(kind, "write int(...) around the operands")
        raise CannotError(node, f"{_sign(node)} of floats", advice)
    sign, level = SIGNS[kind]
    const = _fold(kind, left, right)
    return Value(FLOAT, f"{within(left, level)} {sign} {within(right, level + 1)}", level, const=const)


def _of_ints(body: FunctionBody, node: ast.BinOp, left: Value, right: Value) -> Value:
    kind = type(node.op)
    const = _fold(kind, left, right)
    if kind in (ast.LShift, ast.RShift) and right.const is not UNKNOWN and not 0 <= right.const < 64:
        raise CannotError(node, f"a shift by {right.const} bits", "shift by 0 to 63 bits")
    if kind in (ast.FloorDiv, ast.Mod) and right.const is not UNKNOWN and right.const == 0:
        raise CannotError(node, f"{_sign(node)} by 0", "divide by something else")
    low, high = _bounds(kind, left, right)
    if kind in HELPED:
        text = f"{body.program.helper(HELPED[kind])}({left.text}, {right.text})"
        return in_64_bits(Value(INT, text, const=const, low=low, high=high), node)
    if left.narrow and right.narrow and not (const is not UNKNOWN and -INT32 < const < INT32):
        left = as_wide(left)
    sign, level = SIGNS[kind]
    if level < SUM:
        text = f"{within(left, PRIMARY)} {sign} {within(right, PRIMARY)}"
    else:
        text = f"{within(left, level)} {sign} {within(right, level + 1)}"
    narrow = left.narrow and right.narrow
    return in_64_bits(Value(INT, text, level, const=const, low=low, high=high, narrow=narrow), node)


def _quotient(body: FunctionBody, node: ast.BinOp, left: Value, right: Value) -> Value:
    """Return ``a / b`` of integers, which Python rounds once from the exact quotient."""
    if left.lies_in(-MAX_EXACT_INTEGER, MAX_EXACT_INTEGER) and right.lies_in(-MAX_EXACT_INTEGER, MAX_EXACT_INTEGER):
        return _of_floats(node, as_float(left), as_float(right))
    return Value(FLOAT, f"{body.program.helper('int_quotient')}({left.text}, {right.text})")


def _fold(kind: type[ast.operator], left: Value, right: Value) -> Any:
    """Return the result if both operands are known and Python has one."""
    if UNKNOWN in (left.const, right.const) or (kind is ast.LShift and right.const > 64):
        return UNKNOWN
    try:
        return PYTHON[kind](left.const, right.const)
    except (ArithmeticError, ValueError):
        return UNKNOWN


def _bounds(kind: type[ast.operator], left: Value, right: Value) -> tuple[int | None, int | None]:
    """Return the least and greatest result as far as they follow from those of the operands."""
    a, b, c, d = left.least(), left.most(), right.least(), right.most()
    if kind is ast.Mod and right.const is not UNKNOWN and right.const > 0:
        return 0, right.const - 1
    if kind is ast.BitAnd:
        masks = [item.const for item in (left, right) if item.const is not UNKNOWN and item.const >= 0]
        return (0, min(masks)) if masks else (None, None)
    if kind is ast.Add:
        return None if a is None or c is None else a + c, None if b is None or d is None else b + d
    if kind is ast.Sub:
        return None if a is None or d is None else a - d, None if b is None or c is None else b - c
    if a is None or b is None or c is None or d is None:
        return None, None
    if kind is ast.Mult or (kind is ast.FloorDiv and c > 0):
        ends = [PYTHON[kind](x, y) for x in (a, b) for y in (c, d)]
        return min(ends), max(ends)
    return None, None


def in_64_bits(value: Value, node: ast.AST) -> Value:
    """Return ``value``; refuse an integer that is known to be too large."""
    if value.const is not UNKNOWN and not -INT64 <= value.const < INT64:
        raise CannotError(node, f"the integer {value.const}", "keep integers within 64 bits")
    return value


def _of_tuples(body: FunctionBody, node: ast.BinOp, left: Value, right: Value) -> Value:
    """Return tuples joined by + or repeated by *."""
    if isinstance(node.op, ast.Mult):
        items, count = (left, right) if isinstance(left.kind, Array) else (right, left)
        if count.const is UNKNOWN or count.kind != INT:
            raise CannotError(node, "a tuple repeated an unknown number of times", "write the number, or a constant")
        if count.const < 1:
            raise CannotError(node, "an empty tuple", "repeat it at least once")
        if count.const > MOST_ITEMS:
            raise CannotError(node, f"a tuple repeated {count.const} times", f"repeat it {MOST_ITEMS} times at most")
        return repeat_items(body, elements(body, items), count.const)
    if not isinstance(node.op, ast.Add) or not (isinstance(left.kind, Array) and isinstance(right.kind, Array)):
        raise CannotError(node, f"{_sign(node)} of a tuple", "join tuples with +, repeat them with *")
    if left.kind.item != right.kind.item:
        what = f"{describe(left.kind)} joined to {describe(right.kind)}"
        raise CannotError(node, what, "join tuples of one kind of items")
    return tuple_of(body, elements(body, left) + elements(body, right))


def unary(body: FunctionBody, node: ast.UnaryOp) -> Value:
    """Return ``-x``, ``+x``, ``~x``."""
    value = body.scalar(node.operand)
    if isinstance(node.op, ast.Invert):
        if value.kind != INT:
            raise CannotError(node, f"~ of {describe(value.kind)}", "write 'not' for truth values")
        const = UNKNOWN if value.const is UNKNOWN else ~value.const
        return Value(INT, f"~{within(value, UNARY)}", UNARY, narrow=value.narrow, const=const)
    number = as_int(value)
    if isinstance(node.op, ast.UAdd):
        return number
    const = UNKNOWN if number.const is UNKNOWN else -number.const
    if isinstance(node.operand, ast.Constant) and number.kind == INT:
        return in_64_bits(literal(const), node)
    low, high = number.least(), number.most()
    ends = (None if high is None else -high), (None if low is None else -low)
    text = within(number, UNARY)
    text = f"-({text})" if text.startswith("-") else f"-{text}"
    made = Value(number.kind, text, UNARY, const=const, narrow=number.narrow, low=ends[0], high=ends[1])
    return in_64_bits(made, node) if number.kind == INT else made


def _sign(node: ast.BinOp) -> str:
    return WORDS.get(type(node.op)) or SIGNS[type(node.op)][0]


EXPRESSIONS |= {ast.Constant: constant, ast.Name: name, ast.BinOp: binary}
