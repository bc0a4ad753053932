"""Where each variable of a model lies in the flat list that an FMU keeps: parameters, inputs, outputs, time.

This file and ``slave.py`` end up inside the FMU: standard library and modelkit only.
"""

from collections.abc import Callable, Sequence
from typing import Any

from modelkit.model import Model
from modelkit.signal import Role
from modelkit.variables import constructor_source, limits_of, variables

Values = list[Any]


class Layout:
    """The places and kinds of all variables, and fast functions between the list and the model's types."""

    def __init__(self, model: Model) -> None:
        params = variables(model.params, model.first_params())
        inputs, outputs = variables(model.inputs), variables(model.outputs)
        everything = params + inputs + outputs
        self.kinds: list[type | None] = [item.kind if model.shows(item.name) else None for item in everything] + [float]
        """None: a variable that is not shown, so that nobody may get or set it."""
        self.limits = [limits_of(item.signal) for item in params]
        self.tunable = {place for place, item in enumerate(params) if Role.TUNABLE in item.roles}
        self.start: Values = [item.start for item in everything] + [0.0]
        self.first_input = len(params)
        self.first_output = self.first_input + len(inputs)
        self.time = len(everything)
        self.params = reader(model.params, 0)
        self.inputs = reader(model.inputs, self.first_input)
        self.outputs = lister(model.outputs())


def reader(cls: type[Any], at: int) -> Callable[[Values], Any]:
    """Return a function from the flat list to an instance of ``cls``, whose first scalar lies at ``at``."""
    scope: dict[str, Any] = {}

    def name_of(inner: type[Any]) -> str:
        name = f"{inner.__name__}_{id(inner)}"
        scope[name] = inner
        return name

    expression, _ = constructor_source(cls(), name_of, "v", at)
    function: Callable[[Values], Any] = eval(f"lambda v: {expression}", scope)
    return function


def lister(shape: Any) -> Callable[[Any], Values]:
    """Return a function from a value of ``shape``'s structure to the list of its scalars; ints stay ints."""
    function: Callable[[Any], Values] = eval(f"lambda v: [{', '.join(_scalar_sources(shape, 'v'))}]", {})
    return function


def picker(places: Sequence[int]) -> Callable[[Values], Values]:
    """Return a function that takes the scalars at ``places`` out of the flat list."""
    function: Callable[[Values], Values] = eval(f"lambda v: [{', '.join(f'v[{int(place)}]' for place in places)}]", {})
    return function


def _scalar_sources(shape: Any, source: str) -> list[str]:
    if isinstance(shape, tuple):
        return [part for place, item in enumerate(shape) for part in _scalar_sources(item, f"{source}[{place}]")]
    if isinstance(shape, int) and not isinstance(shape, bool):
        return [f"int({source})"]
    return [source]
