"""The controller: planner, tracking laws and charts of automated parking. Knows nothing of FMI."""

import sys

from controller_fmu import model
from controller_fmu.apa.outputs import apa_outputs
from controller_fmu.apa.system import apa_sample
from controller_fmu.guo2015.parking import outputs, sample
from controller_fmu.hsic.outputs import hsic_outputs
from controller_fmu.hsic.system import hsic_sample
from controller_fmu.interface import ControllerInput, ControllerOutput, ControllerParams, System
from controller_fmu.preview.driving import driving_outputs, driving_sample
from controller_fmu.zhang2022.outputs import zhang_outputs
from controller_fmu.zhang2022.system import zhang_sample
from modelkit.model import Branch, Branches, Model
from modelkit.terminals import TERMINALS

SYSTEMS = Branches(
    parameter="system",
    clock="clock",
    tick=model.tick,
    refused=model.refused,
    systems=(
        Branch((System.NTBPTCWPT, System.NTBPT), "parking", sample, outputs),
        Branch((System.ZHANG2022,), "zhang2022", zhang_sample, zhang_outputs),
        Branch((System.HSIC,), "hsic", hsic_sample, hsic_outputs),
        Branch((System.PREVIEW,), "preview", driving_sample, driving_outputs),
        Branch((System.APA,), "apa", apa_sample, apa_outputs),
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
    terminals=TERMINALS,
    branches=SYSTEMS,
)
