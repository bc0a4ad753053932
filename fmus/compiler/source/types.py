"""The kinds of values that model code has: float, int, bool, NamedTuples and tuples of fixed length."""

import types
import typing
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from typing import Any, Union

from modelkit.store import BYTES, Column, Floats, Ints


class NoKindError(TypeError):
    """What an annotation is instead of a kind, and what to write."""

    def __init__(self, what: str, advice: str) -> None:
        super().__init__(what)
        self.what = what
        self.advice = advice


@dataclass(frozen=True)
class Scalar:
    """A number or a truth value."""

    name: str
    c: str


@dataclass(frozen=True)
class Struct:
    """A NamedTuple: a C struct."""

    cls: Any


@dataclass(frozen=True)
class Array:
    """A tuple of ``length`` equal kinds: a C array."""

    item: "Kind"
    length: int


@dataclass(frozen=True)
class Mixed:
    """A tuple of different kinds, as functions return: a C struct with members item0, item1..."""

    items: tuple["Kind", ...]


@dataclass(frozen=True)
class Open:
    """``tuple[X, ...]`` of an argument or result: each call says how long."""

    item: "Kind"


@dataclass(frozen=True)
class Cells:
    """A column of a store: ``length`` numbers kept as the C type ``c``, read and written as ``item``."""

    item: Scalar
    c: str
    length: int


Kind = Union[Scalar, Struct, Array, Mixed, Open, Cells]  # noqa: UP007

FLOAT = Scalar("float", "double")
INT = Scalar("int", "int64_t")
BOOL = Scalar("bool", "bool")
SCALARS: dict[Any, Scalar] = {float: FLOAT, int: INT, bool: BOOL}
NOTHING = Scalar("None", "void")
"""What a function gives that is called for what it writes into a store."""
CELLS = {"d": (FLOAT, "double"), "f": (FLOAT, "float"), "i": (INT, "int32_t"), "h": (INT, "int16_t")}
"""Columns by their types: as what they are read, as what they are kept."""
UNSET: Any = object()


def kind_of(hint: Any, default: Any = UNSET) -> Kind:
    """Return the kind that an annotation means; ``default`` tells how long a ``tuple[X, ...]`` is."""
    origin = typing.get_origin(hint)
    if origin is typing.Annotated:
        column = next((mark for mark in hint.__metadata__ if isinstance(mark, Column)), None)
        return kind_of(hint.__origin__, default) if column is None else _column_kind(hint.__origin__, column)
    if hint in SCALARS:
        return SCALARS[hint]
    if isinstance(hint, type) and issubclass(hint, IntEnum):
        return INT
    hint = whole_of(hint)
    if is_named_tuple(hint):
        return Struct(hint)
    if origin is tuple:
        return _tuple_kind(typing.get_args(hint), default)
    raise _no_kind(hint, origin)


def _column_kind(hint: Any, column: Column) -> Cells:
    item, c = CELLS.get(column.kind, (NOTHING, ""))
    if item == NOTHING or hint is not (Floats if item == FLOAT else Ints) or column.length < 1:
        advice = f"write Annotated[Floats or Ints, Column(one of {' '.join(BYTES)}, a length, unit, meaning)]"
        raise NoKindError(f"no column of a store: {column}", advice)
    return Cells(item, c, column.length)


def _tuple_kind(items: tuple[Any, ...], default: Any) -> Kind:
    if len(items) == 2 and items[1] is Ellipsis:
        if default is UNSET:
            return Open(kind_of(items[0]))
        if not isinstance(default, tuple) or not default:
            raise NoKindError("an empty tuple", "give the default as many items as the model ever has")
        return Array(kind_of(items[0], default[0]), len(default))
    values = default if isinstance(default, tuple) and len(default) == len(items) else [UNSET] * len(items)
    kinds = tuple(kind_of(hint, value) for hint, value in zip(items, values, strict=True))
    if not kinds:
        raise NoKindError("an empty tuple", "leave it out")
    return Array(kinds[0], len(kinds)) if len(set(kinds)) == 1 else Mixed(kinds)


def _no_kind(hint: Any, origin: Any) -> NoKindError:
    text = getattr(hint, "__name__", str(hint))
    if hint is str:
        return NoKindError("a string", "name the meaning with an IntEnum and use its members")
    if hint in (list, set, frozenset) or origin in (list, set, frozenset):
        return NoKindError(f"a {text}", "write tuple[X, ...] with a default of the length needed")
    if hint is dict or origin is dict:
        return NoKindError("a dict", "write a NamedTuple with one field for each key")
    if origin in (typing.Union, types.UnionType) or hint is None or hint is type(None):
        return NoKindError(
            f"the type {hint}", "write one type, and a bool beside it that says whether there is a value"
        )
    if hint is tuple:
        return NoKindError("a tuple of unknown items", "write tuple[X, ...] or tuple[X, Y]")
    return NoKindError(f"the type {text}", "write float, int, bool, an IntEnum, a NamedTuple or a tuple of these")


def is_named_tuple(item: Any) -> bool:
    """Return whether ``item`` is a NamedTuple class."""
    return isinstance(item, type) and issubclass(item, tuple) and hasattr(item, "_fields")


def whole_of(hint: Any) -> Any:
    """Return the type that a class stands for in the model being translated; any other is itself.

    The types of its systems stand for the model's; a ``Protocol`` stands for the one that has all it names.
    """
    if hint in _WHOLES:
        return _WHOLES[hint]
    if getattr(hint, "_is_protocol", False):
        return _fitting(hint)
    return hint


@contextmanager
def translating(wholes: Mapping[Any, Any], interfaces: Iterable[Any]) -> Iterator[None]:
    """Let the types ``wholes`` stand for the values there, and protocols for one of ``interfaces``."""
    before = dict(_WHOLES), list(_INTERFACES)
    _set(wholes, interfaces)
    try:
        yield
    finally:
        _set(*before)


def first_modules() -> list[str]:
    """Return the modules of what the model's types are made of, where systems give those instead of their own.

    A function of one system names the defaults of another's then, which come before it therefore.
    """
    found: dict[str, None] = {}

    def visit(kind: Kind) -> None:
        for part in parts(kind):
            visit(part)
        if isinstance(kind, Struct):
            found[kind.cls.__module__] = None

    for cls in dict.fromkeys(_WHOLES.values()):
        for kind in fields_of(cls).values():
            visit(kind)
    return list(found)


def _set(wholes: Mapping[Any, Any], interfaces: Iterable[Any]) -> None:
    _WHOLES.clear()
    _WHOLES.update(wholes)
    _INTERFACES[:] = interfaces
    fields_of.cache_clear()


def _fitting(protocol: Any) -> Any:
    """Return the interface of the protocol's package that has all members of ``protocol``."""
    classes = [cls for cls in protocol.__mro__ if getattr(cls, "_is_protocol", False)]
    names = {name for cls in classes for name, item in vars(cls).items() if isinstance(item, property)}
    package = protocol.__module__.partition(".")[0]
    known = dict.fromkeys(cls for cls in _INTERFACES if cls.__module__.partition(".")[0] == package)
    found = [cls for cls in known if names <= set(cls._fields)]
    if len(found) != 1:
        what = f"{protocol.__name__}, which {len(found) or 'none'} of the model's types fit"
        raise NoKindError(what, "name what one of its parameters, inputs or outputs has")
    return found[0]


_WHOLES: dict[Any, Any] = {}
_INTERFACES: list[Any] = []


@cache
def hints_of(cls: Any) -> dict[str, Any]:
    """Return the annotations of a NamedTuple's fields."""
    return typing.get_type_hints(cls, include_extras=True)


@cache
def fields_of(cls: Any) -> dict[str, Kind]:
    """Return the kind of every field of a NamedTuple; ``NoKind`` says which is none."""
    found: dict[str, Kind] = {}
    try:
        hints = hints_of(cls)
    except Exception as error:
        raise NoKindError(f"annotations of {cls.__name__} that cannot be read ({error})", "name known types") from None
    for name in cls._fields:
        if name not in hints:
            raise NoKindError(
                f"{cls.__name__}.{name} has no type", f"write class {cls.__name__}(NamedTuple): {name}: float"
            )
        try:
            kind = kind_of(hints[name], cls._field_defaults.get(name, UNSET))
        except NoKindError as error:
            raise NoKindError(f"{cls.__name__}.{name} is {error.what}", error.advice) from None
        if isinstance(kind, Mixed):
            raise NoKindError(f"{cls.__name__}.{name} is a tuple of different kinds", "write a NamedTuple")
        if isinstance(kind, Open):
            advice = "give it a default of the length needed, or write tuple[X, X, X]"
            raise NoKindError(f"{cls.__name__}.{name} is a tuple of unknown length", advice)
        found[name] = kind
    return found


def is_store(kind: Kind) -> bool:
    """Return whether ``kind`` is a store: a NamedTuple of columns."""
    return isinstance(kind, Struct) and any(isinstance(part, Cells) for part in fields_of(kind.cls).values())


def parts(kind: Kind) -> Iterator[Kind]:
    """Yield the kinds that a value of ``kind`` is directly made of."""
    if isinstance(kind, Struct):
        yield from fields_of(kind.cls).values()
    elif isinstance(kind, Array | Open):
        yield kind.item
    elif isinstance(kind, Mixed):
        yield from kind.items


def kind_of_value(value: Any) -> Kind:
    """Return the kind of a Python constant."""
    if isinstance(value, bool):
        return BOOL
    if isinstance(value, int):
        return INT
    if isinstance(value, float):
        return FLOAT
    if is_named_tuple(type(value)):
        return Struct(type(value))
    if isinstance(value, tuple) and value:
        kinds = tuple(kind_of_value(item) for item in value)
        return Array(kinds[0], len(kinds)) if len(set(kinds)) == 1 else Mixed(kinds)
    raise _no_kind(type(value), type(value))


def describe(kind: Kind) -> str:
    """Return a kind in the words of Python."""
    if isinstance(kind, Scalar):
        return kind.name
    if isinstance(kind, Struct):
        return str(kind.cls.__name__)
    if isinstance(kind, Array):
        return f"a tuple of {kind.length} {describe(kind.item)}"
    if isinstance(kind, Cells):
        return f"a column of {describe(kind.item)}"
    if isinstance(kind, Open):
        return f"tuple[{describe(kind.item)}, ...]"
    return f"tuple[{', '.join(describe(item) for item in kind.items)}]"
