"""When a run is over before its stop time."""

from modelkit.variables import Variable
from orchestrator.cosim.slave import Slave

FINAL_PHASES = ("PARKED", "FAILED", "TAKEOVER")
STANDSTILL_SPEED = 1e-3
"""A car slower than this [m/s] stands."""
STANDSTILL_TIME_NS = 500_000_000


class Standstill:
    """The chart is in a final phase and the car has stood for half a second."""

    def __init__(self, vehicle: Slave, controller: Slave) -> None:
        self._speed = vehicle.outputs.index["speed"]
        self._phase = controller.outputs.index["phase"]
        self._vehicle = vehicle.outputs.values
        self._controller = controller.outputs.values
        self._final = final_phases(controller.outputs.variables[self._phase])
        self._since: int | None = None

    def reached(self, t_ns: int) -> str:
        """Return ``standstill`` once the car has stood long enough in a final phase."""
        if self._controller[self._phase] not in self._final or abs(self._vehicle[self._speed]) > STANDSTILL_SPEED:
            self._since = None
            return ""
        if self._since is None:
            self._since = t_ns
        return "standstill" if t_ns - self._since >= STANDSTILL_TIME_NS else ""


def final_phases(phase: Variable) -> dict[int, str]:
    """Return value -> name of the phases in which a manoeuvre is over."""
    states = phase.signal.states
    return {} if states is None else {int(state): state.name for state in states if state.name in FINAL_PHASES}
