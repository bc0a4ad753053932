"""Who feeds whom: an output and an input of the same name are connected, if type and unit agree.

A unit that an FMU does not say agrees with any.
"""

from typing import NamedTuple

import numpy as np

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
    pairs: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for target, receiver in enumerate(slaves):
        for place, name in enumerate(receiver.inputs.names):
            source = _source_of(name, target, slaves)
            if source is not None:
                _check(slaves[source], receiver, name)
                pairs.setdefault((source, target), []).append((slaves[source].outputs.index[name], place))
    return [
        Connection(source, _places(items, 0), target, _places(items, 1)) for (source, target), items in pairs.items()
    ]


def _source_of(name: str, target: int, slaves: list[Slave]) -> int | None:
    sources = [number for number, slave in enumerate(slaves) if number != target and name in slave.outputs.index]
    if len(sources) > 1:
        offers = " and ".join(slaves[number].name for number in sources)
        raise BadInput(f"{offers} both have an output of this name", key=f"{slaves[target].name}.{name}")
    return sources[0] if sources else None


def _check(sender: Slave, receiver: Slave, name: str) -> None:
    given = sender.outputs.variables[sender.outputs.index[name]]
    taken = receiver.inputs.variables[receiver.inputs.index[name]]
    if given.kind is not taken.kind:
        raise BadInput(
            f"output of {sender.name} is {given.kind.__name__}, input of {receiver.name} is {taken.kind.__name__}",
            key=name,
        )
    said = name not in sender.outputs.unsaid and name not in receiver.inputs.unsaid
    if said and given.signal.unit != taken.signal.unit:
        raise BadInput(
            f"output of {sender.name} is in {given.signal.unit}, input of {receiver.name} in {taken.signal.unit}",
            key=name,
        )


def _places(items: list[tuple[int, int]], side: int) -> Indices:
    return np.array([item[side] for item in items], dtype=np.intp)
