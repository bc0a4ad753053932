"""Work arrays beside a model's state: columns of fixed length and type, changed in place.

A model whose method needs many thousand numbers to work with (a search over poses) declares them as
one NamedTuple of columns:

    class PlanStore(NamedTuple):
        x: Annotated[Floats, Column("f", 20_000, "m", "x of a node")]

It is part of an instance's memory, all zeros at first, and saved with its FMU state. In CPython a column is
an ``array.array``; in C the store is one struct. Values are rounded to the column's type when they are
written, alike in both. A model that makes it a memo, whose content follows from a request and a count of
steps that stand in its state, stays a pure function of its state.
"""

from array import array
from collections.abc import MutableSequence
from typing import Any, NamedTuple, get_type_hints

Floats = MutableSequence[float]
Ints = MutableSequence[int]

BYTES = {"d": 8, "f": 4, "i": 4, "h": 2}
"""Types of a column: float64, float32, int32, int16."""


class Column(NamedTuple):
    """Type (a key of ``BYTES``), length, unit and meaning of a column of a store."""

    kind: str
    length: int
    unit: str = "1"
    text: str = ""


def columns_of(store: type[Any]) -> dict[str, Column]:
    """Return the columns that a store declares, by name; raises ``TypeError`` for a field that is none."""
    found = {}
    for name, hint in get_type_hints(store, include_extras=True).items():
        column = next((item for item in getattr(hint, "__metadata__", ()) if isinstance(item, Column)), None)
        if column is None or column.kind not in BYTES or column.length < 1:
            raise TypeError(f'{store.__name__}.{name}: write Annotated[Floats, Column("f", length, unit, meaning)]')
        found[name] = column
    return found


def new_store(store: type[Any]) -> Any:
    """Return a store of zeros."""
    return store(
        **{name: array(item.kind, bytes(BYTES[item.kind] * item.length)) for name, item in columns_of(store).items()}
    )


def bytes_of(store: Any) -> bytes:
    """Return all that a store holds, column by column; nothing for None."""
    return b"" if store is None else b"".join(column.tobytes() for column in store)


def store_of(store: type[Any] | None, content: bytes) -> Any:
    """Return the store of which ``bytes_of`` gave ``content``; None if there is no such type."""
    if store is None:
        return None
    found, at = new_store(store), 0
    for column in found:
        size = len(column) * column.itemsize
        column[:] = array(column.typecode, content[at : at + size])
        at += size
    return found


def size_of(store: type[Any]) -> int:
    """Return the memory [bytes] of a store's columns."""
    return sum(BYTES[item.kind] * item.length for item in columns_of(store).values())
