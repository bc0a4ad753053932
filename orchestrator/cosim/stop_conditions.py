"""When a run is over before its stop time: the scenario's end condition, watched during a run."""

from collections.abc import Sequence

from orchestrator.cosim.fmu_instance import FmuInstance, Ports
from orchestrator.scenario.end_condition import SPEED, EndCondition


class Standstill:
    """The controller is in a final state and the car has stood still for a time."""

    def __init__(self, condition: EndCondition, mode: tuple[Ports, int], speed: tuple[Ports, int]) -> None:
        self._mode, self._mode_place = mode[0].values, mode[1]
        self._speed, self._speed_place = speed[0].values, speed[1]
        self._final = frozenset(condition.final(mode[0].variables[mode[1]]))
        self._still = condition.still
        self._wait_ns = condition.standstill_ns
        self._since: int | None = None

    def stop_reason(self, t_ns: int) -> str:
        """Return ``standstill`` once the car has stood long enough in a final state."""
        if self._mode[self._mode_place] not in self._final or abs(self._speed[self._speed_place]) > self._still:
            self._since = None
            return ""
        if self._since is None:
            self._since = t_ns
        return "standstill" if t_ns - self._since >= self._wait_ns else ""


def standstill(condition: EndCondition, instances: Sequence[FmuInstance]) -> Standstill | None:
    """Return the stop condition on the instances; None if they lack its signals: then time alone ends a run."""
    mode, speed = (_output(name, instances) for name in (condition.signal, SPEED))
    return Standstill(condition, mode, speed) if mode is not None and speed is not None else None


def _output(signal: str, instances: Sequence[FmuInstance]) -> tuple[Ports, int] | None:
    """Return where an output is, or what is told under that name."""
    owner, _, name = signal.partition(".")
    for instance in instances:
        if instance.name == owner:
            for ports in (instance.outputs, instance.inputs):
                if name in ports.index:
                    return ports, ports.index[name]
    return None
