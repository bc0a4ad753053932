"""Python's own functions and those of math, where C has exactly the same or a small function makes it so."""

import ast
import math
from collections.abc import Callable
from typing import Any

from fmus.compiler.arithmetic import elements
from fmus.compiler.body import Body
from fmus.compiler.kinds import BOOL, FLOAT, INT, Array, Mixed, described
from fmus.compiler.refusals import CannotError
from fmus.compiler.values import EQUAL, UNKNOWN, Value, as_float, as_int, literal, truth

MATH = {
    "sin": 1, "cos": 1, "tan": 1, "asin": 1, "acos": 1, "atan": 1, "atan2": 2, "sinh": 1, "cosh": 1, "tanh": 1,
    "asinh": 1, "acosh": 1, "atanh": 1, "exp": 1, "expm1": 1, "log": 1, "log1p": 1, "log2": 1, "log10": 1,
    "sqrt": 1, "fabs": 1, "copysign": 2, "fmod": 2,
}  # fmt: skip
"""Functions that are those of C's library, with their number of arguments."""
EXACT = {"sqrt", "fabs", "copysign", "fmod"}
WHOLE = ("floor", "ceil", "trunc")
TESTS = {"isnan": "isnan", "isinf": "isinf", "isfinite": "isfinite"}
MATH_ADVICE = {
    "hypot": "write math.sqrt(x * x + y * y)",
    "pow": "write x * x, or math.exp(y * math.log(x))",
    "radians": "write x * (math.pi / 180.0)",
    "degrees": "write x * (180.0 / math.pi)",
    "fsum": "write a loop that adds",
    "dist": "write math.sqrt(dx * dx + dy * dy)",
}


def math_call(body: Body, node: ast.Call, name: str) -> Value:
    """Return a call of a function of math."""
    if name in WHOLE:
        return _whole(body, node, name)
    count = 1 if name in TESTS else MATH.get(name)
    if count is None:
        advice = MATH_ADVICE.get(name, "write it with + - * / and the functions that C has too")
        raise CannotError(node, f"math.{name}()", advice)
    values = [as_float(value) for value in _scalars(body, node, f"math.{name}", count, count)]
    if name in TESTS:
        return Value(BOOL, f"{TESTS[name]}({values[0].text}) != 0", EQUAL)
    const = _known(getattr(math, name), values)
    if const is not UNKNOWN and name not in EXACT:
        return literal(const)
    return Value(FLOAT, f"{name}({', '.join(value.text for value in values)})", const=const)


def _known(function: Callable[..., Any], values: list[Value]) -> Any:
    """Return the result for known arguments: a C compiler may work it out more exactly than the library would."""
    if any(value.const is UNKNOWN for value in values):
        return UNKNOWN
    try:
        return function(*(value.const for value in values))
    except (ArithmeticError, ValueError):
        return UNKNOWN


def _whole(body: Body, node: ast.Call, name: str) -> Value:
    """Return math.floor, ceil or trunc: an int in Python; used as a float it need not pass through one."""
    (value,) = _scalars(body, node, f"math.{name}", 1, 1)
    if value.kind != FLOAT:
        return as_int(value)
    const = _known(getattr(math, name), [value])
    text = f"{name}({value.text})"
    return Value(INT, f"{body.program.helper('int_of')}({text})", const=const, real=f"({text} + 0.0)")


def _scalars(body: Body, node: ast.Call, name: str, least: int, most: int) -> list[Value]:
    if node.keywords or not least <= len(node.args) <= most:
        count = str(least) if least == most else f"{least} to {most}"
        raise CannotError(node, f"{name}() with these arguments", f"give it {count}, without names")
    return [body.scalar(item) for item in node.args]


def absolute(body: Body, node: ast.Call) -> Value:
    """Return abs(x)."""
    (value,) = _scalars(body, node, "abs", 1, 1)
    const = UNKNOWN if value.const is UNKNOWN else abs(value.const)
    if value.kind == FLOAT:
        return Value(FLOAT, f"fabs({value.text})", const=const)
    return Value(INT, f"{body.program.helper('int_abs')}({as_int(value).text})", const=const)


def integer(body: Body, node: ast.Call) -> Value:
    """Return int(x)."""
    (value,) = _scalars(body, node, "int", 1, 1)
    if value.kind != FLOAT:
        return as_int(value)
    const = _known(int, [value])
    text = f"{body.program.helper('int_of')}({value.text})"
    return Value(INT, text, const=const, real=f"(trunc({value.text}) + 0.0)")


def floating(body: Body, node: ast.Call) -> Value:
    """Return float(x)."""
    (value,) = _scalars(body, node, "float", 1, 1)
    return as_float(value)


def boolean(body: Body, node: ast.Call) -> Value:
    """Return bool(x)."""
    (value,) = _scalars(body, node, "bool", 1, 1)
    return truth(value)


def length(body: Body, node: ast.Call) -> Value:
    """Return len(xs)."""
    if len(node.args) != 1 or node.keywords:
        raise CannotError(node, "len() with these arguments", "give it one tuple")
    value = body.value(node.args[0])
    if isinstance(value.kind, Array):
        return literal(value.kind.length)
    if isinstance(value.kind, Mixed):
        return literal(len(value.kind.items))
    raise CannotError(node, f"len() of {described(value.kind)}", "give it a tuple")


def extreme(word: str) -> Callable[[Body, ast.Call], Value]:
    """Return the translation of min or max."""

    def made(body: Body, node: ast.Call) -> Value:
        if node.keywords:
            raise CannotError(node, f"{word}() with {node.keywords[0].arg}", "compare the items one by one")
        values = [body.value(item) for item in node.args]
        if len(values) == 1 and isinstance(values[0].kind, Array):
            values = list(elements(body, values[0]))
        kinds = {value.kind for value in values}
        if not values or not kinds <= {FLOAT, INT, BOOL}:
            raise CannotError(node, f"{word}() of {described(values[0].kind)}", "give it two or more numbers")
        if FLOAT in kinds and len(kinds) > 1:
            what = f"{word}() of float and int, whose result is now one, now the other"
            raise CannotError(node, what, "make all of them floats: 1.0, float(n)")
        result = values[0] if FLOAT in kinds else as_int(values[0])
        for value in values[1:]:
            result = _smaller_or_larger(body, word, result, value if FLOAT in kinds else as_int(value))
        return result

    return made


def _smaller_or_larger(body: Body, word: str, a: Value, b: Value) -> Value:
    helper = body.program.helper(f"{'float' if a.kind == FLOAT else 'int'}_{word}")
    pick = min if word == "min" else max
    const = UNKNOWN if UNKNOWN in (a.const, b.const) else pick(a.const, b.const)
    one, other = a.bounds(), b.bounds()
    low = high = None
    if one and other:
        low, high = pick(one[0], other[0]), pick(one[1], other[1])
    return Value(a.kind, f"{helper}({a.text}, {b.text})", const=const, low=low, high=high)


BUILTINS: dict[Any, Callable[[Body, ast.Call], Value]] = {
    abs: absolute,
    int: integer,
    float: floating,
    bool: boolean,
    len: length,
    min: extreme("min"),
    max: extreme("max"),
}
