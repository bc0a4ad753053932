"""The one face of a model package: types, two functions, and how often it is called."""

from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple


class Branch(NamedTuple):
    """One of several systems in a model: it alone acts while the model's choosing parameter has one of its values.

    ``step(common, own, inputs, params, dt_ns) -> (common, own, outputs)`` sees the common field of the state
    and its own; the fields of all other branches stay as they are.
    """

    values: tuple[int, ...]
    field: str
    step: Callable[..., Any]


class Branches(NamedTuple):
    """The systems a model is made of; a value that none of them has chooses the first."""

    parameter: str
    """The choosing parameter, an integer."""
    common: str
    """The field of the state that every branch gets and returns."""
    systems: tuple[Branch, ...]

    def step(self, state: Any, inputs: Any, params: Any, dt_ns: int) -> tuple[Any, Any]:
        """Return (state, outputs) after a step of the chosen branch: the model's ``step``."""
        value = getattr(params, self.parameter)
        branch = next((item for item in self.systems if value in item.values), self.systems[0])
        common, own = getattr(state, self.common), getattr(state, branch.field)
        common, own, outputs = branch.step(common, own, inputs, params, dt_ns)
        return state._replace(**{self.common: common, branch.field: own}), outputs


class Model(NamedTuple):
    """A sampled or continuous model as pure functions over NamedTuples.

    ``initialize(params) -> (state, outputs)`` gives the state at time zero and the outputs
    that are valid in FMI's Initialization Mode. ``step(state, inputs, params, dt_ns) ->
    (state, outputs)`` moves on by ``dt_ns`` nanoseconds with the inputs held. Neither raises:
    a bad input shows as a status in the outputs. Outputs have no direct feed-through.
    """

    name: str
    description: str
    package: ModuleType
    state: type[Any]
    params: type[Any]
    inputs: type[Any]
    outputs: type[Any]
    initialize: Callable[..., Any]
    step: Callable[..., Any]
    step_size: float
    """Default communication step [s]."""
    stop_time: float
    """Default experiment length [s]."""
    branches: Branches | None = None
    """What ``step`` is made of, if it is ``branches.step``: compiled code then touches the chosen state only."""
