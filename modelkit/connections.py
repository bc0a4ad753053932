"""Who feeds whom: an output and an input of the same name are connected, if type and unit agree.

Local variables are not connected: other tools could not.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple, Protocol

from modelkit.model import Model
from modelkit.signal import Role
from modelkit.variables import Variable, variables


class Part(NamedTuple):
    """Something with inputs and outputs, as far as connecting it goes."""

    name: str
    inputs: Sequence[Variable]
    outputs: Sequence[Variable]
    unsaid: frozenset[str] = frozenset()
    """Variables whose unit is not said: it agrees with any."""


class Wire(NamedTuple):
    """One signal: an output of one part, an input of another, each by its place."""

    source: int
    output: int
    target: int
    input: int


class HasOutputs(Protocol):
    """A slice of a model."""

    @property
    def outputs(self) -> frozenset[str]:
        """Return the names of the outputs that it computes."""


class CannotConnectError(TypeError):
    """Two variables of the same name do not fit; ``signal`` is the one, ``line`` what connects them by name."""

    def __init__(self, text: str, signal: str, line: str = "") -> None:
        super().__init__(f"{signal}: {text}")
        self.text = text
        self.signal = signal
        self.line = line


def part_of(name: str, model: Model) -> Part:
    """Return a model as a part."""
    return Part(name, variables(model.inputs), variables(model.outputs))


def connections(parts: Sequence[Part], fed: Collection[tuple[int, int]] = ()) -> list[Wire]:
    """Return what is connected, in the order of the receivers and of their inputs.

    ``fed`` are inputs (part, place) that something else feeds already.

    Raises ``CannotConnectError`` if a pair differs in type or unit, or if two parts offer the same input.
    """
    places = [
        {item.name: place for place, item in enumerate(part.outputs) if Role.LOCAL not in item.roles} for part in parts
    ]
    wires = []
    for target, receiver in enumerate(parts):
        for place, wanted in enumerate(receiver.inputs):
            if (target, place) in fed:
                continue
            sources = [number for number in range(len(parts)) if number != target and wanted.name in places[number]]
            if len(sources) > 1:
                offers = " and ".join(parts[number].name for number in sources)
                text = f"{offers} both have an output of this name"
                raise CannotConnectError(text, f"{receiver.name}.{wanted.name}")
            for source in sources:
                output = places[source][wanted.name]
                _check(parts[source], parts[source].outputs[output], receiver, wanted)
                wires.append(Wire(source, output, target, place))
    return wires


def live_connections(models: Mapping[str, Model], slices: Mapping[str, HasOutputs] | None = None) -> list[Wire]:
    """Return what is connected of models; of ``slices``, by their names, what leads from an output that these have."""
    names = list(models)
    return [
        wire
        for wire in connections([part_of(name, model) for name, model in models.items()])
        if slices is None
        or variables(models[names[wire.source]].outputs)[wire.output].name in slices[names[wire.source]].outputs
    ]


def _check(sender: Part, given: Variable, receiver: Part, taken: Variable) -> None:
    output, into = f"output of {sender.name}", f"input of {receiver.name}"
    if given.kind is not taken.kind:
        raise CannotConnectError(f"{output} is {given.kind.__name__}, {into} is {taken.kind.__name__}", taken.name)
    said = taken.name not in sender.unsaid and taken.name not in receiver.unsaid
    if said and given.signal.unit != taken.signal.unit:
        text = f"{output} is in {given.signal.unit}, {into} in {taken.signal.unit}"
        line = f"{receiver.name}.{taken.name}: {sender.name}.{given.name}"
        raise CannotConnectError(text, taken.name, line)
