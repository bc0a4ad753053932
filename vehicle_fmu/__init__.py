"""The plant: body, tyres, steering, drive, driver and sensors of the car. Knows nothing of FMI."""

import sys

from modelkit.model import Model, SmallestForm
from modelkit.terminals import TERMINALS
from vehicle_fmu import model, nearest_approach
from vehicle_fmu.interface import VehicleInput, VehicleOutput, VehicleParams

MODEL = Model(
    name="Vehicle",
    description="A car at parking speed with its driver and sensors",
    package=sys.modules[__name__],
    state=model.VehicleState,
    params=VehicleParams,
    inputs=VehicleInput,
    outputs=VehicleOutput,
    initialize=model.initialize,
    step=model.step,
    step_size=0.01,
    stop_time=60.0,
    terminals=TERMINALS,
    smallest=SmallestForm(
        outputs=frozenset({"clearance"}),
        made_of_them=frozenset({"contact"}),
        state=nearest_approach.WatchedVehicle,
        initialize=nearest_approach.initialize,
        step=nearest_approach.step,
    ),
)
