"""All signals of a run as arrays by flat name: made by the run itself or read back from its log.

Summary, figure and report look at nothing else, so they work the same from a live run and from a file.
"""

import json
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from modelkit.model import Model
from modelkit.variables import Variable, constructor, variables
from orchestrator.cosim.master import End
from orchestrator.cosim.slave import Array, Slave, all_values
from orchestrator.text.errors import NotRunError

FIRST_ROWS = 1 << 14
"""Exchanges that the recorder has room for at first."""


@dataclass
class Recording:
    """Names are ``slave.variable``: ``vehicle.pose.x``, ``controller.phase``."""

    t_ns: np.ndarray[Any, np.dtype[np.int64]]
    """Time of each exchange [ns]."""
    signals: dict[str, Array]
    """Outputs as they are, inputs as they were seen, at each exchange; SI units."""
    parameters: dict[str, float]
    variables: dict[str, Variable]
    """Unit, meaning and states of every signal and parameter."""
    info: dict[str, Any] = field(default_factory=dict)
    """Provenance: scenario, versions, fmus, seed, and how the run ended."""

    @property
    def t(self) -> Array:
        """Time of each exchange [s]."""
        return self.t_ns / 1e9

    def states(self, name: str) -> dict[int, str]:
        """Return value -> name of the states of a mode; empty for any other signal."""
        states = self.variables[name].signal.states if name in self.variables else None
        return {} if states is None else {int(state): state.name for state in states}

    def parameters_of(self, slave: str) -> dict[str, float]:
        """Return the parameters of one slave by their own flat names."""
        prefix = slave + "."
        return {name.removeprefix(prefix): value for name, value in self.parameters.items() if name.startswith(prefix)}

    def values_at(self, slave: str, row: int) -> dict[str, float]:
        """Return the signals of one slave at one exchange, by their own flat names."""
        prefix = slave + "."
        return {
            name.removeprefix(prefix): float(values[row])
            for name, values in self.signals.items()
            if name.startswith(prefix)
        }


def inputs_seen(recording: Recording, slave: str, model: Model) -> list[Any]:
    """Return what ``slave``, which is ``model``, was given at each exchange."""
    build = constructor(model.inputs)
    columns = [recording.signals[f"{slave}.{item.name}"] for item in variables(model.inputs)]
    return [build(row) for row in np.column_stack(columns).tolist()]


class Recorder:
    """Observer that keeps every exchange in arrays, doubled in length when they are full."""

    def __init__(self, slaves: list[Slave], exchanges: int) -> None:
        self._slaves = slaves
        self._values = all_values(slaves)
        room = min(exchanges, FIRST_ROWS)
        self._rows = np.empty((room, len(self._values)))
        self._times = np.empty(room, dtype=np.int64)
        self._count = 0

    def exchanged(self, t_ns: int) -> None:
        """Copy all inputs and outputs."""
        count = self._count
        if count == len(self._times):
            self._grow()
        self._times[count] = t_ns
        self._rows[count] = self._values
        self._count = count + 1

    def closed(self, end: End) -> None:
        """Nothing to close."""

    @property
    def count(self) -> int:
        """Return how many exchanges there were."""
        return self._count

    def _grow(self) -> None:
        try:
            self._rows = np.concatenate([self._rows, np.empty_like(self._rows)])
            self._times = np.concatenate([self._times, np.empty_like(self._times)])
        except MemoryError:
            raise NotRunError(f"after {self._count} exchanges there is no memory for more") from None

    def recording(self, info: dict[str, Any]) -> Recording:
        """Return what has been seen so far."""
        signals: dict[str, Array] = {}
        meanings: dict[str, Variable] = {}
        parameters: dict[str, float] = {}
        seen = [
            (slave.name, item) for slave in self._slaves for item in slave.inputs.variables + slave.outputs.variables
        ]
        for (owner, variable), column in zip(seen, self._rows[: self._count].T, strict=True):
            signals[f"{owner}.{variable.name}"] = column
            meanings[f"{owner}.{variable.name}"] = variable
        for slave in self._slaves:
            for place, variable in enumerate(slave.parameters.variables):
                parameters[f"{slave.name}.{variable.name}"] = float(slave.parameters.values[place])
                meanings[f"{slave.name}.{variable.name}"] = variable
        return Recording(self._times[: self._count], signals, parameters, meanings, info)


def to_json(variables: list[Variable], notes: list[str]) -> str:
    """Return the description of ``variables`` that a log carries beside their schema."""
    rows = []
    for variable, note in zip(variables, notes, strict=True):
        signal = variable.signal
        states = None if signal.states is None else {"name": signal.states.__name__, "values": _members(signal.states)}
        row = {"name": variable.name, "type": variable.kind.__name__, "unit": signal.unit, "text": signal.text}
        rows.append({**row, "causality": note, "states": states})
    return json.dumps(rows)


def _members(states: Any) -> dict[str, int]:
    return {member.name: int(member) for member in states}
