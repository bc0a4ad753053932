"""All signals of a run as arrays by flat name: made by the run itself or read back from its log.

Summary, figure and report look at nothing else, so they work the same from a live run and from a file.
"""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from modelkit.model import Model
from modelkit.variables import Variable, constructor, variables
from orchestrator.simulation.cosim.algorithm import Termination
from orchestrator.simulation.cosim.fmu_instance import Array, FmuInstance, all_values
from orchestrator.simulation.cosim.signal_blocks import BlockSignals, SignalBlocks, Times


@dataclass
class Recording:
    """Names are ``instance.variable``: ``vehicle.pose.x``, ``controller.phase``."""

    t_ns: Times
    """Time of each exchange [ns]."""
    signals: Mapping[str, Array]
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

    @property
    def count(self) -> int:
        """Return how many exchanges there were."""
        return len(self.t_ns)

    @property
    def duration(self) -> float:
        """Return the time of the last exchange [s], 0 without one."""
        return float(self.times_between(self.count - 1, self.count)[0] / 1e9) if self.count else 0.0

    def times_between(self, first: int, end: int) -> Times:
        """Return the times [ns] of the exchanges from row ``first`` up to ``end``."""
        return self.t_ns[first:end]

    @property
    def is_stored(self) -> bool:
        """Return whether the signals are not in memory, so that they are best read part by part."""
        return False

    def parts(self) -> "Iterator[RecordingPart]":
        """Yield the recording in parts that fit in memory, in order of time; a short one is one part."""
        yield RecordingPart(self, 0, True)

    def rows(self, chosen: "Sequence[int] | NDArray[np.intp]") -> "Recording":
        """Return the recording of some exchanges."""
        signals = {name: values[chosen] for name, values in self.signals.items()}
        return Recording(self.t_ns[chosen], signals, self.parameters, self.variables, self.info)

    def between(self, first: int, end: int) -> "Recording":
        """Return the exchanges from row ``first`` up to ``end``."""
        signals = {name: values[first:end] for name, values in self.signals.items()}
        return Recording(self.t_ns[first:end], signals, self.parameters, self.variables, self.info)

    def row_at(self, t: float) -> int:
        """Return the first exchange at or after ``t`` [s]; their number if there is none."""
        return int(np.searchsorted(self.t, t))

    def first(self, count: int) -> "Recording":
        """Return the recording of the first exchanges."""
        return self.rows(np.arange(min(count, self.count)))

    def states(self, name: str) -> dict[int, str]:
        """Return value -> name of the states of a mode; empty for any other signal."""
        states = self.variables[name].signal.states if name in self.variables else None
        return {} if states is None else {int(state): state.name for state in states}

    def parameters_of(self, instance: str) -> dict[str, float]:
        """Return the parameters of one instance by their own flat names."""
        prefix = instance + "."
        return {name.removeprefix(prefix): value for name, value in self.parameters.items() if name.startswith(prefix)}

    def values_at(self, instance: str, row: int) -> dict[str, float]:
        """Return the signals of one instance at one exchange, by their own flat names."""
        prefix = instance + "."
        return {
            name.removeprefix(prefix): float(values[row])
            for name, values in self.signals.items()
            if name.startswith(prefix)
        }


class RecordingPart(NamedTuple):
    """Some exchanges of a recording that follow one another."""

    recording: Recording
    first_row: int
    """Its first row in the whole recording."""
    is_last: bool


class StoredRecording(Recording):
    """A recording too long for memory. A signal, and the times, are read from the scratch file when asked for."""

    def __init__(
        self, blocks: SignalBlocks, parameters: dict[str, float], variables: dict[str, Variable], info: dict[str, Any]
    ) -> None:
        blocks.complete()
        self.blocks = blocks
        self.signals = BlockSignals(blocks)
        self.parameters, self.variables, self.info = parameters, variables, info

    @property
    def t_ns(self) -> Times:  # type: ignore[override]
        """Time of each exchange [ns]."""
        return self.blocks.times_of()

    @property
    def count(self) -> int:
        """Return how many exchanges there were."""
        return self.blocks.count

    @property
    def is_stored(self) -> bool:
        """Return that the signals are not in memory."""
        return True

    def times_between(self, first: int, end: int) -> Times:
        """Return the times [ns] of the exchanges from row ``first`` up to ``end``."""
        return self.blocks.times_of(first, end)

    def parts(self) -> Iterator[RecordingPart]:
        """Yield the blocks, in order of time."""
        for first, end in self.blocks.ranges():
            yield RecordingPart(self.between(first, end), first, end == self.count)

    def between(self, first: int, end: int) -> Recording:
        """Return the exchanges from row ``first`` up to ``end``; signals are read when asked for."""
        signals = BlockSignals(self.blocks, first, end)
        return Recording(self.blocks.times_of(first, end), signals, self.parameters, self.variables, self.info)

    def row_at(self, t: float) -> int:
        """Return the first exchange at or after ``t`` [s]; their number if there is none."""
        return self.blocks.row_at(t * 1e9) if math.isfinite(t) else 0 if t < 0.0 else self.count

    def rows(self, chosen: Sequence[int] | NDArray[np.intp]) -> Recording:
        """Return the recording of some exchanges, in memory; ``chosen`` rises."""
        wanted = np.asarray(chosen, dtype=np.intp)
        wanted = np.where(wanted < 0, wanted + self.count, wanted)
        signals = {name: np.empty(len(wanted)) for name in self.signals}
        times = np.empty(len(wanted), dtype=np.int64)
        for first, end in self.blocks.ranges():
            low, high = np.searchsorted(wanted, (first, end))
            if low == high:
                continue
            at = wanted[low:high]
            begin, stop = int(at[0]), int(at[-1]) + 1
            times[low:high] = self.blocks.times_of(begin, stop)[at - begin]
            for name, values in signals.items():
                values[low:high] = self.blocks.column(name, begin, stop)[at - begin]
        return Recording(times, signals, self.parameters, self.variables, self.info)

    def values_at(self, instance: str, row: int) -> dict[str, float]:
        """Return the signals of one instance at one exchange, by their own flat names."""
        return self.rows([row]).values_at(instance, 0)


def recording_of(
    blocks: SignalBlocks, parameters: dict[str, float], variables: dict[str, Variable], info: dict[str, Any]
) -> Recording:
    """Return what ``blocks`` hold as a recording."""
    if blocks.is_stored:
        return StoredRecording(blocks, parameters, variables, info)
    return Recording(blocks.times, blocks.columns, parameters, variables, info)


def inputs_seen(recording: Recording, instance: str, model: Model) -> list[Any]:
    """Return what ``instance``, which is ``model``, was given at each exchange."""
    build = constructor(model.inputs)
    columns = [recording.signals[f"{instance}.{item.name}"] for item in variables(model.inputs)]
    return [build(row) for row in np.column_stack(columns).tolist()]


class Recorder:
    """Observer that keeps every exchange: of a long run not in memory."""

    def __init__(self, instances: list[FmuInstance], exchanges: int) -> None:
        self._instances = instances
        self._values = all_values(instances)
        seen = [
            (instance.name, item)
            for instance in instances
            for item in instance.inputs.variables + instance.outputs.variables
        ]
        names = [f"{owner}.{item.name}" for owner, item in seen]
        self._variables = dict(zip(names, (item for _, item in seen), strict=True))
        self._blocks = SignalBlocks(names, exchanges)

    def on_communication_point(self, t_ns: int) -> None:
        """Copy all inputs and outputs."""
        self._blocks.append(t_ns, self._values)

    def observe_rows(self, t_ns: Times, rows: Array) -> None:
        """Copy all inputs and outputs of many exchanges."""
        self._blocks.extend(t_ns, rows)

    def on_terminate(self, end: Termination) -> None:
        """Nothing to close."""

    @property
    def count(self) -> int:
        """Return how many exchanges there were."""
        return self._blocks.count

    def recording(self, info: dict[str, Any]) -> Recording:
        """Return what has been seen so far."""
        meanings = dict(self._variables)
        parameters: dict[str, float] = {}
        for instance in self._instances:
            for place, variable in enumerate(instance.parameters.variables):
                parameters[f"{instance.name}.{variable.name}"] = float(instance.parameters.values[place])
                meanings[f"{instance.name}.{variable.name}"] = variable
        return recording_of(self._blocks, parameters, meanings, info)


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
