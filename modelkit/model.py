"""The one face of a model package: types, two functions, and how often it is called."""

from collections.abc import Callable, Iterable, Mapping
from enum import IntEnum
from functools import cache, partial
from types import ModuleType
from typing import Any, Generic, NamedTuple, TypeAlias, cast

from modelkit.composition import groups_of
from modelkit.store import new_store
from modelkit.type_variables import Clock, Input, Output, Own, Params, State
from modelkit.variables import variables, with_values

Step: TypeAlias = Callable[[State, Input, Params, int], tuple[State, Output]]
StepWithStore: TypeAlias = Callable[[Any, State, Input, Params, int], tuple[State, Output]]


class Chart(NamedTuple):
    """A state machine of a system as its table, for pictures of it and for who looks on while it runs."""

    signal: str
    """The output that tells its state; empty: none does."""
    states: type[IntEnum]
    guards: type[IntEnum]
    rows: tuple[tuple[int, ...], ...]
    """(source, guard, target, ...) in order of priority; a negative source stands for all states that are no end."""


class SampledSystem(NamedTuple, Generic[Own, Params, Input, Output]):
    """One of several sampled systems in a model: it alone acts while the choosing parameter has one of its values.

    It knows its own types only. The model has the fields of all systems (``modelkit.composition``): a system reads
    those that it has of the model's parameters and inputs, and the outputs that it does not have keep their defaults.
    """

    field: str
    """Its memory: a field of the model's state."""
    choices: type[IntEnum]
    """Its values of the choosing parameter."""
    descriptions: tuple[str, ...]
    """What a model of it alone does, one line for each choice."""
    state: type[Own]
    params: type[Params]
    """What can be set of it: its variables, and no other, are those of a model of it alone."""
    inputs: type[Input]
    reported: type[Output]
    """Its outputs."""
    start: Callable[[Params], Own]
    """``start(params) -> own``: its memory before the first sample."""
    sample: Callable[[Own, Input, Params, int], Own]
    """``sample(own, inputs, params, period_ns) -> own``: its memory a sample later."""
    outputs: Callable[[Own, Params], Output]
    """``outputs(own, params) -> outputs``: what is held until the next sample."""
    charts: tuple[Chart, ...] = ()
    """Its state machines that are tables."""

    @property
    def values(self) -> tuple[int, ...]:
        """Its values of the choosing parameter, as numbers."""
        return tuple(int(choice) for choice in self.choices)

    @property
    def own(self) -> tuple[str, ...]:
        """Its parameters, inputs and outputs: names, or groups that it has all of."""
        return tuple(name for cls in (self.params, self.inputs, self.reported) for name in groups_of(cls))

    @property
    def states(self) -> tuple[tuple[str, type[IntEnum]], ...]:
        """(output, states) of the modes among its outputs."""
        found = ((item.name, item.signal.states) for item in variables(self.reported))
        return tuple((name, states) for name, states in found if states is not None)


class SampledSystems(NamedTuple, Generic[State, Params, Input, Output, Clock]):
    """The sampled systems a model is made of, and the clock they share; together they are its two functions."""

    state: type[State]
    """The model's: a field for the clock and one for the memory of each system."""
    parameter: str
    """The choosing parameter, an integer; a value that no system has is refused."""
    clock: str
    """The field of the state that all share: it has ``usable``, false if the parameters make no sense."""
    begin: Callable[[Any], Clock]
    """``begin(params) -> clock``: the clock at time zero."""
    tick: Callable[[Clock, Any, int], tuple[Clock, int, int]]
    """``tick(clock, params, dt_ns) -> (clock, samples, period_ns)``: how many samples are due in a step."""
    refused: Callable[[], Any]
    """``refused()``: the outputs where no system acts; those that it does not give keep their defaults."""
    outputs: type[Output]
    """The model's, with those of all systems."""
    systems: tuple[SampledSystem[Any, Any, Any, Any], ...]

    def initialize(self, params: Params) -> tuple[State, Output]:
        """Return (state, outputs) at time zero: the model's ``initialize``."""
        memories = {item.field: item.start(params) for item in self.systems}
        state = self.state(**{self.clock: self.begin(params)}, **memories)
        chosen = self._select(params)
        return state, self._outputs(getattr(state, self.clock), chosen, state, params)

    def step(self, state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
        """Return (state, outputs) after a step of the chosen system: the model's ``step``."""
        clock, samples, period_ns = self.tick(getattr(state, self.clock), params, dt_ns)
        changed = {self.clock: clock}
        chosen = self._select(params)
        if chosen is not None:
            own = getattr(state, chosen.field)
            for _ in range(samples):
                own = chosen.sample(own, inputs, params, period_ns)
            changed[chosen.field] = own
        state = _with(state, changed)
        return state, self._outputs(clock, chosen, state, params)

    def _select(self, params: Params) -> SampledSystem[Any, Any, Any, Any] | None:
        value = getattr(params, self.parameter)
        return next((item for item in self.systems if value in item.values), None)

    def _outputs(
        self, clock: Any, chosen: SampledSystem[Any, Any, Any, Any] | None, state: State, params: Params
    ) -> Output:
        if chosen is None or not clock.usable:
            return _complete(self.outputs, self.refused())
        return _complete(self.outputs, chosen.outputs(getattr(state, chosen.field), params))


class Terminal(NamedTuple):
    """Signals that belong together, for tools that connect many of them at once to a terminal of the same name."""

    name: str
    text: str
    members: tuple[str, ...]
    """Inputs and outputs, or groups of them (``pose`` for ``pose.x``, ``pose.y``...); what a model lacks is left out.
    """


class Variant(NamedTuple):
    """What of a model is shown to others, if not all of it, and how it starts. The code is the same."""

    starts: tuple[tuple[str, Any], ...] = ()
    """(parameter, value) of parameters that start with another value than their default."""
    hidden: frozenset[str] = frozenset()
    """Variables that are not shown; they keep their start values."""
    states: tuple[tuple[str, type[IntEnum]], ...] = ()
    """(variable, states) of modes that have only these of all their states."""


class Assembly(NamedTuple):
    """What a model is made of that is several models stepped together: see ``modelkit.assembly``."""

    parts: tuple[tuple[str, "Model"], ...]
    """Name of each, and the model."""
    period_ns: int
    """Time between two exchanges."""
    opened: frozenset[str] = frozenset()
    """Inputs as ``part.input`` that are left to others although a part offers them."""


class SmallestForm(NamedTuple):
    """What a model is made of for runs of which only the smallest value of some outputs is kept.

    These outputs hold their smallest value so far, so that they need not be worked out where they cannot be smaller.
    """

    outputs: frozenset[str]
    made_of_them: frozenset[str]
    """Further outputs that mean something else in this form."""
    state: type[Any]
    initialize: Callable[..., Any]
    step: Callable[..., Any]


class Model(NamedTuple, Generic[State, Params, Input, Output]):
    """A sampled or continuous model as pure functions over NamedTuples: ``Model[State, Params, Input, Output]``.

    A type checker holds both functions against these four types, and those of each system against one another.

    ``initialize(params) -> (state, outputs)`` gives the state at time zero and the outputs
    that are valid in FMI's Initialization Mode. ``step(state, inputs, params, dt_ns) ->
    (state, outputs)`` moves on by ``dt_ns`` nanoseconds with the inputs held. Neither raises:
    a bad input shows as a status in the outputs. Outputs have no direct feed-through.

    A model with a ``store`` (``modelkit.store``) is stepped by ``step(store, state, inputs, params, dt_ns)``,
    which changes the store in place; it is all zeros when an instance is initialized.
    """

    name: str
    description: str
    package: ModuleType
    state: type[State]
    params: type[Params]
    inputs: type[Input]
    outputs: type[Output]
    initialize: Callable[[Params], tuple[State, Output]]
    step: Step[State, Input, Params, Output] | StepWithStore[State, Input, Params, Output]
    step_size: float
    """Default communication step [s]."""
    stop_time: float
    """Default experiment length [s]."""
    systems: SampledSystems | None = None
    """What both functions are made of, if they are its: compiled code then touches the chosen memory only."""
    terminals: tuple[Terminal, ...] = ()
    """Groups of its inputs and outputs; none: all inputs are one and all outputs another."""
    sampled: bool = False
    """It acts at instants of its own and holds its outputs between them."""
    view: Variant = Variant()
    assembly: Assembly | None = None
    """What it is made of, if that is several models."""
    store: type[Any] | None = None
    """Its work arrays beside the state: a NamedTuple of columns."""
    charts: tuple[Chart, ...] = ()
    """Its state machines that are tables, if it is not made of systems that have theirs."""
    substitutes: tuple[tuple[type[Any], type[Any]], ...] = ()
    """(type that the code names, type with the same fields and longer arrays that this model has instead): the same
    code with another capacity."""
    smallest: SmallestForm | None = None

    def new_store(self) -> Any:
        """Return the work arrays of a new instance, all zeros; None if the model has none."""
        return None if self.store is None else new_store(self.store)

    def stepper(self, store: Any) -> Step[State, Input, Params, Output]:
        """Return ``step(state, inputs, params, dt_ns)`` of the instance with this store."""
        if self.store is None:
            return cast("Step[State, Input, Params, Output]", self.step)
        return cast("Step[State, Input, Params, Output]", partial(cast("Callable[..., Any]", self.step), store))

    def first_params(self) -> Params:
        """Return the parameters it starts with: the defaults, but for those that its view starts otherwise."""
        return cast("Params", with_values(self.params, dict(self.view.starts)))

    def sources(self) -> list[ModuleType]:
        """Return the packages that its code is in."""
        if self.assembly is None:
            return [self.package]
        return [package for _, part in self.assembly.parts for package in part.sources()]

    def with_start_values(self, values: Mapping[str, Any]) -> "Model[State, Params, Input, Output]":
        """Return the model with ``values`` as start values of parameters shown, and the defaults of the others.

        Values of parameters not shown are left out: they mean nothing to it. Raises ``KeyError`` for a parameter it
        does not have, ``ValueError`` for a value that is out of range, or that the model is not made for.
        """
        kept = {name: value for name, value in self.view.starts if not self.shows(name)}
        for name in kept.keys() & values.keys():
            if values[name] != kept[name]:
                raise ValueError(f"{name} = {values[name]}: it is {kept[name]} in {self.name}")
        known = variables(self.params, with_values(self.params, dict(values)))
        chosen = {item.name: item.start for item in known if item.name in values and self.shows(item.name)}
        return self._replace(view=self.view._replace(starts=tuple((kept | chosen).items())))

    def only(self, value: int, name: str, description: str) -> "Model[State, Params, Input, Output]":
        """Return the model with the system of ``value`` alone: it shows the variables of that system's types."""
        assert self.systems is not None
        chosen = next(item for item in self.systems.systems if value in item.values)
        known = [item.name for cls in (self.params, self.inputs, self.outputs) for item in variables(cls)]
        parameter = self.systems.parameter
        hidden = frozenset(known) - _those_in(chosen.own, known) | {parameter}
        view = Variant(((parameter, int(value)),), hidden, chosen.states)
        return self._replace(name=name, description=description, view=view)

    def in_smallest_form(self) -> "Model[Any, Params, Input, Output]":
        """Return the model made of its form for smallest values."""
        assert self.smallest is not None
        form = self.smallest
        return self._replace(state=form.state, initialize=form.initialize, step=form.step, smallest=None)

    def all_charts(self) -> list[Chart]:
        """Return its charts and those of its systems, each once."""
        systems = () if self.systems is None else self.systems.systems
        found = [*self.charts, *(chart for system in systems for chart in system.charts)]
        return list({id(chart.rows): chart for chart in found}.values())

    def shows(self, name: str) -> bool:
        """Return whether others see the variable ``name``."""
        return name not in self.view.hidden


def _with(state: State, changed: dict[str, Any]) -> State:
    """Return the state with some of its fields changed."""
    whole: Any = state
    return cast("State", whole._replace(**changed))


def _complete(outputs: type[Output], reported: Any) -> Output:
    """Return the outputs of a system as those of the model, which has more."""
    shape: Any = type(reported)  # mypy does not take a type for hashable
    whole: Any = outputs
    return cast("Output", reported if shape is outputs else _completer(whole, shape)(reported))


@cache
def _completer(outputs: Any, reported: Any) -> Callable[[Any], Any]:
    """Return a fast function from a system's outputs to the model's."""
    whole = outputs()
    fields = [f"t.{name}" if name in reported._fields else f"w.{name}" for name in outputs._fields]
    made: Callable[[Any], Any] = eval(f"lambda t: C({', '.join(fields)})", {"C": outputs, "w": whole})
    return made


def _those_in(groups: tuple[str, ...], names: Iterable[str]) -> frozenset[str]:
    """Return which variables are one of ``groups`` or in one of them."""
    inside = tuple(f"{group}{mark}" for group in groups for mark in ".[")
    return frozenset(name for name in names if name in groups or name.startswith(inside))
