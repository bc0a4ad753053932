"""The one face of a model package: types, two functions, and how often it is called."""

from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple


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
