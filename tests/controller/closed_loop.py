"""Vehicle and controller in one plain loop, for tests: the exchange of the master, nothing else."""

from typing import Any, NamedTuple

from controller_fmu import MODEL as CONTROLLER
from controller_fmu.interface import Phase
from modelkit.variables import constructor, flatten, variables, with_values
from vehicle_fmu import MODEL as VEHICLE


class Run(NamedTuple):
    """What happened: one row of outputs for each exchange."""

    vehicle: list[Any]
    controller: list[Any]

    @property
    def phases(self) -> list[Phase]:
        return [Phase(outputs.phase) for outputs in self.controller]

    @property
    def visited(self) -> list[Phase]:
        phases = self.phases
        return [phase for k, phase in enumerate(phases) if k == 0 or phase != phases[k - 1]]

    def at_entry(self, phase: Phase) -> Any:
        """Return the vehicle outputs when ``phase`` was first entered."""
        return self.vehicle[self.phases.index(phase)]


def _connect(source: Any, target: Any) -> Any:
    names = [variable.name for variable in variables(source.outputs)]
    build = constructor(target.inputs)
    start = [variable.start for variable in variables(target.inputs)]
    places = [
        (k, names.index(variable.name)) for k, variable in enumerate(variables(target.inputs)) if variable.name in names
    ]

    def receive(outputs: Any) -> Any:
        flat, values = flatten(outputs), list(start)
        for to, at in places:
            values[to] = flat[at]
        return build(values)

    return receive


TO_CONTROLLER = _connect(VEHICLE, CONTROLLER)
TO_VEHICLE = _connect(CONTROLLER, VEHICLE)


def drive(vehicle: dict[str, Any], controller: dict[str, Any], stop: float = 60.0, step_ns: int = 10_000_000) -> Run:
    vehicle_params = with_values(VEHICLE.params, vehicle)
    controller_params = with_values(CONTROLLER.params, controller)
    vehicle_state, vehicle_out = VEHICLE.initialize(vehicle_params)
    controller_state, controller_out = CONTROLLER.initialize(controller_params)
    run = Run([vehicle_out], [controller_out])
    for _ in range(round(stop * 1e9) // step_ns):
        vehicle_in, controller_in = TO_VEHICLE(controller_out), TO_CONTROLLER(vehicle_out)
        vehicle_state, vehicle_out = VEHICLE.step(vehicle_state, vehicle_in, vehicle_params, step_ns)
        controller_state, controller_out = CONTROLLER.step(controller_state, controller_in, controller_params, step_ns)
        run.vehicle.append(vehicle_out)
        run.controller.append(controller_out)
        if controller_out.phase >= Phase.PARKED and vehicle_out.speed == 0.0:
            break
    return run
