"""Where each variable of a model lies in the flat list that an FMU keeps: parameters, inputs, outputs, time.

This file and ``slave.py`` end up inside the FMU: standard library and modelkit only.
"""

from collections.abc import Callable, Sequence
from typing import Any

from modelkit.model import Model
from modelkit.signal import Role
from modelkit.variables import constructor, flattener, limits_of, variables

Values = list[Any]

POLICY_FILE = "policy.onnx"
"""The network of an FMU that carries out a policy, in its resources."""


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
        self.params = constructor(model.params)
        self.inputs = constructor(model.inputs, at=self.first_input)
        self.outputs = flattener(model.outputs())


def picker(places: Sequence[int]) -> Callable[[Values], Values]:
    """Return a function that takes the scalars at ``places`` out of the flat list."""
    function: Callable[[Values], Values] = eval(f"lambda v: [{', '.join(f'v[{int(place)}]' for place in places)}]", {})
    return function
