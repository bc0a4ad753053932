"""The plant: body, tyres, steering, drive, driver and sensors of the car. Knows nothing of FMI."""

import sys

from modelkit.model import Model
from modelkit.terminals import TERMINALS
from vehicle_fmu import model
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
)
