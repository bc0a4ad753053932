"""Both models in this process, compiled, for tests that look at their outputs as they are.

``tests/compiler`` and ``tests/twin`` show that the C has CPython's bits.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from fmus.native.libraries import load_model, memory_size
from modelkit.variables import constructor, flatten
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.simulation.cosim.algorithm import CoSimulation
from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.simulation.cosim.model_instance import ModelInstance

Look = Callable[[int, Any, Any], bool]
"""Called at every exchange with time [ns], outputs of the vehicle and of the controller; true ends the run."""


class CompiledInstance(ModelInstance):
    """A model in C, behind the face of the model in CPython."""

    def initialize(self, stop_ns: int) -> None:
        self._library = load_model(self._model)
        self._memory = np.zeros(memory_size(self._library) // 8 + 1, dtype=np.int64)
        self._row = np.zeros(self.outputs.own)
        self._tuple_of = constructor(self._model.outputs)
        params = np.array(flatten(self._params), dtype=float)
        self._library.model_start(self._memory.ctypes.data, params.ctypes.data, self._row.ctypes.data)
        self._update()

    def fetch_outputs(self) -> None:
        self.outputs.values[: self.outputs.own] = self._row

    def send_inputs(self) -> None:
        self._sent = np.array(self.inputs.values[: self.inputs.own])

    def step(self, t_ns: int, dt_ns: int) -> None:
        given, row = self._sent.ctypes.data, self._row.ctypes.data
        self._library.model_step(self._memory.ctypes.data, given, row, dt_ns)
        self._update()

    def _update(self) -> None:
        self.output = self._tuple_of(self._row.tolist())


class Looking:
    """The ending that looks."""

    def __init__(self, instances: list[ModelInstance], look: Look) -> None:
        self._instances, self._look = instances, look

    def stop_reason(self, t_ns: int) -> str:
        vehicle, controller = (instance.output for instance in self._instances)
        return "seen" if self._look(t_ns, vehicle, controller) else ""


def run(parameters: dict[str, dict[str, Any]], stop_ns: int, step_ns: int, look: Look) -> None:
    """Drive until ``look`` is true, or until ``stop_ns``."""
    kind = CompiledInstance if can_compile() else ModelInstance
    instances = [kind(name, model, parameters[name]) for name, model in MODELS.items()]
    master = CoSimulation(list(instances), step_ns, stop_ns)
    master.endings.append(Looking(instances, look))
    master.initialize()
    master.run()
