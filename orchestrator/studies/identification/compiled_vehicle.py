"""The vehicle as compiled code, driven alone by inputs over time: a drive of 20 s takes 3 ms."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fmus.native.libraries import load_model, memory_size
from modelkit.variables import Variable, variables
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.text.errors import BadInput, excerpt
from orchestrator.simulation.cosim.fmu_instance import Array

MODEL = MODELS["vehicle"]
PARAMETERS = {item.name: item for item in variables(MODEL.params, MODEL.first_params())}
INPUTS = {item.name: place for place, item in enumerate(variables(MODEL.inputs))}
OUTPUTS = {item.name: place for place, item in enumerate(variables(MODEL.outputs))}
SIGNALS: dict[str, Variable] = {item.name: item for cls in (MODEL.outputs, MODEL.inputs) for item in variables(cls)}
"""Outputs and inputs of the vehicle by name."""


class InputSequence(NamedTuple):
    """Inputs that are held from each instant to the next."""

    t_ns: NDArray[np.int64]
    """Instants (n), rising from 0."""
    rows: Array
    """Inputs between them (n - 1, inputs), SI."""


class CompiledVehicle:
    """The compiled vehicle. Raises ``BadInput`` where there is no C compiler and none of its code is kept."""

    def __init__(self) -> None:
        try:
            self._library: Any = load_model(MODEL)
        except RuntimeError as error:
            raise BadInput(f"identification runs compiled code: {excerpt(error)}") from error
        self._memory = np.zeros(memory_size(self._library) // 8 + 1)
        self._start = [float(item.start) for item in PARAMETERS.values()]
        self._places = {name: place for place, name in enumerate(PARAMETERS)}
        self.runs = 0
        """How many drives it has done."""

    def outputs(self, parameters: Mapping[str, float], inputs: InputSequence) -> Array:
        """Return the outputs at every instant (n, outputs); ``parameters`` are those that differ from the defaults."""
        values = np.array(self._start)
        for name, value in parameters.items():
            values[self._places[name]] = value
        rows = np.ascontiguousarray(inputs.rows)
        found = np.zeros((len(inputs.t_ns), len(OUTPUTS)))
        self._memory[:] = 0.0
        memory, given, taken = self._memory.ctypes.data, rows.ctypes.data, found.ctypes.data
        self._library.model_start(memory, values.ctypes.data, taken)
        step, width = self._library.model_step, rows.strides[0] if len(rows) else 0
        for dt_ns in np.diff(inputs.t_ns).tolist():
            taken += found.strides[0]
            step(memory, given, taken, dt_ns)
            given += width
        self.runs += 1
        return found
