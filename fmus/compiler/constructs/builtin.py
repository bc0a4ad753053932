"""Python's own functions and those of math, where C has exactly the same or a small function makes it so."""

import ast
import math
from collections.abc import Callable
from typing import Any

from fmus.compiler.constructs.arithmetic import in_64_bits
from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.types import BOOL, FLOAT, INT, Array, Cells, Mixed, describe
from fmus.compiler.target.aggregates import elements
from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.values import EQUAL, UNKNOWN, Value, as_float, as_int, both, either, literal, truth

MATH = {
    "sin": 1, "cos": 1, "tan": 1, "asin": 1, "acos": 1, "atan": 1, "atan2": 2, "sinh": 1, "cosh": 1, "tanh": 1,
    "asinh": 1, "acosh": 1, "atanh": 1, "exp": 1, "expm1": 1, "log": 1, "log1p": 1, "log2": 1, "log10": 1,
    "sqrt": 1, "fabs": 1, "copysign": 2, "fmod": 2,
}  # fmt: skip
"""Functions that are those of C's library, with their number of arguments."""
EXACT = {"sqrt", "fabs", "copysign", "fmod"}
WHOLE = ("floor", "ceil", "trunc")
TESTS = ("isnan", "isinf", "isfinite")
MATH_ADVICE = {
    "hypot": "write math.sqrt(x * x + y * y)",
    "pow": "write x * x, or math.exp(y * math.log(x))",
    "radians": "write x * (math.pi / 180.0)",
    "degrees": "write x * (180.0 / math.pi)",
    "fsum": "write a loop that adds",
    "dist": "write math.sqrt(dx * dx + dy * dy)",
}


def math_call(body: FunctionBody, node: ast.Call, name: str) -> Value:
    """Return a call of a function of math."""
    if name in WHOLE:
        (value,) = scalars(body, node, f"math.{name}", 1, 1)
        return whole(body, value, name, getattr(math, name))
    count = 1 if name in TESTS else MATH.get(name)
    if count is None:
        advice = MATH_ADVICE.get(name, "write it with + - * / and the functions that C has too")
        raise CannotError(node, f"math.{name}()", advice)
    values = [as_float(value) for value in scalars(body, node, f"math.{name}", count, count)]
    if name in TESTS:
        return Value(BOOL, f"{name}({values[0].text}) != 0", EQUAL)
    const = fold_call(getattr(math, name), values)
    if const is not UNKNOWN and name not in EXACT:
        return literal(const)
    return Value(FLOAT, f"{name}({', '.join(value.text for value in values)})", const=const)


def fold_call(function: Callable[..., Any], values: list[Value]) -> Any:
    """Return the result for known arguments: a C compiler may work it out more exactly than the library would."""
    if any(value.const is UNKNOWN for value in values):
        return UNKNOWN
    try:
        return function(*(value.const for value in values))
    except (ArithmeticError, ValueError):
        return UNKNOWN


def whole(body: FunctionBody, value: Value, c: str, python: Callable[..., Any]) -> Value:
    """Return a float made an int by the C function ``c``; used as a float again it need not pass through an int."""
    if value.kind != FLOAT:
        return as_int(value)
    const = fold_call(python, [value])
    text = f"{c}({value.text})"
    given = value.text if c == "trunc" else text
    return Value(INT, f"{body.program.helper('int_of')}({given})", const=const, real=f"({text} + 0.0)")


def scalars(body: FunctionBody, node: ast.Call, name: str, least: int, most: int) -> list[Value]:
    """Return the arguments of a call that takes ``least`` to ``most`` numbers."""
    if node.keywords or not least <= len(node.args) <= most:
        count = str(least) if least == most else f"{least} to {most}"
        raise CannotError(node, f"{name}() with these arguments", f"give it {count}, without names")
    return [body.scalar(item) for item in node.args]


def absolute(body: FunctionBody, node: ast.Call) -> Value:
    """Return abs(x)."""
    (value,) = scalars(body, node, "abs", 1, 1)
    const = UNKNOWN if value.const is UNKNOWN else abs(value.const)
    if value.kind == FLOAT:
        return Value(FLOAT, f"fabs({value.text})", const=const)
    least, most = value.least(), value.most()
    high = None if least is None or most is None else max(abs(least), abs(most))
    text = f"{body.program.helper('int_abs')}({as_int(value).text})"
    return in_64_bits(Value(INT, text, const=const, low=0, high=high), node)


def integer(body: FunctionBody, node: ast.Call) -> Value:
    """Return int(x)."""
    (value,) = scalars(body, node, "int", 1, 1)
    return whole(body, value, "trunc", int)


def lower_round(body: FunctionBody, node: ast.Call) -> Value:
    """Return round(x): halves go to the even neighbour, as C's rint does."""
    if len(node.args) == 2 or node.keywords:
        raise CannotError(node, "round() to decimals", "write math.floor(x / step + 0.5) * step")
    (value,) = scalars(body, node, "round", 1, 1)
    return whole(body, value, "rint", round)


def floating(body: FunctionBody, node: ast.Call) -> Value:
    """Return float(x)."""
    if len(node.args) == 1 and isinstance(node.args[0], ast.Constant) and isinstance(node.args[0].value, str):
        raise CannotError(node, "float() of a string", "write math.inf, -math.inf or math.nan")
    (value,) = scalars(body, node, "float", 1, 1)
    return as_float(value)


def boolean(body: FunctionBody, node: ast.Call) -> Value:
    """Return bool(x)."""
    (value,) = scalars(body, node, "bool", 1, 1)
    return truth(value)


def length(body: FunctionBody, node: ast.Call) -> Value:
    """Return len(xs)."""
    if len(node.args) != 1 or node.keywords:
        raise CannotError(node, "len() with these arguments", "give it one tuple")
    value = body.value(node.args[0])
    if isinstance(value.kind, Array | Cells):
        return literal(value.kind.length)
    if isinstance(value.kind, Mixed):
        return literal(len(value.kind.items))
    raise CannotError(node, f"len() of {describe(value.kind)}", "give it a tuple")


def extreme(word: str) -> Callable[[FunctionBody, ast.Call], Value]:
    """Return the translation of min or max."""

    def lower(body: FunctionBody, node: ast.Call) -> Value:
        if node.keywords:
            raise CannotError(node, f"{word}() with {node.keywords[0].arg}", "compare the items one by one")
        values = [body.value(item) for item in node.args]
        if len(values) == 1 and isinstance(values[0].kind, Array):
            values = list(elements(body, values[0]))
        for value in values:
            if value.kind not in (FLOAT, INT, BOOL):
                raise CannotError(node, f"{word}() of {describe(value.kind)}", "give it two or more numbers")
        if len(values) < 2:
            raise CannotError(node, f"{word}() of {len(values)} values", "give it two or more numbers")
        one_kind(node, f"{word}()", values)
        result = values[0]
        for value in values[1:]:
            result = _smaller_or_larger(body, word, result, value)
        return result

    return lower


def one_kind(node: ast.AST, what: str, values: list[Value]) -> None:
    """Refuse numbers of which some are floats and some are not: Python's result is now one, now the other."""
    kinds = {value.kind for value in values}
    if FLOAT in kinds and len(kinds) > 1:
        raise CannotError(node, f"{what} of float and int", "make all of them floats: 1.0, float(n)")


def _smaller_or_larger(body: FunctionBody, word: str, a: Value, b: Value) -> Value:
    if a.kind != FLOAT:
        a, b = as_int(a), as_int(b)
    helper = body.program.helper(f"{'float' if a.kind == FLOAT else 'int'}_{word}")
    const = UNKNOWN
    if UNKNOWN not in (a.const, b.const):
        const = min(a.const, b.const) if word == "min" else max(a.const, b.const)
    one, other = (a.least(), a.most()), (b.least(), b.most())
    if word == "min":
        low, high = both(min, one[0], other[0]), either(min, one[1], other[1])
    else:
        low, high = either(max, one[0], other[0]), both(max, one[1], other[1])
    return Value(a.kind, f"{helper}({a.text}, {b.text})", const=const, low=low, high=high)


BUILTINS: dict[Any, Callable[[FunctionBody, ast.Call], Value]] = {
    abs: absolute,
    int: integer,
    round: lower_round,
    float: floating,
    bool: boolean,
    len: length,
    min: extreme("min"),
    max: extreme("max"),
}
