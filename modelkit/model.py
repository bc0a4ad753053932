"""The one face of a model package: types, two functions, and how often it is called."""

from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple


class Branch(NamedTuple):
    """One of several sampled systems in a model: it alone acts while the choosing parameter has one of its values.

    ``sample(own, inputs, params, period_ns) -> own`` moves its memory on by a sample, ``outputs(own, params)``
    tells what is held until the next one.
    """

    values: tuple[int, ...]
    field: str
    """Its memory: a field of the model's state."""
    sample: Callable[..., Any]
    outputs: Callable[..., Any]


class Branches(NamedTuple):
    """The sampled systems a model is made of; a value that none of them has chooses the first."""

    parameter: str
    """The choosing parameter, an integer."""
    clock: str
    """The field of the state that all share: it has ``usable``, false if the parameters make no sense."""
    tick: Callable[..., Any]
    """``tick(clock, params, dt_ns) -> (clock, samples, period_ns)``: how many samples are due in a step."""
    refused: Callable[..., Any]
    """``refused()``: the outputs as long as the clock is not usable."""
    systems: tuple[Branch, ...]

    def step(self, state: Any, inputs: Any, params: Any, dt_ns: int) -> tuple[Any, Any]:
        """Return (state, outputs) after a step of the chosen system: the model's ``step``."""
        value = getattr(params, self.parameter)
        chosen = next((item for item in self.systems if value in item.values), self.systems[0])
        clock, samples, period_ns = self.tick(getattr(state, self.clock), params, dt_ns)
        own = getattr(state, chosen.field)
        for _ in range(samples):
            own = chosen.sample(own, inputs, params, period_ns)
        outputs = chosen.outputs(own, params) if clock.usable else self.refused()
        return state._replace(**{self.clock: clock, chosen.field: own}), outputs


class Terminal(NamedTuple):
    """Signals that belong together, for tools that connect many of them at once to a terminal of the same name."""

    name: str
    text: str
    members: tuple[str, ...]
    """Inputs and outputs, or groups of them (``pose`` for ``pose.x``, ``pose.y``...); what a model lacks is left out.
    """


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
    terminals: tuple[Terminal, ...] = ()
    """Groups of its inputs and outputs; none: all inputs are one and all outputs another."""
