"""The connections of a master: all signals from one slave to another as two index arrays."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from modelkit.connections import CannotConnectError, Part, Wire, connections
from orchestrator.cosim.slave import Array, Indices, Slave
from orchestrator.text.errors import BadInput


class Connection(NamedTuple):
    """Signals from one slave to another, as two index arrays."""

    source: int
    source_places: Indices
    target: int
    target_places: Indices
    convert: Callable[[Array], Array] | None = None
    """What makes the values of the inputs from those of the outputs; None: they are the same."""


def connect(slaves: list[Slave]) -> list[Connection]:
    """Return the connections of ``slaves`` by equal names.

    Raises ``BadInput`` if a pair differs in type or unit, or if two slaves offer the same input.
    """
    try:
        return bundle_wires(connections([part_of_slave(slave) for slave in slaves]))
    except CannotConnectError as error:
        raise BadInput(error.text, key=error.signal) from None


def bundle_wires(wires: list[Wire]) -> list[Connection]:
    """Return one connection for each pair of slaves."""
    pairs: dict[tuple[int, int], list[Wire]] = {}
    for wire in wires:
        pairs.setdefault((wire.source, wire.target), []).append(wire)
    return [
        Connection(source, _places([wire.output for wire in wires]), target, _places([wire.input for wire in wires]))
        for (source, target), wires in pairs.items()
    ]


def part_of_slave(slave: Slave) -> Part:
    """Return a slave as far as connecting it goes: without what is only told under its name."""
    unsaid = slave.inputs.unsaid | slave.outputs.unsaid
    inputs = slave.inputs.variables[: slave.inputs.own]
    return Part(slave.name, inputs, slave.outputs.variables, unsaid)


def _places(items: list[int]) -> Indices:
    return np.array(items, dtype=np.intp)
