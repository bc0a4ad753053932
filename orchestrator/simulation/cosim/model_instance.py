"""A model package run in this process, without an FMU: for trials, sweeps, and as the twin of the FMUs."""

from collections.abc import Mapping
from typing import Any

from modelkit.model import Model
from modelkit.variables import constructor, flattener, variables, with_values
from orchestrator.inputs.text.errors import RESOURCES, RunError
from orchestrator.simulation.cosim.fmu_instance import Ports


class ModelInstance:
    """``modelkit.model.Model`` behind the face of an instance."""

    has_variable_step = True

    def __init__(self, name: str, model: Model, parameters: Mapping[str, Any]) -> None:
        self.name = name
        self.identity = f"in-process {model.name}"
        self._model = model
        self._given = dict(parameters)
        self._params = with_values(model.params, self._given)
        self.inputs = Ports(variables(model.inputs))
        self.outputs = Ports(variables(model.outputs))
        self.parameters = Ports(variables(model.params, self._params))
        self._flatten = flattener(model.outputs())
        self._construct = constructor(model.inputs)
        self._input = model.inputs()
        self._state: Any = None
        self._step = model.stepper(None)
        self.output: Any = None
        """The latest outputs as the model gave them."""

    def initialize(self, stop_ns: int) -> None:
        """Compute the state at time zero and the outputs that are valid then."""
        self._step = self._model.stepper(self._model.new_store())
        self._state, self.output = self._model.initialize(self._params)

    def start(self) -> None:
        """Nothing to leave in process."""

    def fetch_outputs(self) -> None:
        """Unpack the latest output tuple."""
        self.outputs.values[:] = self._flatten(self.output)

    def send_inputs(self) -> None:
        """Pack the input tuple."""
        self._input = self._construct(self.inputs.values[: self.inputs.own].tolist())

    def step(self, t_ns: int, dt_ns: int) -> None:
        """Call the model's step; an exception in model code is a defect and ends the run."""
        try:
            self._state, self.output = self._step(self._state, self._input, self._params, dt_ns)
        except RESOURCES:
            raise
        except Exception as error:
            raise RunError(f"{self.name} raised {type(error).__name__}: {error}") from error

    def tune(self, name: str, value: float) -> None:
        """Give a parameter another value from the next step on."""
        kind = self.parameters.variables[self.parameters.index[name]].kind
        self._given[name] = kind(value)
        self._params = with_values(self._model.params, self._given)

    def close(self) -> None:
        """Nothing to free in process."""
