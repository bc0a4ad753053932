"""The controller: planner, tracking laws and charts of automated parking. Knows nothing of FMI."""

import sys

from controller_fmu import model
from controller_fmu.interface import ControllerInput, ControllerOutput, ControllerParams, System
from modelkit.model import Branch, Branches, Model

SYSTEMS = Branches(
    parameter="system",
    common="clock",
    systems=(
        Branch((System.NTBPTCWPT, System.NTBPT), "parking", model.parking_step),
        Branch((System.ZHANG2022,), "zhang2022", model.zhang_step),
        Branch((System.HSIC,), "hsic", model.hsic_step),
        Branch((System.PREVIEW,), "preview", model.preview_step),
        Branch((System.APA,), "apa", model.apa_step),
    ),
)
MODEL = Model(
    name="Controller",
    description="Automated parking: planner, path and point tracking, manoeuvre chart",
    package=sys.modules[__name__],
    state=model.ControllerState,
    params=ControllerParams,
    inputs=ControllerInput,
    outputs=ControllerOutput,
    initialize=model.initialize,
    step=SYSTEMS.step,
    step_size=0.01,
    stop_time=60.0,
    branches=SYSTEMS,
)
