"""The connections of a master: all signals from one instance to another as two index arrays."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from modelkit.connections import CannotConnectError, Part, Wire, connections
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.fmu_instance import Array, FmuInstance, Indices


class Connection(NamedTuple):
    """Signals from one instance to another, as two index arrays."""

    source: int
    source_places: Indices
    target: int
    target_places: Indices
    convert: Callable[[Array], Array] | None = None
    """What makes the values of the inputs from those of the outputs; None: they are the same."""


def connect(instances: list[FmuInstance]) -> list[Connection]:
    """Return the connections of ``instances`` by equal names.

    Raises ``BadInput`` if a pair differs in type or unit, or if two instances offer the same input.
    """
    try:
        return bundle_wires(connections([part_of_instance(instance) for instance in instances]))
    except CannotConnectError as error:
        raise BadInput(error.text, key=error.signal) from None


def bundle_wires(wires: list[Wire]) -> list[Connection]:
    """Return one connection for each pair of instances."""
    pairs: dict[tuple[int, int], list[Wire]] = {}
    for wire in wires:
        pairs.setdefault((wire.source, wire.target), []).append(wire)
    return [
        Connection(source, _places([wire.output for wire in wires]), target, _places([wire.input for wire in wires]))
        for (source, target), wires in pairs.items()
    ]


def part_of_instance(instance: FmuInstance) -> Part:
    """Return an instance as far as connecting it goes: without what is only reported under its name."""
    unsaid = instance.inputs.unsaid | instance.outputs.unsaid
    inputs = instance.inputs.variables[: instance.inputs.own]
    return Part(instance.name, inputs, instance.outputs.variables, unsaid)


def _places(items: list[int]) -> Indices:
    return np.array(items, dtype=np.intp)
