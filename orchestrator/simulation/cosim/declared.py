"""What an FMU declares is checked once, before anything is made of it: sizes, counts, depth, characters, finiteness."""

import math
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from orchestrator.inputs.text.errors import BadInput, format_value
from orchestrator.inputs.text.printable import is_printable, printable

MAX_ELEMENTS = 200_000
"""Scalars that all inputs, outputs and parameters stand for."""
MAX_LETTERS = 1_000
"""Of a name or a unit."""
MAX_DESCRIPTION = 10_000
MAX_DEPTH = 64
"""Of a structured name."""
MAX_ITEMS = 10_000
"""Of an enumeration."""
MAX_EXPONENT = 100
CONNECTED = ("input", "output", "parameter", "local")
IDENTIFIER = re.compile(r"[A-Za-z_]\w{0,255}", re.ASCII)
EXPONENTS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


def check_declared(description: Any, path: Path) -> None:
    """Raise ``BadInput`` for what no FMU of use declares; take control characters out of what is for people only."""
    if description.coSimulation is not None:
        identifier = str(description.coSimulation.modelIdentifier)
        if not IDENTIFIER.fullmatch(identifier):
            raise BadInput(f"{format_value(identifier)} is no identifier of C", file=path, key="modelIdentifier")
    _check_text(description.guid, "guid", path)
    elements = 0
    for item in description.modelVariables:
        key = _check_text(item.name, "name of a variable", path)
        if item.name.count(".") + item.name.count("[") > MAX_DEPTH:
            raise BadInput(f"a name of more than {MAX_DEPTH} parts", file=path, key=format_value(key))
        _check_text(item.unit, f"{format_value(key)}: unit", path)
        item.description = printable(str(item.description or ""))[:MAX_DESCRIPTION]
        reference = _whole(item.valueReference, path, f"{format_value(key)}: valueReference")
        if not 0 <= reference < 1 << 32:
            raise BadInput(f"{reference} is no value reference", file=path, key=format_value(key))
        if item.causality in CONNECTED:
            elements += _size(item, path, format_value(key))
            if elements > MAX_ELEMENTS:
                raise BadInput(
                    f"has more than {MAX_ELEMENTS} inputs, outputs, locals and parameters, elements of arrays counted",
                    file=path,
                )
    kinds = {id(item.declaredType): item.declaredType for item in description.modelVariables if item.declaredType}
    for kind in kinds.values():
        _check_items(kind, path)
    for unit in description.unitDefinitions:
        _check_unit(unit, path)


def _check_text(text: object, what: str, path: Path) -> str:
    """Return a text that is short and has no control characters."""
    written = str(text or "")
    if len(written) > MAX_LETTERS:
        raise BadInput(f"{what} has {len(written)} letters, at most {MAX_LETTERS}", file=path)
    if not is_printable(written):
        raise BadInput(f"{what} has control characters: {format_value(written)}", file=path)
    return written


def _whole(value: object, path: Path, key: str) -> int:
    try:
        return int(str(value))
    except ValueError:
        raise BadInput(f"{format_value(value)} is no whole number", file=path, key=key) from None


def _size(item: Any, path: Path, key: str) -> int:
    """Return how many scalars a variable stands for."""
    size = 1
    for dimension in item.dimensions or ():
        written = dimension.start if dimension.start is not None else getattr(dimension.variable, "start", None)
        count = _whole(written if written is not None else 1, path, f"{key}: dimension")
        if not 1 <= count <= MAX_ELEMENTS:
            raise BadInput(f"{count} elements, expected 1 to {MAX_ELEMENTS}", file=path, key=f"{key}: dimension")
        size = min(size * count, MAX_ELEMENTS + 1)
    return size


def _check_items(kind: Any, path: Path) -> None:
    """Check an enumeration and the unit of a type."""
    name = _check_text(kind.name, "name of a type", path)
    _check_text(getattr(kind, "unit", None), f"{name}: unit", path)
    items: Iterable[Any] = kind.items or ()
    for number, item in enumerate(items):
        if number >= MAX_ITEMS:
            raise BadInput(f"has more than {MAX_ITEMS} items", file=path, key=name)
        _check_text(item.name, f"{name}: an item", path)
        value = _whole(item.value if item.value is not None else 0, path, f"{name}: {format_value(item.name)}")
        if not -(1 << 31) <= value < 1 << 31:
            raise BadInput(f"{value} is no 32-bit integer", file=path, key=f"{name}: {format_value(item.name)}")


def _check_unit(unit: Any, path: Path) -> None:
    name, base = _check_text(unit.name, "name of a unit", path), unit.baseUnit
    if base is None:
        return
    try:
        numbers = float(base.factor), float(base.offset)
        exponents = [int(getattr(base, item) or 0) for item in EXPONENTS]
    except (TypeError, ValueError):
        raise BadInput("its base unit has no numbers", file=path, key=f"unit {name}") from None
    if not all(map(math.isfinite, numbers)) or numbers[0] == 0.0 or max(map(abs, exponents)) > MAX_EXPONENT:
        raise BadInput("its base unit has no finite factor, offset and exponents", file=path, key=f"unit {name}")
