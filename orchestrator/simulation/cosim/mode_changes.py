"""What happened, in words: every change of a mode among the outputs, and every fault that comes and goes."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from orchestrator.inputs.scenario.fault import Fault
from orchestrator.simulation.cosim.algorithm import Termination
from orchestrator.simulation.cosim.fmu_instance import Array, FmuInstance, Indices, all_values, places_of
from orchestrator.simulation.cosim.signal_blocks import Times

DEBUG, INFO, WARNING, ERROR = 1, 2, 3, 4
"""Levels of Foxglove's Log message."""
Say = Callable[[int, int, str, str], None]
"""Called with (time [ns], level, name, text)."""
FMI_LEVELS = {0: INFO, 1: WARNING, 2: WARNING, 3: ERROR, 4: ERROR}


class _Mode(NamedTuple):
    place: int
    """In the array of all values."""
    name: str
    states: dict[int, str]


class ModeChanges:
    """Observer that says what changes."""

    def __init__(self, instances: list[FmuInstance], faults: Iterable[Fault], say: Say) -> None:
        self._say = say
        self._values = all_values(instances)
        outputs = places_of(instances)[1::2]
        self._modes = [
            mode for instance, part in zip(instances, outputs, strict=True) for mode in _modes(instance, part.start)
        ]
        self._places: Indices = np.array([mode.place for mode in self._modes], dtype=np.intp)
        self._before = self._values[self._places].tobytes()
        edges = [(round(fault.start * 1e9), f"{fault.kind} of {fault.signal} begins") for fault in faults]
        edges += [
            (round(fault.stop * 1e9), f"{fault.kind} of {fault.signal} ends") for fault in faults if fault.stop < 1e9
        ]
        self._edges = sorted(edges)

    def on_communication_point(self, t_ns: int) -> None:
        """Say what has changed since the last exchange."""
        while self._edges and self._edges[0][0] <= t_ns:
            self._say(t_ns, WARNING, "fault", self._edges.pop(0)[1])
        self._compare(t_ns, self._values[self._places].tobytes())

    def observe_rows(self, t_ns: Times, rows: Array) -> None:
        """Say what has changed from exchange to exchange."""
        if self._edges:
            for time, row in zip(t_ns.tolist(), rows, strict=True):
                self._values[:] = row
                self.on_communication_point(time)
            return
        modes = rows[:, self._places]
        bits = modes.view(np.int64)
        before = np.frombuffer(self._before, dtype=np.int64)
        changed = (bits != np.vstack([before, bits[:-1]])).any(axis=1)
        for row in np.flatnonzero(changed).tolist():
            self._compare(int(t_ns[row]), modes[row].tobytes())

    def _compare(self, t_ns: int, now: bytes) -> None:
        if now != self._before:
            self._tell(t_ns, np.frombuffer(self._before), np.frombuffer(now))
            self._before = now

    def on_terminate(self, end: Termination) -> None:
        """Say why the run ended."""
        level = ERROR if end.reason.startswith("error") else INFO
        self._say(end.t_ns, level, "run", f"ended: {end.reason}")

    def _tell(self, t_ns: int, before: Array, now: Array) -> None:
        for mode, old, new in zip(self._modes, before.tolist(), now.tolist(), strict=True):
            if old != new:
                was, becomes = (mode.states.get(int(value), str(value)) for value in (old, new))
                level = ERROR if "FAIL" in becomes else WARNING if mode.name.endswith(("prompt", "reason")) else INFO
                self._say(t_ns, level, mode.name, f"{was} -> {becomes}")


def _modes(instance: FmuInstance, start: int) -> list[_Mode]:
    """Return the modes among the outputs, which begin at ``start`` in the array of all values."""
    return [
        _Mode(start + place, f"{instance.name}.{item.name}", {int(state): state.name for state in item.signal.states})
        for place, item in enumerate(instance.outputs.variables)
        if item.signal.states is not None
    ]
