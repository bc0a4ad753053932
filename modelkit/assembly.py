"""Models that feed each other, stepped together as one model: a whole system in one FMU.

They exchange as under a Jacobi master: at time zero and then once a period all outputs are read, all inputs written.
Between two exchanges the inputs are held, and a step of any length is cut there. What no part offers is an input of
the whole, which is passed on at every step.

The exchanges are exact at any communication step. A continuous part integrates over the whole time since its memory was
last brought up to date, from one exchange to the next in one go; in between its outputs come from a copy of its memory
that is thrown away. Its memory is brought up to date where an input of the whole changes. A sampled part keeps its own
sample time; it is stepped by each communication step.
"""

from collections.abc import Iterable, Iterator, Mapping
from types import ModuleType
from typing import Annotated, Any, NamedTuple, cast

from modelkit.connections import Wire, connections, part_of
from modelkit.model import Assembly, Model, Variant
from modelkit.signal import Role
from modelkit.variables import constructor, flatten, variables

INPUTS = "_inputs"
"""``<part>_inputs``: the field of the state that holds a part's inputs."""
LEFT = "to_exchange_ns"
"""The field of the state that says how long it is to the next exchange."""
BEHIND = "_behind_ns"
"""``<part>_behind_ns``: the field of the state that says how far the memory of a continuous part is behind."""


def assemble(
    name: str,
    description: str,
    package: ModuleType,
    parts: Mapping[str, Model],
    period_ns: int,
    opened: Iterable[str] = (),
) -> Model:
    """Return ``parts`` as one model, whose variables are theirs as ``<part>.<variable>`` and start as theirs.

    ``opened`` are inputs, named so too, that are left to others although a part offers them. ``package`` is where the
    types of the whole are said to be from. Raises ``CannotConnectError`` if signals of the same name do not fit,
    ``ValueError`` if more than one part has a store.
    """
    store = _only_store(name, parts)
    own = Assembly(tuple(parts.items()), period_ns, frozenset(opened))
    memory = _memory(own)
    params = {part: (model.params, model.first_params()) for part, model in own.parts}
    inputs = {part: (model.inputs, model.inputs()) for part, model in own.parts}
    outputs = {part: (_output_field(model), model.outputs()) for part, model in own.parts}
    whole = CompositeModel(own, _tuple(f"{name}State", memory, package), _tuple(f"{name}Outputs", outputs, package))
    return Model(
        name=name,
        description=description,
        package=package,
        state=whole.state,
        params=_tuple(f"{name}Params", params, package),
        inputs=_tuple(f"{name}Inputs", inputs, package),
        outputs=whole.outputs,
        initialize=whole.initialize,
        step=whole.step if store is None else whole.step_with_store,
        step_size=period_ns * 1e-9,
        stop_time=max(model.stop_time for _, model in own.parts),
        view=Variant(hidden=frozenset(_hidden(own))),
        assembly=own,
        store=store,
    )


def _memory(own: Assembly) -> dict[str, tuple[Any, Any]]:
    """Return name -> (type, start value) of what the assembled model remembers."""
    memory: dict[str, tuple[Any, Any]] = {part: (model.state, model.state()) for part, model in own.parts}
    memory |= {f"{part}{INPUTS}": (model.inputs, model.inputs()) for part, model in own.parts}
    memory[LEFT] = (int, own.period_ns)
    memory |= {f"{part}{BEHIND}": (int, 0) for part, model in own.parts if is_integrated(model)}
    return memory


class CompositeModel(NamedTuple):
    """The two functions of an assembly."""

    assembly: Assembly
    state: type[Any]
    outputs: type[Any]

    def initialize(self, params: Any) -> tuple[Any, Any]:
        """Return (state, outputs) at time zero."""
        memory, reported = {LEFT: self.assembly.period_ns}, {}
        for name, model in self.assembly.parts:
            memory[name], reported[name] = model.initialize(getattr(params, name))
            memory[name + INPUTS] = model.inputs()
            if is_integrated(model):
                memory[name + BEHIND] = 0
        self._pass_on(memory, reported)
        return self.state(**memory), self.outputs(**reported)

    def step(self, state: Any, inputs: Any, params: Any, dt_ns: int) -> tuple[Any, Any]:
        """Return (state, outputs) after a step, cut at the exchanges."""
        return self.step_with_store(None, state, inputs, params, dt_ns)

    def step_with_store(self, store: Any, state: Any, inputs: Any, params: Any, dt_ns: int) -> tuple[Any, Any]:
        """Return the same, where a part has a store."""
        memory: dict[str, Any] = state._asdict()
        reported: dict[str, Any] = {}
        self._catch_up(memory, inputs, params)
        self._take(memory, inputs)
        while True:
            span_ns = min(dt_ns, memory[LEFT])
            for name, model in self.assembly.parts:
                own, held, behind_ns = getattr(params, name), memory[name + INPUTS], memory.get(name + BEHIND, 0)
                after, reported[name] = model.stepper(store)(memory[name], held, own, behind_ns + span_ns)
                if is_integrated(model) and span_ns < memory[LEFT]:
                    memory[name + BEHIND] = behind_ns + span_ns
                    continue
                memory[name] = after
                if is_integrated(model):
                    memory[name + BEHIND] = 0
            memory[LEFT] -= span_ns
            dt_ns -= span_ns
            if memory[LEFT] == 0:
                self._pass_on(memory, reported)
                memory[LEFT] = self.assembly.period_ns
            if dt_ns <= 0:
                return self.state(**memory), self.outputs(**reported)

    def _catch_up(self, memory: dict[str, Any], inputs: Any, params: Any) -> None:
        """Bring the memory of each part up to date of which an input of the whole changes."""
        for target, (name, model) in enumerate(self.assembly.parts):
            if not memory.get(name + BEHIND, 0):
                continue
            places = [place for part, place in open_inputs(self.assembly) if part == target]
            given, held = flatten(inputs[target]), flatten(memory[name + INPUTS])
            if any(given[place] != held[place] for place in places):
                own, behind_ns = getattr(params, name), memory[name + BEHIND]
                memory[name], _ = model.stepper(None)(memory[name], memory[name + INPUTS], own, behind_ns)
                memory[name + BEHIND] = 0

    def _pass_on(self, memory: dict[str, Any], reported: Mapping[str, Any]) -> None:
        """Write outputs to the inputs they feed."""
        outputs = [flatten(reported[name]) for name, _ in self.assembly.parts]
        given = [flatten(memory[name + INPUTS]) for name, _ in self.assembly.parts]
        for wire in wires(self.assembly):
            given[wire.target][wire.input] = outputs[wire.source][wire.output]
        self._give(memory, given)

    def _take(self, memory: dict[str, Any], inputs: Any) -> None:
        """Write the inputs of the whole to those of the parts."""
        given = [flatten(memory[name + INPUTS]) for name, _ in self.assembly.parts]
        for target, place in open_inputs(self.assembly):
            given[target][place] = flatten(inputs[target])[place]
        self._give(memory, given)

    def _give(self, memory: dict[str, Any], given: list[list[Any]]) -> None:
        for (name, model), values in zip(self.assembly.parts, given, strict=True):
            memory[name + INPUTS] = constructor(model.inputs)(values)


def is_integrated(model: Model) -> bool:
    """Return whether what a part gives depends on how its time is cut: it is continuous.

    A part with work arrays is stepped as it comes: they are no part of its memory and cannot be thrown away.
    """
    return not model.sampled and model.store is None


def wires(assembly: Assembly) -> list[Wire]:
    """Return who feeds whom inside, parts by their number."""
    found = connections([part_of(name, model) for name, model in assembly.parts])
    return [wire for wire in found if _name(assembly, wire.target, wire.input) not in assembly.opened]


def open_inputs(assembly: Assembly) -> Iterator[tuple[int, int]]:
    """Yield number of the part and place of the input of each that no part feeds."""
    fed = {(wire.target, wire.input) for wire in wires(assembly)}
    for target, (_, model) in enumerate(assembly.parts):
        for place in range(len(variables(model.inputs))):
            if (target, place) not in fed:
                yield target, place


def _name(assembly: Assembly, part: int, place: int) -> str:
    name, model = assembly.parts[part]
    return f"{name}.{variables(model.inputs)[place].name}"


def _hidden(assembly: Assembly) -> Iterator[str]:
    """Yield the variables that are not shown: those of the parts that are not, and the inputs that are fed inside."""
    for part, model in assembly.parts:
        known = (item.name for cls in (model.params, model.inputs, model.outputs) for item in variables(cls))
        yield from (f"{part}.{name}" for name in known if not model.shows(name))
    for wire in wires(assembly):
        yield _name(assembly, wire.target, wire.input)


def _only_store(name: str, parts: Mapping[str, Model]) -> type[Any] | None:
    """Return the store of the one model that has one; None if none has."""
    stores = [model.store for model in parts.values() if model.store is not None]
    if len(stores) > 1:
        raise ValueError(f"{name}: only one of the models may have a store")
    return stores[0] if stores else None


def _output_field(model: Model) -> Any:
    shape: Any = model.outputs
    return Annotated[shape, Role.SAMPLED] if model.sampled else shape


def _tuple(name: str, fields: Mapping[str, tuple[Any, Any]], package: ModuleType) -> type[Any]:
    """Return a NamedTuple with ``fields``: name -> (annotation, default)."""
    made: Any = NamedTuple(name, [(field, hint) for field, (hint, _) in fields.items()])  # type: ignore[misc]
    made._field_defaults = {field: default for field, (_, default) in fields.items()}
    made.__new__.__defaults__ = tuple(made._field_defaults.values())
    made.__module__ = package.__name__
    return cast(type[Any], made)
