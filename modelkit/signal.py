"""The unit and meaning of one number, and what others may do with it, written once, beside its type."""

from enum import Enum, IntEnum
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


class Role(Enum):
    """What others may do with a variable: stands beside its ``Signal``, or on a group for all that is in it."""

    LOCAL = "local"
    """Output for logs, judges and plots: no other model takes it, so it needs no port."""
    SAMPLED = "sampled"
    """Output that changes at instants and is held between them."""
    TUNABLE = "tunable"
    """Parameter that may be changed between two steps; it holds from the next step on."""
    FIXED = "fixed"
    """Parameter that may not, in a group of tunable ones: what it says is part of the memory."""


class Group(NamedTuple):
    """Annotation of a field that is a NamedTuple: ``start: Annotated[Pose, Group("at the start")] = Pose()``."""

    text: str
    """What it is; stands before the meaning of each of its fields."""
    limits: tuple[tuple[str, float], ...] = ()
    """(unit, largest magnitude) for fields in it that have no range of their own."""


class Subset(NamedTuple):
    """Annotation of a field that is a NamedTuple: a model has only those of its fields that ``shape`` names as well.

    ``car: Annotated[Car, Subset(OutlinedCar)] = Car()``: the code reads the whole car, the variables are the outline's.
    """

    shape: type
    """A class with annotations, such as a ``Protocol``."""
