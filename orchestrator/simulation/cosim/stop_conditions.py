"""When a run is over before its stop time: the scenario's end condition, watched during a run."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from orchestrator.inputs.scenario.end_condition import SPEED, EndCondition
from orchestrator.simulation.cosim.fmu_instance import Array, FmuInstance, Ports, places_of
from orchestrator.simulation.cosim.signal_blocks import Times


class _Signal(NamedTuple):
    """Where a signal is."""

    ports: Ports
    place: int
    """In the ports."""
    column: int
    """Among all values."""


class Standstill:
    """The controller is in a final state and the car has stood still for a time."""

    def __init__(self, condition: EndCondition, mode: _Signal, speed: _Signal) -> None:
        self._mode, self._mode_place = mode.ports.values, mode.place
        self._speed, self._speed_place = speed.ports.values, speed.place
        self._final = frozenset(condition.final(mode.ports.variables[mode.place]))
        self._final_values = np.array(sorted(self._final), dtype=np.float64)
        self._still = condition.still
        self._wait_ns = condition.standstill_ns
        self._since: int | None = None
        self._columns = mode.column, speed.column

    def stop_reason(self, t_ns: int) -> str:
        """Return ``standstill`` once the car has stood long enough in a final state."""
        if self._mode[self._mode_place] not in self._final or abs(self._speed[self._speed_place]) > self._still:
            self._since = None
            return ""
        if self._since is None:
            self._since = t_ns
        return "standstill" if t_ns - self._since >= self._wait_ns else ""

    def first_reached(self, t_ns: Times, rows: Array) -> tuple[int, str] | None:
        """Return the first exchange at which the car has stood long enough in a final state, and ``standstill``."""
        modes, speeds = (rows[:, column] for column in self._columns)
        stands = (modes[:, None] == self._final_values).any(axis=1) & ~(np.abs(speeds) > self._still)
        if not stands.any():
            self._since = None
            return None
        rows_before = np.maximum.accumulate(np.where(stands, -1, np.arange(len(stands))))
        since = t_ns[np.minimum(rows_before + 1, len(stands) - 1)]
        if self._since is not None:
            since = np.where(rows_before < 0, self._since, since)
        self._since = int(since[-1]) if stands[-1] else None
        reached = np.flatnonzero(stands & (t_ns - since >= self._wait_ns))
        return (int(reached[0]), "standstill") if len(reached) else None


def standstill(condition: EndCondition, instances: Sequence[FmuInstance]) -> Standstill | None:
    """Return the stop condition on the instances; None if they lack its signals: then time alone ends a run."""
    mode, speed = (_output(name, instances) for name in (condition.signal, SPEED))
    return Standstill(condition, mode, speed) if mode is not None and speed is not None else None


def _output(signal: str, instances: Sequence[FmuInstance]) -> _Signal | None:
    """Return where an output is, or an input of that name."""
    owner, _, name = signal.partition(".")
    parts = places_of(instances)
    for number, instance in enumerate(instances):
        if instance.name == owner:
            for ports, part in ((instance.outputs, parts[2 * number + 1]), (instance.inputs, parts[2 * number])):
                if name in ports.index:
                    return _Signal(ports, ports.index[name], part.start + ports.index[name])
    return None
