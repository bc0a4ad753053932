"""Both models in this process under the master, for tests that look at their outputs as they are."""

from collections.abc import Callable
from typing import Any

from orchestrator.cosim.in_process_slave import InProcessSlave
from orchestrator.cosim.master import Master
from orchestrator.scenario.models import MODELS

Look = Callable[[int, Any, Any], bool]
"""Called at every exchange with time [ns], outputs of the vehicle and of the controller; true ends the run."""


class Looking:
    """The ending that looks."""

    def __init__(self, slaves: list[InProcessSlave], look: Look) -> None:
        self._slaves, self._look = slaves, look

    def stop_reason(self, t_ns: int) -> str:
        vehicle, controller = (slave.output for slave in self._slaves)
        return "seen" if self._look(t_ns, vehicle, controller) else ""


def run(parameters: dict[str, dict[str, Any]], stop_ns: int, step_ns: int, look: Look) -> None:
    """Drive until ``look`` says so, or until ``stop_ns``."""
    slaves = [InProcessSlave(name, model, parameters[name]) for name, model in MODELS.items()]
    master = Master(list(slaves), step_ns, stop_ns)
    master.endings.append(Looking(slaves, look))
    master.initialize()
    master.run()
