"""The variables of an FMU as FMI 3.0 has them: tuples are arrays, modes are enumerations.

``scene.boxes[1].length``, ``scene.boxes[2].length``... are one variable, ``scene.boxes.length``, of as many elements.
"""

import re
from collections.abc import Iterator
from enum import IntEnum
from typing import Any, NamedTuple

from fmus.contents.variables import ORDER, FmiVariable, fmi_variables
from modelkit.model import Model

INDEX = re.compile(r"\[(\d+)\]")
MOST_DIMENSIONS = 2


class FmiArray(NamedTuple):
    """One variable: a scalar, or an array of scalars that differ in their indices alone."""

    name: str
    vr: int
    """Value reference: the place in the list, from 0."""
    elements: tuple[FmiVariable, ...]
    """Row by row."""
    shape: tuple[int, ...]
    """Number of elements along each dimension; none for a scalar."""

    @property
    def first(self) -> FmiVariable:
        """Return the first element, which stands for all in what is said of them."""
        return self.elements[0]

    @property
    def states(self) -> type[IntEnum] | None:
        """Return the enumeration of a mode."""
        return self.first.signal.states if self.first.kind is int else None

    @property
    def fmi_type(self) -> str:
        """Return ``Float64``, ``Int32``, ``Enumeration`` or ``Boolean``."""
        if self.states is not None:
            return "Enumeration"
        return {float: "Float64", int: "Int32", bool: "Boolean"}[self.first.kind]

    @property
    def is_exposed(self) -> bool:
        """Return whether the description names it."""
        return all(item.is_exposed for item in self.elements)

    @property
    def starts(self) -> tuple[Any, ...]:
        """Return the start values of all elements, nothing if it is calculated."""
        return () if self.first.start is None else tuple(item.start for item in self.elements)


def fmi_arrays(model: Model) -> list[FmiArray]:
    """Return the FMI 3.0 variables of ``model`` in the order of their value references, that of FMI 2.0's."""
    groups: dict[str, list[FmiVariable]] = {}
    for item in fmi_variables(model):
        groups.setdefault(INDEX.sub("", item.name), []).append(item)
    found = [part for name, items in groups.items() for part in _variable(name, items)]
    return [item._replace(vr=place) for place, item in enumerate(found)]


def alone(item: FmiVariable) -> FmiArray:
    """Return a scalar of FMI 2.0 as a variable of its own."""
    return FmiArray(item.name, item.vr, (item,), ())


def visible_arrays(model: Model) -> list[FmiArray]:
    """Return the variables that an importer sees, in the order of the description."""
    shown = [item for item in fmi_arrays(model) if item.is_exposed]
    return sorted(shown, key=lambda item: ORDER.index(item.first.causality))


def _variable(name: str, items: list[FmiVariable]) -> Iterator[FmiArray]:
    """Yield one variable of all ``items``, or each alone if they are no complete table."""
    indices = [tuple(int(number) for number in INDEX.findall(item.name)) for item in items]
    shape = tuple(max(index) for index in zip(*indices, strict=True))
    complete = len(items) == _count(shape) and len(shape) <= MOST_DIMENSIONS
    if complete and len({(item.kind, item.causality, item.variability, item.is_exposed) for item in items}) == 1:
        ordered = tuple(item for _, item in sorted(zip(indices, items, strict=True), key=lambda pair: pair[0]))
        yield FmiArray(name, 0, ordered, shape)
    else:
        yield from (alone(item) for item in items)


def _count(shape: tuple[int, ...]) -> int:
    count = 1
    for size in shape:
        count *= size
    return count
