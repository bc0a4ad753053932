"""The unit and meaning of one number, written once, beside its type."""

from enum import IntEnum
from math import inf
from typing import NamedTuple


class Signal(NamedTuple):
    """Annotation of a NamedTuple field: ``x: Annotated[float, Signal("m", "...")] = 0.0``.

    FMI variables, log schemas, plot axes and documentation tables are all made from it.
    """

    unit: str
    """SI unit as FMI writes it: ``m``, ``rad``, ``m/s``, ``m/s2``, ``rad/s``, ``N``, ``1``..."""
    text: str
    """Meaning in one line, with its sign convention."""
    low: float = -inf
    """Smallest value allowed."""
    high: float = inf
    """Largest value allowed."""
    source: str = ""
    """Where a parameter's default comes from."""
    states: type[IntEnum] | None = None
    """Names of the values of an integer mode."""
