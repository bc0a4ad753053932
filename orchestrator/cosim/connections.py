"""The connections of a master: all signals from one slave to another as two index arrays."""

from typing import NamedTuple

import numpy as np

from modelkit.connections import CannotConnectError, Part, Wire, connections
from orchestrator.cosim.slave import Indices, Slave
from orchestrator.text.errors import BadInput


class Connection(NamedTuple):
    """All signals from one slave to another, as two index arrays."""

    source: int
    source_places: Indices
    target: int
    target_places: Indices


def connect(slaves: list[Slave]) -> list[Connection]:
    """Return the connections of ``slaves`` by equal names.

    Raises ``BadInput`` if a pair differs in type or unit, or if two slaves offer the same input.
    """
    pairs: dict[tuple[int, int], list[Wire]] = {}
    try:
        for wire in connections([_part(slave) for slave in slaves]):
            pairs.setdefault((wire.source, wire.target), []).append(wire)
    except CannotConnectError as error:
        raise BadInput(error.text, key=error.signal) from None
    return [
        Connection(source, _places([wire.output for wire in wires]), target, _places([wire.input for wire in wires]))
        for (source, target), wires in pairs.items()
    ]


def _part(slave: Slave) -> Part:
    unsaid = slave.inputs.unsaid | slave.outputs.unsaid
    return Part(slave.name, slave.inputs.variables, slave.outputs.variables, unsaid)


def _places(items: list[int]) -> Indices:
    return np.array(items, dtype=np.intp)
