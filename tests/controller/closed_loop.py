"""A drive of vehicle and controller as lists of their outputs."""

from typing import Any, NamedTuple

from controller_fmu.common.phases import is_over
from controller_fmu.registry import Phase
from tests.controller.in_process import run


class Run(NamedTuple):
    """What happened: one row of outputs for each exchange."""

    vehicle: list[Any]
    controller: list[Any]

    @property
    def phases(self) -> list[int]:
        return [Phase(outputs.phase) for outputs in self.controller]

    @property
    def visited(self) -> list[int]:
        phases = self.phases
        return [phase for k, phase in enumerate(phases) if k == 0 or phase != phases[k - 1]]

    def at_entry(self, phase: int) -> Any:
        """Return the vehicle outputs when ``phase`` was first entered."""
        return self.vehicle[self.phases.index(phase)]


def drive(vehicle: dict[str, Any], controller: dict[str, Any], stop: float = 60.0, step_ns: int = 10_000_000) -> Run:
    """Return a run until the car stands in a final phase."""
    seen = Run([], [])

    def look(_t_ns: int, car: Any, asked: Any) -> bool:
        seen.vehicle.append(car)
        seen.controller.append(asked)
        return bool(is_over(asked.phase) and car.speed == 0.0)

    run({"vehicle": vehicle, "controller": controller}, round(stop * 1e9), step_ns, look)
    return seen
