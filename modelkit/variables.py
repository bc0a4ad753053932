"""From the types of a model package to its flat list of named variables, and back.

Nested NamedTuples become dotted names, tuples become indices from 1 as FMI 2.0's structured
naming has them: ``pose.x``, ``ultrasonic[3]``, ``scene.boxes[2].length``. The order is the
order of the fields, depth first, and is the same everywhere.
"""

import typing
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from math import isfinite
from typing import Any, NamedTuple

from modelkit.signal import Group, Role, Signal

UNDOCUMENTED = Signal("1", "")
OPPOSITE = {Role.TUNABLE: Role.FIXED, Role.FIXED: Role.TUNABLE}


class Variable(NamedTuple):
    """One scalar of a model: its flat name, Python type, meaning and start value."""

    name: str
    kind: type
    """``float``, ``int`` or ``bool``."""
    signal: Signal
    start: Any
    roles: frozenset[Role] = frozenset()
    """Its own, and those of the groups it is in."""


def limits_of(signal: Signal) -> tuple[float, float]:
    """Return the smallest and the largest value allowed; a mode's are those of its states."""
    low, high = signal.low, signal.high
    if signal.states is not None:
        low, high = max(low, min(signal.states)), min(high, max(signal.states))
    return low, high


class _Above(NamedTuple):
    """What the groups above a field say of it."""

    signal: Signal = UNDOCUMENTED
    roles: frozenset[Role] = frozenset()
    groups: tuple[Group, ...] = ()

    def and_marks(self, marks: Iterable[Any]) -> "_Above":
        """Return the same with the annotations of a field below: the nearer one wins."""
        signal, roles, groups = self
        for mark in marks:
            if isinstance(mark, Signal):
                signal = mark
            elif isinstance(mark, Role):
                roles = roles - {OPPOSITE.get(mark)} | {mark}
            elif isinstance(mark, Group):
                groups = (*groups, mark)
        return _Above(signal, roles, groups)

    def variable(self, name: str, kind: type, start: Any) -> Variable:
        """Return the variable with the texts of its groups, and their limits if it has none."""
        signal = self.signal
        for group in reversed(self.groups):
            if signal.text:
                signal = signal._replace(text=f"{group.text}: {signal.text}")
            limit = dict(group.limits).get(signal.unit)
            if limit is not None and not isfinite(signal.low) and not isfinite(signal.high):
                signal = signal._replace(low=-limit, high=limit)
        return Variable(name, kind, signal, start, self.roles)


def variables(cls: type[Any], value: Any = None) -> list[Variable]:
    """Return the flat variables of NamedTuple ``cls``, starting at ``value`` or its defaults.

    Raises ``TypeError`` if a field is neither float, int, bool, NamedTuple nor tuple of these.
    """
    shape: Any = cls  # mypy does not take a type for hashable
    return list(_defaults(shape) if value is None else _walk(shape, value, "", _Above()))


@cache
def _defaults(cls: type[Any]) -> tuple[Variable, ...]:
    return tuple(_walk(cls, cls(), "", _Above()))


@cache
def _hints(cls: type[Any]) -> dict[str, Any]:
    return typing.get_type_hints(cls, include_extras=True)


def flatten(value: Any) -> list[Any]:
    """Return the scalars of a nested NamedTuple in the order of :func:`variables`."""
    if not isinstance(value, tuple):
        return [value]
    return [scalar for item in value for scalar in flatten(item)]


def _constructor_source(value: Any, name_of: Callable[[type[Any]], str], array: str, at: int = 0) -> tuple[str, int]:
    """Return (expression, next index) that rebuilds ``value``'s shape from ``array[at:]``.

    ``name_of`` names a NamedTuple class in the scope where the expression will be used.
    """
    if not isinstance(value, tuple):
        return _scalar_source(value, f"{array}[{at}]"), at + 1
    parts = []
    for item in value:
        part, at = _constructor_source(item, name_of, array, at)
        parts.append(part)
    if hasattr(value, "_fields"):
        return f"{name_of(type(value))}({', '.join(parts)})", at
    return f"({', '.join(parts)},)", at


def constructor(cls: type[Any], value: Any = None, at: int = 0) -> Callable[[Sequence[Any]], Any]:
    """Return a fast function from a flat sequence of scalars, the first at ``at``, to an instance of ``cls``."""
    scope: dict[str, Any] = {}

    def name_of(inner: type[Any]) -> str:
        name = f"{inner.__name__}_{id(inner)}"
        scope[name] = inner
        return name

    expression, _ = _constructor_source(cls() if value is None else value, name_of, "v", at)
    function: Callable[[Sequence[Any]], Any] = eval(f"lambda v: {expression}", scope)
    return function


def flattener(shape: Any) -> Callable[[Any], list[Any]]:
    """Return a fast function from a value of ``shape``'s structure to the list of its scalars; modes become ints."""
    function: Callable[[Any], list[Any]] = eval(f"lambda v: [{', '.join(_flat_sources(shape, 'v'))}]", {})
    return function


def with_values(cls: type[Any], changes: dict[str, Any], value: Any = None) -> Any:
    """Return ``value`` (or the defaults of ``cls``) with some flat names changed.

    Raises ``KeyError`` with the unknown name, ``ValueError`` if a number is out of its range.
    """
    shape: Any = cls
    known, index = _defaults(shape), _places(shape)
    old = cls() if value is None else value
    scalars = [variable.kind(scalar) for variable, scalar in zip(known, flatten(old), strict=True)]
    for name, new in changes.items():
        if name not in index:
            raise KeyError(name)
        variable = known[index[name]]
        if not variable.signal.low <= new <= variable.signal.high:
            raise ValueError(
                f"{name} = {new}: expected [{variable.signal.low}, {variable.signal.high}] {variable.signal.unit}"
            )
        scalars[index[name]] = variable.kind(new)
    return _rebuild(old, iter(scalars))


@cache
def _places(cls: type[Any]) -> dict[str, int]:
    """Return flat name -> place in :func:`variables`."""
    shape: Any = cls
    return {variable.name: place for place, variable in enumerate(_defaults(shape))}


def _rebuild(shape: Any, scalars: Iterator[Any]) -> Any:
    """Return a value of ``shape``'s structure and types made of the next ``scalars``."""
    if not isinstance(shape, tuple):
        scalar = next(scalars)
        return bool(scalar) if isinstance(shape, bool) else int(scalar) if isinstance(shape, int) else scalar
    items = [_rebuild(item, scalars) for item in shape]
    return type(shape)(*items) if hasattr(shape, "_fields") else tuple(items)


def _flat_sources(shape: Any, source: str) -> list[str]:
    if isinstance(shape, tuple):
        return [part for place, item in enumerate(shape) for part in _flat_sources(item, f"{source}[{place}]")]
    return [f"int({source})"] if isinstance(shape, int) and not isinstance(shape, bool) else [source]


def _scalar_source(value: Any, item: str) -> str:
    return f"bool({item})" if isinstance(value, bool) else f"int({item})" if isinstance(value, int) else item


def _walk(hint: Any, value: Any, name: str, above: _Above) -> Iterator[Variable]:
    if typing.get_origin(hint) is typing.Annotated:
        yield from _walk(hint.__origin__, value, name, above.and_marks(hint.__metadata__))
    elif hint in (float, int, bool):
        yield above.variable(name, hint, hint(value))
    elif hasattr(hint, "_fields"):
        hints = _hints(hint)
        for field, item in zip(hint._fields, value, strict=True):
            yield from _walk(hints[field], item, f"{name}.{field}" if name else field, above)
    elif typing.get_origin(hint) is tuple:
        element = typing.get_args(hint)[0]
        for number, item in enumerate(value, start=1):
            yield from _walk(element, item, f"{name}[{number}]", above)
    else:
        raise TypeError(f"{name}: a model field is float, int, bool, NamedTuple or tuple, not {hint}")
