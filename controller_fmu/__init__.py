"""The controller: planner, tracking laws and charts of automated parking. Knows nothing of FMI."""

import sys

from controller_fmu import model
from controller_fmu.interface import ControllerInput, ControllerOutput, ControllerParams
from modelkit.model import Model

MODEL = Model(
    name="Controller",
    description="Automated parking: planner, path and point tracking, manoeuvre chart",
    package=sys.modules[__name__],
    state=model.ControllerState,
    params=ControllerParams,
    inputs=ControllerInput,
    outputs=ControllerOutput,
    initialize=model.initialize,
    step=model.step,
    step_size=0.01,
    stop_time=60.0,
)
