"""The parking system, a controller of its own until it replaces the others: its arrays would weigh on their memory."""

import sys

from controller_fmu.parking import chart
from controller_fmu.parking.model import ParkingModelState, parking_initialize, parking_step
from controller_fmu.parking.params import ParkingParams, ParkingSystem
from controller_fmu.parking.planning.work import PlanningWork
from controller_fmu.parking.signals import ParkingOutput, ParkingSystemInput
from modelkit.model import Chart, Model, Variant
from modelkit.terminals import TERMINALS

MODEL = Model(
    name="Controller_apa",
    description="Parking: a map of landmarks, slots in it, a path into one, a collision monitor",
    package=sys.modules[__package__.rpartition(".")[0]],
    state=ParkingModelState,
    params=ParkingParams,
    inputs=ParkingSystemInput,
    outputs=ParkingOutput,
    initialize=parking_initialize,
    step=parking_step,
    step_size=0.01,
    stop_time=5.0,
    terminals=TERMINALS,
    sampled=True,
    view=Variant((("system", int(ParkingSystem.APA)),), frozenset({"system"})),
    store=PlanningWork,
    charts=(Chart("apa.state", chart.ParkingState, chart.Condition, chart.TRANSITIONS),),
)
