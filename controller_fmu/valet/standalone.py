"""The valet system as a controller of its own: its work arrays would weigh on the memory of the others."""

import sys

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.valet import chart
from controller_fmu.valet.model import ValetModelState, valet_initialize, valet_step
from controller_fmu.valet.params import ValetParams, ValetSystem
from controller_fmu.valet.signals import ValetInput, ValetOutput
from modelkit.model import Chart, Model, Variant
from modelkit.terminals import TERMINALS

MODEL = Model(
    name="Controller_valet",
    description="Valet: plans a way among the polygons of a map and drives it",
    package=sys.modules[__package__.rpartition(".")[0]],
    state=ValetModelState,
    params=ValetParams,
    inputs=ValetInput,
    outputs=ValetOutput,
    initialize=valet_initialize,
    step=valet_step,
    step_size=0.01,
    stop_time=5.0,
    terminals=TERMINALS,
    sampled=True,
    view=Variant((("system", int(ValetSystem.VALET)),), frozenset({"system"})),
    store=PlanStore,
    charts=(Chart("valet.step", chart.Step, chart.Guard, chart.TRANSITIONS),),
)
"""A controller of its own: its map would weigh on the parameters of the others, its store on their memory."""
