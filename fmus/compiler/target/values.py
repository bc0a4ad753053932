"""Expressions in C while they are being made: text, kind, and what is known of the value."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from fmus.compiler.source.types import BOOL, FLOAT, INT, Array, Kind, Scalar, Struct, parts

PRIMARY, UNARY, PRODUCT, SUM, SHIFT, ORDER, EQUAL, BIT_AND, BIT_XOR, BIT_OR, AND, OR, CHOICE = range(13, 0, -1)
"""How tightly the operators of C bind."""
UNKNOWN: Any = object()
MAX_EXACT_INTEGER = 2**53
"""Integers up to here are exact as float."""
INT32 = 2**31
INT64 = 2**63
MAX_BY_VALUE_SCALARS = 8
"""Structs of no more scalars are returned by value, and written in one line."""


@dataclass(frozen=True)
class Place:
    """Something that can be assigned to: a variable, a member, an element, or what a pointer points to."""

    text: str
    pointer: bool = False

    @property
    def whole(self) -> str:
        """The text that is assigned to."""
        return f"*{self.text}" if self.pointer else self.text

    @property
    def address(self) -> str:
        """The text of a pointer to it."""
        return self.text if self.pointer else f"&{self.text}"

    def member(self, name: str) -> "Place":
        """Return a member of a struct."""
        return Place(f"{self.text}{'->' if self.pointer else '.'}{name}")

    def element(self, index: object) -> "Place":
        """Return an element of an array."""
        return Place(f"{self.text}[{index}]")


Fill = Callable[[Place], None]


@dataclass(frozen=True)
class Value:
    """A C expression of one kind.

    A NamedTuple or tuple is either a place (something that stays and can be pointed at), or an
    expression of struct type, or made by statements that fill a place given to them.
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
    low: int | None = None
    high: int | None = None
    """Bounds of an integer, if known."""
    fill: Fill | None = None
    """Writes the statements that put the value into a place."""
    fill_items: Callable[[list[Place]], None] | None = None
    """The same for the items of a tuple that a function returns."""
    held: frozenset[str] | None = None
    """The variables that the statements look at while they write; None: all that the source mentions."""
    braces: str = ""
    """What is filled, as an initializer, if it can be."""
    items: tuple["Value", ...] | None = None
    """Of a tuple written out."""
    members: dict[str, "Value"] | None = None
    """Of a struct written out, under their names in C."""
    base: "Value | None" = None
    """The place that this is a changed copy of; ``fill`` of that very place changes it, without a copy."""
    changes: int = 0
    """Which item of several results is the changed copy of ``base``."""

    def least(self) -> int | None:
        """Return a lower bound of an integer, if known."""
        if self.const is not UNKNOWN and self.kind in (INT, BOOL):
            return int(self.const)
        return 0 if self.kind == BOOL else self.low

    def most(self) -> int | None:
        """Return an upper bound of an integer, if known."""
        if self.const is not UNKNOWN and self.kind in (INT, BOOL):
            return int(self.const)
        return 1 if self.kind == BOOL else self.high

    def lies_in(self, low: int, high: int) -> bool:
        """Return whether an integer is certainly in [low, high]."""
        least, most = self.least(), self.most()
        return least is not None and most is not None and low <= least and most <= high


def within(value: Value, level: int) -> str:
    """Return the text of ``value`` as an operand of something that binds at ``level``."""
    return value.text if value.level >= level else f"({value.text})"


def float_text(number: float) -> str:
    """Return a double in C that is read back to the same bits."""
    if number != number:
        return "NAN"
    if number in (float("inf"), float("-inf")):
        return "INFINITY" if number > 0.0 else "-INFINITY"
    usual, short = repr(number), f"{number:g}"
    return short if len(usual) > 9 and "e" in short and float(short) == number else usual


def int_text(number: int) -> str:
    """Return an integer in C."""
    if -INT32 < number < INT32:
        return str(int(number))
    return "INT64_MIN" if number == -INT64 else f"INT64_C({int(number)})"


def literal(constant: Any) -> Value:
    """Return a number or truth value written out."""
    if isinstance(constant, bool):
        return Value(BOOL, "true" if constant else "false", const=constant)
    if isinstance(constant, int):
        small = -INT32 < constant < INT32
        return Value(INT, int_text(constant), UNARY if constant < 0 else PRIMARY, const=int(constant), narrow=small)
    text = float_text(constant)
    return Value(FLOAT, text, UNARY if text.startswith("-") else PRIMARY, const=float(constant))


def as_float(value: Value) -> Value:
    """Return a number or truth value as a float."""
    if value.kind == FLOAT:
        return value
    if value.const is not UNKNOWN and abs(int(value.const)) <= MAX_EXACT_INTEGER:
        real = literal(float(value.const))
        written = value.kind == BOOL or value.text.lstrip("-").isdigit()
        return real if written else replace(real, text=f"(double){within(value, UNARY)}", level=UNARY)
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
    const = UNKNOWN if value.const is UNKNOWN else bool(value.const)
    return Value(BOOL, f"{within(value, ORDER)} != {zero}", EQUAL, const=const)


def rvalue(value: Value) -> str:
    """Return the text of a scalar or struct where a value is wanted."""
    return f"*{within(value, UNARY)}" if value.pointer else value.text


def place_of(value: Value) -> Place:
    """Return where a value that is a place lives."""
    return Place(within(value, PRIMARY), value.pointer)


def both(pick: Callable[[int, int], int], a: int | None, b: int | None) -> int | None:
    """Return the pick of two bounds of which both must be known."""
    return None if a is None or b is None else pick(a, b)


def either(pick: Callable[[int, int], int], a: int | None, b: int | None) -> int | None:
    """Return the pick of two bounds of which one is enough."""
    return b if a is None else a if b is None else pick(a, b)


def is_scalar(kind: Kind) -> bool:
    """Return whether a kind is float, int or bool."""
    return isinstance(kind, Scalar)


def scalars_in(kind: Kind) -> int:
    """Return how many numbers and truth values a kind is made of."""
    if isinstance(kind, Array):
        return kind.length * scalars_in(kind.item)
    return 1 if isinstance(kind, Scalar) else sum(scalars_in(part) for part in parts(kind))


def is_result_by_value(kind: Kind) -> bool:
    """Return whether a C function gives a kind as its value; others are written where a pointer says."""
    return isinstance(kind, Scalar) or (isinstance(kind, Struct) and scalars_in(kind) <= MAX_BY_VALUE_SCALARS)
