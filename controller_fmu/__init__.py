"""The controller: planner, tracking laws and charts of automated parking. Knows nothing of FMI."""

import sys

from controller_fmu import model
from controller_fmu.adaptive import chart as adaptive_chart
from controller_fmu.adaptive.outputs import adaptive_outputs
from controller_fmu.adaptive.phases import AdaptivePhase
from controller_fmu.adaptive.system import adaptive_sample, adaptive_start
from controller_fmu.apa import chart as apa_chart
from controller_fmu.apa import manoeuvre_chart
from controller_fmu.apa.outputs import apa_outputs
from controller_fmu.apa.phases import ApaPhase
from controller_fmu.apa.system import apa_sample, apa_start
from controller_fmu.guo2015 import chart as guo_chart
from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.guo2015.system import guo_outputs, guo_sample, guo_start
from controller_fmu.hsic.outputs import hsic_outputs
from controller_fmu.hsic.phases import HsicPhase
from controller_fmu.hsic.system import hsic_sample, hsic_start
from controller_fmu.interface import ControllerInput, ControllerOutput, ControllerParams, System
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.preview.driving import driving_outputs, driving_sample, driving_start
from controller_fmu.preview.phases import PreviewPhase
from controller_fmu.valet import chart as valet_chart
from controller_fmu.valet.given import ValetInput
from controller_fmu.valet.model import ValetModelState, valet_initialize, valet_step
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.signals import ValetOutput
from controller_fmu.zhang2022.outputs import zhang_outputs
from controller_fmu.zhang2022.phases import ZhangPhase
from controller_fmu.zhang2022.system import zhang_sample, zhang_start
from modelkit.model import Chart, Model, SampledSystem, SampledSystems, View
from modelkit.terminals import TERMINALS

OF_PARKING = ("target", "vehicle_fault", "path", "shifts")
"""What every system has that parks at a given pose. The names are those that not all systems have."""
OF_GUO2015 = (*OF_PARKING, "threshold", "limit", "guo2015")
OF_ZHANG2022 = (
    *OF_PARKING,
    *(f"threshold.{name}" for name in ("standstill", "wheel", "miss_lateral", "miss_heading", "lost_lateral")),
    "limit",
    "zhang2022",
)
OUTLINE = ("car.front_overhang", "car.rear_overhang", "car.width")
OF_HSIC = (*OF_PARKING, *OUTLINE, "threshold.standstill", "threshold.lost_lateral", "limit", "hsic")
OF_PREVIEW = ("car.cg_to_rear", "threshold.standstill", "threshold.lost_lateral", "preview")
OF_APA = (
    *("gear", "brake_pedal", "vehicle_fault", "ultrasonic", "apa_switch", "driver_confirm"),
    *("told", "choice", "shifts"),
    *OUTLINE,
    "car.ultrasonic",
    "threshold.wheel",
    *(f"limit.{name}" for name in ("stopping", "pose_frozen", "wheel_off", "wheel_fault")),
    "apa",
)
OF_ADAPTIVE = (
    *OUTLINE,
    "target",
    "vehicle_fault",
    "shifts",
    "threshold.wheel",
    "threshold.standstill",
    "limit",
    "adaptive",
)
GUO_CHART = Chart("phase", GuoPhase, guo_chart.Guard, guo_chart.TRANSITIONS)
APA_CHART = Chart("apa.mode", apa_chart.Mode, apa_chart.Guard, apa_chart.TRANSITIONS)
MANOEUVRE_CHART = Chart("", manoeuvre_chart.Step, manoeuvre_chart.Guard, manoeuvre_chart.TRANSITIONS)
VALET_CHART = Chart("valet.step", valet_chart.Step, valet_chart.Guard, valet_chart.TRANSITIONS)
ADAPTIVE_CHART = Chart("phase", AdaptivePhase, adaptive_chart.Guard, adaptive_chart.TRANSITIONS)
SYSTEMS = SampledSystems(
    state=model.ControllerState,
    parameter="system",
    clock="clock",
    begin=model.begin,
    tick=model.tick,
    refused=model.refused,
    systems=(
        SampledSystem(
            (System.NTBPTCWPT, System.NTBPT),
            "guo2015",
            guo_start,
            guo_sample,
            guo_outputs,
            OF_GUO2015,
            (GUO_CHART,),
            states=(("phase", GuoPhase),),
        ),
        SampledSystem(
            (System.ZHANG2022,),
            "zhang2022",
            zhang_start,
            zhang_sample,
            zhang_outputs,
            OF_ZHANG2022,
            states=(("phase", ZhangPhase),),
        ),
        SampledSystem(
            (System.HSIC,), "hsic", hsic_start, hsic_sample, hsic_outputs, OF_HSIC, states=(("phase", HsicPhase),)
        ),
        SampledSystem(
            (System.PREVIEW,),
            "preview",
            driving_start,
            driving_sample,
            driving_outputs,
            OF_PREVIEW,
            states=(("phase", PreviewPhase),),
        ),
        SampledSystem(
            (System.APA,),
            "apa",
            apa_start,
            apa_sample,
            apa_outputs,
            OF_APA,
            (APA_CHART, MANOEUVRE_CHART),
            states=(("phase", ApaPhase),),
        ),
        SampledSystem(
            (System.ADAPTIVE,),
            "adaptive",
            adaptive_start,
            adaptive_sample,
            adaptive_outputs,
            OF_ADAPTIVE,
            (ADAPTIVE_CHART,),
            states=(("phase", AdaptivePhase),),
        ),
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
    sampled=True,
)
NTBPTCWPT = MODEL.only(System.NTBPTCWPT, "Controller_ntbptcwpt", "Parking by path and point tracking (Guo 2015)")
NTBPT = MODEL.only(System.NTBPT, "Controller_ntbpt", "Parking by path tracking (Guo 2015)")
ZHANG2022 = MODEL.only(System.ZHANG2022, "Controller_zhang2022", "Parking on a quintic path, MPC, PID (Zhang 2022)")
HSIC = MODEL.only(System.HSIC, "Controller_hsic", "Parking by human-simulated intelligent control")
PREVIEW = MODEL.only(System.PREVIEW, "Controller_preview", "Driving a road by dual-point preview and fuzzy control")
APA = MODEL.only(System.APA, "Controller_apa", "Parking assist: slot search, planner, tracking, position tuning")
ADAPTIVE = MODEL.only(System.ADAPTIVE, "Controller_adaptive", "Parking adapted to the driver: his speed, his stops")
VALET = Model(
    name="Controller_valet",
    description="Valet: plans a way among the polygons of a map and drives it",
    package=sys.modules[__name__],
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
    view=View((("system", int(System.VALET)),), frozenset({"system"})),
    store=PlanStore,
    charts=(VALET_CHART,),
)
"""No system of the other controller: its map would weigh on their parameters, its store on their memory."""
SYSTEM_MODELS = {
    System.NTBPTCWPT: NTBPTCWPT,
    System.NTBPT: NTBPT,
    System.ZHANG2022: ZHANG2022,
    System.HSIC: HSIC,
    System.PREVIEW: PREVIEW,
    System.APA: APA,
    System.ADAPTIVE: ADAPTIVE,
}
"""The controller with one system alone: the same code, with that system's parameters, inputs and outputs only."""
