"""Both models in this process under the master, for tests that look at their outputs as they are."""

from collections.abc import Callable
from typing import Any

from orchestrator.inputs.scenario.models import MODELS
from orchestrator.simulation.cosim.algorithm import CoSimulation
from orchestrator.simulation.cosim.model_instance import ModelInstance

Look = Callable[[int, Any, Any], bool]
"""Called at every exchange with time [ns], outputs of the vehicle and of the controller; true ends the run."""


class Looking:
    """The ending that looks."""

    def __init__(self, instances: list[ModelInstance], look: Look) -> None:
        self._instances, self._look = instances, look

    def stop_reason(self, t_ns: int) -> str:
        vehicle, controller = (instance.output for instance in self._instances)
        return "seen" if self._look(t_ns, vehicle, controller) else ""


def run(parameters: dict[str, dict[str, Any]], stop_ns: int, step_ns: int, look: Look) -> None:
    """Drive until ``look`` says so, or until ``stop_ns``."""
    instances = [ModelInstance(name, model, parameters[name]) for name, model in MODELS.items()]
    master = CoSimulation(list(instances), step_ns, stop_ns)
    master.endings.append(Looking(instances, look))
    master.initialize()
    master.run()
