"""A whole automated parking assist: slot search, planners, tracking, position tuning, supervision."""

from controller_fmu.apa import chart, manoeuvre_chart
from controller_fmu.apa.outputs import apa_outputs
from controller_fmu.apa.params import ApaSystem, ApaSystemParams
from controller_fmu.apa.signals import ApaInput, ApaOutput
from controller_fmu.apa.system import ApaState, apa_sample, apa_start
from modelkit.model import Chart, SampledSystem

SYSTEM = SampledSystem(
    field="apa",
    choices=ApaSystem,
    descriptions=("Parking assist: slot search, planner, tracking, position tuning",),
    state=ApaState,
    params=ApaSystemParams,
    inputs=ApaInput,
    reported=ApaOutput,
    start=apa_start,
    sample=apa_sample,
    outputs=apa_outputs,
    charts=(
        Chart("apa.mode", chart.Mode, chart.Guard, chart.TRANSITIONS),
        Chart("", manoeuvre_chart.Step, manoeuvre_chart.Guard, manoeuvre_chart.TRANSITIONS),
    ),
)
"""Its row of ``controller_fmu.registry``."""
