"""Expressions in C while they are being made: text, kind, and what is known of the value."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from fmus.compiler.kinds import BOOL, FLOAT, INT, Array, Kind, Mixed, Scalar, Struct

PRIMARY, UNARY, PRODUCT, SUM, SHIFT, ORDER, EQUAL, BIT_AND, BIT_XOR, BIT_OR, AND, OR, CHOICE = range(13, 0, -1)
"""How tightly the operators of C bind."""
UNKNOWN: Any = object()
WHOLE = 2**53
"""Integers up to here are exact as float."""
INT32 = 2**31
INT64 = 2**63


@dataclass(frozen=True)
class Value:
    """A C expression of one kind.

    A NamedTuple or tuple is a place (something that stays and can be pointed at), an initializer in
    braces, an expression of struct type, or is made by statements that fill a place given to them.
    """

    kind: Kind
    text: str = ""
    level: int = PRIMARY
    place: bool = False
    fixed: bool = False
    """The place is not written to as long as it is visible."""
    pointer: bool = False
    """``text`` is the address of the struct."""
    const: Any = UNKNOWN
    """The value itself, if known."""
    narrow: bool = False
    """The C expression has type int, not int64_t."""
    real: str = ""
    """An integer's value as a double, if it came from one."""
    braces: str = ""
    """Initializer of a struct or array."""
    low: int | None = None
    high: int | None = None
    """Bounds of an integer, if known."""
    fill: Callable[[str], None] | None = None
    """Writes the statements that put the value into a place."""
    items: tuple["Value", ...] | None = None
    """Of a tuple written out."""

    def bounds(self) -> tuple[int, int] | None:
        """Return the least and the greatest value of an integer, if known."""
        if self.kind in (INT, BOOL) and self.const is not UNKNOWN:
            return int(self.const), int(self.const)
        if self.low is None or self.high is None:
            return (0, 1) if self.kind == BOOL else None
        return self.low, self.high


def within(value: Value, level: int) -> str:
    """Return the text of ``value`` as an operand of something that binds at ``level``."""
    return value.text if value.level >= level else f"({value.text})"


def float_text(number: float) -> str:
    """Return a double in C that is read back to the same bits."""
    if number != number:
        return "NAN"
    if number in (float("inf"), float("-inf")):
        return "INFINITY" if number > 0.0 else "-INFINITY"
    return repr(number)


def int_text(number: int) -> str:
    """Return an integer in C."""
    if -INT32 < number < INT32:
        return str(number)
    return "INT64_MIN" if number == -INT64 else f"INT64_C({number})"


def literal(constant: Any) -> Value:
    """Return a number or truth value written out."""
    if isinstance(constant, bool):
        return Value(BOOL, "true" if constant else "false", const=constant)
    if isinstance(constant, int):
        text = int_text(int(constant))
        small = -INT32 < constant < INT32
        return Value(INT, text, UNARY if constant < 0 else PRIMARY, const=int(constant), narrow=small)
    text = float_text(constant)
    return Value(FLOAT, text, UNARY if text.startswith("-") else PRIMARY, const=float(constant))


def as_float(value: Value) -> Value:
    """Return a number or truth value as a float."""
    if value.kind == FLOAT:
        return value
    if value.const is not UNKNOWN and abs(int(value.const)) <= WHOLE:
        return literal(float(value.const))
    if value.real:
        return Value(FLOAT, value.real)
    return Value(FLOAT, f"(double){within(value, UNARY)}", UNARY)


def as_int(value: Value) -> Value:
    """Return a truth value as an integer; integers as they are."""
    if value.kind != BOOL:
        return value
    if value.const is not UNKNOWN:
        return literal(int(value.const))
    return Value(INT, f"(int64_t){within(value, UNARY)}", UNARY, low=0, high=1)


def as_wide(value: Value) -> Value:
    """Return an integer whose C type is int64_t."""
    if not value.narrow:
        return value
    return replace(value, text=f"(int64_t){within(value, UNARY)}", level=UNARY, narrow=False)


def truth(value: Value) -> Value:
    """Return the truth of a number."""
    if value.kind == BOOL:
        return value
    zero = "0.0" if value.kind == FLOAT else "0"
    return Value(BOOL, f"{within(value, ORDER)} != {zero}", EQUAL)


def rvalue(value: Value) -> str:
    """Return the text of a scalar or struct where a value is wanted."""
    if value.pointer:
        return f"*{within(value, UNARY)}"
    return value.text


def member(value: Value, name: str) -> str:
    """Return the text of a member of a struct."""
    return f"{within(value, PRIMARY)}{'->' if value.pointer else '.'}{name}"


def initial(value: Value, most: int = 4) -> str | None:
    """Return the text of ``value`` inside an initializer; None if it takes statements."""
    if value.fill is not None and not value.braces:
        return None
    if value.braces:
        return value.braces
    if isinstance(value.kind, Array):
        if value.kind.length > most or not isinstance(value.kind.item, Scalar | Struct):
            return None
        return "{" + ", ".join(element(value, str(at)) for at in range(value.kind.length)) + "}"
    return rvalue(value)


def element(value: Value, index: str) -> str:
    """Return the text of an element of an array that is a place."""
    return f"{within(value, PRIMARY)}[{index}]"


def is_scalar(kind: Kind) -> bool:
    """Return whether a kind is float, int or bool."""
    return isinstance(kind, Scalar)


def is_by_value(kind: Kind) -> bool:
    """Return whether C can assign and return a kind."""
    return isinstance(kind, Scalar | Struct | Mixed)
