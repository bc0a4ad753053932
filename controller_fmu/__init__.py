"""The controller: planner, tracking laws and charts of automated parking. Knows nothing of FMI."""

import sys

from controller_fmu import model
from controller_fmu.apa.outputs import apa_outputs
from controller_fmu.apa.system import apa_sample, apa_start
from controller_fmu.guo2015.parking import outputs, sample, start
from controller_fmu.hsic.outputs import hsic_outputs
from controller_fmu.hsic.system import hsic_sample, hsic_start
from controller_fmu.interface import ControllerInput, ControllerOutput, ControllerParams, System
from controller_fmu.preview.driving import driving_outputs, driving_sample, driving_start
from controller_fmu.zhang2022.outputs import zhang_outputs
from controller_fmu.zhang2022.system import zhang_sample, zhang_start
from modelkit.model import Model, SampledSystem, SampledSystems
from modelkit.terminals import TERMINALS

SYSTEMS = SampledSystems(
    state=model.ControllerState,
    parameter="system",
    clock="clock",
    begin=model.begin,
    tick=model.tick,
    refused=model.refused,
    systems=(
        SampledSystem((System.NTBPTCWPT, System.NTBPT), "parking", start, sample, outputs),
        SampledSystem((System.ZHANG2022,), "zhang2022", zhang_start, zhang_sample, zhang_outputs),
        SampledSystem((System.HSIC,), "hsic", hsic_start, hsic_sample, hsic_outputs),
        SampledSystem((System.PREVIEW,), "preview", driving_start, driving_sample, driving_outputs),
        SampledSystem((System.APA,), "apa", apa_start, apa_sample, apa_outputs),
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
    initialize=SYSTEMS.initialize,
    step=SYSTEMS.step,
    step_size=0.01,
    stop_time=60.0,
    terminals=TERMINALS,
    systems=SYSTEMS,
)
